// A world of particles among polygons, and the step that moves it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/archive.h>
#include <froude/base/transform.h>
#include <froude/particles/pool.h>
#include <froude/solver/definitions.h>
#include <froude/solver/events.h>
#include <froude/solver/queries.h>
#include <froude/solver/report.h>

namespace froude {

/// State of a body as seen from outside.
struct BodyState {
  Transform transform;
  double angle = 0.0;   // [rad], not wrapped
  Vec2 velocity{0, 0};  // of the origin, of a free body its centre of mass [m/s]
  double spin = 0.0;    // [rad/s]
  Vec2 force{0, 0};     // of particles, fluid, other bodies, walls and hinge, over the last sub-step [N/m]
  double torque = 0.0;  // about the centre of mass [N]
  bool asleep = false;  // a free body that rests, with all that it touches
};

/// State of a soft body.
struct SoftState {
  double mass = 0.0;     // [kg/m]
  double area = 0.0;     // of its triangles [m²]
  double kinetic = 0.0;  // [J/m]
  double strain = 0.0;   // elastic energy [J/m]
  Vec2 center{0, 0};     // of mass [m]
  Vec2 momentum{0, 0};   // [kg/s]
  std::size_t torn = 0;  // triangles or links that gave way
};

/// Sums over particles of one species, or over all particles and free bodies, at the present time. Count and largest
/// speed are of particles alone.
struct Totals {
  std::size_t count = 0;
  double mass = 0.0;       // [kg/m]
  double kinetic = 0.0;    // [J/m]
  double potential = 0.0;  // from the lowest point of the domain, constant gravity only [J/m]
  double strain = 0.0;     // elastic energy of soft bodies [J/m]
  Vec2 momentum{0, 0};     // [kg/s]
  double angular = 0.0;    // about the world's origin
  double maxSpeed = 0.0;   // [m/s]
};

/// Bytes that a world of this definition and so many particles will take; for predictions and refusals.
FROUDE_API std::size_t estimateWorldBytes(const WorldDef& def, std::size_t fluidParticles, std::size_t bullets);

/// The world. Not copyable; all access from one thread at a time. Construction and all that changes the world between
/// steps throw Error and then leave it as it was; steps never throw. Loops run in the TBB arena of the caller; nothing
/// global is set. Vectors are in world coordinates, angles in rad.
class FROUDE_API World {
 public:
  explicit World(const WorldDef& def);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Advances by exactly dt [s], finite, in as many sub-steps as the bounds ask for. dt ≤ 0 does nothing.
  StepReport step(double dt);
  /// One accepted sub-step of the length that the bounds allow, at most `maxDt` [s]; nothing happens unless that is
  /// above 0.
  StepReport substep(double maxDt = kInfinity);

  double time() const;
  /// What the world was built from. Bodies created later are not in it; see `bodyDefinition`.
  const WorldDef& definition() const;
  const Ledger& ledger() const;

  // ---- particles

  /// Adds particles; returns their handles in the same order. Error for a position outside the domain or inside a
  /// polygon that the species collides with. The order of calls is part of the state. Cost: a distance query each.
  std::vector<ParticleHandle> addFluid(std::span<const Vec2> positions, std::span<const Vec2> velocities);
  std::vector<ParticleHandle> addBullets(std::span<const Vec2> positions, std::span<const Vec2> velocities);
  /// Takes one particle away, whose index the last one gets; false for a null or stale handle. Cost: O(1).
  bool kill(Species species, ParticleHandle particle);
  /// Takes away all whose centre is in the area; returns how many. Cost: one pass over the columns.
  std::size_t kill(Species species, const Area& area);
  /// Indices of the particles whose centre is in the area, in column order; the vector's memory is reused. They are
  /// good until the next call that changes the world. Error without the species. Cost: one pass over x and y.
  void find(Species species, const Area& area, std::vector<std::uint32_t>& indices) const;

  /// Live particles in cell order; the pools' columns are the state itself, without copies. Null when the scene has
  /// none of the species. Fluid columns besides x, y, vx, vy: "pressure" (float, p/density in m²/s²), "density" (float,
  /// relative to rest). A caller may add columns of its own and write into any; State columns are sorted, compacted,
  /// saved and hashed with the rest (a state is loaded into a world that has the same ones). Spans end with the next
  /// step. Asking for write access costs one pass over the particles in the next step, which books what was changed;
  /// ask again after each step.
  const ParticlePool* fluid() const;
  const ParticlePool* bullets() const;
  ParticlePool* fluid();
  ParticlePool* bullets();
  double fluidMass() const;   // of one particle [kg/m]
  double bulletMass() const;  // [kg/m]

  /// Replaces WorldDef::force from the next sub-step on; an empty function: none. Like scripts it is not saved.
  void setForce(ForceCallback force);

  // ---- bodies

  /// Makes a body. Particles that collide with it and are where it stands have no place any more: they are retired and
  /// counted as crushed (fluids by their centre, bullets by their disc). It may overlap other bodies. Error as in the
  /// constructor. Cost: a pass over the particles; once before the next step or query, the field of all fixed bodies if
  /// it is fixed, its own field if it moves and no body with the same shape object is there.
  BodyId createBody(const BodyDef& def);
  /// Takes a body away; bodies behind it move down by one index, ids last. Error for a null or stale id.
  void destroyBody(BodyId id);
  /// Puts a body elsewhere at once, a fixed one too; a scripted one goes on from there. Crushes and costs as
  /// `createBody`. To push particles away instead, give a scripted body a velocity.
  void placeBody(BodyId id, const Vec2& position, double angle);
  /// Of a scripted body without script, from the next sub-step on [m/s, of its origin; rad/s], or of a free body (its
  /// centre of mass), which wakes. Error for others.
  void setBodyVelocity(BodyId id, const Vec2& velocity, double spin);
  /// The velocity and spin that bring it to this pose in `duration` [s] > 0; it keeps them until told otherwise.
  void steerBody(BodyId id, const Vec2& position, double angle, double duration);

  // ---- soft bodies

  /// Appends a soft body; returns its index. A state is loaded into a world that has the same ones. Error for a
  /// definition that cannot work, or a point outside the domain or inside a polygon that it collides with; points that
  /// are pinned may be inside. Cost: sorting its edges, a distance query a point.
  std::size_t addSoft(const SoftDef& def);
  std::size_t softCount() const;
  const SoftDef& softDefinition(std::size_t index) const;
  /// Pool index of its first particle; that of the mesh's point k is k later, as long as the body is there.
  std::size_t softFirst(std::size_t index) const;
  SoftState softState(std::size_t index) const;
  /// By triangle of its mesh, by link of a rope: the largest |principal stretch − 1|; NaN where it is torn. The
  /// vector's memory is reused.
  void softStrain(std::size_t index, std::vector<double>& values) const;
  /// The particles of all soft bodies, never sorted; null when there are none. Columns besides x, y, vx, vy: "mass"
  /// (double, [kg/m]), "body" (uint32, its index).
  const ParticlePool* soft() const;
  ParticlePool* soft();

  std::size_t bodyCount() const;
  bool isAlive(BodyId id) const;
  /// Bodies by index, 0 … bodyCount() − 1, in the order of their making. Error for an index or id that is not there.
  BodyId bodyId(std::size_t index) const;
  std::size_t bodyIndex(BodyId id) const;
  /// By name, the first of that name; throws Error with the names that there are.
  std::size_t bodyIndex(std::string_view name) const;
  const BodyState& body(std::size_t index) const;
  const BodyState& body(BodyId id) const;
  const BodyDef& bodyDefinition(std::size_t index) const;
  const BodyDef& bodyDefinition(BodyId id) const;

  // ---- questions: they alter nothing

  /// The first body, or closed side of the domain, on the straight line from → to [m], exact; bodies that `filter` does
  /// not accept let it through. Valid within the domain; along periodic sides bodies are met up to one period away.
  /// Cost: cells of the world field that are crossed, and a box test for each moving body.
  RayHit castRay(const Vec2& from, const Vec2& to, const CollisionFilter& filter = kEverything) const;
  /// A body that holds the point, the nearest boundary's if there are several; null if none does. Cost: one distance
  /// query; far inside a body a search over all.
  BodyId bodyAt(const Vec2& point, const CollisionFilter& filter = kEverything) const;
  /// Bodies that share a point with the area, by index; the vector's memory is reused. Cost: edges of all bodies.
  void findBodies(const Area& area, std::vector<BodyId>& found, const CollisionFilter& filter = kEverything) const;

  Totals totals(std::optional<Species> species = std::nullopt) const;

  /// Filled fraction φ at points: Σ (m/ρ0) W + λ, hidden particles masked. Outside solids only; inside a solid it is
  /// NaN. Valid after construction and after each step. Cost: a neighbour query a point; parallel over points.
  void filledFraction(std::span<const Vec2> points, std::span<double> phi) const;
  /// Shepard means over one support radius at a point: pressure [N/m] and velocity; NaN where no particle is near.
  double pressureAt(const Vec2& point) const;
  Vec2 velocityAt(const Vec2& point) const;
  /// Is the point inside a polygon that the filter accepts, or beyond a closed side of the domain?
  bool insideSolid(const Vec2& point, const CollisionFilter& filter = kEverything) const;

  // ---- events of the last step() or substep()

  /// What to record from now on; nothing unless asked. Recorded or not, the state is the same to the bit as long as no
  /// bullet leaks (EventSettings::leaks).
  void record(const EventSettings& settings);
  /// In order of time by sub-step, there fluid before bullets, each by the particle's slot: the same on any number of
  /// threads. Good until the next step.
  std::span<const ContactEvent> contacts() const;
  std::span<const SinkEvent> swallowed() const;
  /// As many as the ledger's leaks have grown by.
  std::span<const LeakEvent> leaks() const;

  /// Everything on which the future depends; see base/archive.h.
  void archive(Archive& a);
  std::string stateHash() const;

 private:
  struct Impl;
  std::vector<ParticleHandle> add(Species species, std::span<const Vec2> positions, std::span<const Vec2> velocities);
  std::unique_ptr<Impl> impl_;
};

}  // namespace froude
