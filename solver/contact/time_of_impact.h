// When two moving and turning convex polygons meet first.
#pragma once

#include <froude/fields/sweep.h>
#include <froude/solver/contact/closest_features.h>

namespace froude {

enum class ImpactStatus : std::uint8_t {
  Separate,     // never nearer than the target in the time asked for
  Hit,          // at `time` they are at the target distance
  Overlapping,  // at the start already
  Failed        // not decided within the bound on steps; they are free up to `time`
};

struct TimeOfImpact {
  ImpactStatus status = ImpactStatus::Failed;
  double time = 0.0;  // [s]; they are apart before it
  int steps = 0;
};

/// Conservative advancement over the closest features, from t = 0 to `duration` [s] ≥ 0. `target` [m] > 0 is the
/// distance that counts as touching, met to a tenth of it. Pairs that start nearer than the target and part are
/// Separate; that come closer, Hit at 0. At most 100 steps and 20 for each radian of turning, 10,000 in all; a few
/// where nothing grazes.
FROUDE_API TimeOfImpact timeOfImpact(const ConvexShape& a, const RigidMotion& motionA, const ConvexShape& b,
                                     const RigidMotion& motionB, double duration, double target);

}  // namespace froude
