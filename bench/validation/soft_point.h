// Points of soft bodies' material, read off a world.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <froude/solver/world.h>
#include "scene/material_point.h"
#include "scene/scene.h"

namespace froude::validation {

/// Where point k of the mesh of soft body `body` is [m].
inline Vec2 softPoint(const World& world, std::size_t body, std::uint32_t k) {
  const std::size_t i = world.softFirst(body) + k;
  return {world.soft()->x()[i], world.soft()->y()[i]};
}

/// A point of a body's material, by its place in the shape at rest.
class SoftPoint {
 public:
  SoftPoint(const scene::Scene& scene, std::size_t body, const Vec2& rest)
      : body_(body), point_(*scene.world.soft.at(body).mesh, rest) {
    const SoftDef& def = scene.world.soft[body];
    start_ = Transform::of(def.position, def.angle).toWorld(point_.nearest);
  }
  Vec2 at(const World& world) const {
    return point_.at([&](std::uint32_t k) { return softPoint(world, body_, k); });
  }
  Vec2 displacement(const World& world) const { return at(world) - start_; }

 private:
  std::size_t body_;
  scene::MaterialPoint point_;
  Vec2 start_;
};

/// Largest |stretch − 1| of a rope's links.
inline double largestStretch(const World& world, std::size_t body) {
  const TriangleMesh& mesh = *world.softDefinition(body).mesh;
  double largest = 0.0;
  for (const auto& link : mesh.outline) {
    const double rest = (mesh.points[link[1]] - mesh.points[link[0]]).norm();
    const double now = (softPoint(world, body, link[1]) - softPoint(world, body, link[0])).norm();
    largest = std::max(largest, std::abs(now / rest - 1.0));
  }
  return largest;
}

}  // namespace froude::validation
