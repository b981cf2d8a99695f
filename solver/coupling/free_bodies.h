// Free bodies as particles meet them within a sub-step: what pushes them, and where they give way to.
#pragma once

#include <array>

#include <froude/solver/coupling/obstacles.h>
#include <froude/solver/rigid/body_set.h>
#include <froude/solver/step_context.h>

namespace froude {

/// A linear impulse and a moment about the centre of mass, or a displacement and a turn.
using Wrench = std::array<double, 3>;

/// The bodies' side of a pressure that moves them. The rigid solver has moved them already, with the pressure of the
/// sub-step before; what a fluid finds now changes that.
class FreeBodies {
 public:
  FreeBodies(BodySet& bodies, Obstacles& obstacles) : bodies_(bodies), obstacles_(obstacles) {}
  void begin(double dt, double reach) { dt_ = dt, reach_ = reach; }

  /// Is the owner (−1: the domain) a free body?
  bool isFree(int owner) const { return owner >= 0 && bodies_.isFree(static_cast<std::size_t>(owner)); }
  std::size_t count() const { return bodies_.size(); }
  /// Where its centre of mass is at the end of the sub-step [m].
  Vec2 center(int owner) const {
    const BodyMotion& m = bodies_.motion(static_cast<std::size_t>(owner));
    return m.position + dt_ * m.velocity;
  }
  /// Its motion over the sub-step: of the centre of mass [m/s], and its spin [rad/s].
  const Vec2& velocity(int owner) const { return bodies_.motion(static_cast<std::size_t>(owner)).velocity; }
  double spin(int owner) const { return bodies_.motion(static_cast<std::size_t>(owner)).spin; }
  const MassData& mass(int owner) const { return bodies_.mass(static_cast<std::size_t>(owner)); }
  /// From its hinge to its centre of mass at the end of the sub-step; empty if it has none.
  std::optional<Vec2> hingeArm(int owner) const;
  /// Impulse of the pressure that its motion has already.
  Wrench expected(int owner) const {
    const FreeState& f = bodies_.freeState(static_cast<std::size_t>(owner));
    return {dt_ * f.pressure.x(), dt_ * f.pressure.y(), dt_ * f.pressureTorque};
  }
  /// The impulse that it is, and how much farther than its motion the body gets by it [m, rad].
  void push(int owner, const Wrench& impulse, const Wrench& displacement);
  double turn(int owner) const { return std::abs(dt_ * bodies_.motion(static_cast<std::size_t>(owner)).spin); }
  /// Obstacles are where the pushed bodies are. Cost: that of Obstacles::beginStep.
  void settle() { obstacles_.beginStep(bodies_, dt_, reach_); }

 private:
  BodySet& bodies_;
  Obstacles& obstacles_;
  double dt_ = 0.0, reach_ = 0.0;
};

/// Does a free body turn by 4 rad or more in the sub-step, beyond what bounds the step before it is pushed? Round one
/// that turns a million times, paths would be followed for hours. Says so in `stats`.
bool overTurned(const StepContext& context, StepStats& stats);

/// Changes the velocities of free bodies by what particles gave them (by owner, of which `expected` they have already);
/// wakes what was hit. Momentum is kept to rounding.
void giveImpulse(BodySet& bodies, std::size_t body, const Wrench& impulse);

}  // namespace froude
