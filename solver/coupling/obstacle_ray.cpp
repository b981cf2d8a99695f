// A ray among the obstacles: the swept query of a point, with every body at rest where it is.
#include <froude/solver/coupling/obstacles.h>

namespace froude {

Obstacles::RayHit Obstacles::ray(const Vec2& from, const Vec2& to, const CollisionFilter& filter) const {
  RayHit best;
  best.point = to;
  auto offer = [&](const SweepHit& hit, const Vec2& point, const Vec2& normal, int body) {
    if (!hit.hit || (best.hit && hit.time >= best.share)) return;
    best = {true, hit.time, point, normal, body, hit.startedInside};
  };
  auto castAt = [&](const Vec2& shift) {
    const Vec2 a = from + shift, b = to + shift;
    const SweepHit still = fixed_->sweepDisc(a, b, 0.0, filter);
    offer(still, still.point - shift, still.normal, still.body);
    Box line;
    line.include(a);
    line.include(b);
    for (const Moving& m : moving_) {
      if (!filter.accepts(m.group, m.collidesWith) || !m.swept.overlaps(line)) continue;
      const SweepHit hit = sweepDisc(*m.field, m.end.toLocal(a), m.end.toLocal(b), 0.0);
      offer(hit, m.end.toWorld(hit.point) - shift, m.end.rotation.apply(hit.normal), m.body);
    }
  };
  const Vec2 period = domain_.box.size();
  const int nx = domain_.periodicX ? 1 : 0, ny = domain_.periodicY ? 1 : 0;
  castAt(Vec2(0.0, 0.0));
  for (int i = -nx; i <= nx; ++i) {
    for (int j = -ny; j <= ny; ++j) {
      if (i != 0 || j != 0) castAt(Vec2(i * period.x(), j * period.y()));
    }
  }
  return best;
}

}  // namespace froude
