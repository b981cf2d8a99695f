// Where a scene's soft bodies cannot start (inside polygons, outside the domain), and what of them runs but is probably
// not meant: overlaps with each other, triangles too large for the shape, materials that give way under their weight.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "scene/draft.h"

namespace froude::scene {

namespace {

constexpr double kMostTests = 2e8;  // point against edge, in one scene
constexpr std::size_t kMostSaid = 5;
constexpr double kRounding = 1e-9;     // [m]
constexpr double kTouch = 0.02;        // of the spacing: below, two bodies are meant to touch
constexpr double kFewestAcross = 2.0;  // triangles across a body that bends
constexpr double kNearlyRigidVolume = 0.49;
constexpr double kSagging = 0.5;  // strain under the own weight

class SoftJudge {
 public:
  explicit SoftJudge(Draft& draft) : draft_(draft), soft_(draft.scene.world.soft) {
    for (std::size_t i = 0; i < soft_.size(); ++i) {
      const Transform transform = Transform::of(soft_[i].position, soft_[i].angle);
      Placed placed;
      std::vector<bool> pinned(soft_[i].mesh->points.size(), false);
      for (const std::uint32_t p : soft_[i].pinned) pinned[p] = true;
      for (std::size_t p = 0; p < pinned.size(); ++p) {
        const Vec2 at = transform.toWorld(soft_[i].mesh->points[p]);
        placed.bounds.include(at);
        if (pinned[p]) continue;
        placed.points.push_back(at);
        placed.free.include(at);
      }
      if (draft.soft[i].shape) placed.outline.push_back(draft.soft[i].shape->transformed(transform));
      placed_.push_back(std::move(placed));
    }
  }

  void judge() {
    std::set<const TriangleMesh*> seen;  // copies are said once
    for (std::size_t i = 0; i < soft_.size(); ++i) {
      checkSides(i);
      if (!seen.insert(soft_[i].mesh.get()).second) continue;
      judgeResolution(i);
      judgeMaterial(i);
      judgePins(i);
    }
    judgeBullets();
    checkBodies();
    judgeOverlapsAmongSoft();
    sayHowManyMore();
  }

 private:
  struct Placed {
    std::vector<Vec2> points;      // that are free to move
    std::vector<Polygon> outline;  // one; none of a rope
    Box bounds, free;              // of all points, and of those
  };

  void warn(std::size_t i, const char* key, const std::string& text) {
    draft_.warn(draft_.soft[i].place, draft_.soft[i].path + "." + key, text);
  }

  void judgeBullets() {
    const std::optional<BulletDef>& bullet = draft_.scene.world.bullet;
    for (std::size_t i = 0; bullet && i < soft_.size(); ++i) {
      if (!mayMeet(soft_[i], bullet->group, bullet->collidesWith)) continue;
      warn(i, "collides_with",
           "soft bodies and bullets pass through each other in this version; right is a group of their own");
      return;
    }
  }

  bool isElastic(std::size_t i) const {
    return soft_[i].model == SoftModel::NeoHookean || soft_[i].model == SoftModel::StVenantKirchhoff;
  }

  /// Strips of a thickness t and a length L have an area of t·L and an outline of 2·L.
  void judgeResolution(std::size_t i) {
    if (!isElastic(i)) return;
    const TriangleMesh& mesh = *soft_[i].mesh;
    double length = 0.0;
    for (const auto& edge : mesh.outline) length += (mesh.points[edge[1]] - mesh.points[edge[0]]).norm();
    const double across = 2.0 * draft_.soft[i].shape->area() / length / soft_[i].spacing;
    if (across >= kFewestAcross) return;
    warn(i, "spacing",
         fmt::format("puts about {:.1f} triangles across the body: it bends less than it should; right is {:.2g} m or "
                     "less",
                     across, soft_[i].spacing * across / kFewestAcross));
  }

  void judgeMaterial(std::size_t i) {
    const SoftDef& def = soft_[i];
    if (isElastic(i) && def.poisson > kNearlyRigidVolume)
      warn(i, "poisson",
           fmt::format("is above {}: triangles lock as the volume becomes rigid; right is at most {}",
                       kNearlyRigidVolume, kNearlyRigidVolume));
    const WorldDef& world = draft_.scene.world;
    if (world.gravityField || def.model == SoftModel::Rope) return;
    const double height = placed_[i].bounds.size().y();
    const double strain = def.density * world.gravity.norm() * height / def.young;
    if (strain > kSagging)
      warn(i, "young",
           fmt::format(
               "lets the body sag by a strain of about {:.2g} under its own weight; right is {:.2g} N/m² or more",
               strain, def.density * world.gravity.norm() * height / (0.2 * kSagging)));
  }

  void judgePins(std::size_t i) {
    if (placed_[i].points.empty()) warn(i, "pin", "holds every point of the body, which will not move at all");
  }

  [[noreturn]] void refuse(std::size_t i, const std::string& problem) {
    throw SceneError(draft_.soft[i].place, draft_.soft[i].path + ".position", problem);
  }

  void checkSides(std::size_t i) {
    const DomainDef& domain = draft_.scene.world.domain;
    if (domain.periodicX || domain.periodicY)
      refuse(i, "soft bodies among periodic sides are not in this version, right are walls or open sides");
    const Box& box = placed_[i].free;
    const std::array<double, 4> beyond{domain.box.min.x() - box.min.x(), box.max.x() - domain.box.max.x(),
                                       domain.box.min.y() - box.min.y(), box.max.y() - domain.box.max.y()};
    static constexpr std::array<const char*, 4> kSides{"left", "right", "bottom", "top"};
    for (std::size_t side = 0; side < 4; ++side)
      if (beyond[side] > 0.0)
        refuse(i, fmt::format("reaches {:.2g} m beyond the domain's {} side, right is a place within the domain",
                              beyond[side], kSides[side]));
  }

  bool mayMeet(const SoftDef& soft, std::uint32_t group, std::uint32_t mask) const {
    return (soft.group & mask) != 0 && (group & soft.collidesWith) != 0;
  }

  /// The largest depth of free points of soft body i in a polygon [m], a rope's thickness included; 0: none lies in it.
  double depthIn(std::size_t i, const Polygon& polygon) {
    const double radius = 0.5 * soft_[i].thickness;
    const Box reach = polygon.bounds().grown(radius);
    double depth = 0.0;
    if (placed_[i].points.empty() || !reach.overlaps(placed_[i].free)) return depth;
    for (const Vec2& p : placed_[i].points) {
      if (!reach.contains(p)) continue;
      tests_ += 2.0 * polygon.edgeCount();
      if (tests_ > kMostTests) return 0.0;
      const double away = distanceToOutline(polygon, p);
      depth = std::max(depth, radius + (polygon.contains(p) ? away : -away));
    }
    return depth;
  }

  void sayOverlap(std::size_t i, const std::string& other, double depth) {
    if (depth <= kTouch * soft_[i].spacing) return;
    last_ = i;
    if (++found_ > kMostSaid) return;
    warn(i, "position",
         fmt::format("overlaps {} at the start, by about {:.2g} m: they are pushed apart; right is a place where they "
                     "touch at most, or filters that let them pass",
                     other, depth));
  }

  void checkBodies() {
    for (const BodyDef& body : draft_.scene.world.bodies) {
      const Polygon polygon = body.shape->transformed(Transform::of(body.position, body.angle));
      for (std::size_t i = 0; i < soft_.size(); ++i) {
        if (!mayMeet(soft_[i], body.group, body.collidesWith)) continue;
        const double depth = depthIn(i, polygon);
        if (depth > kRounding)
          refuse(i,
                 fmt::format("overlaps body.{} by {:.2g} m; right is a place where they touch at most, pins that hold "
                             "the points inside, or filters that let them pass",
                             body.name, depth));
      }
    }
  }

  void judgeOverlapsAmongSoft() {
    std::vector<std::size_t> order(soft_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return placed_[a].bounds.min.x() < placed_[b].bounds.min.x();
    });
    for (std::size_t i = 0; i < order.size(); ++i)
      for (std::size_t k = i + 1; k < order.size(); ++k) {
        const std::size_t a = std::min(order[i], order[k]), b = std::max(order[i], order[k]);
        if (placed_[order[k]].bounds.min.x() > placed_[order[i]].bounds.max.x()) break;
        if (!mayMeet(soft_[a], soft_[b].group, soft_[b].collidesWith)) continue;
        double depth = 0.0;
        for (const Polygon& outline : placed_[b].outline) depth = std::max(depth, depthIn(a, outline));
        for (const Polygon& outline : placed_[a].outline) depth = std::max(depth, depthIn(b, outline));
        sayOverlap(a, draft_.soft[b].path, depth);
      }
  }

  void sayHowManyMore() {
    if (found_ > kMostSaid)
      warn(last_, "position", fmt::format("{} more pairs of soft bodies overlap at the start", found_ - kMostSaid));
  }

  Draft& draft_;
  const std::vector<SoftDef>& soft_;
  std::vector<Placed> placed_;
  double tests_ = 0.0;
  std::size_t found_ = 0, last_ = 0;
};

}  // namespace

void judgeSoft(Draft& draft) {
  if (!draft.scene.world.soft.empty()) SoftJudge(draft).judge();
}

}  // namespace froude::scene
