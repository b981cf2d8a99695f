// What runs but is probably not meant. Every warning here is true of the scene; doubtful ones would be switched off
// unread.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "scene/draft.h"
#include "scene/estimate.h"

namespace froude::scene {

namespace {

constexpr double kMostTests = 2e8;  // edge against edge, in one scene
constexpr std::size_t kMostGaps = 5;

void judgeTimeStep(Draft& draft) {
  const WorldDef& world = draft.scene.world;
  if (!world.timeStep || !world.fluid) return;
  // A travel of one support radius in a sub-step stops a run as unstable.
  const double reach = 2.0 * world.fluid->spacing;
  const double speed = expectedSpeed(draft.scene, false);
  if (speed * *world.timeStep <= reach) return;
  draft.warn(
      draft.timeStepPlace, "model.time_step",
      fmt::format(
          "what falls from the top reaches {:.3g} m/s and moves {:.2g} support radii in one sub-step, and a run is "
          "stopped at 1; right is at most {:.2g} s, or to leave it out",
          speed, speed * *world.timeStep / reach, reach / speed));
}

void judgeCuts(Draft& draft) {
  for (std::size_t i = 0; i < draft.fluidBlocks.size(); ++i) {
    const SeededBlock& block = draft.scene.fluidBlocks[i];
    const std::size_t places = block.cut + block.positions.size();
    if (2 * block.cut <= places) continue;
    draft.warn(draft.fluidBlocks[i].place, draft.fluidBlocks[i].path + ".shape",
               fmt::format("{} of its {} places are taken by bodies, walls or earlier blocks", block.cut, places));
  }
}

void judgeConveyors(Draft& draft) {
  std::set<const Polygon*> said;  // copies share a shape and are said once
  for (std::size_t i = 0; i < draft.scene.world.bodies.size(); ++i) {
    const BodyDef& body = draft.scene.world.bodies[i];
    const bool sticks = body.slip.value_or(draft.scene.world.domain.slip) == Slip::NoSlip;
    if (body.surfaceVelocity == 0.0 || sticks || !said.insert(body.shape.get()).second) continue;
    draft.warn(draft.bodyPlaces[i], draft.bodyPaths[i] + ".surface_velocity",
               "moves bullets only: this body is free-slip for the fluid; slip = \"no\" lets it take the fluid along");
  }
}

/// What sticks to a wall feels it by viscosity alone.
void judgeSlip(Draft& draft) {
  const WorldDef& world = draft.scene.world;
  if (world.fluid->viscosity > 0.0) return;
  if (world.domain.slip == Slip::NoSlip) {
    draft.warn(draft.slipPlace, "domain.wall_slip", "\"no\" does nothing without fluid.viscosity");
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].slip != Slip::NoSlip) continue;
    draft.warn(draft.bodyPlaces[i], draft.bodyPaths[i] + ".slip", "\"no\" does nothing without fluid.viscosity");
    return;
  }
}

/// Length of the ray from the middle of edge i into the solid until it leaves it.
double chordFrom(const Polygon& shape, std::uint32_t i) {
  const Vec2 a = shape.edgeStart(i), along = shape.edgeEnd(i) - a;
  const Vec2 origin = a + 0.5 * along, inward = leftNormal(along).normalized();
  double least = kInfinity;
  for (std::uint32_t k = 0; k < shape.edgeCount(); ++k) {
    if (k == i) continue;
    const Vec2 p = shape.edgeStart(k) - origin, q = shape.edgeEnd(k) - origin;
    const double sideP = cross(inward, p), sideQ = cross(inward, q);
    if ((sideP > 0.0) == (sideQ > 0.0)) continue;
    const Vec2 hit = p + (q - p) * (sideP / (sideP - sideQ));
    if (hit.dot(inward) > 0.0) least = std::min(least, hit.dot(inward));
  }
  return least;
}

void judgeThickness(Draft& draft) {
  const WorldDef& world = draft.scene.world;
  const double dx = world.fluid->spacing;
  std::set<const Polygon*> seen;  // copies share a shape and are said once
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Polygon& shape = *world.bodies[b].shape;
    if (shape.edgeCount() > 2000 || !seen.insert(&shape).second) continue;
    double thickness = kInfinity;
    for (std::uint32_t i = 0; i < shape.edgeCount(); ++i) thickness = std::min(thickness, chordFrom(shape, i));
    if (thickness >= dx * (1.0 - 1e-9)) continue;
    draft.warn(
        draft.bodyPlaces[b], draft.bodyPaths[b] + ".shape",
        fmt::format(
            "is {:.3g} m thin, and the spacing is {:.3g} m: its sides are kept apart, but the flow around its ends "
            "is not resolved",
            thickness, dx));
  }
}

double distanceToSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 ab = b - a;
  const double part = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - (a + part * ab)).norm();
}

bool segmentsCross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

/// Distance of two polygons; 0 where they touch or overlap.
double gapBetween(const Polygon& a, const Polygon& b) {
  if (a.contains(b.edgeStart(0)) || b.contains(a.edgeStart(0))) return 0.0;
  double least = kInfinity;
  for (std::uint32_t i = 0; i < a.edgeCount(); ++i)
    for (std::uint32_t k = 0; k < b.edgeCount(); ++k) {
      const Vec2 p = a.edgeStart(i), q = a.edgeEnd(i), r = b.edgeStart(k), s = b.edgeEnd(k);
      if (segmentsCross(p, q, r, s)) return 0.0;
      least = std::min({least, distanceToSegment(p, r, s), distanceToSegment(r, p, q)});
    }
  return least;
}

/// Gaps that are open, but too narrow for a particle.
class GapJudge {
 public:
  explicit GapJudge(Draft& draft) : draft_(draft), dx_(draft.scene.world.fluid->spacing) {
    for (const BodyDef& body : draft.scene.world.bodies)
      placed_.push_back(body.shape->transformed(Transform::of(body.position, body.angle)));
  }

  void judge() {
    std::vector<std::size_t> order(placed_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return placed_[a].bounds().min.x() < placed_[b].bounds().min.x();
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (!gapStays(order[i])) continue;
      judgeSides(order[i]);
      const Box reach = placed_[order[i]].bounds().grown(dx_);
      for (std::size_t k = i + 1; k < order.size() && placed_[order[k]].bounds().min.x() <= reach.max.x(); ++k) {
        if (!reach.overlaps(placed_[order[k]].bounds()) || !gapStays(order[k])) continue;
        tests_ += static_cast<double>(placed_[order[i]].edgeCount()) * placed_[order[k]].edgeCount();
        if (tests_ > kMostTests || said_ >= kMostGaps) return;
        say(order[i], "body." + draft_.scene.world.bodies[order[k]].name,
            gapBetween(placed_[order[i]], placed_[order[k]]));
      }
    }
  }

 private:
  /// A free body's gaps change as it moves.
  bool gapStays(std::size_t i) const { return draft_.scene.world.bodies[i].motion != Motion::Free; }

  void judgeSides(std::size_t i) {
    const DomainDef& domain = draft_.scene.world.domain;
    const Box& box = placed_[i].bounds();
    const std::array<double, 4> gaps{box.min.x() - domain.box.min.x(), domain.box.max.x() - box.max.x(),
                                     box.min.y() - domain.box.min.y(), domain.box.max.y() - box.max.y()};
    static constexpr std::array<const char*, 4> kSides{"left", "right", "bottom", "top"};
    for (std::size_t side = 0; side < 4; ++side)
      if (domain.closed[side]) say(i, fmt::format("the domain's {} wall", kSides[side]), gaps[side]);
  }

  void say(std::size_t i, const std::string& other, double gap) {
    // Below a thousandth of dx the two are meant to touch.
    if (gap <= 1e-3 * dx_ || gap >= dx_ * (1.0 - 1e-9) || said_ >= kMostGaps) return;
    ++said_;
    draft_.warn(
        draft_.bodyPlaces[i], draft_.bodyPaths[i] + ".position",
        fmt::format(
            "leaves a gap of {:.3g} m to {}, narrower than the spacing of {:.3g} m: what flows through it is not "
            "resolved; right is none, or several spacings",
            gap, other, dx_));
  }

  Draft& draft_;
  double dx_;
  std::vector<Polygon> placed_;
  double tests_ = 0.0;
  std::size_t said_ = 0;
};

}  // namespace

void judge(Draft& draft) {
  judgeTimeStep(draft);
  judgeCuts(draft);
  judgeFreeBodies(draft);
  judgeSoft(draft);
  if (!draft.scene.world.fluid) return;
  judgeConveyors(draft);
  judgeSlip(draft);
  judgeThickness(draft);
  GapJudge(draft).judge();
}

}  // namespace froude::scene
