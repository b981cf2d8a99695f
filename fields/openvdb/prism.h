// A polygon as a closed prism along z: the mesh that OpenVDB is given.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <froude/fields/polygon.h>

namespace froude::vdb {

/// Quadrilaterals over shared vertices; a triangle has kNoVertex in the fourth place. Counter-clockwise from outside.
struct QuadMesh {
  static constexpr std::uint32_t kNoVertex = 0xffffffffu;
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 4>> faces;
};

/// Adds the prism |z| ≤ halfHeight over the polygon, scaled: vertex = ((x, y) − origin) / unit. One quadrilateral for
/// each edge; both caps are cut into trapezoids along x by a sweep over the heights of the vertices, which no concave
/// ring and no hole can mislead. Caps have vertices in the middle of edges of walls (to a float's rounding): closed for
/// voxels, not for a solver. Cost: O(n · edges cut by a line along x), some 2n trapezoids a cap, sliced where they are
/// few.
void addPrism(const Polygon& polygon, const Vec2& origin, double unit, double halfHeight, QuadMesh& mesh);

}  // namespace froude::vdb
