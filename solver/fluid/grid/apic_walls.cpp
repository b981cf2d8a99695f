// What the grid model has to do with polygons and walls: cut cells, faces behind walls, paths, and what is booked.
#include <algorithm>
#include <array>

#include <froude/base/parallel.h>
#include <froude/solver/coupling/leak_check.h>
#include <froude/solver/fluid/grid/apic.h>

namespace froude {
namespace {

constexpr std::size_t kCells = TileGrid::kCells;
constexpr std::size_t kTileBlock = 4;  // tiles a task

}  // namespace

void Apic::cutCells(const StepContext& context) {
  const Obstacles& obstacles = context.obstacles;
  if (fixedVersion_ != obstacles.fixedVersion()) {
    outlines_.clear();
    obstacles.outlines(false, filter(), outlines_);
    CutWalls walls{domain_.box, domain_.closed};
    if (domain_.periodicX) walls.closed[0] = walls.closed[1] = false;
    if (domain_.periodicY) walls.closed[2] = walls.closed[3] = false;
    cuts_.setFixed(grid_, outlines_, walls);
    for (const CutOutline& o : outlines_) {
      const auto body = static_cast<std::size_t>(o.body);
      if (centers_.size() <= body) centers_.resize(body + 1, Vec2(0.0, 0.0));
      centers_[body] = o.center;
    }
    fixedVersion_ = obstacles.fixedVersion();
  }
  outlines_.clear();
  obstacles.outlines(true, filter(), outlines_);
  for (const CutOutline& o : outlines_) {
    const auto body = static_cast<std::size_t>(o.body);
    if (centers_.size() <= body) centers_.resize(body + 1, Vec2(0.0, 0.0));
    centers_[body] = o.center;
  }
  const TileGrid& tiles = particles_.tiles();
  std::array<std::int32_t, 4> range{INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (std::size_t t = 1; t <= tiles.size(); ++t) {
    const TileIndex at = tiles.tile(t).at;
    range[0] = std::min(range[0], at.x * kTileSide);
    range[1] = std::min(range[1], at.y * kTileSide);
    range[2] = std::max(range[2], at.x * kTileSide + kTileSide - 1);
    range[3] = std::max(range[3], at.y * kTileSide + kTileSide - 1);
  }
  cuts_.update(range, outlines_);
}

// Friction holds at the wall what slides: behind it the slip of the next face before it goes on, with the other sign.
float Apic::heldBySticking(const FaceComponent& c, std::size_t place, int axis, const Obstacles::Distance& wall,
                           const Vec2& surface, float without) const {
  const int towards = std::abs(wall.normal.x()) > std::abs(wall.normal.y()) ? 0 : 1;
  const int step = wall.normal[towards] > 0.0 ? 1 : -1;
  const auto [i, j] = particles_.tiles().cell(place);
  const std::size_t before = particles_.tiles().place(i + (towards == 0 ? step : 0), j + (towards == 1 ? step : 0));
  const double depth = std::max(0.0, -wall.distance) / grid_.size;
  const double height = std::abs(wall.normal[towards]) - depth;
  const bool reaches = c.open[before] > 0.0f && c.known[before] > 0.0f && height > 0.0;
  const double share = reaches && depth < height ? depth / height : 1.0;
  const double along = 1.0 - wall.normal[axis] * wall.normal[axis];
  const double fluid = static_cast<double>(reaches ? c.value[before] : c.value[place]);
  return without - static_cast<float>(along * (static_cast<double>(c.value[place]) - surface[axis]) +
                                      share * along * (fluid - surface[axis]));
}

// Deep behind a side of the domain nothing else matters, and a query would go through all polygons.
Obstacles::Distance Apic::wallBehind(const Obstacles& obstacles, const Vec2& at) const {
  const Box& box = domain_.box;
  const std::array<double, 4> depth{box.min.x() - at.x(), at.x() - box.max.x(), box.min.y() - at.y(),
                                    at.y() - box.max.y()};
  const std::array<Vec2, 4> inwards{Vec2(1.0, 0.0), Vec2(-1.0, 0.0), Vec2(0.0, 1.0), Vec2(0.0, -1.0)};
  const auto deepest = static_cast<std::size_t>(std::max_element(depth.begin(), depth.end()) - depth.begin());
  const std::size_t across = deepest < 2 ? 2 : 0;
  const bool corner = depth[across] > 0.0 || depth[across + 1] > 0.0;
  if (!domain_.closed[deepest] || corner || depth[deepest] < 2.0 * grid_.size) return obstacles.distance(at, filter());
  return {-depth[deepest], inwards[deepest], -1};
}

// What is behind a wall goes along it: its velocity loses the normal part that is not the wall's.
void Apic::holdWalls(const StepContext& context) {
  const TileGrid& tiles = particles_.tiles();
  auto hold = [&](FaceComponent& c, const FaceComponent& other, int axis, AlignedArray<float>& held) {
    tiles.fit(held);
    parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin + 1; t <= end; ++t) {
        TileHalo value, known;
        bool loaded = false;
        for (std::int32_t k = 0; k < static_cast<std::int32_t>(kCells); ++k) {
          const std::size_t place = t * kCells + static_cast<std::size_t>(k);
          held[place] = c.value[place];
          if (c.open[place] > 0.0f || c.known[place] == 0.0f) continue;
          const auto [i, j] = tiles.cell(place);
          const Vec2 at = grid_.origin + grid_.size * (axis == 0 ? Vec2(i, j + 0.5) : Vec2(i + 0.5, j));
          const Obstacles::Distance wall = wallBehind(context.obstacles, at);
          if (!(wall.distance < kInfinity)) continue;
          if (!loaded) {
            tiles.loadHalo(other.value.data(), t, value);
            tiles.loadHalo(other.known.data(), t, known);
            loaded = true;
          }
          const std::int32_t column = k % kTileSide, row = k / kTileSide;
          float sum = 0.0f, count = 0.0f;
          for (const std::int32_t a : {0, 1}) {
            for (const std::int32_t d : {0, 1}) {
              const std::int32_t ci = axis == 0 ? column - a : column + a, rj = axis == 0 ? row + d : row - d;
              sum += value.value(ci, rj);
              count += known.value(ci, rj);
            }
          }
          Vec2 v(0.0, 0.0);
          v[axis] = static_cast<double>(c.value[place]);
          v[1 - axis] = count > 0.0f ? static_cast<double>(sum / count) : 0.0;
          const Vec2 surface = context.obstacles.surfaceVelocityAt(wall.body, at, wall.normal);
          held[place] = static_cast<float>(v[axis] - wall.normal[axis] * (v - surface).dot(wall.normal));
          if (rubbed_ && context.obstacles.sticks(wall.body)) {
            held[place] = heldBySticking(c, place, axis, wall, surface, held[place]);
          }
        }
      }
    });
  };
  hold(faces_.x, faces_.y, 0, heldX_);
  hold(faces_.y, faces_.x, 1, heldY_);
  std::copy_n(heldX_.data(), tiles.values(), faces_.x.value.data());
  std::copy_n(heldY_.data(), tiles.values(), faces_.y.value.data());
}

void Apic::meetWalls(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const DiscContact point{0.0, 0.0, 0.0, filter(), true};
  const double dt = context.dt, size = grid_.size;
  contacts_.begin(pool.size());
  crushed_.assign(blockCount(pool.size()), 0);
  if (leaks_.size() < crushed_.size()) leaks_.resize(crushed_.size());
  for (std::vector<ParticleLeak>& block : leaks_) block.clear();
  auto travel = [&](std::size_t k) {
    const auto dx = static_cast<double>(dx_[k]), dy = static_cast<double>(dy_[k]);
    return size * std::sqrt(dx * dx + dy * dy);
  };
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    forEachWithin(context.obstacles, x, y, begin, end, travel, [&](std::size_t k) {
      const Vec2 at(x[k], y[k]), way = size * Vec2(static_cast<double>(dx_[k]), static_cast<double>(dy_[k]));
      // What is free around its start, and around its end: most go along a wall, not into it.
      const double length = way.norm(), free = context.obstacles.clearance(at);
      if (free > length) return;
      if (free > 0.0 && domain_.box.contains(at + way) && free + context.obstacles.clearance(at + way) > length) return;
      PathResult path;
      followPath(context.obstacles, at, way / dt, dt, point, path);
      if (path.contacts > 0) {
        const Vec2 v(vx[k], vy[k]), after = alongWalls(v, path);
        const Vec2 to = path.x;
        path.x = at + dt * after;
        contacts_.addMean(k, path, at, v, dt);
        path.x = to;
        vx[k] = after.x();
        vy[k] = after.y();
        dx_[k] = static_cast<float>((to.x() - at.x()) / size);
        dy_[k] = static_cast<float>((to.y() - at.y()) / size);
      }
      if (const PathLeak leak = checkPath(context.obstacles, at, path.x, point, path); leak.leaked) {
        const auto particle = static_cast<std::uint32_t>(k);
        if (path.crushed) {
          ++crushed_[begin / kBlockSize];
        } else {
          leaks_[begin / kBlockSize].push_back({particle, at, path.x, leak.inside, leak.body, leak.at});
        }
        pool.kill(particle);
      }
      x[k] = path.x.x();
      y[k] = path.x.y();
      dx_[k] = dy_[k] = 0.0f;
    });
    for (std::size_t k = begin; k < end; ++k) {
      x[k] += size * static_cast<double>(dx_[k]);
      y[k] += size * static_cast<double>(dy_[k]);
    }
  });
  stats.wallHits += contacts_.size();
  for (const std::uint32_t n : crushed_) stats.crushed += n;
  for (const std::vector<ParticleLeak>& block : leaks_) {
    stats.leaks += block.size();
    if (context.leaks == nullptr) continue;
    for (const ParticleLeak& leak : block) context.leaks->add(leak);
  }
  contacts_.book(particleMass(), impulses);
}

// Beside the walls' pressure there is a rest, since the faces' weights are those of the particles where the pressure
// takes the fluid's rest density: it goes to the domain's books.
void Apic::bookWalls(const StepContext& context, const Vec2& gained, ImpulseLedger& impulses) {
  Vec2 rest = -gained;
  solver_.forEachWall(def_.density, [&](const CutWall& wall, const Vec2& impulse, const Vec2& at, std::size_t) {
    impulses.add(wall.body, at, impulse, context.obstacles.velocityAt(wall.body, at));
    rest -= impulse;
  });
  if (rubbed_) viscosity_.book(impulses, rest);
  impulses.add(-1, domain_.box.center(), rest, Vec2(0.0, 0.0));
}

}  // namespace froude
