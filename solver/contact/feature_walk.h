// The walk of Lin and Canny over vertices and edges, one step after another, until the features' closest points lie in
// each other's Voronoi regions. Inside the narrow phase only.
#pragma once

#include <froude/solver/contact/pair_frame.h>

namespace froude {

enum class WalkEnd {
  Found,
  Behind,  // a feature lies behind the other's edge: overlap, or a start on the far side
  TooLong  // only where rounding makes neighbours contradict each other
};

/// The vertices that lie farthest towards the other shape's centroid: near the answer for round shapes, and a start
/// for pairs without a history.
PairCache firstGuess(const PairFrame& pair);

/// Walks from `features`, which may be stale, and leaves the last pair there. `found` is filled where Found, its normal
/// in A's frame. Each step lowers the distance, so it cannot come back to a pair; `limit` bounds it against rounding.
WalkEnd walkFeatures(const PairFrame& pair, PairCache& features, int limit, ClosestFeatures& found);

}  // namespace froude
