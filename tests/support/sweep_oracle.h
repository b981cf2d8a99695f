// Slow, independent answers about swept discs: all edges, long double, a scan in time instead of advancement.
#pragma once

#include <optional>

#include <froude/fields/sweep.h>

#include "support/polygon_oracle.h"

namespace froude::test {

/// First time at which a disc on the straight path from p to q touches the boundary from outside: entry into the
/// Minkowski sum, edge by edge (the offset line over the edge, a circle round each end). Empty: never.
inline std::optional<long double> firstTouch(std::span<const OracleEdge> edges, const Vec2& p, const Vec2& q,
                                             double radius) {
  using L = long double;
  std::optional<L> best;
  const auto offer = [&](L t) {
    if (t >= 0 && t <= 1 && (!best || t < *best)) best = t;
  };
  const L dx = static_cast<L>(q.x()) - p.x();
  const L dy = static_cast<L>(q.y()) - p.y();
  for (const OracleEdge& e : edges) {
    const L ex = static_cast<L>(e.b.x()) - e.a.x();
    const L ey = static_cast<L>(e.b.y()) - e.a.y();
    const L length = std::hypot(ex, ey);
    const L nx = ey / length;
    const L ny = -ex / length;
    const L px = static_cast<L>(p.x()) - e.a.x();
    const L py = static_cast<L>(p.y()) - e.a.y();
    const L speed = nx * dx + ny * dy;
    if (speed < 0) {
      const L t = (radius - (nx * px + ny * py)) / speed;
      const L along = ((px + t * dx) * ex + (py + t * dy) * ey) / length;
      if (along >= 0 && along <= length) offer(t);
    }
    const L a = dx * dx + dy * dy;
    const L b = px * dx + py * dy;
    const L c = px * px + py * py - static_cast<L>(radius) * radius;
    if (radius > 0 && b < 0 && b * b >= a * c) offer((-b - std::sqrt(b * b - a * c)) / a);
  }
  return best;
}

/// The disc's centre in the frame of a moving polygon after the fraction t of the step, computed without the library.
inline Vec2 inFrame(const RigidMotion& motion, double dt, const Vec2& from, const Vec2& to, double t) {
  const double angle = motion.spin * (dt * t);
  const Rotation& start = motion.start.rotation;
  const double c = start.c * std::cos(angle) - start.s * std::sin(angle);
  const double s = start.s * std::cos(angle) + start.c * std::sin(angle);
  const double x = from.x() + t * (to.x() - from.x()) - (motion.start.position.x() + motion.velocity.x() * (dt * t));
  const double y = from.y() + t * (to.y() - from.y()) - (motion.start.position.y() + motion.velocity.y() * (dt * t));
  return {c * x + s * y, c * y - s * x};
}

/// First sampled time, refined by bisection, at which the disc overlaps the moving polygon. May miss short contacts.
inline std::optional<double> scanForTouch(std::span<const OracleEdge> edges, const RigidMotion& motion, double dt,
                                          const Vec2& from, const Vec2& to, double radius, int samples) {
  const auto overlaps = [&](double t) { return signedDistance(edges, inFrame(motion, dt, from, to, t)) < radius; };
  for (int i = 1; i <= samples; ++i) {
    double high = static_cast<double>(i) / samples;
    if (!overlaps(high)) continue;
    double low = static_cast<double>(i - 1) / samples;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (overlaps(middle) ? high : low) = middle;
    }
    return high;
  }
  return std::nullopt;
}

}  // namespace froude::test
