#include <froude/fields/world_field.h>

#include <froude/base/assert.h>
#include <froude/fields/sweep_static.h>

namespace froude {
namespace {

constexpr double kCellsPerEdge = 16.0;
constexpr std::size_t kMostCells = 1u << 22;
/// Walls go on this many times the domain's size past an open side: nothing that is still simulated gets round their
/// end.
constexpr double kWallOverhang = 8.0;

struct Outlines {
  std::vector<detail::GridEdge> edges;
  bool walls = false;
  Box box;
  bool sealed = true;
};

/// The solid lies beyond each closed side, so the walls run clockwise: up the left side, along the top, down the right.
void appendWalls(const DomainWalls& walls, std::vector<detail::GridEdge>* edges) {
  const Vec2& low = walls.box.min;
  const Vec2& high = walls.box.max;
  const std::array<Vec2, 4> corners{low, Vec2(low.x(), high.y()), high, Vec2(high.x(), low.y())};
  constexpr std::array<std::size_t, 4> kSide{0, 3, 1, 2};  // left, top, right, bottom in DomainWalls::closed
  const double overhang = kWallOverhang * walls.box.size().maxCoeff();
  std::array<std::int32_t, 4> numbers{};
  std::int32_t count = 0;
  for (std::size_t k = 0; k < 4; ++k) numbers[k] = walls.closed[kSide[k]] ? count++ : -1;
  for (std::size_t k = 0; k < 4; ++k) {
    if (numbers[k] < 0) continue;
    Vec2 a = corners[k];
    Vec2 b = corners[(k + 1) % 4];
    const Vec2 along = (b - a).normalized();
    const std::int32_t previous = numbers[(k + 3) % 4];
    if (previous < 0) a -= overhang * along;
    if (numbers[(k + 1) % 4] < 0) b += overhang * along;
    detail::appendEdge(a, b, previous, 0, edges);
  }
}

detail::GridPlan planFor(const Outlines& outlines, double band, double cellSize) {
  if (!(cellSize >= 0.0) || !std::isfinite(cellSize))
    throw Error("the cell size must be positive [m], or 0 to choose it");
  detail::GridPlan plan;
  plan.box = outlines.box;
  plan.band = band;
  plan.sealed = outlines.sealed;
  plan.walls = outlines.walls;
  plan.cellLimit = kMostCells;
  plan.cellSize = cellSize;
  if (cellSize == 0.0) {
    const Vec2 size = plan.box.size();
    const double perEdge = kCellsPerEdge * static_cast<double>(outlines.edges.size() + 16);
    plan.cellSize = std::min(0.5 * band, std::sqrt(size.x() * size.y() / perEdge));
  }
  return plan;
}

Outlines collect(std::span<const PlacedPolygon> polygons, const DomainWalls& walls, double band) {
  if (!(band > 0.0) || !std::isfinite(band)) throw Error("the band of a world field must be positive and finite [m]");
  Outlines outlines;
  const bool domain = !walls.box.empty();
  if (domain) {
    if (!walls.box.min.allFinite() || !walls.box.max.allFinite()) throw Error("the box of a domain must be finite");
    appendWalls(walls, &outlines.edges);
  }
  outlines.walls = !outlines.edges.empty();
  std::uint32_t source = outlines.walls ? 1 : 0;
  const std::size_t wallEdges = outlines.edges.size();
  for (const PlacedPolygon& placed : polygons) {
    detail::appendEdges(*placed.polygon, &placed.transform, source++, &outlines.edges);
  }
  Box solids;
  for (std::size_t i = wallEdges; i < outlines.edges.size(); ++i) solids.include(outlines.edges[i].a);
  if (!domain && solids.empty()) solids.include(Vec2(0.0, 0.0));
  outlines.box = (domain ? walls.box : solids).grown(band * detail::kBandMargin);
  const Box& box = outlines.box;
  outlines.sealed = solids.empty() || (box.contains(solids.min) && box.contains(solids.max));
  return outlines;
}

detail::EdgeGrid gridOf(std::span<const PlacedPolygon> polygons, const DomainWalls& walls, double band,
                        double cellSize) {
  Outlines outlines = collect(polygons, walls, band);
  const detail::GridPlan plan = planFor(outlines, band, cellSize);
  return detail::EdgeGrid(std::move(outlines.edges), plan);
}

}  // namespace

WorldField::WorldField(std::span<const PlacedPolygon> polygons, const DomainWalls& walls, double band, double cellSize)
    : band_(band), grid_(gridOf(polygons, walls, band, cellSize)) {
  const std::span<const detail::GridEdge> edges = grid_.edges();
  const bool anyWall = !walls.box.empty() && (walls.closed[0] || walls.closed[1] || walls.closed[2] || walls.closed[3]);
  if (anyWall) sources_.push_back({-1, ~0u, ~0u});
  for (const PlacedPolygon& placed : polygons) sources_.push_back({placed.body, placed.group, placed.collidesWith});
  for (const PlacedPolygon& placed : polygons) {
    const bool known = std::any_of(filters_.begin(), filters_.end(), [&](const CollisionFilter& f) {
      return f.group == placed.group && f.collidesWith == placed.collidesWith;
    });
    if (!known) filters_.push_back({placed.group, placed.collidesWith});
  }
  edges_.reserve(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    edges_.push_back({edges[i].a, edges[i].b, edges[i].normal(), sources_[edges[i].source].body, i});
  }
}

WorldSample WorldField::sample(const Vec2& p) const { return withBody(grid_.sample(p)); }

WorldSample WorldField::sampleExact(const Vec2& p) const { return withBody(grid_.sampleExact(p)); }

WorldSample WorldField::sample(const Vec2& p, const CollisionFilter& filter) const {
  if (acceptsAll(filter)) return sample(p);
  return withBody(grid_.sampleAccepted(p, [&](std::uint32_t source) { return accepts(filter, source); }));
}

void WorldField::forEachEdgeNear(const Vec2& p, double radius, FunctionRef<void(const FieldEdge&)> visit) const {
  grid_.forEachEdgeNear(p, radius, [&](std::uint32_t i) { visit(edges_[i]); });
}

SweepHit WorldField::sweepDisc(const Vec2& from, const Vec2& to, double radius, const CollisionFilter& filter) const {
  FROUDE_ASSERT(radius >= 0.0 && radius <= band_);
  if (!detail::finitePath(from, to)) return {};
  SweepHit hit;
  if (acceptsAll(filter)) {
    hit = detail::sweepStill(grid_, from, to, radius,
                             detail::startOf(grid_, from, detail::freeDistance(grid_, from, to, radius)), nullptr);
  } else {
    const auto accepted = [&](std::uint32_t source) { return accepts(filter, source); };
    const detail::SourceFilter sources(accepted);
    hit = detail::sweepStill(grid_, from, to, radius, grid_.sampleAccepted(from, sources), &sources);
  }
  if (hit.hit) hit.body = edges_[static_cast<std::size_t>(hit.edge)].body;
  return hit;
}

std::size_t WorldField::memoryBytes() const {
  return sizeof *this + grid_.memoryBytes() + edges_.capacity() * sizeof(FieldEdge) +
         sources_.capacity() * sizeof(Source);
}

bool WorldField::accepts(const CollisionFilter& filter, std::uint32_t source) const {
  const Source& s = sources_[source];
  return s.body < 0 || filter.accepts(s.group, s.collidesWith);
}

bool WorldField::acceptsAll(const CollisionFilter& filter) const {
  return std::all_of(filters_.begin(), filters_.end(),
                     [&](const CollisionFilter& f) { return filter.accepts(f.group, f.collidesWith); });
}

WorldSample WorldField::withBody(const FieldSample& sample) const {
  WorldSample result;
  static_cast<FieldSample&>(result) = sample;
  if (sample.edge >= 0) result.body = edges_[static_cast<std::size_t>(sample.edge)].body;
  return result;
}

}  // namespace froude
