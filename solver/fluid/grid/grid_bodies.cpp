#include <froude/solver/fluid/grid/grid_bodies.h>

namespace froude {

void GridBodies::begin(FreeBodies* bodies, double density, double size, double dt, std::span<const Wrench> drag) {
  bodies_ = bodies;
  density_ = density;
  size_ = size;
  dt_ = dt;
  count_ = 0;
  if (bodies == nullptr) return;
  indexOf_.assign(bodies->count(), -1);
  for (int owner = 0; owner < static_cast<int>(bodies->count()); ++owner) {
    if (!bodies->isFree(owner)) continue;
    indexOf_[static_cast<std::size_t>(owner)] = static_cast<std::int32_t>(count_);
    if (moving_.size() <= count_) moving_.emplace_back();
    Body& body = moving_[count_++];
    const MassData& mass = bodies->mass(owner);
    const std::optional<Vec2> arm = bodies->hingeArm(owner);
    Wrench had = bodies->expected(owner);
    for (std::size_t c = 0; c < 3 && !drag.empty(); ++c) had[c] -= drag[static_cast<std::size_t>(owner)][c];
    body.owner = owner;
    body.hinged = arm.has_value();
    body.arm = arm.value_or(Vec2(0.0, 0.0));
    body.mass = mass.mass;
    body.inertia = mass.inertia + (body.hinged ? mass.mass * body.arm.squaredNorm() : 0.0);
    body.velocity = bodies->velocity(owner);
    body.spin = bodies->spin(owner);
    if (body.hinged) {
      body.spin -= (had[2] + cross(body.arm, Vec2(had[0], had[1]))) / body.inertia;
      body.velocity = cross(body.spin, body.arm);
    } else {
      body.velocity -= Vec2(had[0], had[1]) / body.mass;
      body.spin -= had[2] / body.inertia;
    }
    body.entries.clear();
    body.walls.clear();
  }
}

double GridBodies::add(int owner, const WallPressure::Share& share) {
  Body& body = moving_[static_cast<std::size_t>(indexOf_[static_cast<std::size_t>(owner)])];
  const double turn = share.moment + (body.hinged ? cross(body.arm, share.normal) : 0.0);
  PressureBody::Entry entry{share.place, {0.0f, 0.0f, static_cast<float>(turn)}};
  if (!body.hinged) {
    entry.j[0] = static_cast<float>(share.normal.x());
    entry.j[1] = static_cast<float>(share.normal.y());
  }
  body.entries.push_back(entry);
  body.walls.push_back({share.normal.x(), share.normal.y(), share.moment});
  return body.velocity.dot(share.normal) + body.spin * share.moment;
}

// κ pushes with −(ρh³/dt)·j κ, and what a body's speed changes by counts dt/h·j: together ρh²/mass.
std::span<const PressureBody> GridBodies::system() {
  system_.clear();
  const double unit = density_ * size_ * size_;
  for (std::size_t b = 0; b < count_; ++b) {
    const Body& body = moving_[b];
    if (body.entries.empty()) continue;
    const auto linear = static_cast<float>(body.hinged ? 0.0 : unit / body.mass);
    system_.push_back({{linear, linear, static_cast<float>(unit / body.inertia)}, body.entries});
  }
  return system_;
}

void GridBodies::settle(const float* kappa) {
  if (bodies_ == nullptr) return;
  const double unit = density_ * size_ * size_ * size_ / dt_;
  for (std::size_t b = 0; b < count_; ++b) {
    const Body& body = moving_[b];
    Wrench impulse{0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < body.entries.size(); ++k) {
      const double strength = -unit * static_cast<double>(kappa[body.entries[k].place]);
      for (std::size_t c = 0; c < 3; ++c) impulse[c] += strength * body.walls[k][c];
    }
    Vec2 velocity = body.velocity + Vec2(impulse[0], impulse[1]) / body.mass;
    double spin = body.spin + impulse[2] / body.inertia;
    if (body.hinged) {
      spin = body.spin + (impulse[2] + cross(body.arm, Vec2(impulse[0], impulse[1]))) / body.inertia;
      velocity = cross(spin, body.arm);
    }
    const Vec2 change = velocity - bodies_->velocity(body.owner);
    bodies_->push(body.owner, impulse, {dt_ * change.x(), dt_ * change.y(), dt_ * (spin - bodies_->spin(body.owner))});
  }
  bodies_->settle();
}

}  // namespace froude
