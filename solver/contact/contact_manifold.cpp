// Clips the edge that faces the reference edge against the reference edge's two ends.
#include <froude/solver/contact/contact_manifold.h>

#include <froude/solver/contact/axis_search.h>
#include <froude/solver/contact/closest_pair.h>

namespace froude {

namespace {

// Two points nearer than this fraction of the pair's extent, along the edge, are one.
constexpr double kOnePoint = 1e-9;

// A point is named by a vertex of one shape and an edge of the other, whichever of them is the reference: the name
// stays when two nearly parallel edges change their parts.
std::uint32_t pointId(bool vertexOfA, std::uint32_t vertex, std::uint32_t edge) {
  return (vertexOfA ? 0x80000000u : 0u) | (vertex & 0x7fffu) << 16 | (edge & 0xffffu);
}

struct Clip {
  double along = 0.0, height = 0.0;  // from the reference edge's first vertex [m]
  std::uint32_t id = 0;
};

struct Builder {
  const PairFrame& pair;
  double least, most;  // the separations that make a point
  ContactManifold& manifold;

  template <bool kOfA>
  void add(std::uint32_t edge, const Clip& clip) {
    if (!(clip.height >= least && clip.height <= most)) return;
    const Flat n = pair.self<kOfA>().normal(edge);
    const Flat at = Flat(pair.self<kOfA>().vertex(edge)) + clip.along * leftNormal(n) + 0.5 * clip.height * n;
    manifold.points[manifold.count++] = {pair.toA<kOfA>(at), clip.height, clip.id};
  }

  template <bool kOfA>
  Clip vertexOver(std::uint32_t edge, std::uint32_t vertex) const {
    const Flat arm = pair.armOf<kOfA>(edge, vertex);
    const Flat n = pair.self<kOfA>().normal(edge);
    return {cross(n, arm), dot(n, arm), pointId(!kOfA, vertex, edge)};
  }

  // Reference edge against the other shape's edge `facing`.
  template <bool kOfA>
  void clip(std::uint32_t edge, std::uint32_t facing) {
    const ConvexShape& self = pair.self<kOfA>();
    const std::uint32_t last = self.next(edge);
    const double length = cross(Flat(self.normal(edge)), Flat(self.vertex(last)) - Flat(self.vertex(edge)));
    Clip low = vertexOver<kOfA>(edge, pair.other<kOfA>().next(facing));
    Clip high = vertexOver<kOfA>(edge, facing);
    if (low.along > high.along) std::swap(low, high);
    if (low.along > length || high.along < 0.0) return;
    // Whether an end is cut off is a coin's toss from pair to pair: chosen, not branched upon.
    const double width = high.along - low.along;
    const double slope = (high.height - low.height) / (width > 0.0 ? width : 1.0);
    const bool cutLow = low.along<0.0, cutHigh = high.along> length;
    low.height -= std::min(low.along, 0.0) * slope;
    low.along = std::max(low.along, 0.0);
    low.id = cutLow ? pointId(kOfA, edge, facing) : low.id;
    high.height -= std::max(high.along - length, 0.0) * slope;
    high.along = std::min(high.along, length);
    high.id = cutHigh ? pointId(kOfA, last, facing) : high.id;
    if (high.along - low.along <= kOnePoint * pair.extent())
      return add<kOfA>(edge, low.height < high.height ? low : high);
    add<kOfA>(edge, low);
    add<kOfA>(edge, high);
  }

  // Reference edge against the other shape where `vertex` is nearest.
  template <bool kOfA>
  void build(std::uint32_t edge, std::uint32_t vertex) {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    const Flat facing = -pair.toOther<kOfA>(self.normal(edge));
    const std::uint32_t previous = other.previous(vertex);
    bool first = dot(other.normal(previous), facing) > dot(other.normal(vertex), facing);
    if (!other.isWhole() && other.isOutline(previous) != other.isOutline(vertex)) first = other.isOutline(previous);
    const std::uint32_t incident = first ? previous : vertex;
    if (other.isOutline(incident)) return clip<kOfA>(edge, incident);
    const Clip point = vertexOver<kOfA>(edge, vertex);
    if (point.along >= 0.0 && cross(Flat(self.normal(edge)), pair.armOf<kOfA>(self.next(edge), vertex)) <= 0.0)
      add<kOfA>(edge, point);
  }

  void fromAxis(const SeparatingAxis& axis) {
    manifold.normal = axis.normal;
    const std::uint32_t edge = featureIndex(axis.edge);
    if (axis.ofA) {
      build<true>(edge, axis.support);
    } else {
      build<false>(edge, axis.support);
    }
  }

  // The deepest vertex, where it lies beside the reference edge and the edge that faces it does too.
  void fallBack(const SeparatingAxis& axis) {
    const std::uint32_t edge = featureIndex(axis.edge);
    if (axis.ofA) {
      add<true>(edge, vertexOver<true>(edge, axis.support));
    } else {
      add<false>(edge, vertexOver<false>(edge, axis.support));
    }
  }

  // The best axis of the four edges that meet at a vertex of each.
  SeparatingAxis axisAt(std::uint32_t i, std::uint32_t j) const {
    SeparatingAxis best;
    best.separation = -kInfinity;
    for (const std::uint32_t edge : {pair.a.previous(i), i}) {
      std::uint32_t support = j;
      const double separation = separationAlong<true>(pair, edge, support);
      if (separation <= best.separation) continue;
      best.separation = separation;
      best.normal = pair.a.normal(edge), best.edge = 2 * edge + 1, best.ofA = true, best.support = support;
    }
    for (const std::uint32_t edge : {pair.b.previous(j), j}) {
      std::uint32_t support = i;
      const double separation = separationAlong<false>(pair, edge, support);
      if (separation <= best.separation) continue;
      best.separation = separation;
      best.normal = (-pair.turned(pair.b.normal(edge))).vec(), best.edge = 2 * edge + 1, best.ofA = false;
      best.support = support;
    }
    return best;
  }

  void fromFeatures(const ClosestFeatures& closest) {
    manifold.normal = closest.normal;
    const std::uint32_t i = featureIndex(closest.a), j = featureIndex(closest.b);
    if (isEdge(closest.a)) {
      isEdge(closest.b) ? clip<true>(i, j) : build<true>(i, j);
    } else if (isEdge(closest.b)) {
      build<false>(j, i);
    } else if (const SeparatingAxis axis = axisAt(i, j);
               axis.separation >= closest.distance - kOnePoint * pair.extent()) {
      fromAxis(axis);
      if (manifold.count == 2) return;  // corners of faces that are flush
      manifold.count = 0;
      manifold.normal = closest.normal;
    }
    // Two vertices; or features that touch to rounding, and miss each other by as much when they are clipped.
    if (manifold.count > 0) return;
    const std::uint32_t id = isEdge(closest.a) ? pointId(false, j, i) : pointId(true, i, isEdge(closest.b) ? j : ~j);
    manifold.points[manifold.count++] = {0.5 * (closest.onA + closest.onB), closest.distance, id};
  }
};

// Can the polygons that these are pieces of touch there, or is it a seam?
bool isTouchable(const PairFrame& pair, const ClosestFeatures& closest) {
  const std::uint32_t i = featureIndex(closest.a), j = featureIndex(closest.b);
  const bool a = isEdge(closest.a) ? pair.a.isOutline(i) : pair.a.allows(i, closest.normal);
  return a && (isEdge(closest.b) ? pair.b.isOutline(j) : pair.b.allows(j, (-pair.turnedBack(closest.normal)).vec()));
}

void buildNear(const PairFrame& pair, const ClosestFeatures& closest, double margin, ContactManifold& manifold) {
  manifold.status = PairStatus::Near;
  Builder builder{pair, -kInfinity, margin, manifold};
  if ((pair.a.isWhole() && pair.b.isWhole()) || isTouchable(pair, closest)) return builder.fromFeatures(closest);
  // Nearest at a seam; a part of the outline may still be within the margin. What lies below it there lies beyond it.
  const SeparatingAxis axis = bestAxis(pair, {closest.a, closest.b}, AxisChoice::Touchable);
  builder.least = 0.0;
  if (axis.separation > -kInfinity) builder.fromAxis(axis);
}

void buildOverlapping(const PairFrame& pair, SeparatingAxis axis, double margin, PairCache& cache,
                      ContactManifold& manifold) {
  manifold.status = PairStatus::Overlapping;
  Builder builder{pair, -kInfinity, margin, manifold};
  const bool whole = pair.a.isWhole() && pair.b.isWhole();
  if (!whole) {
    axis = bestAxis(pair, cache, AxisChoice::Touchable);
    if (axis.separation == -kInfinity) return;
    cache = featuresOf(axis);
  }
  builder.fromAxis(axis);
  if (whole && manifold.count == 0) builder.fallBack(axis);
}

}  // namespace

ContactManifold contactManifold(const ConvexShape& a, const ConvexShape& b, const Transform& bInA, double margin,
                                PairCache& cache) {
  const PairFrame pair{a, b, bInA};
  ContactManifold manifold;
  if (!pair.isFinite()) return manifold;
  ClosestFeatures closest;
  SeparatingAxis axis;
  if (walkFeatures(pair, cache, stepLimit(pair), closest) != WalkEnd::Found) axis = closestBehind(pair, cache, closest);
  manifold.status = closest.status;
  if (closest.status == PairStatus::Overlapping) {
    buildOverlapping(pair, axis, margin, cache, manifold);
  } else if (closest.status != PairStatus::Failed && closest.distance <= margin) {
    buildNear(pair, closest, margin, manifold);
  }
  return manifold;
}

}  // namespace froude
