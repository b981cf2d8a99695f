#include "scene/material_point.h"

#include <algorithm>

namespace froude::scene {

MaterialPoint::MaterialPoint(const TriangleMesh& mesh, const Vec2& place) : distance(kInfinity) {
  const auto take = [&](const std::array<std::uint32_t, 3>& corners, const std::array<double, 3>& weights) {
    const Vec2 p = weights[0] * mesh.points[corners[0]] + weights[1] * mesh.points[corners[1]] +
                   weights[2] * mesh.points[corners[2]];
    const double away = (p - place).norm();
    if (away >= distance) return;
    corner = corners;
    weight = weights;
    nearest = p;
    distance = away;
  };
  for (const auto& edge : mesh.outline) {
    const Vec2 a = mesh.points[edge[0]], along = mesh.points[edge[1]] - a;
    const double t = std::clamp((place - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    take({edge[0], edge[1], edge[1]}, {1.0 - t, t, 0.0});
  }
  for (const auto& t : mesh.triangles) {
    const Vec2 u = mesh.points[t[1]] - mesh.points[t[0]], v = mesh.points[t[2]] - mesh.points[t[0]];
    const Vec2 p = place - mesh.points[t[0]];
    const double area = cross(u, v), b = cross(p, v) / area, c = cross(u, p) / area;
    if (b >= 0.0 && c >= 0.0 && b + c <= 1.0) take(t, {1.0 - b - c, b, c});
  }
}

}  // namespace froude::scene
