#include <froude/solver/fluid/body_response.h>

#include <Eigen/Cholesky>

#include <froude/solver/fluid/pair_loops.h>

namespace froude {

void BodyResponse::begin(FreeBodies* bodies, const WallLayer& walls, std::span<const double> x,
                         std::span<const double> y, double spacing, double mass, double unit) {
  bodies_ = bodies;
  links_.clear();
  touched_.clear();
  if (bodies == nullptr) return;
  spacing_ = spacing;
  unit_ = unit;
  indexOf_.assign(bodies->count(), -1);
  walls.forEachLink([&](const WallLink& link) {
    if (!bodies->isFree(link.owner)) return;
    std::int32_t& index = indexOf_[static_cast<std::size_t>(link.owner)];
    const Vec2 center = bodies->center(link.owner);
    if (index < 0) {
      index = static_cast<std::int32_t>(touched_.size());
      const MassData& data = bodies->mass(link.owner);
      Body body{link.owner, bodies->hingeArm(link.owner), data.mass / mass, data.inertia / (mass * spacing * spacing),
                bodies->expected(link.owner)};
      for (double& v : body.expected) v /= unit;
      body.expected[2] /= spacing;
      if (body.arm) *body.arm /= spacing;
      touched_.push_back(body);
    }
    const Vec2 g(static_cast<double>(link.gradientX), static_cast<double>(link.gradientY));
    const Vec2 arm = (Vec2(x[link.particle], y[link.particle]) - center) / spacing;
    links_.push_back({link.particle, static_cast<std::uint32_t>(index), g.x(), g.y(), cross(arm, g)});
  });
  if (!any()) return;
  lambda_.resize(x.size());
  std::copy_n(walls.lambda(), x.size(), lambda_.data());
}

void BodyResponse::holdBack(const float* diagonal) {
  for (const Link& l : links_) {
    const double w = 2.0 / static_cast<double>(std::max(diagonal[l.particle], kSmallestDiagonal));
    std::array<double, 6>& k = touched_[l.body].hold;
    k[0] += w * l.x * l.x, k[1] += w * l.x * l.y, k[2] += w * l.y * l.y;
    k[3] += w * l.x * l.moment, k[4] += w * l.y * l.moment, k[5] += w * l.moment * l.moment;
  }
}

void BodyResponse::sumImpulses(const float* kappa) {
  sums_.assign(touched_.size(), {0.0, 0.0, 0.0});
  for (const Link& l : links_) {
    const double twice = 2.0 * static_cast<double>(kappa[l.particle]);
    Wrench& sum = sums_[l.body];
    sum[0] += twice * l.x, sum[1] += twice * l.y, sum[2] += twice * l.moment;
  }
}

// A hinged body has one freedom, its turn: the centre of mass goes along with it.
void BodyResponse::step(Body& body, const Wrench& impulse) {
  Eigen::Vector3d rest;
  Eigen::Matrix3d system;
  const std::array<double, 6>& k = body.hold;
  system << k[0], k[1], k[3], k[1], k[2], k[4], k[3], k[4], k[5];
  const Eigen::Vector3d mass(body.mass, body.mass, body.inertia);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    rest[i] = impulse[at] - body.expected[at] - mass[i] * body.moved[at];
    system(i, i) += mass[i];
  }
  Eigen::Vector3d change;
  if (body.arm) {
    const Eigen::Vector3d way(-body.arm->y(), body.arm->x(), 1.0);
    change = way * (way.dot(rest) / way.dot(system * way));
  } else {
    change = system.llt().solve(rest);
  }
  for (int i = 0; i < 3; ++i) body.moved[static_cast<std::size_t>(i)] += change[i];
}

void BodyResponse::follow(const float* kappa, const WallLayer& walls) {
  if (!any()) return;
  sumImpulses(kappa);
  for (std::size_t b = 0; b < touched_.size(); ++b) step(touched_[b], sums_[b]);
  for (const Link& l : links_) lambda_[l.particle] = walls.lambda()[l.particle];
  for (const Link& l : links_) {
    const Wrench& q = touched_[l.body].moved;
    lambda_[l.particle] -= static_cast<float>(l.x * q[0] + l.y * q[1] + l.moment * q[2]);
  }
}

void BodyResponse::settle(const float* kappa) {
  if (bodies_ == nullptr) return;
  sumImpulses(kappa);
  for (int owner = 0; owner < static_cast<int>(bodies_->count()); ++owner) {
    if (!bodies_->isFree(owner)) continue;
    const std::int32_t index = indexOf_[static_cast<std::size_t>(owner)];
    if (index < 0) {
      bodies_->release(owner);
      continue;
    }
    const auto at = static_cast<std::size_t>(index);
    const Wrench& sum = sums_[at];
    const Wrench& q = touched_[at].moved;
    bodies_->push(owner, {unit_ * sum[0], unit_ * sum[1], unit_ * spacing_ * sum[2]},
                  {spacing_ * q[0], spacing_ * q[1], q[2]});
  }
  bodies_->settle();
}

}  // namespace froude
