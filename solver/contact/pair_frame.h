// The two shapes of a pair query and the pose between them, seen from either side. Inside the narrow phase only.
#pragma once

#include <froude/solver/contact/closest_features.h>

namespace froude {

inline Feature vertexFeature(std::uint32_t k) { return 2 * k; }
inline Feature edgeFeature(std::uint32_t k) { return 2 * k + 1; }

/// A vector in two registers. A Vec2 that is put together from two numbers and then read as a pair waits for the memory
/// between them, several times in each step of a walk: this one is never a pair.
struct Flat {
  double x, y;
  Flat(double vx, double vy) : x(vx), y(vy) {}
  Flat(const Vec2& v) : x(v.x()), y(v.y()) {}  // NOLINT(google-explicit-constructor): it is the same vector
  Vec2 vec() const { return {x, y}; }
};

inline Flat operator-(const Flat& a, const Flat& b) { return {a.x - b.x, a.y - b.y}; }
inline Flat operator+(const Flat& a, const Flat& b) { return {a.x + b.x, a.y + b.y}; }
inline Flat operator*(double s, const Flat& a) { return {s * a.x, s * a.y}; }
inline Flat operator-(const Flat& a) { return {-a.x, -a.y}; }
inline double dot(const Flat& a, const Flat& b) { return a.x * b.x + a.y * b.y; }
inline double cross(const Flat& a, const Flat& b) { return a.x * b.y - a.y * b.x; }
inline Flat leftNormal(const Flat& a) { return {-a.y, a.x}; }

/// ConvexShape::support for the inner loops: the same climb, in registers.
inline std::uint32_t climb(const ConvexShape& shape, const Flat& d, std::uint32_t hint) {
  std::uint32_t k = hint, before = shape.previous(hint);
  if (cross(Flat(shape.normal(k)), d) > 0.0) {
    for (std::uint32_t step = shape.size(); step > 0 && cross(Flat(shape.normal(k)), d) > 0.0; --step)
      k = shape.next(k);
    return k;
  }
  for (std::uint32_t step = shape.size(); step > 0 && cross(Flat(shape.normal(before)), d) < 0.0; --step) {
    k = before;
    before = shape.previous(k);
  }
  // In the middle of a straight run on the far side both edges are level, and yet it is the lowest vertex.
  const bool lowest = dot(shape.normal(k), d) < 0.0 && dot(shape.normal(before), d) < 0.0;
  return lowest ? shape.farthest(d.vec()) : k;
}

struct PairFrame {
  const ConvexShape& a;
  const ConvexShape& b;
  const Transform& pose;  // of B in A's frame

  Flat turned(const Flat& v) const {
    const Rotation& r = pose.rotation;
    return {r.c * v.x - r.s * v.y, r.s * v.x + r.c * v.y};
  }
  Flat turnedBack(const Flat& v) const {
    const Rotation& r = pose.rotation;
    return {r.c * v.x + r.s * v.y, r.c * v.y - r.s * v.x};
  }
  Flat inA(const Flat& pointOfB) const { return Flat(pose.position) + turned(pointOfB); }
  Flat inB(const Flat& pointOfA) const { return turnedBack(pointOfA - Flat(pose.position)); }

  /// From vertex i of A to vertex j of B, in A's frame. Everything else is measured along such arms, so that the tests
  /// of neighbouring features see the same numbers and cannot contradict each other.
  Flat arm(std::uint32_t i, std::uint32_t j) const { return inA(b.vertex(j)) - Flat(a.vertex(i)); }
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
  Flat armOf(std::uint32_t i, std::uint32_t j) const {
    if constexpr (kOfA) return arm(i, j);
    return -turnedBack(arm(j, i));
  }
  /// A direction in the frame of the one, in the frame of the other.
  template <bool kOfA>
  Flat toOther(const Flat& v) const {
    if constexpr (kOfA) return turnedBack(v);
    return turned(v);
  }
  /// A point in the frame of the one, in A's frame.
  template <bool kOfA>
  Vec2 toA(const Flat& p) const {
    if constexpr (kOfA) return p.vec();
    return inA(p).vec();
  }
  /// Are these features of this pair at all?
  bool holds(const PairCache& cache) const {
    return featureIndex(cache.a) < a.size() && featureIndex(cache.b) < b.size();
  }
  bool isFinite() const {
    const double sum = pose.position.x() + pose.position.y() + pose.rotation.c + pose.rotation.s;
    return std::abs(sum) < kInfinity;
  }
};

}  // namespace froude
