// Sums over the particles of a pool in one pass, for the accounts of mass, momentum and energy.
#pragma once

#include <froude/base/simd.h>
#include <froude/base/types.h>
#include <froude/particles/pool.h>

namespace froude {

/// Sums over particles of unit mass, and their extremes. NaN where a particle is not finite.
struct ParticleSums {
  double x = 0.0, y = 0.0;       // Σ position [m]
  double vx = 0.0, vy = 0.0;     // Σ velocity [m/s]
  double speedSquared = 0.0;     // Σ v² [m²/s²]
  double angular = 0.0;          // Σ x × v [m²/s]
  double maxSpeedSquared = 0.0;  // [m²/s²]
  Box bounds;                    // of the positions [m]; says nothing if a position is not finite
  bool finite() const { return std::isfinite(x + y + speedSquared); }
};

/// The sums of a pool. The same bits on any number of threads and for every target: fixed blocks of particles, eight
/// partial sums in each, added in order, no fused multiply-add. Cost: 32 bytes read a particle.
ParticleSums sumParticles(const ParticlePool& pool, SimdTarget target);

}  // namespace froude
