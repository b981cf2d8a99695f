// Bullets against one moving polygon: a plain resolution of contacts, and a count of leaks that knows nothing of the
// swept query.
#pragma once

#include <vector>

#include <froude/base/random.h>
#include <froude/fields/sweep.h>

#include "support/sweep_oracle.h"

namespace froude::test {

/// One corner of a resolved path: where the disc's centre is after `time` seconds of the step. Two of one time are a
/// push.
struct PathPoint {
  double time;
  Vec2 position;
};

struct Bounce {
  double restitution = 0.0;
  double friction = 0.0;  // 0: slides freely; 1: loses all of its tangential motion relative to the surface
};

/// The path of a disc through one step: straight pieces between contacts; after 8 contacts it stays where it touches
/// and is carried along (`restsFrom` ≥ 0: from that time on).
struct ResolvedPath {
  std::vector<PathPoint> corners;
  double restsFrom = -1.0;
  int contacts = 0;
  bool startedInside = false;
  Vec2 velocity{0.0, 0.0};
};

/// `sweep(elapsed, from, to)` answers for the rest of the step; `surface(point, time)` is the velocity of the solid
/// there.
template <typename Sweep, typename Surface>
ResolvedPath resolve(const Vec2& from, const Vec2& velocity, double dt, const Bounce& bounce, const Sweep& sweep,
                     const Surface& surface) {
  ResolvedPath path;
  path.velocity = velocity;
  double elapsed = 0.0;
  Vec2 position = from;
  path.corners.push_back({0.0, position});
  while (elapsed < dt) {
    const double left = dt - elapsed;
    const SweepHit hit = sweep(elapsed, position, Vec2(position + left * path.velocity));
    if (hit.hit && hit.startedInside) path.startedInside = true;
    elapsed = hit.hit ? elapsed + hit.time * left : dt;
    // The way that was swept, and then the push off the solid: one straight line would be neither.
    if (hit.hit) path.corners.push_back({elapsed, Vec2(position + hit.time * left * path.velocity)});
    position = hit.center;
    path.corners.push_back({elapsed, position});
    if (!hit.hit) break;
    if (++path.contacts == 8) {
      path.restsFrom = elapsed;
      break;
    }
    const Vec2 wall = surface(hit.point, elapsed);
    const Vec2 relative = path.velocity - wall;
    const double approach = relative.dot(hit.normal);
    if (approach >= 0.0) continue;
    const Vec2 tangential = relative - approach * hit.normal;
    path.velocity = wall + (1.0 - bounce.friction) * tangential - bounce.restitution * approach * hit.normal;
  }
  return path;
}

/// True if a chord of the path in the polygon's frame enters the polygon and goes on doing so however finely it is
/// divided. `at(t)` is the path; a point found inside ends the search.
template <typename At>
bool entersBetween(std::span<const OracleEdge> edges, const At& at, double t0, double t1, const Vec2& p, const Vec2& q,
                   int depth) {
  if (!crosses(edges, p, q)) return false;
  if (depth == 0 || whereIs(edges, q) > 0) return true;
  const double middle = 0.5 * (t0 + t1);
  const Vec2 m = at(middle);
  if (whereIs(edges, m) > 0) return true;
  return entersBetween(edges, at, t0, middle, p, m, depth - 1) || entersBetween(edges, at, middle, t1, m, q, depth - 1);
}

/// Counts entries of a resolved path into the moving polygon: exact orientation over all edges, on chords of at most
/// `turn` radians in the polygon's own frame. Stretches that stay outside the polygon's circle about its origin are
/// taken whole.
inline int countLeaks(std::span<const OracleEdge> edges, const RigidMotion& motion, double dt, const ResolvedPath& path,
                      double turn = 0.01) {
  double reach = 0.0;
  for (const OracleEdge& e : edges) reach = std::max(reach, e.a.norm());
  int leaks = 0;
  for (std::size_t i = 0; i + 1 < path.corners.size(); ++i) {
    const PathPoint& a = path.corners[i];
    const PathPoint& b = path.corners[i + 1];
    const double length = b.time - a.time;
    if (length == 0.0) {
      const double f = a.time / dt;
      leaks += crosses(edges, inFrame(motion, dt, a.position, a.position, f),
                       inFrame(motion, dt, b.position, b.position, f));
      leaks += whereIs(edges, inFrame(motion, dt, b.position, b.position, f)) > 0;
      continue;
    }
    const auto world = [&](double t) {
      const double f = (t - a.time) / length;
      return t >= b.time ? b.position : Vec2(a.position + f * (b.position - a.position));
    };
    const auto at = [&](double t) {
      const Vec2 w = world(t);
      return inFrame(motion, dt, w, w, t / dt);
    };
    const double speed = ((b.position - a.position) / length - motion.velocity).norm();
    const double shortest = motion.spin == 0.0 ? length : turn / std::abs(motion.spin);
    double begin = a.time;
    Vec2 from = at(begin);
    do {
      // Outside the circle only the approach counts, whatever the turn.
      const double away = from.norm() - 1.001 * reach;
      const double step = away > 0.0 ? std::max(shortest, 0.99 * away / speed) : shortest;
      const double end = std::min(b.time, begin + step);
      const Vec2 to = at(end);
      const bool clear = away > 0.0 && speed * (end - begin) < away;
      if (!clear && entersBetween(edges, at, begin, end, from, to, 40)) ++leaks;
      from = to;
      begin = end;
    } while (begin < b.time);
    if (whereIs(edges, at(b.time)) > 0) ++leaks;
  }
  return leaks;
}

}  // namespace froude::test
