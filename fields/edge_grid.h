// The engine behind DistanceField and WorldField: directed edges of one or many outlines, and a grid of their nearest
// ones.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/parallel.h>
#include <froude/base/transform.h>
#include <froude/fields/field_sample.h>
#include <froude/fields/polygon.h>

namespace froude::detail {

/// A directed edge, solid on its left. One cache line.
struct alignas(64) GridEdge {
  Vec2 a, b;
  Vec2 direction;                 ///< unit, from a to b
  double length;                  ///< [m]
  std::int32_t previous;          ///< edge that ends where this one starts; −1: the outline begins here
  std::uint32_t source : 30;      ///< which outline it belongs to; edges of a source are contiguous and in order
  std::uint32_t convexStart : 1;  ///< the solid's angle at a is less than 180 degrees
  std::uint32_t convexEnd : 1;    ///< the solid's angle at b is less than 180 degrees

  Vec2 normal() const { return rightNormal(direction); }
};

/// Appends the edges of `polygon`, placed by `transform` if there is one.
void appendEdges(const Polygon& polygon, const Transform* transform, std::uint32_t source,
                 std::vector<GridEdge>* edges);
/// The edge a → b of `source`, which follows edge `previous` of `edges` (−1: none); appended.
void appendEdge(const Vec2& a, const Vec2& b, std::int32_t previous, std::uint32_t source,
                std::vector<GridEdge>* edges);
/// Squared distance of p to the closed edge [m²].
double squaredDistance(const GridEdge& edge, const Vec2& p);

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
/// least one of the cell's points: those no farther than the farthest point of the closest edge. Other cells are wholly
/// outside or wholly inside and keep a clearance. A coarser grid lists all edges within the band, for queries that must
/// not lose any.
class FROUDE_API EdgeGrid {
 public:
  EdgeGrid(std::vector<GridEdge> edges, const GridPlan& plan);

  FieldSample sample(const Vec2& p) const;
  FieldSample sampleExact(const Vec2& p) const;
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
  std::span<const float> clearance() const { return clearance_; }
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
  /// Nearest edges of a cell; empty for a cell that is farther than the band from every outline.
  std::span<const std::uint32_t> nearest(std::size_t cell) const { return list(lists_, listOf_[cell]); }
  double inverseCell() const { return inverseCell_; }
  int coarseness() const { return coarse_; }
  /// All edges within the band of any point of the coarse cell around p; p in the grid.
  std::span<const std::uint32_t> within(const Vec2& p) const {
    const int i = column(p.x()) / coarse_;
    const int j = row(p.y()) / coarse_;
    return list(
        coarseLists_,
        coarseListOf_[static_cast<std::size_t>(j) * static_cast<std::size_t>(coarseNx_) + static_cast<std::size_t>(i)]);
  }

 private:
  friend class EdgeGridBuilder;
  struct Nearest;

  static std::span<const std::uint32_t> list(const std::vector<std::uint32_t>& lists, std::uint32_t at) {
    return {lists.data() + at + 1, lists[at]};
  }
  void layOut(const GridPlan& plan);
  /// True if every point outside the grid is outside everything.
  bool freeOutside() const { return sealed_ && !walls_; }
  bool oneOutline() const { return sourceStarts_.size() == 2; }
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
  float farther_ = 0.0F;  // a clearance above it is that of a cell without edges
  double scale_ = 0.0;
  double rounding_ = 0.0;  // closer than this, signs are decided exactly
  bool sealed_ = true;
  bool walls_ = false;
  int nx_ = 0;
  int ny_ = 0;
  int coarse_ = 1;  // cells along one side of a coarse cell
  int coarseNx_ = 0;
  int coarseNy_ = 0;
  std::vector<std::uint32_t> listOf_;  // per cell: where its list is in lists_ (count, then edges); 0: the empty list
  std::vector<std::uint32_t> lists_;
  std::vector<float> clearance_;
  std::vector<std::uint32_t> coarseListOf_;
  std::vector<std::uint32_t> coarseLists_;
};

}  // namespace froude::detail
