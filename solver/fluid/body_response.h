// Free bodies, and soft ones (soft_response.h), inside the pressure iterations: how far a fluid's pressures move the
// bodies that it touches, and what that changes for the fluid's densities.
#pragma once

#include <vector>

#include <froude/base/aligned.h>
#include <froude/solver/coupling/free_bodies.h>
#include <froude/solver/fluid/soft_response.h>
#include <froude/solver/fluid/wall_layer.h>

namespace froude {

/// Bodies and pressures are two unknowns of one saddle-point problem. The pressures are swept as before; the bodies'
/// displacements q follow the impulse of the pressures, M q = Σ 2κ G, and are held back by what the fluid will answer:
/// q += (M + K)⁻¹ (Σ 2κ G − M q), K = Σ 2 G Gᵀ/diagonal (a preconditioned Uzawa iteration). Without K a body much
/// lighter than the fluid that it moves is thrown to and fro. G is a particle's wall gradient and its moment about the
/// centre of mass. All lengths in spacings dx; masses in particles' masses.
class BodyResponse {
 public:
  /// What lengths, masses and impulses are divided by.
  struct Units {
    double spacing;  // dx [m]
    double mass;     // of a particle [kg/m]
    double impulse;  // of a displacement by dx of one particle, mass·dx/dt [kg/s]
  };
  /// All free bodies and soft walls, at the start of a pressure solve; null: there are none. Without links a body only
  /// loses, in `settle`, what its motion had of a pressure.
  void begin(FreeBodies* bodies, SoftWalls* soft, const Units& units);
  /// The links of `walls` to them, of particles at x, y [m].
  void link(const WallLayer& walls, std::span<const double> x, std::span<const double> y);
  bool any() const { return !links_.empty() || soft_.any(); }
  bool anySoft() const { return soft_.any(); }
  bool anyRigid() const { return !links_.empty(); }
  SoftResponse& soft() { return soft_; }

  /// After the diagonal of the pressure system is known: what holds the bodies back.
  void holdBack(const float* diagonal);
  /// What the particles see of the walls while no body has moved by the pressures: their λ, or what these gain. Must
  /// stay where it is.
  void startFrom(std::span<const float> field);
  /// One step towards where the pressures κ, times `share`, bring the bodies; writes the field as the fluid now sees
  /// it. past: part of the sub-step that these pressures are of, (0, 1]; a body's motion has all of what was expected
  /// of the sub-step, and only that part of it is to be found in them.
  void follow(const float* kappa, double share = 1.0, double past = 1.0);
  /// The field by particle.
  const float* answered() const { return any() ? answered_.data() : field_; }
  /// Tells the bodies what the pressures κ are to them and moves them; also those that the fluid has left. κ may be
  /// null where there are no links.
  void settle(const float* kappa);

 private:
  struct Link {
    std::uint32_t particle;
    std::uint32_t body;  // into moving_
    double x, y, moment;
  };
  struct Body {
    int owner;
    std::optional<Vec2> arm;         // from its hinge to its centre of mass
    double mass, inertia;            // about the centre of mass
    Wrench expected{0.0, 0.0, 0.0};  // impulse that its motion has already
    std::array<double, 6> hold{};    // K: xx, xy, yy, xm, ym, mm
    Wrench moved{0.0, 0.0, 0.0};     // q
    bool touched = false;            // by any particle
  };
  void add(int owner);
  void sumImpulses(const float* kappa, double share);
  static void step(Body& body, const Wrench& impulse, double past = 1.0);

  FreeBodies* bodies_ = nullptr;
  std::vector<Body> moving_;
  std::vector<Link> links_;            // by particle
  std::vector<std::int32_t> indexOf_;  // of each owner in moving_, −1
  std::vector<Wrench> sums_;
  const float* field_ = nullptr;
  AlignedArray<float> answered_;
  Units units_{1.0, 1.0, 1.0};
  SoftResponse soft_;
};

}  // namespace froude
