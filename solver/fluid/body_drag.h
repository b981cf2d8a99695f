// Free bodies inside a solve for the velocities of a viscous fluid: what sticks to a body moves it, and it gives way.
#pragma once

#include <vector>

#include <froude/solver/coupling/free_bodies.h>

namespace froude {

/// A body that links drag with coefficients c changes its velocity q by S q = Σ c Jᵀ u, S = M + Σ c Jᵀ J: u what the
/// particles move by relative to its surface, J q what q is at a particle. With q eliminated, the particles feel
/// c J S⁻¹ Σ c Jᵀ u besides: symmetric, and so that no body is thrown to and fro however light it is. Lengths in
/// spacings dx, masses in particles' masses, velocities in m/s, turns in m/s at a distance of dx.
class BodyDrag {
 public:
  /// bodies null: there are none. spacing dx [m], mass of a particle [kg/m].
  void begin(const FreeBodies* bodies, double spacing, double mass);
  bool isFree(int owner) const { return bodies_ != nullptr && bodies_->isFree(owner); }
  /// A particle at [m], dragged with c by a free body relative to whose surface it moves at u [m/s].
  void add(std::uint32_t particle, int owner, const Vec2& at, double c, const Vec2& u);
  /// After the last `add`: the velocities that the bodies take from u. Adds what particles feel of them to image.
  void start(float* imageX, float* imageY);
  bool any() const { return !links_.empty(); }
  /// Adds to image what particles feel of bodies that a change of their velocities moves. By particle [m/s].
  void answer(const float* changeX, const float* changeY, float* imageX, float* imageY);
  /// The bodies take what the change of velocities gives them, on top of `start`.
  void take(const float* changeX, const float* changeY);
  /// What the surface gained at the k-th `add` [m/s].
  Vec2 gained(std::size_t k) const;

 private:
  struct Link {
    std::uint32_t particle, body;
    double c;
    Vec2 arm;  // from the centre of mass
  };
  struct Body {
    int owner;
    Eigen::Vector3d gained;  // q
    Eigen::Vector3d sum;     // Σ c Jᵀ u
    Eigen::Matrix3d answer;  // S⁻¹; S until `start`
  };
  void sumUp(const float* x, const float* y);
  static Vec2 at(const Link& link, const Eigen::Vector3d& q) { return q.head<2>() + cross(q[2], link.arm); }

  const FreeBodies* bodies_ = nullptr;
  double spacing_ = 1.0, mass_ = 1.0;
  std::vector<Body> moving_;
  std::vector<Link> links_;
  std::vector<std::int32_t> indexOf_;  // of each owner in moving_, −1
};

}  // namespace froude
