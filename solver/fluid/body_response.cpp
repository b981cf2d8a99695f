#include <froude/solver/fluid/body_response.h>

#include <Eigen/Cholesky>

#include <froude/solver/fluid/pair_loops.h>

namespace froude {

void BodyResponse::begin(FreeBodies* bodies, SoftWalls* soft, const Units& units) {
  soft_.begin(soft, units.spacing, units.mass, units.impulse);
  bodies_ = bodies;
  units_ = units;
  links_.clear();
  moving_.clear();
  if (bodies == nullptr) return;
  indexOf_.assign(bodies->count(), -1);
  for (int owner = 0; owner < static_cast<int>(bodies->count()); ++owner) {
    if (bodies->isFree(owner)) add(owner);
  }
}

void BodyResponse::link(const WallLayer& walls, std::span<const double> x, std::span<const double> y) {
  soft_.link(walls, x, y);
  if (bodies_ == nullptr) return;
  walls.forEachLink([&](const WallLink& link) {
    if (!bodies_->isFree(link.owner)) return;
    const Vec2 g(static_cast<double>(link.gradientX), static_cast<double>(link.gradientY));
    const Vec2 arm = (Vec2(x[link.particle], y[link.particle]) - bodies_->center(link.owner)) / units_.spacing;
    const auto body = static_cast<std::uint32_t>(indexOf_[static_cast<std::size_t>(link.owner)]);
    moving_[body].touched = true;
    links_.push_back({link.particle, body, g.x(), g.y(), cross(arm, g)});
  });
}

void BodyResponse::startFrom(std::span<const float> field) {
  field_ = field.data();
  if (!any()) return;
  answered_.resize(field.size());
  std::copy_n(field.data(), field.size(), answered_.data());
}

void BodyResponse::add(int owner) {
  indexOf_[static_cast<std::size_t>(owner)] = static_cast<std::int32_t>(moving_.size());
  const MassData& data = bodies_->mass(owner);
  const double dx = units_.spacing;
  Body body{owner, bodies_->hingeArm(owner), data.mass / units_.mass, data.inertia / (units_.mass * dx * dx),
            bodies_->expected(owner)};
  for (double& v : body.expected) v /= units_.impulse;
  body.expected[2] /= dx;
  if (body.arm) *body.arm /= dx;
  moving_.push_back(body);
}

void BodyResponse::holdBack(const float* diagonal) {
  soft_.holdBack(diagonal);
  for (const Link& l : links_) {
    const double w = 2.0 / static_cast<double>(std::max(diagonal[l.particle], kSmallestDiagonal));
    std::array<double, 6>& k = moving_[l.body].hold;
    k[0] += w * l.x * l.x, k[1] += w * l.x * l.y, k[2] += w * l.y * l.y;
    k[3] += w * l.x * l.moment, k[4] += w * l.y * l.moment, k[5] += w * l.moment * l.moment;
  }
}

void BodyResponse::sumImpulses(const float* kappa, double share) {
  sums_.assign(moving_.size(), {0.0, 0.0, 0.0});
  for (const Link& l : links_) {
    const double twice = 2.0 * share * static_cast<double>(kappa[l.particle]);
    Wrench& sum = sums_[l.body];
    sum[0] += twice * l.x, sum[1] += twice * l.y, sum[2] += twice * l.moment;
  }
}

// A hinged body has one freedom, its turn: the centre of mass goes along with it.
void BodyResponse::step(Body& body, const Wrench& impulse, double past) {
  Eigen::Vector3d rest;
  Eigen::Matrix3d system;
  const std::array<double, 6>& k = body.hold;
  system << k[0], k[1], k[3], k[1], k[2], k[4], k[3], k[4], k[5];
  const Eigen::Vector3d mass(body.mass, body.mass, body.inertia);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    rest[i] = impulse[at] - past * body.expected[at] - mass[i] * body.moved[at];
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

void BodyResponse::follow(const float* kappa, double share, double past) {
  if (!any()) return;
  sumImpulses(kappa, share);
  for (std::size_t b = 0; b < moving_.size(); ++b) step(moving_[b], sums_[b], past);
  for (const Link& l : links_) answered_[l.particle] = field_[l.particle];
  soft_.restore(field_, answered_.data());
  if (soft_.any()) soft_.follow(kappa, share, past, answered_.data());
  for (const Link& l : links_) {
    const Wrench& q = moving_[l.body].moved;
    answered_[l.particle] -= static_cast<float>(l.x * q[0] + l.y * q[1] + l.moment * q[2]);
  }
}

void BodyResponse::settle(const float* kappa) {
  if (bodies_ == nullptr) return;
  sumImpulses(kappa, 1.0);
  const double dx = units_.spacing, unit = units_.impulse;
  for (std::size_t b = 0; b < moving_.size(); ++b) {
    Body& body = moving_[b];
    const Wrench& sum = sums_[b];
    if (!body.touched) step(body, sum);  // takes back what its motion had of a pressure that is no more
    const Wrench& q = body.moved;
    bodies_->push(body.owner, {unit * sum[0], unit * sum[1], unit * dx * sum[2]}, {dx * q[0], dx * q[1], q[2]});
  }
  bodies_->settle();
}

}  // namespace froude
