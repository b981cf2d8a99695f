#include "export/soft_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace froude::exporting {
namespace {

using Edge = std::array<std::uint32_t, 2>;

/// Edges that belong to one of the triangles alone.
std::vector<Edge> outlineOf(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Edge> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> outline;
  for (const Edge& edge : edges)
    if (!std::binary_search(edges.begin(), edges.end(), Edge{edge[1], edge[0]})) outline.push_back(edge);
  return outline;
}

void addRope(const World& world, std::size_t body, const std::vector<double>& strain, SoftSurface& surface) {
  const SoftDef& def = world.softDefinition(body);
  const auto first = static_cast<std::uint32_t>(world.softFirst(body));
  for (std::size_t k = 0; k < def.mesh->outline.size(); ++k) {
    if (std::isnan(strain[k])) continue;
    const Edge& link = def.mesh->outline[k];
    surface.links.push_back({first + link[0], first + link[1]});
    surface.linkStrain.push_back(static_cast<float>(strain[k]));
    surface.linkThickness.push_back(static_cast<float>(def.thickness));
  }
}

void addTriangles(const World& world, std::size_t body, const std::vector<double>& strain, SoftSurface& surface) {
  const TriangleMesh& mesh = *world.softDefinition(body).mesh;
  const auto first = static_cast<std::uint32_t>(world.softFirst(body));
  std::vector<std::array<std::uint32_t, 3>> whole;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    if (std::isnan(strain[k])) continue;
    whole.push_back(mesh.triangles[k]);
    surface.strain.push_back(static_cast<float>(strain[k]));
  }
  for (const auto& t : whole) surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  for (const Edge& edge : whole.size() < mesh.triangles.size() ? outlineOf(whole) : mesh.outline)
    surface.outline.push_back({first + edge[0], first + edge[1]});
}

}  // namespace

SoftSurface softSurface(const World& world) {
  SoftSurface surface;
  std::vector<double> strain;
  for (std::size_t body = 0; body < world.softCount(); ++body) {
    world.softStrain(body, strain);
    const bool rope = world.softDefinition(body).model == SoftModel::Rope;
    (rope ? addRope : addTriangles)(world, body, strain, surface);
  }
  return surface;
}

}  // namespace froude::exporting
