// A world of particles among polygons, and the step that moves it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <froude/base/archive.h>
#include <froude/base/transform.h>
#include <froude/particles/pool.h>
#include <froude/solver/definitions.h>
#include <froude/solver/report.h>

namespace froude {

/// State of a body as seen from outside.
struct BodyState {
  Transform transform;
  double angle = 0.0;   // [rad], not wrapped
  Vec2 velocity{0, 0};  // of the origin [m/s]
  double spin = 0.0;    // [rad/s]
  Vec2 force{0, 0};     // of particles and fluid on the body, over the last sub-step [N/m]
  double torque = 0.0;  // about the centre of mass [N]
};

/// Sums over particles (one species or all), at the present time.
struct Totals {
  std::size_t count = 0;
  double mass = 0.0;       // [kg/m]
  double kinetic = 0.0;    // [J/m]
  double potential = 0.0;  // from the lowest point of the domain, constant gravity only [J/m]
  Vec2 momentum{0, 0};     // [kg/s]
  double angular = 0.0;    // about the world's origin
  double maxSpeed = 0.0;   // [m/s]
};

/// Bytes that a world of this definition and so many particles will take; for predictions and refusals.
std::size_t estimateWorldBytes(const WorldDef& def, std::size_t fluidParticles, std::size_t bullets);

/// The world. Construction throws Error; steps never throw. Not copyable; all access from one thread at a time.
class World {
 public:
  explicit World(const WorldDef& def);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Adds particles; positions inside a polygon are an Error. Order of calls is part of the state.
  void addFluid(std::span<const Vec2> positions, std::span<const Vec2> velocities);
  void addBullets(std::span<const Vec2> positions, std::span<const Vec2> velocities);

  /// Advances by exactly dt [s] in as many sub-steps as the bounds ask for.
  StepReport step(double dt);
  /// One accepted sub-step of the length that the bounds allow, at most `maxDt` [s].
  StepReport substep(double maxDt = kInfinity);

  double time() const;
  const WorldDef& definition() const;
  const Ledger& ledger() const;

  /// Live particles in cell order; the pools' columns are the state itself. Null when the scene has none of the
  /// species. Fluid columns besides x, y, vx, vy: "pressure" (float, p/density in m²/s²), "density" (float, relative to
  /// rest).
  const ParticlePool* fluid() const;
  const ParticlePool* bullets() const;
  ParticlePool* fluid();
  ParticlePool* bullets();
  double fluidMass() const;   // of one particle [kg/m]
  double bulletMass() const;  // [kg/m]

  std::size_t bodyCount() const;
  const BodyState& body(std::size_t index) const;
  const BodyDef& bodyDefinition(std::size_t index) const;
  /// Index of a body by name; throws Error with the nearest name.
  std::size_t bodyIndex(std::string_view name) const;

  Totals totals(std::optional<Species> species = std::nullopt) const;

  /// Filled fraction φ at points: Σ (m/ρ0) W + λ, hidden particles masked. Outside solids only; inside a solid it is
  /// NaN. Valid after construction and after each step. Cost: a neighbour query a point; parallel over points.
  void filledFraction(std::span<const Vec2> points, std::span<double> phi) const;
  /// Shepard means over one support radius at a point: pressure [N/m] and velocity; NaN where no particle is near.
  double pressureAt(const Vec2& point) const;
  Vec2 velocityAt(const Vec2& point) const;
  /// Is the point inside a polygon or beyond a closed side of the domain?
  bool insideSolid(const Vec2& point) const;

  /// Everything on which the future depends; see base/archive.h.
  void archive(Archive& a);
  std::string stateHash() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace froude
