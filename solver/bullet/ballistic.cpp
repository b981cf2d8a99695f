#include <froude/solver/bullet/ballistic.h>

#include <numeric>

#include <froude/base/parallel.h>

namespace froude {

double bulletStepBound(const BulletDef& def, double gravity) {
  return gravity > 0.0 ? std::sqrt(0.8 * def.radius / gravity) : kInfinity;  // sagitta g·dt²/8 = radius/10
}

Ballistic::Ballistic(const BulletDef& def) : def_(def), mass_(def.density * kPi * def.radius * def.radius) {}

void Ballistic::advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) {
  if (pool.empty()) return;
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const DiscContact disc{def_.radius, def_.restitution, def_.friction, {def_.group, def_.collidesWith}};
  const double dt = context.dt;
  contacts_.begin(pool.size());
  crushed_.assign(blockCount(pool.size()), 0);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 at(x[i], y[i]);
      const Vec2 half = 0.5 * dt * context.gravity.at(at, context.time);
      Vec2 v = Vec2(vx[i], vy[i]) + half;
      Vec2 to = at + dt * v;
      const double reach = (to - at).norm() + def_.radius;
      if (context.obstacles.clearance(at) <= reach && context.obstacles.freeDistance(at, disc.filter) <= reach) {
        PathResult path;
        followPath(context.obstacles, at, v, dt, disc, path);
        contacts_.add(i, path);
        to = path.x;
        v = path.v;
        if (path.crushed) {
          ++crushed_[begin / kBlockSize];
          pool.kill(static_cast<std::uint32_t>(i));
        }
      }
      v += half;
      x[i] = to.x();
      y[i] = to.y();
      vx[i] = v.x();
      vy[i] = v.y();
    }
  });
  contacts_.book(mass_, impulses);
  stats.crushed += std::accumulate(crushed_.begin(), crushed_.end(), std::uint64_t{0});
  if (context.gravity.isConstant()) {
    stats.gravityImpulse += mass_ * static_cast<double>(pool.size()) * dt * context.gravity.constant();
  }
}

}  // namespace froude
