#include <froude/solver/fluid/body_drag.h>

#include <Eigen/LU>

namespace froude {
namespace {

// Jᵀ f.
Eigen::Vector3d wrench(const Vec2& arm, const Vec2& f) { return {f.x(), f.y(), cross(arm, f)}; }

}  // namespace

void BodyDrag::begin(const FreeBodies* bodies, double spacing, double mass) {
  bodies_ = bodies;
  spacing_ = spacing;
  mass_ = mass;
  moving_.clear();
  links_.clear();
  indexOf_.assign(bodies == nullptr ? 0 : bodies->count(), -1);
}

void BodyDrag::add(std::uint32_t particle, int owner, const Vec2& at, double c, const Vec2& u) {
  std::int32_t& index = indexOf_[static_cast<std::size_t>(owner)];
  if (index < 0) {
    index = static_cast<std::int32_t>(moving_.size());
    const MassData& data = bodies_->mass(owner);
    const double mass = data.mass / mass_, inertia = data.inertia / (mass_ * spacing_ * spacing_);
    moving_.push_back(
        {owner, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d(mass, mass, inertia).asDiagonal()});
  }
  Body& body = moving_[static_cast<std::size_t>(index)];
  const Vec2 arm = (at - bodies_->center(owner)) / spacing_;
  links_.push_back({particle, static_cast<std::uint32_t>(index), c, arm});
  const Eigen::Vector3d x = wrench(arm, {1.0, 0.0}), y = wrench(arm, {0.0, 1.0});
  body.answer += c * (x * x.transpose() + y * y.transpose());
  body.sum += c * wrench(arm, u);
}

void BodyDrag::start(float* imageX, float* imageY) {
  for (Body& body : moving_) {
    if (const auto hinge = bodies_->hingeArm(body.owner)) {  // its one freedom is its turn
      const Vec2 arm = *hinge / spacing_;
      const Eigen::Vector3d way(-arm.y(), arm.x(), 1.0);
      body.answer = (way * way.transpose() / way.dot(body.answer * way)).eval();
    } else {
      body.answer = body.answer.inverse().eval();
    }
    body.gained = body.answer * body.sum;
  }
  for (const Link& l : links_) {
    const Vec2 felt = l.c * at(l, moving_[l.body].gained);
    imageX[l.particle] += static_cast<float>(felt.x());
    imageY[l.particle] += static_cast<float>(felt.y());
  }
}

void BodyDrag::sumUp(const float* x, const float* y) {
  for (Body& body : moving_) body.sum.setZero();
  for (const Link& l : links_) {
    const Vec2 change(static_cast<double>(x[l.particle]), static_cast<double>(y[l.particle]));
    moving_[l.body].sum += l.c * wrench(l.arm, change);
  }
}

void BodyDrag::answer(const float* changeX, const float* changeY, float* imageX, float* imageY) {
  sumUp(changeX, changeY);
  for (const Link& l : links_) {
    const Body& body = moving_[l.body];
    const Vec2 felt = l.c * at(l, body.answer * body.sum);
    imageX[l.particle] += static_cast<float>(felt.x());
    imageY[l.particle] += static_cast<float>(felt.y());
  }
}

void BodyDrag::take(const float* changeX, const float* changeY) {
  sumUp(changeX, changeY);
  for (Body& body : moving_) body.gained += body.answer * body.sum;
}

Vec2 BodyDrag::gained(std::size_t k) const { return at(links_[k], moving_[links_[k].body].gained); }

}  // namespace froude
