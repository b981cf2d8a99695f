// TriangleMesh: a polygon's solid as triangles of about one size, what a soft body is made of.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <froude/base/types.h>

namespace froude {

/// Points and triangles of a solid; the outline's own vertices are among the points.
struct TriangleMesh {
  std::vector<Vec2> points;                             ///< at rest, in the polygon's own frame [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< corners counter-clockwise, numbers of points
  std::vector<std::array<std::uint32_t, 2>> outline;    ///< edges in order round each ring, the solid on their left
};

}  // namespace froude
