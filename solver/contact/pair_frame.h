// The two shapes of a pair query and the pose between them, seen from either side. Inside the narrow phase only.
#pragma once

#include <froude/solver/contact/closest_features.h>

namespace froude {

inline Feature vertexFeature(std::uint32_t k) { return 2 * k; }
inline Feature edgeFeature(std::uint32_t k) { return 2 * k + 1; }

struct PairFrame {
  const ConvexShape& a;
  const ConvexShape& b;
  const Transform& pose;  // of B in A's frame

  /// From vertex i of A to vertex j of B, in A's frame. Everything else is measured along such arms, so that the tests
  /// of neighbouring features see the same numbers and cannot contradict each other.
  Vec2 arm(std::uint32_t i, std::uint32_t j) const { return pose.toWorld(b.vertex(j)) - a.vertex(i); }
  /// The length against which rounding is judged [m].
  double extent() const { return a.outerRadius() + b.outerRadius(); }

  template <bool kOfA>
  const ConvexShape& self() const {
    return kOfA ? a : b;
  }
  template <bool kOfA>
  const ConvexShape& other() const {
    return kOfA ? b : a;
  }
  /// From vertex i of the one shape to vertex j of the other, in the frame of the one.
  template <bool kOfA>
  Vec2 armOf(std::uint32_t i, std::uint32_t j) const {
    if constexpr (kOfA) return arm(i, j);
    return -pose.rotation.applyInverse(arm(j, i));
  }
  /// A direction in the frame of the one, in the frame of the other.
  template <bool kOfA>
  Vec2 toOther(const Vec2& v) const {
    if constexpr (kOfA) return pose.rotation.applyInverse(v);
    return pose.rotation.apply(v);
  }
  bool isFinite() const {
    const double sum = pose.position.x() + pose.position.y() + pose.rotation.c + pose.rotation.s;
    return std::abs(sum) < kInfinity;
  }
};

}  // namespace froude
