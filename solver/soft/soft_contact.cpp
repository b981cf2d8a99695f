// How the points of soft bodies meet polygons.
#include <cmath>

#include <froude/solver/soft/soft_bodies.h>

namespace froude {
namespace {

constexpr int kMostTouches = 4;  // of a particle in a part

}  // namespace

// Points that have not gone farther than the free distance that they started the sub-step with cannot have met
// anything.
void SoftBodies::meetObstacles(const StepContext& context, const Part& part, std::size_t i) {
  const std::size_t o = offset(i), end = o + body(i).points();
  for (std::size_t k = o; k < end; ++k) {
    const double dx = x_[k] - startX_[k], dy = y_[k] - startY_[k];
    if (free_[k] > 0.0 && dx * dx + dy * dy < free_[k] * free_[k]) continue;
    if (inverseMass_[k] > 0.0) meet(context, part, i, k);
  }
}

// The way of a part, straight until it meets a polygon; there what is left of it slides along the surface, held by
// Coulomb friction against the depth that it would have gone in.
void SoftBodies::meet(const StepContext& context, const Part& part, std::size_t i, std::size_t k) {
  const SoftDef& def = body(i).def;
  const CollisionFilter filter{def.group, def.collidesWith};
  const double radius = 0.5 * def.thickness;
  Vec2 from(fromX_[k], fromY_[k]), to(x_[k], y_[k]);
  double t = part.begin;
  for (int touch = 0; touch < kMostTouches && t < part.end; ++touch) {
    const Vec2 beyond = from + (1.0 - t) / (part.end - t) * (to - from);  // the query looks to the sub-step's end
    const ObstacleHit hit = context.obstacles.sweep(from, beyond, t, radius, filter);
    if (!hit.hit || hit.time >= part.end) break;
    const double left = (part.end - hit.time) * context.dt;
    const Vec2 carried = left * hit.surfaceVelocity;
    const Vec2 rest = to - hit.center - carried;
    const double depth = -rest.dot(hit.normal);
    if (depth <= 0.0 && !hit.startedInside) break;
    Vec2 along = rest + depth * hit.normal;
    const double slip = along.norm(), grip = std::sqrt(def.friction * hit.friction) * std::max(0.0, depth);
    along *= slip > grip ? 1.0 - grip / slip : 0.0;
    const bool last = touch + 1 == kMostTouches;
    const Vec2 stop = hit.center + carried + (last ? Vec2(0.0, 0.0) : along);
    touches_[i].push_back({hit.body, hit.center - radius * hit.normal, -1.0 / (inverseMass_[k] * part.dt) * (stop - to),
                           hit.surfaceVelocity});
    from = hit.center;
    to = stop;
    t = hit.time;
  }
  x_[k] = to.x();
  y_[k] = to.y();
}

void SoftBodies::book(const StepContext&, double, ImpulseLedger& impulses, StepStats&) {
  for (std::size_t i = 0; i < count(); ++i) {
    for (const Touch& t : touches_[i]) {
      impulses.add(t.body, t.at, t.impulse, t.surface);
      touchImpulse_[i] -= t.impulse;
    }
    touches_[i].clear();
  }
}

}  // namespace froude
