// What follows a walk that came to lie behind an edge. Inside the narrow phase only.
#pragma once

#include <froude/solver/contact/axis_search.h>
#include <froude/solver/contact/feature_walk.h>

namespace froude {

inline int stepLimit(const PairFrame& pair) { return static_cast<int>(pair.a.size() + pair.b.size()) + 8; }

/// Fills `closest`. The axis that is returned is the one of the least depth where that says Overlapping: of all edges,
/// cuts too.
SeparatingAxis closestBehind(const PairFrame& pair, PairCache& cache, ClosestFeatures& closest);

}  // namespace froude
