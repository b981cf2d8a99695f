#include <froude/fields/distance_field.h>

namespace froude {
namespace {

constexpr double kLeastCells = 2048.0;
constexpr double kMostCells = 1048576.0;
constexpr double kCellsPerEdge = 32.0;

std::vector<detail::GridEdge> edgesOf(const Polygon& polygon) {
  std::vector<detail::GridEdge> edges;
  detail::appendEdges(polygon, nullptr, 0, &edges);
  return edges;
}

detail::GridPlan planFor(const Polygon& polygon, double band, double cellSize) {
  if (!(band > 0.0) || !std::isfinite(band))
    throw Error("the band of a distance field must be positive and finite [m]");
  if (!(cellSize >= 0.0) || !std::isfinite(cellSize))
    throw Error("the cell size must be positive [m], or 0 to choose it");
  detail::GridPlan plan;
  plan.band = band;
  plan.box = polygon.bounds().grown(band * detail::kBandMargin);
  plan.cellSize = cellSize;
  if (cellSize == 0.0) {
    const Vec2 size = plan.box.size();
    const double cells = std::clamp(kCellsPerEdge * polygon.edgeCount(), kLeastCells, kMostCells);
    plan.cellSize = std::sqrt(size.x() * size.y() / cells);
  }
  return plan;
}

}  // namespace

DistanceField::DistanceField(const Polygon& polygon, double band, double cellSize)
    : polygon_(polygon), band_(band), grid_(edgesOf(polygon), planFor(polygon, band, cellSize)) {}

}  // namespace froude
