// The search for the closest feature with a sign that is right where rounding would decide. Internal to EdgeGrid.
#pragma once

#include <froude/fields/edge_grid.h>
#include <froude/fields/predicates.h>

namespace froude::detail {

/// The closest feature so far, kept apart by what it says about the point: inside or outside. In exact arithmetic the
/// nearer one is right; where rounding cannot tell which is nearer, the point is located exactly.
struct EdgeGrid::Nearest {
  const EdgeGrid& grid;
  const Vec2& p;
  double inside = kInfinity;  // squared distances within the current source
  double outside = kInfinity;
  std::uint32_t insideEdge = 0;
  std::uint32_t outsideEdge = 0;
  double best = kInfinity;  // signed square of the distance, least over the sources so far
  std::uint32_t bestEdge = 0;
  bool any = false;
  double limit = kInfinity;  // squared distance beyond which a source is not known well enough to count

  /// A vertex belongs to the edge that starts there; the part of the plane beyond an edge's end is its successor's
  /// business.
  void consider(std::uint32_t index) {
    const GridEdge& e = grid.edges_[index];
    const Vec2 arm = p - e.a;
    const double along = e.direction.dot(arm);
    if (along > e.length) return;
    const double left = cross(e.direction, arm);
    const bool vertex = along < 0.0;
    const double square = vertex ? arm.squaredNorm() : left * left;
    if (vertex ? e.convexStart == 0 : left > 0.0) {
      if (square < inside) inside = square, insideEdge = index;
    } else {
      if (square < outside) outside = square, outsideEdge = index;
    }
  }

  void closeSource(std::uint32_t source) {
    const double nearer = std::min(inside, outside);
    if (nearer == kInfinity) return;
    if (nearer > limit) {
      inside = outside = kInfinity;
      return;
    }
    const double rounding = grid.rounding_;
    const double gap = inside - outside;
    const double doubt = rounding * rounding * std::max(nearer, rounding * rounding);
    bool isInside = gap < 0.0;
    bool byInside = isInside;  // which of the two features answers
    if (gap * gap <= 4.0 * doubt) {
      isInside = byInside = grid.contains(source, p);
      // A point of the boundary counts as inside, but lies on a feature that may say otherwise.
      if (isInside && outside < inside && onSegment(grid.edges_[outsideEdge].a, grid.edges_[outsideEdge].b, p))
        byInside = false;
    } else if (nearer <= rounding * rounding) {
      isInside = onTheSpot(isInside ? insideEdge : outsideEdge, source);
    }
    const double square = byInside ? inside : outside;
    const double value = isInside ? -square : square;
    const std::uint32_t edge = byInside ? insideEdge : outsideEdge;
    if (!any || value < best) best = value, bestEdge = edge;
    any = true;
    inside = outside = kInfinity;
  }

  /// Sign within rounding of an edge: exactly that edge's, unless another one is as near as rounding can tell (a
  /// corner, a slit, a sliver).
  bool onTheSpot(std::uint32_t index, std::uint32_t source) const {
    const GridEdge& e = grid.edges_[index];
    if (e.direction.dot(p - e.a) < 0.0 || !grid.inGrid(p)) return grid.contains(source, p);
    const double reach = 4.0 * grid.rounding_ * grid.rounding_;
    for (const std::uint32_t i : grid.within(p)) {
      const bool other = i != index && i >= grid.sourceStarts_[source] && i < grid.sourceStarts_[source + 1];
      if (other && squaredDistance(grid.edges_[i], p) <= reach) return grid.contains(source, p);
    }
    return orientation(e.a, e.b, p) >= 0;
  }
};

}  // namespace froude::detail
