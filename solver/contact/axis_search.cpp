// Searches all edge normals; most are ruled out by one product, before a supporting vertex is looked for.
#include <froude/solver/contact/axis_search.h>

namespace froude {

namespace {

// Axes whose separations differ by less, as a fraction of the pair's extent, are equal: the one found first stays.
constexpr double kTie = 1e-12;

struct Search {
  const PairFrame& pair;
  AxisChoice choice;
  double separation = -kInfinity;
  std::uint32_t edge = 0, support = 0;
  bool ofA = true;
  bool apart = false;
  double tie = 0.0;

  bool done() const { return apart && choice == AxisChoice::UntilParting; }

  template <bool kOfA>
  void consider(std::uint32_t candidate, std::uint32_t& hint) {
    const double found = separationAlong(pair, kOfA, candidate, hint);
    if (found > 0.0) apart = true;
    const bool wins = found > separation + (separation > -kInfinity ? tie : 0.0);
    if (!done() && (!wins || (choice != AxisChoice::Any && !isTouchable<kOfA>(candidate, hint)))) return;
    separation = found;
    edge = candidate;
    support = hint;
    ofA = kOfA;
  }

  template <bool kOfA>
  bool isTouchable(std::uint32_t candidate, std::uint32_t vertex) const {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    if (!self.isOutline(candidate)) return false;
    return other.isWhole() || other.allows(vertex, -pair.toOther<kOfA>(self.normal(candidate)));
  }

  // The other shape holds a disc of its inner radius about its centroid, so along no axis it can be farther than that
  // disc: one product an edge, and the support is looked for where that bound beats the best.
  template <bool kOfA>
  void all(std::uint32_t hint) {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    const Vec2 centre = kOfA ? pair.pose.toWorld(other.centroid()) : pair.pose.toLocal(other.centroid());
    const double radius = (1.0 - kTie) * other.innerRadius();
    for (std::uint32_t k = 0; k < self.size() && !done(); ++k)
      if (self.normal(k).dot(centre - self.vertex(k)) - radius > separation) consider<kOfA>(k, hint);
  }
};

std::uint32_t withinSize(std::uint32_t k, const ConvexShape& shape) { return k < shape.size() ? k : 0; }

}  // namespace

double separationAlong(const PairFrame& pair, bool ofA, std::uint32_t edge, std::uint32_t& support) {
  if (ofA) {
    const Vec2& n = pair.a.normal(edge);
    support = pair.b.support(-pair.toOther<true>(n), support);
    return n.dot(pair.armOf<true>(edge, support));
  }
  const Vec2& n = pair.b.normal(edge);
  support = pair.a.support(-pair.toOther<false>(n), support);
  return n.dot(pair.armOf<false>(edge, support));
}

SeparatingAxis bestAxis(const PairFrame& pair, const PairCache& cache, AxisChoice choice) {
  Search search{pair, choice};
  search.tie = kTie * pair.extent();
  const std::uint32_t a = withinSize(featureIndex(cache.a), pair.a);
  const std::uint32_t b = withinSize(featureIndex(cache.b), pair.b);
  std::uint32_t onA = a, onB = b;
  // The last axis first: it is most often still the best, and rules out nearly all others.
  if (isEdge(cache.b) && !isEdge(cache.a)) {
    search.consider<false>(b, onA);
  } else {
    search.consider<true>(a, onB);
  }
  if (!search.done()) search.all<true>(onB);
  if (!search.done()) search.all<false>(onA);

  SeparatingAxis axis;
  axis.status = search.apart ? PairStatus::Apart : PairStatus::Overlapping;
  axis.separation = search.separation;
  axis.edge = edgeFeature(search.edge);
  axis.ofA = search.ofA;
  axis.support = search.support;
  axis.normal = search.ofA ? pair.a.normal(search.edge) : Vec2(-pair.pose.rotation.apply(pair.b.normal(search.edge)));
  return axis;
}

}  // namespace froude
