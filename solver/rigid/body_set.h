// The polygons' own motion: fixed ones stand, scripted ones follow their script. Knows no particles.
#pragma once

#include <span>
#include <vector>

#include <froude/base/archive.h>
#include <froude/base/transform.h>
#include <froude/solver/definitions.h>

namespace froude {

/// Pose and motion of a body over one sub-step.
struct BodyMotion {
  Vec2 position{0, 0};  // of the origin [m]
  double angle = 0.0;   // [rad], not wrapped
  Vec2 velocity{0, 0};  // of the origin [m/s], constant over the sub-step
  double spin = 0.0;    // [rad/s], constant over the sub-step
  Transform transform() const { return Transform::of(position, angle); }
};

/// Bodies by index, in the order of the definitions.
class BodySet {
 public:
  explicit BodySet(std::vector<BodyDef> definitions);

  std::size_t size() const { return definitions_.size(); }
  const BodyDef& definition(std::size_t i) const { return definitions_[i]; }
  const BodyMotion& motion(std::size_t i) const { return motions_[i]; }
  bool moves(std::size_t i) const { return definitions_[i].motion == Motion::Scripted; }
  bool anyMoves() const { return anyMoves_; }

  /// Sets each scripted body's velocity and spin to the mean of its script over [t, t + dt] (exact where constant,
  /// midpoint rule in each piece for expressions: error O(dt²)).
  void beginStep(double t, double dt);
  /// Moves the bodies by dt at the velocities of `beginStep`.
  void finishStep(double dt);

  /// Fastest point of any body over the next step [m/s] and largest spin [rad/s].
  double maxSurfaceSpeed() const;
  double maxSpin() const;

  void archive(Archive& a);

 private:
  std::vector<BodyDef> definitions_;
  std::vector<BodyMotion> motions_;
  std::vector<double> radius_;  // largest distance of a vertex from the origin [m]
  bool anyMoves_ = false;
  AlignedArray<double> flat_;  // work space of archive
};

}  // namespace froude
