#include "export/soft_surface.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace froude::exporting {
namespace {

using Matrix2 = Eigen::Matrix2d;

Matrix2 edges(const Vec2& a, const Vec2& b, const Vec2& c) {
  Matrix2 m;
  m << b - a, c - a;
  return m;
}

/// From the deformation gradient's singular values, the smaller one signed.
double strainOf(const Matrix2& f) {
  const double turning = std::hypot(f(0, 0) + f(1, 1), f(1, 0) - f(0, 1));
  const double shear = std::hypot(f(0, 0) - f(1, 1), f(1, 0) + f(0, 1));
  return std::max(std::abs(0.5 * (turning + shear) - 1.0), std::abs(0.5 * (turning - shear) - 1.0));
}

void addBody(const World& world, std::size_t body, SoftSurface& surface) {
  const SoftDef& def = world.softDefinition(body);
  const TriangleMesh& mesh = *def.mesh;
  const auto first = static_cast<std::uint32_t>(world.softFirst(body));
  const auto x = world.soft()->x(), y = world.soft()->y();
  const auto at = [&](std::uint32_t point) { return Vec2(x[first + point], y[first + point]); };
  for (const auto& t : mesh.triangles) {
    const Matrix2 rest = edges(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
    const Matrix2 now = edges(at(t[0]), at(t[1]), at(t[2]));
    surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    surface.strain.push_back(static_cast<float>(strainOf(now * rest.inverse())));
  }
  const bool rope = def.model == SoftModel::Rope;
  for (const auto& edge : mesh.outline) {
    (rope ? surface.links : surface.outline).push_back({first + edge[0], first + edge[1]});
    if (!rope) continue;
    const double rest = (mesh.points[edge[1]] - mesh.points[edge[0]]).norm();
    surface.linkStrain.push_back(static_cast<float>(std::abs((at(edge[1]) - at(edge[0])).norm() / rest - 1.0)));
    surface.linkThickness.push_back(static_cast<float>(def.thickness));
  }
}

}  // namespace

SoftSurface softSurface(const World& world) {
  SoftSurface surface;
  for (std::size_t body = 0; body < world.softCount(); ++body) addBody(world, body, surface);
  return surface;
}

}  // namespace froude::exporting
