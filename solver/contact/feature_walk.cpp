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
bool leaves(const Vec2& after, const Vec2& before, const Vec2& d, double tolerance) {
  return cross(after, d) > tolerance || cross(before, d) < -tolerance;
}

// Which of them: the only one, or where both do, as at the tip of a needle, the one on the side that d leads out of.
// Its other side comes nearer as well, but lies behind.
bool isUpper(const Vec2& after, const Vec2& before, const Vec2& d) {
  if (cross(after, d) <= 0.0) return false;
  return cross(before, d) >= 0.0 || after.dot(d) >= before.dot(d);
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
    const Vec2 w = pair.arm(i, j);
    const Vec2 &afterA = a.normal(i), &beforeA = a.normal(a.previous(i));
    if (leaves(afterA, beforeA, w, 0.0))
      return at.a = edgeFeature(isUpper(afterA, beforeA, w) ? i : a.previous(i)), Step::Moved;
    const Vec2 u = -pair.pose.rotation.applyInverse(w);
    const Vec2 &afterB = b.normal(j), &beforeB = b.normal(b.previous(j));
    if (leaves(afterB, beforeB, u, 0.0))
      return at.b = edgeFeature(isUpper(afterB, beforeB, u) ? j : b.previous(j)), Step::Moved;
    const double distance = w.norm();
    // A vertex within a straight run passes the products from behind too, as does an arm of no length.
    const bool before = std::max(afterA.dot(w), beforeA.dot(w)) > 0.0 && std::max(afterB.dot(u), beforeB.dot(u)) > 0.0;
    if (!before || distance < kCoincident * pair.extent()) return Step::Behind;
    found.distance = distance;
    found.onA = a.vertex(i);
    found.onB = a.vertex(i) + w;
    found.normal = w / distance;
    return Step::Found;
  }

  template <bool kOfA>
  Step edgeAndVertex(std::uint32_t edge, std::uint32_t vertex) {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    const Vec2& n = self.normal(edge);
    const std::uint32_t last = self.next(edge);
    const Vec2 arm = pair.armOf<kOfA>(edge, vertex);
    if (cross(n, arm) < 0.0) return move<kOfA>(vertexFeature(edge), vertexFeature(vertex)), Step::Moved;
    if (cross(n, pair.armOf<kOfA>(last, vertex)) > 0.0)
      return move<kOfA>(vertexFeature(last), vertexFeature(vertex)), Step::Moved;
    const double height = n.dot(arm);
    if (height < 0.0) return Step::Behind;
    const Vec2 facing = -pair.toOther<kOfA>(n);
    const std::uint32_t previous = other.previous(vertex);
    const Vec2 &after = other.normal(vertex), &before = other.normal(previous);
    if (leaves(after, before, facing, kParallel)) {
      if (isUpper(after, before, facing)) return descend<kOfA>(edge, vertex, other.next(vertex));
      return descend<kOfA>(edge, previous, previous);
    }
    if (cross(after, facing) >= -kParallel) return parallelOf<kOfA>(edge, vertex);
    if (cross(before, facing) <= kParallel) return parallelOf<kOfA>(edge, previous);
    const Vec2 normal = kOfA ? n : facing;
    found.distance = height;
    found.normal = normal;
    if constexpr (kOfA) {
      found.onB = self.vertex(edge) + arm;
      found.onA = found.onB - height * normal;
    } else {
      found.onA = other.vertex(vertex);
      found.onB = found.onA + height * normal;
    }
    return Step::Found;
  }

  // The other shape comes nearer along its edge `down`, towards `lower`. If that vertex is in the slab it is the next
  // pair; else the edge leaves the slab above one end of ours, and that end against it is nearer still.
  template <bool kOfA>
  Step descend(std::uint32_t edge, std::uint32_t down, std::uint32_t lower) {
    const ConvexShape& self = pair.self<kOfA>();
    const Vec2& n = self.normal(edge);
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
    const Vec2& n = pair.a.normal(i);
    const Vec2 m = pair.pose.rotation.apply(pair.b.normal(j));
    if (n.dot(m) > 0.0) return surely ? Step::Behind : leaveEdges(i, j);
    if (!surely && std::abs(cross(n, m)) > kParallel) return leaveEdges(i, j);
    const Vec2 first = pair.arm(i, j), second = pair.arm(i, pair.b.next(j));
    const double length = cross(n, pair.a.vertex(pair.a.next(i)) - pair.a.vertex(i));
    const double low = std::max(0.0, cross(n, second)), high = std::min(length, cross(n, first));
    const double height = n.dot(first);
    if (!surely && low > high) return leaveEdges(i, j);
    if (height < 0.0) return Step::Behind;
    found.distance = height;
    found.normal = n;
    found.onA = pair.a.vertex(i) + 0.5 * (low + high) * leftNormal(n);
    found.onB = found.onA + height * n;
    return Step::Found;
  }

  Step leaveEdges(std::uint32_t i, std::uint32_t j) {
    // The end of B's edge that turned towards A's.
    const Vec2 m = pair.pose.rotation.apply(pair.b.normal(j));
    at = {edgeFeature(i), vertexFeature(cross(pair.a.normal(i), m) < 0.0 ? j : pair.b.next(j))};
    return Step::Moved;
  }

  Step step() {
    const std::uint32_t i = featureIndex(at.a), j = featureIndex(at.b);
    if (isEdge(at.a)) return isEdge(at.b) ? parallel(i, j, false) : edgeAndVertex<true>(i, j);
    return isEdge(at.b) ? edgeAndVertex<false>(j, i) : vertices(i, j);
  }
};

}  // namespace

WalkEnd walkFeatures(const PairFrame& pair, PairCache& features, int limit, ClosestFeatures& found) {
  if (featureIndex(features.a) >= pair.a.size()) features.a = 0;
  if (featureIndex(features.b) >= pair.b.size()) features.b = 0;
  Walker walker{pair, features, found};
  for (int count = 1; count <= limit; ++count) {
    ++found.steps;
    const Step step = walker.step();
    if (step == Step::Moved) continue;
    if (step == Step::Behind) return WalkEnd::Behind;
    found.a = features.a;
    found.b = features.b;
    found.status = found.distance > 0.0 ? PairStatus::Apart : PairStatus::Near;
    return WalkEnd::Found;
  }
  return WalkEnd::TooLong;
}

}  // namespace froude
