// Filling the blocks with particles, outside of bodies, walls and each other.
#include <fmt/format.h>
#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/particles/fill.h>

#include <map>

#include "run/machine.h"
#include "scene/draft.h"

namespace froude::scene {

namespace {

/// Particles that the blocks will have at most, by area.
double expectedFluid(const Draft& draft) {
  double count = 0.0;
  if (draft.scene.world.fluid)
    for (const BlockDraft& block : draft.fluidBlocks)
      count += block.shape->area() / std::pow(draft.scene.world.fluid->spacing, 2);
  return count;
}

double expectedBullets(const Draft& draft) {
  double count = 0.0;
  for (const BlockDraft& block : draft.bulletBlocks) count += static_cast<double>(block.count);
  return count;
}

}  // namespace

void checkMemory(const Draft& draft) {
  constexpr double kMost = 1e15;  // beyond, counts need not be exact
  constexpr double kPlaced =
      2.0 * 2.0 * sizeof(Vec2);  // position and velocity, in the scene and on their way into the world
  const double fluid = std::min(expectedFluid(draft), kMost), bullets = std::min(expectedBullets(draft), kMost);
  const double needed = kPlaced * (fluid + bullets) +
                        static_cast<double>(estimateWorldBytes(draft.scene.world, static_cast<std::size_t>(fluid),
                                                               static_cast<std::size_t>(bullets)));
  const auto had = static_cast<double>(run::availableMemoryBytes());
  if (had == 0.0 || needed <= had) return;
  const bool byFluid = fluid >= bullets;
  const std::string what = fmt::format("{:.3g} particles would need {}, and {} are available; right is {}",
                                       fluid + bullets, run::bytesInWords(needed), run::bytesInWords(had),
                                       byFluid ? "a larger model.spacing" : "a smaller count");
  if (byFluid && draft.spacingPlace) throw SceneError(*draft.spacingPlace, "model.spacing", what);
  if (byFluid) throw SceneError(draft.fluidBlocks.front().place, draft.fluidBlocks.front().path + ".shape", what);
  std::size_t largest = 0;
  for (std::size_t i = 0; i < draft.bulletBlocks.size(); ++i)
    if (draft.bulletBlocks[i].count > draft.bulletBlocks[largest].count) largest = i;
  throw SceneError(draft.bulletBlocks[largest].countPlace, draft.bulletBlocks[largest].path + ".count", what);
}

namespace {

/// A rope as its links, each a rectangle; any other soft body as its shape at rest.
std::vector<std::shared_ptr<const Polygon>> solidsOf(const SoftDraft& draft, const SoftDef& def) {
  if (draft.shape) return {draft.shape};
  std::vector<std::shared_ptr<const Polygon>> links;
  for (const auto& link : def.mesh->outline) {
    const Vec2 a = def.mesh->points[link[0]], b = def.mesh->points[link[1]];
    const Vec2 side = 0.5 * def.thickness * leftNormal(b - a).normalized();
    links.push_back(std::make_shared<const Polygon>(Polygon::make({a - side, b - side, b + side, a + side})));
  }
  return links;
}

/// The bodies that a species collides with, soft ones too, and the domain: is a place nearer to them than `clearance`?
class Obstacles {
 public:
  Obstacles(const Draft& draft, double clearance, std::uint32_t group, std::uint32_t mask)
      : domain_(draft.scene.world.domain.box), clearance_(clearance) {
    const WorldDef& world = draft.scene.world;
    // A hair less than asked for, so that a particle at half a spacing from a wall is not cut by rounding.
    const double room = clearance * (1.0 - 1e-6);
    const std::array<bool, 4>& closed = world.domain.closed;
    free_.min = domain_.min + Vec2(closed[0] ? room : 0.0, closed[2] ? room : 0.0);
    free_.max = domain_.max - Vec2(closed[1] ? room : 0.0, closed[3] ? room : 0.0);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const BodyDef& body = world.bodies[i];
      if ((body.group & mask) == 0 || (group & body.collidesWith) == 0) continue;
      add(i, body.shape, Transform::of(body.position, body.angle));
    }
    for (std::size_t i = 0; i < world.soft.size(); ++i) {
      const SoftDef& soft = world.soft[i];
      if ((soft.group & mask) == 0 || (group & soft.collidesWith) == 0) continue;
      for (const auto& solid : solidsOf(draft.soft[i], soft))
        add(world.bodies.size() + i, solid, Transform::of(soft.position, soft.angle));
    }
    sortIntoCells();
  }

  static constexpr int kFree = -1, kDomain = -2;

  /// Index of the first body that blocks the place (soft ones after the others), kDomain, or kFree.
  int blockedBy(const Vec2& p) const {
    if (!free_.contains(p)) return kDomain;
    for (const std::uint32_t i : cells_[cellOf(p.x(), 0) + static_cast<std::size_t>(cellsAcross_) * cellOf(p.y(), 1)]) {
      const Entry& body = bodies_[i];
      if (!body.box.contains(p)) continue;
      const FieldSample sample = body.field->sample(body.transform.toLocal(p));
      if (sample.distance < (sample.exact ? clearance_ * (1.0 - 1e-6) : 0.0)) return static_cast<int>(body.index);
    }
    return kFree;
  }

 private:
  struct Entry {
    std::size_t index;
    const DistanceField* field;
    Transform transform;
    Box box;
  };

  void add(std::size_t index, const std::shared_ptr<const Polygon>& shape, const Transform& transform) {
    std::shared_ptr<const DistanceField>& field = fields_[shape];
    if (field == nullptr) field = std::make_shared<const DistanceField>(*shape, clearance_);
    bodies_.push_back({index, field.get(), transform, shape->transformed(transform).bounds().grown(clearance_)});
  }

  std::size_t cellOf(double value, int axis) const {
    const double part = (value - domain_.min[axis]) / (domain_.max[axis] - domain_.min[axis]);
    return static_cast<std::size_t>(std::clamp(std::floor(part * cellsAcross_), 0.0, cellsAcross_ - 1.0));
  }

  void sortIntoCells() {
    cellsAcross_ = std::clamp(std::ceil(2.0 * std::sqrt(static_cast<double>(bodies_.size()))), 1.0, 512.0);
    const auto n = static_cast<std::size_t>(cellsAcross_);
    cells_.resize(n * n);
    for (std::uint32_t i = 0; i < bodies_.size(); ++i)
      for (std::size_t y = cellOf(bodies_[i].box.min.y(), 1); y <= cellOf(bodies_[i].box.max.y(), 1); ++y)
        for (std::size_t x = cellOf(bodies_[i].box.min.x(), 0); x <= cellOf(bodies_[i].box.max.x(), 0); ++x)
          cells_[x + n * y].push_back(i);
  }

  Box domain_, free_;
  double clearance_;
  double cellsAcross_ = 1.0;
  std::map<std::shared_ptr<const Polygon>, std::shared_ptr<const DistanceField>> fields_;
  std::vector<Entry> bodies_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

std::string obstacleName(const WorldDef& world, int blocker) {
  if (blocker == Obstacles::kDomain) return "the edge of the domain";
  const auto index = static_cast<std::size_t>(blocker);
  if (index >= world.bodies.size()) return "soft." + world.soft[index - world.bodies.size()].name;
  return "body." + world.bodies[index].name;
}

std::vector<Vec2> velocitiesAt(const BlockDraft& block, const std::vector<Vec2>& points) {
  std::vector<Vec2> velocities;
  velocities.reserve(points.size());
  for (const Vec2& p : points) {
    velocities.emplace_back(block.velocity[0].evaluate(p.x(), p.y(), 0.0),
                            block.velocity[1].evaluate(p.x(), p.y(), 0.0));
    if (!velocities.back().allFinite() || velocities.back().norm() > 1e9)
      throw SceneError(
          block.velocityPlace, block.path + ".velocity",
          fmt::format("is [{}, {}] at [{}, {}], right is finite and at most 1e9 m/s everywhere in the block",
                      show(velocities.back().x()), show(velocities.back().y()), show(p.x()), show(p.y())));
  }
  return velocities;
}

void seedFluidBlock(const BlockDraft& block, const Obstacles& obstacles, PlacedPoints& placed, Draft& draft) {
  const WorldDef& world = draft.scene.world;
  const double dx = world.fluid->spacing;
  const Vec2 size = block.shape->bounds().size();
  if (size.minCoeff() < dx * (1.0 - 1e-6))
    throw SceneError(
        block.place, block.path + ".shape",
        fmt::format("is {} m × {} m, smaller than the spacing of {} m, right is model.spacing of at most {}",
                    show(size.x()), show(size.y()), show(dx), show(size.minCoeff())));
  std::string overlap;
  const auto isBlocked = [&](const Vec2& p) {
    const int blocker = obstacles.blockedBy(p);
    const bool taken = blocker == Obstacles::kFree && placed.isTaken(p);
    if (overlap.empty() && (taken || blocker != Obstacles::kFree))
      overlap = taken ? "an earlier block" : obstacleName(world, blocker);
    return taken || blocker != Obstacles::kFree;
  };
  FillResult fill;
  try {
    fill = fillLattice(*block.shape, dx, isBlocked, std::size_t{1} << 33);
  } catch (const FillError& error) {
    throw SceneError(block.place, block.path + ".shape", error.what());
  }
  if (fill.points.empty())
    throw SceneError(
        block.place, block.path + ".shape",
        "has no free place for a particle" +
            (overlap.empty() ? "" : ": all is taken by " + overlap + (fill.cut > 1 ? " and what else is there" : "")));
  if (fill.cut > 0 && !block.cut)
    throw SceneError(block.place, block.path + ".shape",
                     fmt::format("overlaps {} ({} places), right is cut = true or a smaller shape", overlap, fill.cut));
  if (fill.cut > 0)
    draft.scene.notes.push_back(
        fmt::format("{}: {} particles placed, {} places cut out (bodies, walls and earlier blocks)", block.path,
                    fill.points.size(), fill.cut));
  SeededBlock seeded;
  seeded.velocities = velocitiesAt(block, fill.points);
  seeded.positions = std::move(fill.points);
  seeded.cut = fill.cut;
  if (&block != &draft.fluidBlocks.back()) placed.add(seeded.positions);
  draft.scene.fluidBlocks.push_back(std::move(seeded));
}

void seedBulletBlock(const BlockDraft& block, std::size_t index, const Obstacles& obstacles, Draft& draft) {
  // A stream of its own for each block, apart from those of the emitters, which count from 0.
  constexpr std::uint64_t kBlockStreams = std::uint64_t{1} << 32;
  RandomStream random(draft.scene.world.seed, kBlockStreams + index);
  const auto isBlocked = [&](const Vec2& p) { return obstacles.blockedBy(p) != Obstacles::kFree; };
  SeededBlock seeded;
  try {
    seeded.positions = fillRandom(*block.shape, block.count, random, isBlocked);
  } catch (const FillError& error) {
    throw SceneError(block.place, block.path + ".shape",
                     fmt::format("has no free place for bullets: {}", error.what()));
  }
  seeded.velocities = velocitiesAt(block, seeded.positions);
  draft.scene.bulletBlocks.push_back(std::move(seeded));
}

}  // namespace

void seed(Draft& draft) {
  const WorldDef& world = draft.scene.world;
  if (!draft.fluidBlocks.empty()) {
    const double dx = world.fluid->spacing;
    const Obstacles obstacles(draft, 0.5 * dx, world.fluid->group, world.fluid->collidesWith);
    PlacedPoints placed(0.9 * dx);
    for (const BlockDraft& block : draft.fluidBlocks) seedFluidBlock(block, obstacles, placed, draft);
  }
  if (!draft.bulletBlocks.empty()) {
    const Obstacles obstacles(draft, world.bullet->radius, world.bullet->group, world.bullet->collidesWith);
    for (std::size_t i = 0; i < draft.bulletBlocks.size(); ++i)
      seedBulletBlock(draft.bulletBlocks[i], i, obstacles, draft);
  }
}

}  // namespace froude::scene
