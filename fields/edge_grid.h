// The engine behind DistanceField and WorldField: directed edges of one or many outlines, and a grid of their nearest ones.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <froude/base/parallel.h>
#include <froude/base/transform.h>
#include <froude/fields/field_sample.h>
#include <froude/fields/polygon.h>

namespace froude::detail {

/// A directed edge, solid on its left. One cache line.
struct alignas(64) GridEdge {
  Vec2 a, b;
  Vec2 direction;         ///< unit, from a to b
  double length;
  std::int32_t previous;  ///< edge that ends where this one starts; −1: the outline begins here
  std::uint32_t source : 31;    ///< which outline it belongs to; edges of a source are contiguous and in order
  std::uint32_t convexStart : 1;  ///< the solid's angle at a is less than 180 degrees
};

/// Appends the edges of `polygon`, placed by `transform`.
void appendEdges(const Polygon& polygon, const Transform* transform, std::uint32_t source, std::vector<GridEdge>* edges);
GridEdge makeEdge(const Vec2& a, const Vec2& b);
/// Fills `convexStart` of edges whose a, b and previous are set.
void markConvex(std::span<GridEdge> edges);

/// Cells over a box. A cell within the band of an outline lists the edges that are closest, of their own outline, to at least
/// one of the cell's points: those no farther than the farthest point of the closest edge. Other cells are wholly outside or
/// wholly inside and keep a clearance. A coarser grid lists all edges within the band, for queries that must not lose any.
class EdgeGrid {
 public:
  /// `cellSize` 0: chosen. `cellLimit`: the cell size is raised until no more cells are needed.
  EdgeGrid(std::vector<GridEdge> edges, const Box& box, double band, double cellSize, std::size_t cellLimit);

  FieldSample sample(const Vec2& p) const;
  FieldSample sampleExact(const Vec2& p) const;
  double lowerBound(const Vec2& p) const;
  void forEachEdgeNear(const Vec2& p, double radius, FunctionRef<void(std::uint32_t)> visit) const;
  /// Over the sources that `accepts` says; exact for |distance| ≤ band.
  FieldSample sampleAccepted(const Vec2& p, FunctionRef<bool(std::uint32_t)> accepts) const;
  /// True if p is inside or on the boundary of the source. Exact. Cost: its edges.
  bool contains(std::uint32_t source, const Vec2& p) const;

  const Vec2& origin() const { return origin_; }
  double cellSize() const { return cell_; }
  double band() const { return band_; }
  int nx() const { return nx_; }
  int ny() const { return ny_; }
  const Box& box() const { return box_; }
  std::span<const float> clearance() const { return clearance_; }
  std::span<const GridEdge> edges() const { return edges_; }
  std::size_t memoryBytes() const;
  /// Largest coordinate [m] of edges and grid, and the distance below which rounding may decide.
  double scale() const { return scale_; }

  /// True if p is in the grid (false for NaN).
  bool inGrid(const Vec2& p) const {
    return p.x() >= box_.min.x() && p.x() <= box_.max.x() && p.y() >= box_.min.y() && p.y() <= box_.max.y();
  }
  /// Cell of a point in the grid.
  std::size_t cellOf(const Vec2& p) const {
    const int i = std::min(static_cast<int>((p.x() - origin_.x()) * inverseCell_), nx_ - 1);
    const int j = std::min(static_cast<int>((p.y() - origin_.y()) * inverseCell_), ny_ - 1);
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  /// Nearest edges of a cell; empty for a cell that is farther than the band from every outline.
  std::span<const std::uint32_t> nearest(std::size_t cell) const {
    const std::uint32_t* list = lists_.data() + listOf_[cell];
    return {list + 1, list[0]};
  }
  /// All edges within the band (and a little more) of any point of the coarse cell around p; p in the grid.
  std::span<const std::uint32_t> within(const Vec2& p) const;
  /// How many cells of the fine grid a coarse cell has along each side.
  int coarseness() const { return coarse_; }

 private:
  friend class EdgeGridBuilder;
  double chooseCell(const Box& box, double wanted, std::size_t limit) const;
  FieldSample closestOf(std::span<const std::uint32_t> list, const Vec2& p) const;
  FieldSample bruteForce(const Vec2& p) const;

  std::vector<GridEdge> edges_;
  std::vector<std::uint32_t> sourceStarts_;  // first edge of each source, and the number of edges
  Box box_;
  Vec2 origin_{0.0, 0.0};
  double cell_ = 0.0;
  double inverseCell_ = 0.0;
  double band_ = 0.0;
  double scale_ = 0.0;
  double rounding_ = 0.0;  // distances closer than this are told apart exactly
  int nx_ = 0;
  int ny_ = 0;
  int coarse_ = 1;
  int coarseNx_ = 0;
  std::vector<std::uint32_t> listOf_;  // per cell: where its list is in lists_ (count, then edges); 0: the empty list
  std::vector<std::uint32_t> lists_;
  std::vector<float> clearance_;
  std::vector<std::uint32_t> coarseListOf_;
  std::vector<std::uint32_t> coarseLists_;
};

}  // namespace froude::detail
