// Separating axes: the search of axis_search.h, with the cache kept.
#include <froude/solver/contact/sat.h>

#include <froude/solver/contact/axis_search.h>

namespace froude {

SeparatingAxis sat(const ConvexShape& a, const ConvexShape& b, const Transform& bInA, PairCache& cache) {
  const PairFrame pair{a, b, bInA};
  if (!pair.isFinite()) return {};
  SeparatingAxis axis = bestAxis(pair, cache, AxisChoice::UntilParting);
  if (axis.separation == -kInfinity) {
    axis.status = PairStatus::Apart;
    axis.separation = kInfinity;
    return axis;
  }
  if (!std::isfinite(axis.separation)) return {};
  cache = featuresOf(axis);
  return axis;
}

}  // namespace froude
