// Pairs of convex polygons from a seeded stream: random ones, and those that are hard on a narrow phase.
#pragma once

#include <froude/base/random.h>
#include <froude/solver/contact/convex_shape.h>

namespace froude::test {

inline double turnAtRandom(RandomStream& random) { return random.uniform(-kPi, kPi); }
inline Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// n points at growing angles on an ellipse: convex whatever the angles are.
inline std::vector<Vec2> roundRing(RandomStream& random, std::uint32_t n, double flatness = 1.0) {
  std::vector<Vec2> ring;
  for (std::uint32_t k = 0; k < n; ++k) {
    const Vec2 p = unit(2.0 * kPi * (k + random.uniform(0.0, 0.9)) / n);
    ring.emplace_back(p.x(), flatness * p.y());
  }
  return ring;
}

inline std::vector<Vec2> rectangle(double halfWidth, double halfHeight, const Vec2& at = {0.0, 0.0}) {
  return {at + Vec2(-halfWidth, -halfHeight), at + Vec2(halfWidth, -halfHeight), at + Vec2(halfWidth, halfHeight),
          at + Vec2(-halfWidth, halfHeight)};
}

/// The outline of an octagon-like shape whose lower side is a run of `parts` edges on one line.
inline std::vector<Vec2> straightRun(std::uint32_t parts) {
  std::vector<Vec2> ring;
  for (std::uint32_t k = 0; k <= parts; ++k) ring.emplace_back(-1.0 + 2.0 * k / parts, -0.5);
  ring.emplace_back(1.25, 0.25);
  ring.emplace_back(0.0, 1.0);
  ring.emplace_back(-1.25, 0.25);
  return ring;
}

/// Two convex polygons of 3 to 14 vertices, B's pose in A's frame, and a cache that may name features they do not have.
struct RandomPair {
  ConvexShape a, b;
  Transform pose;
  PairCache cache;
};

inline ConvexShape randomShape(RandomStream& random) {
  const std::uint32_t vertices = 3 + random.below(12);
  return ConvexShape(roundRing(random, vertices, random.uniform(0.1, 1.0)));
}

/// Origins at most `farthest` apart; each polygon is within 1 of its own.
inline RandomPair randomPair(RandomStream& random, double farthest) {
  ConvexShape a = randomShape(random), b = randomShape(random);
  const double distance = random.uniform(0.0, farthest), direction = turnAtRandom(random);
  const Transform pose = Transform::of(distance * unit(direction), turnAtRandom(random));
  return {std::move(a), std::move(b), pose, PairCache{random.below(40), random.below(40)}};
}

inline std::vector<Vec2> scaled(std::vector<Vec2> ring, double by, const Vec2& offset = {0.0, 0.0}) {
  for (Vec2& v : ring) v = by * v + offset;
  return ring;
}

}  // namespace froude::test
