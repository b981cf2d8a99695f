// Meshes and worlds for tests of soft bodies, made without the mesher.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include <froude/solver/world.h>

namespace froude::testing {

/// A box from the origin, nx × ny cells, each cut along the same diagonal.
inline std::shared_ptr<const TriangleMesh> lattice(double width, double height, int nx, int ny) {
  auto mesh = std::make_shared<TriangleMesh>();
  auto id = [&](int i, int j) { return static_cast<std::uint32_t>(j * (nx + 1) + i); };
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) mesh->points.emplace_back(width * i / nx, height * j / ny);
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      mesh->triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh->triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  for (int i = 0; i < nx; ++i) mesh->outline.push_back({id(i, 0), id(i + 1, 0)});
  for (int j = 0; j < ny; ++j) mesh->outline.push_back({id(nx, j), id(nx, j + 1)});
  for (int i = nx; i > 0; --i) mesh->outline.push_back({id(i, ny), id(i - 1, ny)});
  for (int j = ny; j > 0; --j) mesh->outline.push_back({id(0, j), id(0, j - 1)});
  return mesh;
}

template <typename Where>
std::vector<std::uint32_t> pinnedWhere(const TriangleMesh& mesh, Where&& where) {
  std::vector<std::uint32_t> pinned;
  for (std::uint32_t k = 0; k < mesh.points.size(); ++k) {
    if (where(mesh.points[k])) pinned.push_back(k);
  }
  return pinned;
}

/// A closed box [−1, 3] × [0, 2] of soft bodies, which begin within it.
inline WorldDef softWorld(std::vector<SoftDef> soft, const Vec2& gravity) {
  WorldDef def;
  def.domain.box = {{-1.0, 0.0}, {3.0, 2.0}};
  def.gravity = gravity;
  for (SoftDef& s : soft) {
    if (s.position == Vec2(0.0, 0.0)) s.position = {0.0, 1.0};
    def.soft.push_back(std::move(s));
  }
  return def;
}

/// Displacement of the mesh's point nearest to `at`, which is in the body's own frame.
inline Vec2 tipOf(const World& world, std::size_t body, const Vec2& at) {
  const SoftDef& def = world.softDefinition(body);
  std::size_t best = 0;
  for (std::size_t k = 0; k < def.mesh->points.size(); ++k) {
    if ((def.mesh->points[k] - at).norm() < (def.mesh->points[best] - at).norm()) best = k;
  }
  const std::size_t i = world.softFirst(body) + best;
  return Vec2(world.soft()->x()[i], world.soft()->y()[i]) - def.position - def.mesh->points[best];
}

}  // namespace froude::testing
