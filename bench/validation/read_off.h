// Numbers that several cases read off the fluid's particles.
#pragma once

#include <functional>
#include <vector>

#include <froude/solver/world.h>

namespace froude::validation {

/// Velocity at a place [m/s].
using Flow = std::function<Vec2(const Vec2&)>;

/// √(Σ |v − v_exact(x)|² / Σ |v_exact(x)|²) over the particles.
double velocityError(const ParticlePool& pool, const Flow& exact);

/// Largest over `bins` equal strips in from ≤ position < to of |mean of (speed − exact)|: means over a strip take the
/// particles' own positions, so that an uneven filling of a strip is no error. `position`, `difference`: of the
/// particle at an index. Strips without particles are left out.
std::vector<double> stripMeans(std::size_t count, double from, double to, int bins,
                               const std::function<double(std::size_t)>& position,
                               const std::function<double(std::size_t)>& difference);

/// Mean, covariance and kinetic energy per mass of the particles.
struct Moments {
  Vec2 centre{0, 0};                    // [m]
  double xx = 0.0, yy = 0.0, xy = 0.0;  // ⟨(x − centre)²⟩ … [m²]
  double kinetic = 0.0;                 // ½⟨v²⟩ [m²/s²]
  double angular = 0.0;                 // ⟨x v_y − y v_x⟩ about the origin [m²/s]
  /// Semi-axes of the uniform ellipse with these moments, along x and y [m].
  double axisX() const;
  double axisY() const;
};
Moments moments(const ParticlePool& pool);

/// How evenly the particles lie.
struct Clumping {
  double leastDistance = 0.0;  // of any two [m]; infinite for fewer than two
  double closeShare = 0.0;     // of particles with a neighbour nearer than `close`
  std::size_t components = 0;  // groups of particles that are linked by distances below `link`
};
/// close, link [m], close ≤ link. Cost: neighbours within `link`.
Clumping clumping(const ParticlePool& pool, double close, double link);

}  // namespace froude::validation
