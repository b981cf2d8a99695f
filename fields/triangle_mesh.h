// TriangleMesh: a polygon's solid as triangles of about one size, what a soft body is made of.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/error.h>
#include <froude/fields/polygon.h>

namespace froude {

/// Points and triangles of a solid; the outline's own vertices are among the points.
struct TriangleMesh {
  std::vector<Vec2> points;                             ///< at rest, in the polygon's own frame [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< corners counter-clockwise, numbers of points
  std::vector<std::array<std::uint32_t, 2>> outline;    ///< edges in order round each ring, the solid on their left
};

/// A polygon that cannot be filled with triangles of the spacing that was asked for. `what()` says where and why, and
/// what would be right.
class FROUDE_API MeshError : public Error {
 public:
  MeshError(const Vec2& place, const std::string& message) : Error(message), place_(place) {}
  /// Where the trouble is, in the polygon's own frame [m].
  const Vec2& place() const { return place_; }

 private:
  Vec2 place_;
};

/// The smallest angle of a triangle that a mesh may have [rad]: 10 degrees. Only sharp corners of the outline lead to
/// less than 20.
inline constexpr double kLeastMeshAngle = 10.0 * kPi / 180.0;

/// Fills the solid with points about `spacing` [m] apart, in rows that fit its box, and joins them by a Delaunay
/// triangulation in which every edge of the outline is there, cut into pieces no longer than 1.25 spacings and shorter
/// ones where the outline is fine or comes close to itself. The triangles cover the solid exactly (areas to rounding);
/// no circle through the corners of one holds another point. Points of the outline come first, in its order. Throws
/// MeshError: spacing not above 0 and finite, more than 10⁸ points, an outline closer to itself than a 64th of the
/// spacing, an angle below kLeastMeshAngle. Deterministic. Cost: O(n log n), a few triangulations of all points; 0.6 s
/// for 50,000 points. Source: J. Ruppert, "A Delaunay refinement algorithm for quality 2-dimensional mesh generation",
/// J. Algorithms 18, 1995 (refinement, cuts near sharp corners).
FROUDE_API TriangleMesh triangleMesh(const Polygon& polygon, double spacing);

/// The polygon without detail that triangles of this spacing cannot follow: vertices are left out next to edges shorter
/// than three quarters of a spacing, as long as the outline moves by less than a 16th of it. The polygon itself where
/// nothing can go. Cost: O(edges²) at worst.
FROUDE_API Polygon coarseOutline(const Polygon& polygon, double spacing);

}  // namespace froude
