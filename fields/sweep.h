// The swept query: when does a moving disc first touch a polygon, fixed or moving and turning? Never misses a crossing.
#pragma once

#include <froude/base/api.h>
#include <froude/base/transform.h>
#include <froude/base/types.h>

namespace froude {

class DistanceField;

/// The first contact of a sweep. If !hit, only `time` = 1 and `center` = the end of the path are meaningful.
struct SweepHit {
  bool hit = false;
  double time = 1.0;       ///< fraction of the step, 0 … 1
  Vec2 center{0.0, 0.0};   ///< put the disc here: its centre at `time`, a rounding skin off the solid [m]
  Vec2 point{0.0, 0.0};    ///< contact point on the boundary at `time` [m]
  Vec2 normal{0.0, 0.0};   ///< outward, unit, at `time`
  std::int32_t edge = -1;  ///< number of the edge that was hit; a vertex is the start of its edge
  std::int32_t body = -1;  ///< WorldField only: the body that was hit, −1 for a wall of the domain
  bool startedInside =
      false;  ///< the disc overlapped at the start; then time = 0 and normal is the minimum translation's
};

/// Constant velocity and spin during a step.
struct FROUDE_API RigidMotion {
  Transform start;          ///< pose at the beginning
  Vec2 velocity{0.0, 0.0};  ///< of the polygon's origin [m/s]
  double spin = 0.0;        ///< [rad/s]

  /// Pose after t seconds.
  Transform at(double t) const;
  /// Velocity of the material point that is at `world` after t seconds [m/s].
  Vec2 velocityAt(const Vec2& world, double t) const { return velocity + cross(spin, world - at(t).position); }
};

/// Relative thickness of the contact skin: a disc is put kSweepSkin · (largest coordinate in play) off the solid, so
/// that rounding between frames cannot carry it inside.
inline constexpr double kSweepSkin = 0x1p-44;

/// Disc of `radius` [m] (0 … band of the field) on the straight path from → to, in the polygon's own frame; so is the
/// answer.
///
/// Exact to rounding. A disc that starts in contact and moves off or along the boundary does not hit; one that moves in
/// hits at time 0. For radius 0 the decision on the boundary itself is exact. A disc that overlaps by more than the
/// skin at the start is reported at time 0 with `startedInside`, whatever its direction. A path with a coordinate that
/// is not finite never hits. No allocation. Cost: cells crossed; empty space is skipped by its clearance.
FROUDE_API SweepHit sweepDisc(const DistanceField& field, const Vec2& from, const Vec2& to, double radius);

/// The same for a polygon that moves: the disc goes straight from → to in the world during `dt` [s], and all of the
/// answer is in world coordinates at the time of impact.
///
/// The path in the polygon's frame is a curve; it is followed in chords whose deviation is added to the radius and
/// shortened until it is as small as rounding, so no crossing is missed at any speed, spin or thickness. Where a disc
/// grazes for long, it is held off by at most a thousandth of its radius, or of a millionth of the polygon's size if
/// that is less or the radius is 0.
FROUDE_API SweepHit sweepDisc(const DistanceField& field, const RigidMotion& motion, double dt, const Vec2& from,
                              const Vec2& to, double radius);

}  // namespace froude
