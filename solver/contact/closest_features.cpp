// The walk, and what follows where it comes to lie behind an edge: the best separating axis says whether that is
// overlap, and if not, the walk goes on from there and has only a few steps left.
#include <froude/solver/contact/closest_features.h>

#include <froude/solver/contact/closest_pair.h>
#include <froude/solver/contact/feature_walk.h>

namespace froude {

namespace {

// Pairs whose best axis is nearer to 0 than this fraction of their extent touch, to rounding.
constexpr double kTouching = 1e-12;

// Touching within rounding, where arms have lost their direction: the axis is the answer.
void touch(const PairFrame& pair, const SeparatingAxis& axis, ClosestFeatures& closest) {
  closest.status = axis.separation > 0.0 ? PairStatus::Apart : PairStatus::Near;
  closest.distance = axis.separation;
  closest.normal = axis.normal;
  closest.onA = axis.ofA ? Vec2(pair.pose.toWorld(pair.b.vertex(axis.support)) - axis.separation * axis.normal)
                         : pair.a.vertex(axis.support);
  closest.onB = closest.onA + axis.separation * axis.normal;
}

void overlap(const SeparatingAxis& axis, ClosestFeatures& closest) {
  closest.status = PairStatus::Overlapping;
  closest.distance = 0.0;
  closest.normal = axis.normal;
}

}  // namespace

ClosestPair closestPair(const PairFrame& pair, PairCache& cache) {
  ClosestPair answer;
  ClosestFeatures& closest = answer.closest;
  if (!pair.isFinite()) return answer;
  const int limit = static_cast<int>(pair.a.size() + pair.b.size()) + 8;
  if (walkFeatures(pair, cache, limit, closest) == WalkEnd::Found) return answer;

  answer.axis = bestAxis(pair, cache, AxisChoice::Any);
  if (!std::isfinite(answer.axis.separation)) return answer;
  cache = featuresOf(answer.axis);
  if (answer.axis.separation < 0.0) {
    overlap(answer.axis, closest);
  } else if (walkFeatures(pair, cache, limit, closest) == WalkEnd::Found) {
    return answer;
  } else if (answer.axis.separation <= kTouching * pair.extent()) {
    cache = featuresOf(answer.axis);
    touch(pair, answer.axis, closest);
  }
  closest.a = cache.a;
  closest.b = cache.b;
  return answer;
}

ClosestFeatures closestFeatures(const ConvexShape& a, const ConvexShape& b, const Transform& bInA, PairCache& cache) {
  return closestPair({a, b, bInA}, cache).closest;
}

}  // namespace froude
