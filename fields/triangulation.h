// Constrained Delaunay triangulation of the inside of a polygon, without new vertices. Internal.
#pragma once

#include <array>
#include <vector>

#include <froude/fields/polygon.h>

namespace froude::detail {

/// Corners counter-clockwise, as numbers of the polygon's vertices.
using TriangleCorners = std::array<std::uint32_t, 3>;

/// Covers the solid exactly; every edge of the polygon is an edge of one triangle. Signs of areas are exact, the
/// Delaunay condition holds where rounding leaves no doubt about it. Deterministic. Cost: near O(n log n) for shapes as
/// people draw them, O(n²) at worst. Source: C. L. Lawson, "Software for C1 surface interpolation", 1977 (flips);
/// S. W. Sloan, "A fast algorithm for generating constrained Delaunay triangulations", Computers & Structures 47, 1993.
std::vector<TriangleCorners> triangulate(const Polygon& polygon);

}  // namespace froude::detail
