// The engine behind DistanceField and WorldField: directed edges of one or many outlines, and a grid of their nearest
// ones.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/parallel.h>
#include <froude/fields/cell_code.h>
#include <froude/fields/field_sample.h>
#include <froude/fields/grid_edge.h>

namespace froude::detail {

/// Cells are exact to this multiple of the band, so that a disc as large as the band finds its contact even where its
/// path is known only up to a deviation.
inline constexpr double kBandMargin = 1.125;

/// How a grid is laid out.
struct GridPlan {
  Box box;                           ///< [m]; what lies outside is not in any cell
  double band = 0.0;                 ///< [m]
  double cellSize = 0.0;             ///< [m]
  std::size_t cellLimit = 1u << 22;  ///< the cell size is raised until no more cells are needed
  bool sealed = true;                ///< no polygon reaches out of the box
  bool walls = false;  ///< source 0 is the walls of a domain: solid wherever on the left of any of its edges
};

/// Cells over a box. A cell within the band of an outline lists the edges that are closest, of their own outline, to at
/// least one of the cell's points; where these are many the cell is divided once more, and each part has its own list.
/// Other cells are wholly outside or wholly inside and keep a clearance. A coarser grid lists all edges within the
/// band, for queries that must not lose any.
class FROUDE_API EdgeGrid {
 public:
  EdgeGrid(std::vector<GridEdge> edges, const GridPlan& plan);

  FieldSample sample(const Vec2& p) const;
  FieldSample sampleExact(const Vec2& p) const;
  /// The distance of `sample` alone, to rounding, or a bound of it: for many a sweep that is all there is to know.
  /// `exact` as in FieldSample.
  double distance(const Vec2& p, bool* exact) const;
  /// Over the sources that `accepts` says; exact for |distance| ≤ band.
  FieldSample sampleAccepted(const Vec2& p, FunctionRef<bool(std::uint32_t)> accepts) const;
  double lowerBound(const Vec2& p) const;
  void forEachEdgeNear(const Vec2& p, double radius, FunctionRef<void(std::uint32_t)> visit) const;
  /// True if p is inside or on the boundary of the source. Exact for closed outlines. Cost: its edges.
  bool contains(std::uint32_t source, const Vec2& p) const;

  const Vec2& origin() const { return box_.min; }
  double cellSize() const { return cell_; }
  double band() const { return band_; }
  int nx() const { return nx_; }
  int ny() const { return ny_; }
  const Box& box() const { return box_; }
  std::span<const float> clearance() const { return {clearance_.data(), cellCount()}; }
  std::size_t cellCount() const { return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_); }
  std::span<const GridEdge> edges() const { return edges_; }
  /// Edge that starts where edge i ends; −1: the outline ends there.
  std::int32_t next(std::uint32_t i) const { return next_[i]; }
  /// Box of all edges.
  const Box& outlines() const { return outlines_; }
  std::size_t memoryBytes() const;
  /// Largest coordinate of edges and grid [m].
  double scale() const { return scale_; }

  /// True if p is in the grid (false for NaN).
  bool inGrid(const Vec2& p) const { return box_.contains(p); }
  int column(double x) const { return std::clamp(static_cast<int>((x - box_.min.x()) * inverseCell_), 0, nx_ - 1); }
  int row(double y) const { return std::clamp(static_cast<int>((y - box_.min.y()) * inverseCell_), 0, ny_ - 1); }
  /// Cell of a point in the grid.
  std::size_t cellOf(const Vec2& p) const {
    return static_cast<std::size_t>(row(p.y())) * static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(column(p.x()));
  }
  /// Edges that can be nearest in a cell; empty for a cell that is farther than the band from every outline.
  std::span<const std::uint32_t> nearest(std::size_t cell) const { return list(codeOfWhole(codes_[cell])); }
  /// Edges that can be nearest at p, which is in the grid: those of its cell, or of the part of the cell.
  std::span<const std::uint32_t> nearestAt(const Vec2& p) const {
    const double x = (p.x() - box_.min.x()) * inverseCell_;
    const double y = (p.y() - box_.min.y()) * inverseCell_;
    const int i = std::clamp(static_cast<int>(x), 0, nx_ - 1);
    const int j = std::clamp(static_cast<int>(y), 0, ny_ - 1);
    const CellCode code =
        codes_[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i)];
    return list(isDivided(code) ? partCodes_[partIndex(code, x - i, y - j)] : code);
  }
  double inverseCellSize() const { return inverseCell_; }
  int coarseness() const { return coarse_; }
  /// All edges within the band of any point of the coarse cell around p; p in the grid.
  std::span<const std::uint32_t> within(const Vec2& p) const {
    const int i = column(p.x()) / coarse_;
    const int j = row(p.y()) / coarse_;
    const std::uint32_t at =
        coarseListOf_[static_cast<std::size_t>(j) * static_cast<std::size_t>(coarseNx_) + static_cast<std::size_t>(i)];
    return {coarseLists_.data() + at + 1, coarseLists_[at]};
  }

  /// The arrays, raw, for loops over lanes; behind the last cell there is one more, which is empty,
  /// and behind the last entry of the lists as well.
  std::span<const CellCode> codes() const { return codes_; }
  std::span<const CellCode> partCodes() const { return partCodes_; }
  std::span<const std::uint32_t> lists() const { return lists_; }
  /// Closer than this to a feature, signs are decided exactly [m].
  double rounding() const { return rounding_; }
  /// True if every point outside the grid is outside everything.
  bool freeOutside() const { return sealed_ && !walls_; }
  /// True if all edges belong to one outline.
  bool oneOutline() const { return sourceStarts_.size() == 2; }

 private:
  friend class EdgeGridBuilder;
  friend class EdgeSieve;
  struct Nearest;

  /// Code of the list of a whole cell, divided or not.
  CellCode codeOfWhole(CellCode code) const { return isDivided(code) ? partCodes_[firstPart(code) - 1] : code; }
  std::span<const std::uint32_t> list(CellCode code) const {
    const std::uint32_t* at = lists_.data() + listOffset(code);
    if (const std::uint32_t count = listCount(code); count > 0) return {at, count};
    return {at + 1, *at};
  }
  void layOut(const GridPlan& plan);
  FieldSample bound(const Vec2& p, double clearance) const;
  FieldSample searchRings(const Vec2& p, double clearance) const;
  FieldSample makeSample(const Vec2& p, std::uint32_t edge, bool inside) const;

  std::vector<GridEdge> edges_;
  std::vector<std::int32_t> next_;
  std::vector<std::uint32_t> sourceStarts_;  // first edge of each source, and the number of edges
  Box box_;
  Box outlines_;  // box of all edges
  double cell_ = 0.0;
  double inverseCell_ = 0.0;
  double band_ = 0.0;
  double scale_ = 0.0;
  double rounding_ = 0.0;  // closer than this, signs are decided exactly
  bool sealed_ = true;
  bool walls_ = false;
  int nx_ = 0;
  int ny_ = 0;
  int coarse_ = 1;  // cells along one side of a coarse cell
  int coarseNx_ = 0;
  int coarseNy_ = 0;
  std::vector<CellCode> codes_;       // per cell
  std::vector<CellCode> partCodes_;   // of divided cells: the code of the whole, then those of its parts
  std::vector<std::uint32_t> lists_;  // edges of all lists, one after the other; see cell_code.h
  std::vector<float> clearance_;
  std::vector<std::uint32_t> coarseListOf_;
  std::vector<std::uint32_t> coarseLists_;
};

}  // namespace froude::detail
