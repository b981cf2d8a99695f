// What of a scene's free bodies runs but is probably not meant: overlaps at the start, hinges far away, bodies that
// reach out of the domain or might cross its periodic sides.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "scene/draft.h"

namespace froude::scene {

namespace {

constexpr double kMostTests = 2e8;  // edge against edge, in one scene
constexpr std::size_t kMostSaid = 5;
constexpr double kTouch = 1e-3;  // of the smaller body's size: below, two bodies are meant to touch

/// One edge of a placed polygon.
struct Edge {
  Vec2 start, end;
  Vec2 at(double t) const { return start + t * (end - start); }
};

double distanceTo(const Edge& edge, const Vec2& p) {
  const Vec2 along = edge.end - edge.start;
  return (p - edge.at(std::clamp((p - edge.start).dot(along) / along.squaredNorm(), 0.0, 1.0))).norm();
}

double boundaryDistance(const Polygon& shape, const Vec2& p) {
  double least = kInfinity;
  for (std::uint32_t i = 0; i < shape.edgeCount(); ++i)
    least = std::min(least, distanceTo({shape.edgeStart(i), shape.edgeEnd(i)}, p));
  return least;
}

/// The part of `edge` at which it crosses `other`; negative where it does not.
double crossing(const Edge& edge, const Edge& other) {
  const Vec2 along = edge.end - edge.start, across = other.end - other.start;
  const double sideA = cross(across, edge.start - other.start), sideB = cross(across, edge.end - other.start);
  const double sideC = cross(along, other.start - edge.start), sideD = cross(along, other.end - edge.start);
  if ((sideA > 0.0) == (sideB > 0.0) || (sideC > 0.0) == (sideD > 0.0)) return -1.0;
  return sideA / (sideA - sideB);
}

/// A point within the solid: half-way along the ray that leaves the middle of the first edge inwards.
Vec2 innerPoint(const Polygon& shape) {
  const Edge first{shape.edgeStart(0), shape.edgeEnd(0)};
  const Vec2 inward = leftNormal(first.end - first.start).normalized();
  const Edge ray{first.at(0.5), first.at(0.5) + 2.0 * shape.bounds().size().norm() * inward};
  double least = 1.0;
  for (std::uint32_t i = 1; i < shape.edgeCount(); ++i) {
    const double at = crossing(ray, {shape.edgeStart(i), shape.edgeEnd(i)});
    if (at > 0.0) least = std::min(least, at);
  }
  return ray.at(0.5 * least);
}

/// How deep polygon a reaches into b, about: the largest distance to b's boundary among a's vertices, the middles of
/// the pieces into which b cuts a's edges, and one inner point of a, as far as they lie in b. 0: they do not overlap.
double depthOf(const Polygon& a, const Polygon& b) {
  double depth = 0.0;
  const auto probe = [&](const Vec2& p) {
    if (b.bounds().contains(p) && b.contains(p)) depth = std::max(depth, boundaryDistance(b, p));
  };
  std::vector<double> cuts;
  for (std::uint32_t i = 0; i < a.edgeCount(); ++i) {
    const Edge edge{a.edgeStart(i), a.edgeEnd(i)};
    Box reach;
    reach.include(edge.start);
    reach.include(edge.end);
    if (!reach.overlaps(b.bounds())) continue;
    cuts.assign({0.0, 1.0});
    for (std::uint32_t k = 0; k < b.edgeCount(); ++k) {
      const double at = crossing(edge, {b.edgeStart(k), b.edgeEnd(k)});
      if (at > 0.0) cuts.push_back(at);
    }
    std::sort(cuts.begin(), cuts.end());
    probe(edge.start);
    for (std::size_t k = 1; k < cuts.size(); ++k) probe(edge.at(0.5 * (cuts[k - 1] + cuts[k])));
  }
  probe(innerPoint(a));
  return depth;
}

class FreeBodyJudge {
 public:
  explicit FreeBodyJudge(Draft& draft) : draft_(draft), bodies_(draft.scene.world.bodies) {
    for (const BodyDef& body : bodies_)
      placed_.push_back(body.shape->transformed(Transform::of(body.position, body.angle)));
  }

  void judge() {
    judgeOverlaps();
    judgePeriods();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i].motion != Motion::Free) continue;
      judgeHinge(i);
      judgeSides(i);
    }
  }

 private:
  double sizeOf(std::size_t i) const { return placed_[i].bounds().size().norm(); }

  bool mayMeet(std::size_t a, std::size_t b) const {
    const BodyDef &p = bodies_[a], &q = bodies_[b];
    return (p.motion == Motion::Free || q.motion == Motion::Free) && (p.group & q.collidesWith) != 0 &&
           (q.group & p.collidesWith) != 0;
  }

  /// Boxes in order of their left sides, then the polygons of those that share a point.
  void judgeOverlaps() {
    std::vector<std::size_t> order(placed_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return placed_[a].bounds().min.x() < placed_[b].bounds().min.x();
    });
    double tests = 0.0;
    std::size_t found = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Box& box = placed_[order[i]].bounds();
      for (std::size_t k = i + 1; k < order.size() && placed_[order[k]].bounds().min.x() <= box.max.x(); ++k) {
        const std::size_t a = std::min(order[i], order[k]), b = std::max(order[i], order[k]);
        if (!mayMeet(a, b) || !placed_[a].bounds().overlaps(placed_[b].bounds())) continue;
        tests += 2.0 * placed_[a].edgeCount() * placed_[b].edgeCount();
        if (tests > kMostTests) return;
        const double depth = std::max(depthOf(placed_[a], placed_[b]), depthOf(placed_[b], placed_[a]));
        if (depth > kTouch * std::min(sizeOf(a), sizeOf(b)) && ++found <= kMostSaid) sayOverlap(a, b, depth);
      }
    }
    if (found > kMostSaid)
      draft_.warn(draft_.bodyPlaces[lastSaid_], "body",
                  fmt::format("{} more pairs of bodies overlap at the start", found - kMostSaid));
  }

  void sayOverlap(std::size_t a, std::size_t b, double depth) {
    if (bodies_[a].motion != Motion::Free) std::swap(a, b);
    lastSaid_ = a;
    draft_.warn(
        draft_.bodyPlaces[a], draft_.bodyPaths[a] + ".position",
        fmt::format("overlaps body.{} at the start, by about {:.2g} m: they are pushed apart gently; right is a "
                    "place where they touch at most, or filters that let them pass",
                    bodies_[b].name, depth));
  }

  void judgePeriods() {
    const DomainDef& domain = draft_.scene.world.domain;
    if (!domain.periodicX && !domain.periodicY) return;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i].motion != Motion::Free || bodies_[i].hinge) continue;
      draft_.warn(
          draft_.bodyPlaces[i], draft_.bodyPaths[i] + ".motion",
          "free bodies are not carried across a periodic side: one that gets there leaves the domain; right are "
          "walls, open sides or a hinge");
      return;
    }
  }

  void judgeHinge(std::size_t i) {
    if (!bodies_[i].hinge || placed_[i].contains(bodies_[i].hinge->at)) return;
    const double away = boundaryDistance(placed_[i], bodies_[i].hinge->at);
    if (away <= sizeOf(i)) return;
    draft_.warn(draft_.bodyPlaces[i], draft_.bodyPaths[i] + ".hinge.at",
                fmt::format("is {:.3g} m away from the body, which is {:.3g} m large: it swings as on a long rod; the "
                            "place is meant in world coordinates",
                            away, sizeOf(i)));
  }

  void judgeSides(std::size_t i) {
    const DomainDef& domain = draft_.scene.world.domain;
    const Box& box = placed_[i].bounds();
    const std::array<double, 4> beyond{domain.box.min.x() - box.min.x(), box.max.x() - domain.box.max.x(),
                                       domain.box.min.y() - box.min.y(), box.max.y() - domain.box.max.y()};
    static constexpr std::array<const char*, 4> kSides{"left", "right", "bottom", "top"};
    for (std::size_t side = 0; side < 4; ++side) {
      const bool periodic = side < 2 ? domain.periodicX : domain.periodicY;
      if (periodic || beyond[side] <= kTouch * sizeOf(i) || ++outside_ > kMostSaid) continue;
      draft_.warn(draft_.bodyPlaces[i], draft_.bodyPaths[i] + ".position",
                  fmt::format("reaches {:.2g} m beyond the domain's {} {}; right is a free body within the domain",
                              beyond[side], kSides[side], domain.closed[side] ? "wall" : "side, which is open"));
    }
  }

  Draft& draft_;
  const std::vector<BodyDef>& bodies_;
  std::vector<Polygon> placed_;
  std::size_t lastSaid_ = 0, outside_ = 0;
};

}  // namespace

void judgeFreeBodies(Draft& draft) {
  const auto isFree = [](const BodyDef& body) { return body.motion == Motion::Free; };
  const std::vector<BodyDef>& bodies = draft.scene.world.bodies;
  if (std::any_of(bodies.begin(), bodies.end(), isFree)) FreeBodyJudge(draft).judge();
}

}  // namespace froude::scene
