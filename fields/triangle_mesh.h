// A plane mesh: points, triangles and outline.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <froude/base/types.h>

namespace froude {

/// What a deformable body is made of, at rest and in its own frame. A chain has no triangles; its points follow each
/// other along it.
struct TriangleMesh {
  std::vector<Vec2> points;                             // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // corners counter-clockwise
  /// Edges of one triangle each, the triangle to the left (outer outline counter-clockwise, holes clockwise); of a
  /// chain its links in order.
  std::vector<std::array<std::uint32_t, 2>> boundary;
};

}  // namespace froude
