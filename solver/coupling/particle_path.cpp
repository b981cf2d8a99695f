#include <froude/solver/coupling/particle_path.h>

namespace froude {
namespace {

// The velocity after a contact with a surface that moves at u, outward normal n. Coulomb friction against the normal
// impulse; a disc that leaves already is not held.
Vec2 bounced(const Vec2& v, const Vec2& u, const Vec2& n, double restitution, double friction) {
  const Vec2 relative = v - u;
  const double normal = relative.dot(n);
  if (normal >= 0.0) return v;
  Vec2 tangential = relative - normal * n;
  const double slip = tangential.norm();
  const double grip = friction * (1.0 + restitution) * -normal;
  tangential *= slip > grip ? 1.0 - grip / slip : 0.0;
  return u + tangential - restitution * normal * n;
}

}  // namespace

void followPath(const Obstacles& obstacles, const Vec2& x, const Vec2& v, double dt, const DiscContact& disc,
                PathResult& result) {
  result.contacts = 0;
  result.crushed = false;
  result.startedInside = false;
  Vec2 at = x;
  Vec2 velocity = v;
  double t = 0.0;
  while (true) {
    const Vec2 to = at + (1.0 - t) * dt * velocity;
    const ObstacleHit hit = obstacles.sweep(at, to, t, disc.radius, disc.filter);
    if (!hit.hit) {
      at = to;
      break;
    }
    result.startedInside = result.startedInside || (t == 0.0 && hit.startedInside);
    const Vec2 before = velocity;
    velocity = disc.slides
                   ? bounced(velocity, hit.surfaceVelocity, hit.normal, 0.0, 0.0)
                   : bounced(velocity, hit.surfaceVelocity, hit.normal, std::max(disc.restitution, hit.restitution),
                             std::sqrt(disc.friction * hit.friction));
    at = hit.center;
    t = hit.time;
    const bool last = result.contacts == kMaxBounces;
    if (last) velocity = hit.surfaceVelocity;
    result.impulses[static_cast<std::size_t>(result.contacts++)] = {
        hit.body,
        at - disc.radius * hit.normal,
        velocity - before,
        hit.surfaceVelocity,
        t,
        hit.normal,
        std::max(0.0, (hit.surfaceVelocity - before).dot(hit.normal))};
    if (last) {
      // Rest at the last contact and go with it, on its own arc: the chord of a turning polygon would end inside it.
      // Another obstacle in the way means that there is no free place.
      const Vec2 belt = obstacles.beltVelocity(hit.body, hit.normal);
      const Vec2 carried = obstacles.carriedFrom(hit.body, at, t) + (1.0 - t) * dt * belt;
      const ObstacleHit blocked = obstacles.sweep(at, carried, t, disc.radius, disc.filter);
      const bool byOther = blocked.hit && blocked.body != hit.body;
      result.crushed = blocked.hit && (byOther || blocked.startedInside);
      at = byOther || (blocked.hit && belt.squaredNorm() > 0.0) ? blocked.center : carried;
      break;
    }
  }
  result.x = at;
  result.v = velocity;
}

Vec2 alongWalls(Vec2 v, const PathResult& path) {
  for (int k = 0; k < path.contacts; ++k) {
    const PathResult::Impulse& wall = path.impulses[static_cast<std::size_t>(k)];
    v -= std::min(0.0, (v - wall.surfaceVelocity).dot(wall.normal)) * wall.normal;
  }
  return v;
}

}  // namespace froude
