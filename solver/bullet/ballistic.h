// Bullets: no interaction among themselves, exact collision with the polygons, bounce and friction.
#pragma once

#include <span>

#include <froude/base/api.h>
#include <froude/particles/pool.h>
#include <froude/solver/bullet/flight.h>
#include <froude/solver/coupling/contact_log.h>
#include <froude/solver/step_context.h>

namespace froude {

/// Largest sub-step of bullets [s]: the chord of a step departs from the parabola by at most a tenth of the radius.
FROUDE_API double bulletStepBound(const BulletDef& def, double gravity);

/// Moves the bullets of a pool.
class Ballistic {
 public:
  explicit Ballistic(const BulletDef& def);
  double mass() const { return mass_; }  // [kg/m]
  /// One sub-step. Positions in free flight are exact for constant gravity; contacts are found along the chord. Bullets
  /// whose path a map of free space proves free fly over SIMD lanes; the map decides the cost alone, not one bit.
  void advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);
  /// By block of kBlockSize bullets: not 0 if `advance` marked one of them or one has left (hasLeft in flight.h).
  std::span<const std::uint8_t> left() const { return left_.span(); }

 private:
  // Moves one bullet by the exact query; true if it is marked or has left.
  bool follow(const StepContext& context, const DiscContact& disc, ParticlePool& pool, std::uint32_t i);

  BulletDef def_;
  double mass_;
  FreeMap map_;
  ContactLog contacts_;
  AlignedArray<std::uint32_t> near_;              // by block: the bullets that the map leaves to the exact query
  std::vector<std::uint32_t> crushed_;            // counts, one a block
  std::vector<std::vector<ParticleLeak>> leaks_;  // lists, one a block; empty but for what went wrong
  AlignedArray<std::uint8_t> left_;
};

}  // namespace froude
