// One query for two callers: the closest features of a pair, or the axis of its least depth. Inside the narrow phase.
#pragma once

#include <froude/solver/contact/axis_search.h>

namespace froude {

struct ClosestPair {
  ClosestFeatures closest;
  SeparatingAxis axis;  // filled where the status is Overlapping: of all edges, cuts too
};

ClosestPair closestPair(const PairFrame& pair, PairCache& cache);

}  // namespace froude
