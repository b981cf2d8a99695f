// A point of a soft body's material: what of the body's points it moves with.
#pragma once

#include <array>

#include <froude/fields/triangle_mesh.h>

namespace froude::scene {

/// Found in the mesh at rest: within a triangle, or on a rope's link. Cost of finding: O(triangles).
struct MaterialPoint {
  std::array<std::uint32_t, 3> corner{0, 0, 0};  ///< numbers of mesh points; a rope's link has two
  std::array<double, 3> weight{0, 0, 0};         ///< from 0 to 1, their sum is 1
  Vec2 nearest{0, 0};                            ///< of the body to the place that was asked for [m]
  double distance = 0.0;                         ///< between the two [m]; 0 within the body

  MaterialPoint() = default;
  MaterialPoint(const TriangleMesh& mesh, const Vec2& place);
  /// Where it is when the mesh's points are at `positions(number)`.
  template <typename Positions>
  Vec2 at(Positions&& positions) const {
    return weight[0] * positions(corner[0]) + weight[1] * positions(corner[1]) + weight[2] * positions(corner[2]);
  }
};

}  // namespace froude::scene
