// Worlds of free bodies that several tests use.
#pragma once

#include <cmath>

#include "support/worlds.h"

namespace froude::testing {

inline constexpr double kG = 9.81;

/// Free, without restitution; the rest as BodyDef has it.
inline BodyDef freeBody(const std::string& name, Polygon shape, const Vec2& position) {
  BodyDef def = body(name, std::move(shape), position);
  def.motion = Motion::Free;
  def.restitution = 0.0;
  return def;
}

/// About its own origin.
inline Polygon box(double width, double height) {
  return Polygon::box({{-0.5 * width, -0.5 * height}, {0.5 * width, 0.5 * height}});
}

/// A domain of 200 × 200 m, its floor at y = 0.
inline WorldDef plain() {
  WorldDef def;
  def.domain.box = {{-100.0, 0.0}, {100.0, 200.0}};
  return def;
}

/// The floor tilted by `degrees` downhill to the right: gravity is turned instead.
inline WorldDef slope(double degrees) {
  WorldDef def = plain();
  const double t = degrees * kPi / 180.0;
  def.gravity = kG * Vec2(std::sin(t), -std::cos(t));
  return def;
}

/// In steps of dt, the last one shorter if it must be.
inline void run(World& world, double until, double dt) {
  while (world.time() < until - 1e-9) world.step(std::min(dt, until - world.time()));
}

}  // namespace froude::testing
