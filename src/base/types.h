// Number and vector types that every floor shares. SI units throughout; two dimensions.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace froude {

/// A point or vector in the plane [m unless said otherwise].
using Vec2 = Eigen::Vector2d;

/// z component of the cross product of a and b.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Spin w [rad/s] crossed with the arm r: the velocity of a point at r from the turning centre.
inline Vec2 cross(double w, const Vec2& r) { return {-w * r.y(), w * r.x()}; }

/// v turned by +90 degrees (the left normal of a direction).
inline Vec2 leftNormal(const Vec2& v) { return {-v.y(), v.x()}; }

/// v turned by −90 degrees (the right normal: outwards on a counter-clockwise outline).
inline Vec2 rightNormal(const Vec2& v) { return {v.y(), -v.x()}; }

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kPi = std::numbers::pi;

/// Axis-aligned box [m]. An empty box has min > max and is the neutral element of `include`.
struct Box {
  Vec2 min{kInfinity, kInfinity};
  Vec2 max{-kInfinity, -kInfinity};

  bool empty() const { return !(min.x() <= max.x() && min.y() <= max.y()); }
  Vec2 size() const { return max - min; }
  Vec2 center() const { return 0.5 * (min + max); }
  bool contains(const Vec2& p) const {
    return p.x() >= min.x() && p.x() <= max.x() && p.y() >= min.y() && p.y() <= max.y();
  }
  bool overlaps(const Box& b) const {
    return min.x() <= b.max.x() && b.min.x() <= max.x() && min.y() <= b.max.y() && b.min.y() <= max.y();
  }
  void include(const Vec2& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  void include(const Box& b) {
    min = min.cwiseMin(b.min);
    max = max.cwiseMax(b.max);
  }
  Box grown(double by) const { return {min - Vec2(by, by), max + Vec2(by, by)}; }
};

}  // namespace froude
