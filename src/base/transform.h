// Rigid motions of the plane: world = position + R(angle) · local.
#pragma once

#include <froude/base/types.h>

namespace froude {

/// A rotation kept as cosine and sine, so that applying it costs no trigonometry.
struct Rotation {
  double c = 1.0;
  double s = 0.0;

  static Rotation of(double angle) { return {std::cos(angle), std::sin(angle)}; }
  Vec2 apply(const Vec2& v) const { return {c * v.x() - s * v.y(), s * v.x() + c * v.y()}; }
  Vec2 applyInverse(const Vec2& v) const { return {c * v.x() + s * v.y(), -s * v.x() + c * v.y()}; }
};

/// Rigid transform from a body's own frame to the world.
struct Transform {
  Vec2 position{0.0, 0.0};
  Rotation rotation;

  static Transform of(const Vec2& position, double angle) { return {position, Rotation::of(angle)}; }
  Vec2 toWorld(const Vec2& local) const { return position + rotation.apply(local); }
  Vec2 toLocal(const Vec2& world) const { return rotation.applyInverse(world - position); }
};

}  // namespace froude
