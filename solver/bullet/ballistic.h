// Bullets: no interaction among themselves, exact collision with the polygons, bounce and friction.
#pragma once

#include <froude/base/api.h>
#include <froude/particles/pool.h>
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
  /// One sub-step. Positions in free flight are exact for constant gravity; contacts are found along the chord.
  void advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);

 private:
  BulletDef def_;
  double mass_;
  ContactLog contacts_;
  std::vector<std::uint32_t> crushed_;
};

}  // namespace froude
