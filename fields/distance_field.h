// DistanceField: the signed distance to one polygon, precomputed in cells and exact within a band around the boundary.
#pragma once

#include <froude/base/api.h>
#include <froude/base/parallel.h>
#include <froude/fields/edge_grid.h>
#include <froude/fields/field_sample.h>
#include <froude/fields/polygon.h>

namespace froude {

/// What one cell knows.
struct FieldCell {
  enum class Kind : std::uint8_t { Outside, Inside, Near };
  Kind kind = Kind::Outside;  ///< Near: the cell keeps edges
  std::uint32_t edges = 0;    ///< how many; 0 unless Near
  float clearance = 0.0F;     ///< no point of the cell is nearer to the boundary; negative inside [m]
};

/// A grid over the polygon's box grown by the band; a cell near the boundary keeps the edges that are closest to at
/// least one of its points, any other cell a conservative distance. All points are in the polygon's own frame [m].
/// Immutable; queries allocate nothing and may run on any number of threads.
class FROUDE_API DistanceField {
 public:
  /// `band` [m]: how far from the boundary, on both sides, `sample` is exact: at least the largest disc's radius or
  /// support radius. `cellSize` [m]: 0 chooses it by the polygon's size and number of edges. Throws Error unless band >
  /// 0 and finite. Cost: O(cells near the boundary).
  DistanceField(const Polygon& polygon, double band, double cellSize = 0.0);

  /// Exact for |distance| ≤ band, else a bound. Exactly on the boundary the distance is 0 (at points that are within
  /// rounding of a second edge: 0 to rounding) and the normal still a unit vector.
  FieldSample sample(const Vec2& local) const { return grid_.sample(local); }
  /// Exact everywhere. Cost far from the boundary: a search over rings of cells.
  FieldSample sampleExact(const Vec2& local) const { return grid_.sampleExact(local); }
  /// Never exceeds the signed distance of an outside point; not positive at inside points. Cost: one look-up.
  double lowerBound(const Vec2& local) const { return grid_.lowerBound(local); }
  /// Every edge within `radius` ≤ band of p, once, in increasing order of its number.
  void forEachEdgeNear(const Vec2& p, double radius, FunctionRef<void(std::uint32_t)> visit) const {
    grid_.forEachEdgeNear(p, radius, visit);
  }

  const Polygon& polygon() const { return polygon_; }
  double band() const { return band_; }
  double cellSize() const { return grid_.cellSize(); }
  std::size_t memoryBytes() const { return sizeof *this + grid_.memoryBytes(); }
  /// The cells, for swept queries.
  const detail::EdgeGrid& grid() const { return grid_; }

  /// Cell in column i < nx() and row j < ny(), counted from `gridOrigin`.
  FieldCell cell(int i, int j) const {
    const std::size_t at =
        static_cast<std::size_t>(j) * static_cast<std::size_t>(grid_.nx()) + static_cast<std::size_t>(i);
    const auto edges = static_cast<std::uint32_t>(grid_.nearest(at).size());
    const float clearance = grid_.clearance()[at];
    if (edges > 0) return {FieldCell::Kind::Near, edges, clearance};
    return {clearance < 0.0F ? FieldCell::Kind::Inside : FieldCell::Kind::Outside, 0, clearance};
  }
  int nx() const { return grid_.nx(); }
  int ny() const { return grid_.ny(); }
  /// Lower left corner of cell (0, 0) [m].
  const Vec2& gridOrigin() const { return grid_.origin(); }

 private:
  Polygon polygon_;
  double band_;
  detail::EdgeGrid grid_;
};

}  // namespace froude
