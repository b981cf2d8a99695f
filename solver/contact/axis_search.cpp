// Searches all edge normals; most are ruled out by one product, before a supporting vertex is looked for.
#include <froude/solver/contact/axis_search.h>

#include <froude/solver/contact/feature_walk.h>

namespace froude {

namespace {

// Axes whose separations differ by less, as a fraction of the pair's extent, are equal: the one found first stays.
constexpr double kTie = 1e-12;

struct Search {
  const PairFrame& pair;
  AxisChoice choice;
  double tie;
  double separation = -kInfinity;
  std::uint32_t edge = 0, support = 0;
  bool ofA = true;
  bool apart = false;

  bool done() const { return apart && choice == AxisChoice::UntilParting; }

  template <bool kOfA>
  void consider(std::uint32_t candidate, std::uint32_t& hint) {
    const double along = separationAlong<kOfA>(pair, candidate, hint);
    if (along > 0.0) apart = true;
    if (!done()) {
      if (along <= separation + tie) return;
      if (choice != AxisChoice::Any && !isTouchable<kOfA>(candidate, hint)) return;
    }
    separation = along;
    edge = candidate;
    support = hint;
    ofA = kOfA;
  }

  template <bool kOfA>
  bool isTouchable(std::uint32_t candidate, std::uint32_t vertex) const {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    if (!self.isOutline(candidate)) return false;
    return other.isWhole() || other.allows(vertex, (-pair.toOther<kOfA>(self.normal(candidate))).vec());
  }

  // Along no axis is the other shape farther away than any of its points: its last support and the two beside it lie
  // deep behind most edges. A few products for two edges; the support is looked for where that bound beats the best.
  template <bool kOfA>
  void all(std::uint32_t hint) {
    const ConvexShape& self = pair.self<kOfA>();
    Witness witness = witnessOf<kOfA>(hint);
    const auto lines = self.linePairs();
    for (std::uint32_t k = 0; k < lines.size(); ++k) {
      const Eigen::Array2d bound = witness.above(lines[k]);
      if (std::max(bound[0], bound[1]) <= separation) continue;
      for (std::uint32_t e = 2 * k; e < std::min(2 * k + 2, self.size()); ++e) {
        if (bound[e & 1] <= separation) continue;
        consider<kOfA>(e, hint);
        if (done()) return;
      }
      witness = witnessOf<kOfA>(hint);
    }
  }

  struct Witness {
    Flat point, after, before;  // from the centroid of the shape whose edges are tried

    Eigen::Array2d above(const ConvexShape::LinePair& line) const {
      const Eigen::Array2d first = line.normalX * point.x + line.normalY * point.y;
      const Eigen::Array2d second = line.normalX * after.x + line.normalY * after.y;
      const Eigen::Array2d third = line.normalX * before.x + line.normalY * before.y;
      return first.min(second).min(third) - line.offset;
    }
  };

  template <bool kOfA>
  Witness witnessOf(std::uint32_t k) const {
    const ConvexShape& other = pair.other<kOfA>();
    const auto place = [&](std::uint32_t v) {
      return (kOfA ? pair.inA(other.vertex(v)) : pair.inB(other.vertex(v))) - Flat(pair.self<kOfA>().centroid());
    };
    return {place(k), place(other.next(k)), place(other.previous(k))};
  }

  // First the cached edge, then the edge of the other shape that faces it: most often one of them is the best, and what
  // supports them are the points that rule out all others.
  template <bool kOfA>
  void run(std::uint32_t first, std::uint32_t hint) {
    const ConvexShape& self = pair.self<kOfA>();
    const ConvexShape& other = pair.other<kOfA>();
    consider<kOfA>(first, hint);
    if (done()) return;
    const Flat facing = -pair.toOther<kOfA>(self.normal(first));
    const std::uint32_t before = other.previous(hint);
    std::uint32_t back = first;
    consider<!kOfA>(dot(other.normal(before), facing) > dot(other.normal(hint), facing) ? before : hint, back);
    if (!done()) all<kOfA>(hint);
    if (!done()) all<!kOfA>(back);
  }
};

}  // namespace

SeparatingAxis bestAxis(const PairFrame& pair, const PairCache& cache, AxisChoice choice) {
  Search search{pair, choice, kTie * pair.extent()};
  const PairCache start = pair.holds(cache) ? cache : firstGuess(pair);
  const std::uint32_t a = featureIndex(start.a), b = featureIndex(start.b);
  if (isEdge(start.b) && !isEdge(start.a)) {
    search.run<false>(b, a);
  } else {
    search.run<true>(a, b);
  }
  SeparatingAxis axis;
  axis.status = search.apart ? PairStatus::Apart : PairStatus::Overlapping;
  axis.separation = search.separation;
  axis.edge = edgeFeature(search.edge);
  axis.ofA = search.ofA;
  axis.support = search.support;
  axis.normal = search.ofA ? pair.a.normal(search.edge) : (-pair.turned(pair.b.normal(search.edge))).vec();
  return axis;
}

}  // namespace froude
