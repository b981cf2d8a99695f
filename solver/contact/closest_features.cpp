// The walk, and what follows where it comes to lie behind an edge: the best separating axis says whether that is
// overlap, and if not, the walk goes on from there and has only a few steps left.
#include <froude/solver/contact/closest_features.h>

#include <froude/solver/contact/closest_pair.h>
#include <froude/solver/contact/feature_walk.h>

namespace froude {

namespace {

// Pairs whose best axis is nearer to 0 than this fraction of their extent touch, to rounding.
constexpr double kTouching = 1e-12;

// Touching within rounding, where arms have lost their direction: the axis is the answer. Its support may be one of
// several vertices on a level edge; the one that touches lies in the slab of the axis's edge, or its own edge reaches
// into it.
template <bool kOfA>
void touch(const PairFrame& pair, const SeparatingAxis& axis, ClosestFeatures& closest, PairCache& cache) {
  const ConvexShape& self = pair.self<kOfA>();
  const ConvexShape& other = pair.other<kOfA>();
  const std::uint32_t edge = featureIndex(axis.edge);
  const Flat n = self.normal(edge);
  const double length = cross(n, Flat(self.vertex(self.next(edge))) - Flat(self.vertex(edge)));
  const double level = axis.separation + kTouching * pair.extent();
  const auto along = [&](std::uint32_t v) { return cross(n, pair.armOf<kOfA>(edge, v)); };
  std::uint32_t vertex = axis.support;
  Feature feature = vertexFeature(vertex);
  double at = along(vertex);
  for (std::uint32_t step = 0; step < other.size() && (at < 0.0 || at > length); ++step) {
    const bool upwards = at < 0.0;  // against the other's order of vertices, which faces ours
    const std::uint32_t neighbour = upwards ? other.previous(vertex) : other.next(vertex);
    if (dot(n, pair.armOf<kOfA>(edge, neighbour)) > level) break;
    feature = edgeFeature(upwards ? neighbour : vertex);
    vertex = neighbour;
    const double reached = along(vertex);
    if (upwards ? reached >= 0.0 : reached <= length) {
      at = 0.5 * (std::clamp(at, 0.0, length) + std::clamp(reached, 0.0, length));
    } else {
      at = reached;
    }
  }
  const Flat onSelf = Flat(self.vertex(edge)) + std::clamp(at, 0.0, length) * leftNormal(n);
  const Flat onOther = onSelf + axis.separation * n;
  closest.status = axis.separation > 0.0 ? PairStatus::Apart : PairStatus::Near;
  closest.distance = axis.separation;
  closest.normal = axis.normal;
  closest.onA = pair.toA<kOfA>(kOfA ? onSelf : onOther);
  closest.onB = pair.toA<kOfA>(kOfA ? onOther : onSelf);
  cache = kOfA ? PairCache{axis.edge, feature} : PairCache{feature, axis.edge};
}

void overlap(const SeparatingAxis& axis, ClosestFeatures& closest) {
  closest.status = PairStatus::Overlapping;
  closest.distance = 0.0;
  closest.normal = axis.normal;
}

}  // namespace

SeparatingAxis closestBehind(const PairFrame& pair, PairCache& cache, ClosestFeatures& closest) {
  SeparatingAxis axis = bestAxis(pair, cache, AxisChoice::Any);
  closest.status = PairStatus::Failed;
  if (!std::isfinite(axis.separation)) return axis;
  cache = featuresOf(axis);
  if (axis.separation < 0.0) {
    overlap(axis, closest);
  } else if (walkFeatures(pair, cache, stepLimit(pair), closest) == WalkEnd::Found) {
    return axis;
  } else if (axis.separation <= kTouching * pair.extent()) {
    axis.ofA ? touch<true>(pair, axis, closest, cache) : touch<false>(pair, axis, closest, cache);
  }
  closest.a = cache.a;
  closest.b = cache.b;
  return axis;
}

ClosestFeatures closestFeatures(const ConvexShape& a, const ConvexShape& b, const Transform& bInA, PairCache& cache) {
  const PairFrame pair{a, b, bInA};
  ClosestFeatures closest;
  if (!pair.isFinite()) return closest;
  if (walkFeatures(pair, cache, stepLimit(pair), closest) != WalkEnd::Found) closestBehind(pair, cache, closest);
  return closest;
}

}  // namespace froude
