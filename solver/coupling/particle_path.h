// The path of one particle through a sub-step: straight until it meets an obstacle, then bounced or slid along it.
#pragma once

#include <array>

#include <froude/solver/coupling/obstacles.h>

namespace froude {

/// How a disc meets obstacles.
struct DiscContact {
  double radius = 0.0;       // [m]; fluids meet polygons at 0
  double restitution = 0.0;  // with a body's: the larger of the two
  double friction = 0.0;     // Coulomb coefficient; with a body's: the geometric mean
  CollisionFilter filter;
  bool slides = false;  // fluids: no bounce and no friction, whatever the body's
};

/// Contacts after which a particle rests at its last one and moves with it (see `followPath`).
inline constexpr int kMaxBounces = 8;

/// What happened on the way.
struct PathResult {
  Vec2 x{0, 0};  // position at the end of the sub-step [m]
  Vec2 v{0, 0};  // velocity at the end [m/s]
  int contacts = 0;
  bool crushed = false;        // no free place: squeezed between bodies
  bool startedInside = false;  // it overlapped an obstacle at the start
  // Left without values until there is a contact: most paths have none, and there are many paths.
  struct Impulse {
    int body;
    Vec2 at;               // contact point [m]
    Vec2 change;           // of the particle's velocity [m/s]
    Vec2 surfaceVelocity;  // of the obstacle there [m/s]
    double time;           // fraction of the sub-step at which it happened
    Vec2 normal;           // outward from the obstacle
    double approach;       // of the particle towards the surface before [m/s], ≥ 0
  };
  std::array<Impulse, kMaxBounces + 1> impulses;  // the first `contacts`
};

/// Moves a disc from x with velocity v for dt [s]. At each contact the velocity relative to the surface loses its
/// normal part (times 1 + restitution) and, by friction, some of its tangential part. After kMaxBounces contacts the
/// disc rests at the last one and moves with that surface. Fills `result` (not returned by value: it is large).
void followPath(const Obstacles& obstacles, const Vec2& x, const Vec2& v, double dt, const DiscContact& disc,
                PathResult& result);

/// What is left of a velocity [m/s] that does not go into any of the walls that the path met.
Vec2 alongWalls(Vec2 v, const PathResult& path);

}  // namespace froude
