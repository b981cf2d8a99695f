// GridEdge: one directed edge of an outline as the grids keep it, and its distance to a point. Internal.
#pragma once

#include <vector>

#include <froude/base/transform.h>
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
inline double squaredDistance(const GridEdge& edge, const Vec2& p) {
  const Vec2 arm = p - edge.a;
  const double along = edge.direction.dot(arm);
  if (along <= 0.0) return arm.squaredNorm();
  if (along >= edge.length) return (p - edge.b).squaredNorm();
  const double left = cross(edge.direction, arm);
  return left * left;
}

}  // namespace froude::detail
