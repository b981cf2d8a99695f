// Lin-Canny in two dimensions: the closest pair of features of two convex polygons, walked to from the last one.
//
// M. C. Lin and J. F. Canny, "A fast algorithm for incremental distance calculation", ICRA 1991.
#pragma once

#include <array>

#include <froude/solver/contact/convex_shape.h>

namespace froude {

enum class PairStatus : std::uint8_t {
  Apart,        // farther than asked for; a query that asks for no margin: farther than 0
  Near,         // within the margin that was asked for, and not overlapping
  Overlapping,  // interiors share points; touching at distance 0 is Near
  Failed        // no answer within the bound on steps, or a number that is not finite: never a wrong answer
};

/// A vertex or an edge of a shape, as one number: 2·k for vertex k, 2·k + 1 for edge k.
using Feature = std::uint32_t;
inline bool isEdge(Feature f) { return (f & 1u) != 0; }
inline std::uint32_t featureIndex(Feature f) { return f >> 1; }

inline constexpr Feature kNoFeature = ~Feature{0};

/// What a pair remembers from query to query; any value is good to start from, also a stale one of another pair. The
/// answers of all queries do not depend on it beyond rounding, their cost does.
struct PairCache {
  Feature a = kNoFeature, b = kNoFeature;  // the last closest features, or those of the last axis
  friend bool operator==(const PairCache&, const PairCache&) = default;
};

/// All vectors in A's frame.
struct ClosestFeatures {
  PairStatus status = PairStatus::Failed;
  Feature a = 0, b = 0;       // Apart, Near: each closest point lies in the Voronoi region of the other's feature
  double distance = 0.0;      // [m]; 0 where they overlap
  Vec2 onA{0, 0}, onB{0, 0};  // closest points [m]
  Vec2 normal{0, 0};          // unit, from A to B
  int steps = 0;              // of the walk
};

/// bInA: B's pose in A's frame. Bounded by 2 (size(a) + size(b) + 8) steps; a few when warm. Two edges that are
/// parallel to 1e-12 and face each other are both named, their points stand in the middle of what they share. Overlap
/// is recognised and reported with the normal of the least depth; `sat` then starts from its edge.
FROUDE_API ClosestFeatures closestFeatures(const ConvexShape& a, const ConvexShape& b, const Transform& bInA,
                                           PairCache& cache);

/// B's pose in A's frame, from the poses of both.
inline Transform poseIn(const Transform& a, const Transform& b) {
  const Rotation& ra = a.rotation;
  const Rotation& rb = b.rotation;
  return {ra.applyInverse(b.position - a.position), {ra.c * rb.c + ra.s * rb.s, ra.c * rb.s - ra.s * rb.c}};
}

}  // namespace froude
