// Separating axes of two convex polygons: the depth and the minimum translation vector where they overlap.
#pragma once

#include <froude/solver/contact/closest_features.h>

namespace froude {

/// In A's frame. Of an overlapping pair: moving B by depth · normal just parts them, and no shorter way does.
struct SeparatingAxis {
  PairStatus status = PairStatus::Failed;  // Apart or Overlapping
  double separation = 0.0;                 // [m] along the axis; −depth where they overlap
  Vec2 normal{0, 0};                       // unit, from A to B: outward normal of an edge of A, or inward of one of B
  Feature edge = 0;                        // that edge
  bool ofA = true;                         // whose it is
  std::uint32_t support = 0;               // the deepest vertex of the other shape
};

/// Edges that are cuts are no axes, nor are directions in which the supporting vertex can not be touched
/// (ConvexShape::allows), but for the one answer that the pair is apart; a pair without any axis left is Apart with
/// separation +∞. For whole polygons the depth is exact; of two equal ones the cached edge's stays. Where the pair is
/// apart, the separation is that of the first axis found, not the largest. Cost: O(n + m); O(1) where the cached edge
/// still separates.
FROUDE_API SeparatingAxis sat(const ConvexShape& a, const ConvexShape& b, const Transform& bInA, PairCache& cache);

}  // namespace froude
