// Delaunay triangulation of points in the plane. Internal.
#pragma once

#include <span>
#include <vector>

#include <froude/fields/triangulation.h>

namespace froude::detail {

/// A square lattice of 2³⁰ steps over the longer side of the points' box.
class PointLattice {
 public:
  struct Node {
    std::int32_t x, y;
    friend bool operator==(const Node&, const Node&) = default;
    friend auto operator<=>(const Node&, const Node&) = default;
  };
  explicit PointLattice(const Box& box);
  Node snap(const Vec2& p) const {
    return {static_cast<std::int32_t>(std::lround((p.x() - center_.x()) * scale_)),
            static_cast<std::int32_t>(std::lround((p.y() - center_.y()) * scale_))};
  }

 private:
  Vec2 center_;
  double scale_;  // [1/m]
};

/// Triangles of the convex hull, corners counter-clockwise. Points on the lattice must differ from each other, and not
/// all lie on one line. The dual of Boost.Polygon's Voronoi diagram, which is robust on integers; where four or more
/// points lie on one circle, a fan about the first of them. Deterministic. Cost: O(n log n). Source: S. Fortune, "A
/// sweepline algorithm for Voronoi diagrams", Algorithmica 2, 1987.
std::vector<TriangleCorners> delaunay(std::span<const PointLattice::Node> points);

}  // namespace froude::detail
