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
    if (pushed_.isFree(hit.body)) {
      meetings_[i].push_back({k, hit.body});
      break;
    }
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
    touches_[i].push_back({hit.body, static_cast<std::uint32_t>(i), hit.center - radius * hit.normal,
                           -1.0 / (inverseMass_[k] * part.dt) * (stop - to), hit.surfaceVelocity});
    from = hit.center;
    to = stop;
    t = hit.time;
  }
  x_[k] = to.x();
  y_[k] = to.y();
}

void SoftBodies::meetFreeBodies(const StepContext& context, const Part& part, std::size_t i) {
  for (const Meeting& m : meetings_[i]) meetFree(context, part, i, m);
  meetings_[i].clear();
}

// As `meet`, in the frame of the body as it was before it was pushed; point and body part by their masses.
void SoftBodies::meetFree(const StepContext& context, const Part& part, std::size_t i, const Meeting& meeting) {
  const SoftDef& def = body(i).def;
  const std::size_t k = meeting.point;
  const double end = part.end * context.dt, radius = 0.5 * def.thickness;
  const Vec2 x(x_[k], y_[k]);
  const Vec2 shift = pushed_.shiftAt(meeting.body, x, end), velocity = pushed_.velocityAt(meeting.body, x, end);
  const Vec2 from = Vec2(fromX_[k], fromY_[k]) - (shift - part.dt * velocity), to = x - shift;
  const Vec2 beyond = from + (1.0 - part.begin) / (part.end - part.begin) * (to - from);
  const ObstacleHit hit = context.obstacles.sweep(from, beyond, part.begin, radius, {def.group, def.collidesWith});
  if (!hit.hit || hit.time >= part.end) return;
  const Vec2 rest = to - hit.center - (part.end - hit.time) * context.dt * hit.surfaceVelocity;
  const double depth = -rest.dot(hit.normal);
  if (!(depth > 0.0)) return;
  auto weightAlong = [&](const Vec2& n) {
    return inverseMass_[k] + pushed_.inverseMassAt(hit.body, hit.center, n, end);
  };
  const double normal = depth / weightAlong(hit.normal);
  Vec2 amount = normal * hit.normal;
  const Vec2 along = rest + depth * hit.normal;
  const double slip = along.norm();
  if (slip > 0.0) {
    const double grip = std::sqrt(def.friction * hit.friction) * normal;
    amount -= std::min(grip, slip / weightAlong(along / slip)) / slip * along;
  }
  x_[k] += inverseMass_[k] * amount.x();
  y_[k] += inverseMass_[k] * amount.y();
  const Vec2 at = hit.center - radius * hit.normal;
  touches_[i].push_back({hit.body, static_cast<std::uint32_t>(i), at, -amount / part.dt, hit.surfaceVelocity});
  pushed_.push(hit.body, at, -amount, part.dt, end);
}

void SoftBodies::book(ImpulseLedger& impulses) {
  auto give = [&](const PairTouch& t) {
    if (t.body != kByFluid) impulses.add(t.body, t.at, t.impulse, t.surface);
    touchImpulse_[t.soft] -= t.impulse;
  };
  for (const PairTouch& t : pairTouches_) give(t);
  pairTouches_.clear();
  for (std::size_t i = 0; i < count(); ++i) {
    for (const PairTouch& t : touches_[i]) give(t);
    touches_[i].clear();
  }
}

}  // namespace froude
