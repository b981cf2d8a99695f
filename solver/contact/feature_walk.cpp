// One step of the walk for each kind of pair: vertex and vertex, edge and vertex, two parallel edges.
//
// At vertex k with the edge normals N(k−1) and N(k) a direction d lies in the vertex's Voronoi region where
// cross(N(k−1), d) ≥ 0 and cross(d, N(k)) ≥ 0. The other shape's vertex lies in the slab of edge k where
// cross(N(k), arm) ≥ 0 from its first vertex and ≤ 0 from its last: the same products from the other side, on the same
// numbers.
#include <froude/solver/contact/feature_walk.h>

namespace froude {

namespace {

// Edges are parallel below this angle [rad].
constexpr double kParallel = 1e-12;
// Vertices nearer than this fraction of the pair's extent have no direction between them that could be a normal.
constexpr double kCoincident = 1e-13;

enum class Step { Found, Moved, Behind };

// Does one of a vertex's two edges come nearer to where `d` leads?
bool leaves(const Flat& after, const Flat& before, const Flat& d, double tolerance) {
  return cross(after, d) > tolerance || cross(before, d) < -tolerance;
}

// Which of them: the only one, or where both do, as at the tip of a needle, the one on the side that d leads out of.
// Its other side comes nearer as well, but lies behind.
bool isUpper(const Flat& after, const Flat& before, const Flat& d) {
  if (cross(after, d) <= 0.0) return false;
  return cross(before, d) >= 0.0 || dot(after, d) >= dot(before, d);
}

struct Walker {
  const PairFrame& pair;
  PairCache& at;
  ClosestFeatures& found;

  template <bool kOfA>
  void move(Feature self, Feature other) {
    at = kOfA ? PairCache{self, other} : PairCache{other, self};
  }

  Step vertices(std::uint32_t i, std::uint32_t j) {
    const ConvexShape &a = pair.a, &b = pair.b;
    const Flat w = pair.arm(i, j);
    const Flat afterA = a.normal(i), beforeA = a.normal(a.previous(i));
    const Flat u = -pair.turnedBack(w);
    const Flat afterB = b.normal(j), beforeB = b.normal(b.previous(j));
    if (leaves(afterA, beforeA, w, 0.0)) {
      at.a = edgeFeature(isUpper(afterA, beforeA, w) ? i : a.previous(i));
      return Step::Moved;
    }
    if (leaves(afterB, beforeB, u, 0.0)) {
      at.b = edgeFeature(isUpper(afterB, beforeB, u) ? j : b.previous(j));
      return Step::Moved;
    }
    const double distance = std::sqrt(dot(w, w));
    // A vertex within a straight run passes the products from behind too, as does an arm of no length.
    const bool before =
        std::max(dot(afterA, w), dot(beforeA, w)) > 0.0 && std::max(dot(afterB, u), dot(beforeB, u)) > 0.0;
    if (!before || distance < kCoincident * pair.extent()) return Step::Behind;
    found.distance = distance;
    found.onA = a.vertex(i);
    found.onB = (Flat(a.vertex(i)) + w).vec();
    found.normal = ((1.0 / distance) * w).vec();
    return Step::Found;
  }

  // `isFirst`: the pair may be the one that overlapped in the last query, and most likely still does.
  template <bool kOfA>
  Step edgeAndVertex(std::uint32_t edge, std::uint32_t vertex, bool isFirst) {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    const Flat n = self.normal(edge);
    const std::uint32_t last = self.next(edge);
    const Flat arm = pair.armOf<kOfA>(edge, vertex);
    const double height = dot(n, arm);
    if (isFirst && height < 0.0) return Step::Behind;
    if (cross(n, arm) < 0.0) return move<kOfA>(vertexFeature(edge), vertexFeature(vertex)), Step::Moved;
    if (cross(n, pair.armOf<kOfA>(last, vertex)) > 0.0)
      return move<kOfA>(vertexFeature(last), vertexFeature(vertex)), Step::Moved;
    if (height < 0.0) return Step::Behind;
    const Flat facing = -pair.toOther<kOfA>(n);
    const std::uint32_t previous = other.previous(vertex);
    const Flat after = other.normal(vertex), before = other.normal(previous);
    if (leaves(after, before, facing, kParallel)) {
      if (isUpper(after, before, facing)) return descend<kOfA>(edge, vertex, other.next(vertex));
      return descend<kOfA>(edge, previous, previous);
    }
    if (cross(after, facing) >= -kParallel) return parallelOf<kOfA>(edge, vertex);
    if (cross(before, facing) <= kParallel) return parallelOf<kOfA>(edge, previous);
    found.distance = height;
    if constexpr (kOfA) {
      const Flat onB = Flat(self.vertex(edge)) + arm;
      found.normal = n.vec();
      found.onA = (onB - height * n).vec();
      found.onB = onB.vec();
    } else {
      found.normal = facing.vec();
      found.onA = other.vertex(vertex);
      found.onB = (Flat(other.vertex(vertex)) + height * facing).vec();
    }
    return Step::Found;
  }

  // The other shape comes nearer along its edge `down`, towards `lower`. If that vertex is in the slab it is the next
  // pair; else the edge leaves the slab above one end of ours, and that end against it is nearer still.
  template <bool kOfA>
  Step descend(std::uint32_t edge, std::uint32_t down, std::uint32_t lower) {
    const ConvexShape& self = pair.self<kOfA>();
    const Flat n = self.normal(edge);
    const std::uint32_t last = self.next(edge);
    if (cross(n, pair.armOf<kOfA>(edge, lower)) < 0.0) {
      move<kOfA>(vertexFeature(edge), edgeFeature(down));
    } else if (cross(n, pair.armOf<kOfA>(last, lower)) > 0.0) {
      move<kOfA>(vertexFeature(last), edgeFeature(down));
    } else {
      move<kOfA>(edgeFeature(edge), vertexFeature(lower));
    }
    return Step::Moved;
  }

  template <bool kOfA>
  Step parallelOf(std::uint32_t edge, std::uint32_t otherEdge) {
    move<kOfA>(edgeFeature(edge), edgeFeature(otherEdge));
    return parallel(featureIndex(at.a), featureIndex(at.b), true);
  }

  // Two edges that face each other: the answer is the middle of what they share, so that it does not depend on the
  // vertex the walk came from. `surely`: the walk came from a vertex in the slab.
  Step parallel(std::uint32_t i, std::uint32_t j, bool surely) {
    const Flat n = pair.a.normal(i);
    const Flat m = pair.turned(pair.b.normal(j));
    if (dot(n, m) > 0.0) return surely ? Step::Behind : leaveEdges(i, j);
    if (!surely && std::abs(cross(n, m)) > kParallel) return leaveEdges(i, j);
    const Flat first = pair.arm(i, j), second = pair.arm(i, pair.b.next(j));
    const double length = cross(n, Flat(pair.a.vertex(pair.a.next(i))) - Flat(pair.a.vertex(i)));
    const double low = std::max(0.0, cross(n, second)), high = std::min(length, cross(n, first));
    const double height = dot(n, first);
    if (!surely && low > high) return leaveEdges(i, j);
    if (height < 0.0) return Step::Behind;
    const Flat onA = Flat(pair.a.vertex(i)) + 0.5 * (low + high) * leftNormal(n);
    found.distance = height;
    found.normal = n.vec();
    found.onA = onA.vec();
    found.onB = (onA + height * n).vec();
    return Step::Found;
  }

  Step leaveEdges(std::uint32_t i, std::uint32_t j) {
    // The end of B's edge that turned towards A's.
    const Flat m = pair.turned(pair.b.normal(j));
    at = {edgeFeature(i), vertexFeature(cross(Flat(pair.a.normal(i)), m) < 0.0 ? j : pair.b.next(j))};
    return Step::Moved;
  }

  Step step(bool isFirst) {
    const std::uint32_t i = featureIndex(at.a), j = featureIndex(at.b);
    if (isEdge(at.a)) return isEdge(at.b) ? parallel(i, j, false) : edgeAndVertex<true>(i, j, isFirst);
    return isEdge(at.b) ? edgeAndVertex<false>(j, i, isFirst) : vertices(i, j);
  }
};

}  // namespace

PairCache firstGuess(const PairFrame& pair) {
  const Flat towards = pair.inA(pair.b.centroid()) - Flat(pair.a.centroid());
  return {vertexFeature(pair.a.farthest(towards.vec())),
          vertexFeature(pair.b.farthest((-pair.turnedBack(towards)).vec()))};
}

WalkEnd walkFeatures(const PairFrame& pair, PairCache& features, int limit, ClosestFeatures& found) {
  if (!pair.holds(features)) features = firstGuess(pair);
  PairCache at = features;
  Walker walker{pair, at, found};
  Step step = walker.step(true);
  int count = 1;
  for (; step == Step::Moved && count < limit; ++count) step = walker.step(false);
  found.steps += count;
  features = at;
  if (step == Step::Moved) return WalkEnd::TooLong;
  if (step == Step::Behind) return WalkEnd::Behind;
  found.a = at.a;
  found.b = at.b;
  found.status = found.distance > 0.0 ? PairStatus::Apart : PairStatus::Near;
  return WalkEnd::Found;
}

}  // namespace froude
