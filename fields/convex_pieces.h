// Convex pieces of a polygon that need not be convex: few, without slivers where that can be, and without new vertices.
#pragma once

#include <vector>

#include <froude/base/api.h>
#include <froude/fields/polygon.h>

namespace froude {

/// Vertices counter-clockwise; edge k runs from vertex k to the next. No angle is above 180 degrees, decided exactly;
/// an angle of exactly 180 degrees occurs where two edges that are to be told apart lie on one line, such as an edge of
/// the outline and a cut.
struct ConvexPiece {
  std::vector<std::uint32_t> vertex;      ///< numbers of its vertices in the polygon
  std::vector<std::int32_t> outlineEdge;  ///< of each edge: the polygon's edge that it is; −1: a cut, inside the solid

  std::size_t size() const { return vertex.size(); }
  std::vector<Vec2> points(const Polygon& polygon) const;
};

/// Pieces that cover the solid without overlap; their areas add up to the polygon's. Each edge of the polygon is an
/// edge of exactly one piece, each cut one of exactly two. With r reflex vertices and h holes there are at most 2r + 1
/// − h pieces; without holes that is at most four times the least number that any method can reach, which is at least
/// ⌈r/2⌉ + 1. A convex polygon is one piece. Deterministic. Cost: near O(n log n) for shapes as people draw them, O(n²)
/// at worst. Source: S. Hertel and K. Mehlhorn, "Fast triangulation of simple polygons", FCT 1983, on a constrained
/// Delaunay triangulation, the sharpest angle removed first.
FROUDE_API std::vector<ConvexPiece> convexPieces(const Polygon& polygon);

}  // namespace froude
