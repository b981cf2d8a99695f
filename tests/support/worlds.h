// Small worlds that several tests use.
#pragma once

#include <string>
#include <vector>

#include <froude/solver/world.h>

namespace froude::testing {

inline std::vector<Vec2> latticePoints(const Box& box, double dx) {
  std::vector<Vec2> points;
  for (double y = box.min.y() + 0.5 * dx; y < box.max.y(); y += dx) {
    for (double x = box.min.x() + 0.5 * dx; x < box.max.x(); x += dx) points.push_back({x, y});
  }
  return points;
}

inline void fill(World& world, const Box& box, double dx) {
  const std::vector<Vec2> points = latticePoints(box, dx);
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
}

inline WorldDef fluidWorld(const Box& domain, double dx) {
  WorldDef def;
  def.domain.box = domain;
  def.fluid = FluidDef{};
  def.fluid->spacing = dx;
  def.fluid->viscosity = 0.0;
  return def;
}

/// Of fluid, without an end.
inline EmitterDef nozzle(const Vec2& from, const Vec2& to, double speed, std::size_t limit) {
  EmitterDef def;
  def.kind = EmitterDef::Kind::Fluid;
  def.from = from;
  def.to = to;
  def.speed = speed;
  def.limit = limit;
  return def;
}

inline BodyDef body(const std::string& name, Polygon shape, const Vec2& position) {
  BodyDef def;
  def.name = name;
  def.shape = std::make_shared<const Polygon>(std::move(shape));
  def.position = position;
  return def;
}

/// A column of 0.4 × 0.8 that falls onto a turning paddle and an octagon.
inline World busyWorld(const std::string& method = "pbf", SimdTarget simd = bestSimdTarget()) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.6, 1.2}}, 0.025);
  def.fluid->model = method;
  def.simd = simd;
  def.bodies.push_back(body("octagon", Polygon::regular(8, 0.08), {0.6, 0.1}));
  BodyDef paddle = body("paddle", Polygon::box({{-0.15, -0.01}, {0.15, 0.01}}), {1.0, 0.3});
  paddle.motion = Motion::Scripted;
  paddle.spin = 3.0;
  def.bodies.push_back(paddle);
  def.bullet = BulletDef{};
  EmitterDef jet = nozzle({1.4, 1.0}, {1.2, 1.0}, 1.0, 60);
  jet.policy = GrowthPolicy::RecycleOldest;
  def.emitters.push_back(jet);
  EmitterDef gun;
  gun.kind = EmitterDef::Kind::Bullet;
  gun.from = {0.2, 1.1};
  gun.to = {0.1, 1.1};
  gun.speed = 4.0;
  gun.rate = 900.0;
  gun.spread = 0.3;
  gun.lifetime = 0.15;
  def.emitters.push_back(gun);
  World world(def);
  fill(world, {{0.0, 0.0}, {0.4, 0.8}}, 0.025);
  return world;
}

}  // namespace froude::testing
