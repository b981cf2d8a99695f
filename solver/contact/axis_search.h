// The best of all edge normals of a pair as a separating axis: behind `sat` and behind the walk of closest features.
#pragma once

#include <froude/solver/contact/pair_frame.h>
#include <froude/solver/contact/sat.h>

namespace froude {

enum class AxisChoice {
  Any,           // the axis of the largest separation
  Touchable,     // the same without cuts and without directions that a vertex does not allow
  UntilParting,  // Touchable, but any axis at all that parts the pair ends the search
};

/// Separation along an edge's normal of the one shape; `support` begins as a hint.
template <bool kOfA>
double separationAlong(const PairFrame& pair, std::uint32_t edge, std::uint32_t& support) {
  const Flat n = pair.self<kOfA>().normal(edge);
  support = climb(pair.other<kOfA>(), -pair.toOther<kOfA>(n), support);
  return dot(n, pair.armOf<kOfA>(edge, support));
}

/// Starts with the edge that the cache names. `status` is Apart where any axis parts the pair, a cut's too. −∞ for
/// `separation` where no axis is left. Cost: O(n + m).
SeparatingAxis bestAxis(const PairFrame& pair, const PairCache& cache, AxisChoice choice);

inline PairCache featuresOf(const SeparatingAxis& axis) {
  if (axis.ofA) return {axis.edge, vertexFeature(axis.support)};
  return {vertexFeature(axis.support), axis.edge};
}

}  // namespace froude
