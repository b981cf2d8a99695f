#include <froude/solver/coupling/free_bodies.h>

namespace froude {

std::optional<Vec2> FreeBodies::hingeArm(int owner) const {
  const auto i = static_cast<std::size_t>(owner);
  if (!bodies_.definition(i).hinge) return std::nullopt;
  const BodyMotion& m = bodies_.motion(i);
  return Vec2(-Rotation::of(m.angle + dt_ * m.spin).apply(bodies_.hingeAnchor(i)));
}

bool overTurned(const StepContext& context, StepStats& stats) {
  constexpr double kMostTurn = 4.0;  // [rad]
  const FreeBodies* bodies = context.freeBodies;
  for (int owner = 0; bodies != nullptr && owner < static_cast<int>(bodies->count()); ++owner) {
    if (!bodies->isFree(owner) || bodies->turn(owner) < kMostTurn) continue;
    stats.trouble = Trouble::Turn;
    stats.troubleValue = bodies->turn(owner);
    stats.troubleLimit = kMostTurn;
    stats.troubleAt = bodies->center(owner);
    return true;
  }
  return false;
}

void FreeBodies::push(int owner, const Wrench& impulse, const Wrench& displacement) {
  const auto i = static_cast<std::size_t>(owner);
  FreeState& f = bodies_.freeState(i);
  const double rate = 1.0 / dt_;
  f.pressure = rate * Vec2(impulse[0], impulse[1]);
  f.pressureTorque = rate * impulse[2];
  const BodyMotion& m = bodies_.motion(i);
  bodies_.setMotion(i, m.velocity + rate * Vec2(displacement[0], displacement[1]), m.spin + rate * displacement[2]);
}

void giveImpulse(BodySet& bodies, std::size_t body, const Wrench& impulse) {
  if (impulse[0] == 0.0 && impulse[1] == 0.0 && impulse[2] == 0.0) return;
  FreeState& f = bodies.freeState(body);
  const MassData& mass = bodies.mass(body);
  f.velocity += mass.inverseMass * Vec2(impulse[0], impulse[1]);
  f.spin += mass.inverseInertia * impulse[2];
  if (f.asleep != 0.0) bodies.wake(body);
}

}  // namespace froude
