#include <froude/solver/bullet/ballistic.h>

#include <numeric>

#include <froude/base/parallel.h>
#include <froude/solver/coupling/leak_check.h>

namespace froude {

double bulletStepBound(const BulletDef& def, double gravity) {
  return gravity > 0.0 ? std::sqrt(0.8 * def.radius / gravity) : kInfinity;  // sagitta g·dt²/8 = radius/10
}

Ballistic::Ballistic(const BulletDef& def) : def_(def), mass_(def.density * kPi * def.radius * def.radius) {}

void Ballistic::advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) {
  left_.resize(blockCount(pool.size()));
  if (pool.empty()) return;
  const DiscContact disc{def_.radius, def_.restitution, def_.friction, {def_.group, def_.collidesWith}};
  map_.prepare(context.obstacles, def_.radius, disc.filter, pool.size());
  map_.refresh(context.obstacles);
  contacts_.begin(pool.size());
  crushed_.assign(blockCount(pool.size()), 0);
  if (leaks_.size() < crushed_.size()) leaks_.resize(crushed_.size());
  for (std::vector<ParticleLeak>& block : leaks_) block.clear();
  near_.resize(pool.size());
  const Vec2 halfKick = 0.5 * context.dt * context.gravity.constant();
  const Flight flight{pool.x().data(), pool.y().data(), pool.vx().data(), pool.vy().data(),
                      context.dt,      halfKick,        map_.view(),      context.obstacles.domain().box};
  const FlyLoop fly = flyLoop(context.simd);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    std::uint32_t* near = near_.data() + begin;
    FlightResult result;
    if (context.gravity.isConstant()) {
      result = fly(flight, begin, end, near);
    } else {
      result.near = end - begin;
      std::iota(near, near + result.near, static_cast<std::uint32_t>(begin));
    }
    for (std::size_t k = 0; k < result.near; ++k) result.left |= follow(context, disc, pool, near[k]);
    left_[begin / kBlockSize] = result.left ? 1 : 0;
  });
  contacts_.book(mass_, impulses);
  stats.crushed += std::accumulate(crushed_.begin(), crushed_.end(), std::uint64_t{0});
  for (const std::vector<ParticleLeak>& block : leaks_) {
    stats.leaks += block.size();
    if (context.leaks == nullptr) continue;
    for (const ParticleLeak& leak : block) context.leaks->add(leak);
  }
  if (context.gravity.isConstant()) {
    stats.gravityImpulse += mass_ * static_cast<double>(pool.size()) * context.dt * context.gravity.constant();
  }
}

bool Ballistic::follow(const StepContext& context, const DiscContact& disc, ParticlePool& pool, std::uint32_t i) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const Vec2 at(x[i], y[i]);
  const Vec2 half = 0.5 * context.dt * context.gravity.at(at, context.time);
  PathResult path;
  followPath(context.obstacles, at, Vec2(vx[i], vy[i]) + half, context.dt, disc, path);
  contacts_.add(i, path);
  PathLeak leak;
  if (path.crushed) {
    ++crushed_[i / kBlockSize];
    pool.kill(i);
  } else if (context.leaks != nullptr || path.startedInside) {
    // The check of every path would cost a fifth of a step: only who listens pays. What overlapped is rare.
    leak = checkPath(context.obstacles, at, path.x, disc, path);
    if (leak.leaked) {
      leaks_[i / kBlockSize].push_back({i, at, path.x, leak.inside, leak.body, leak.at});
      pool.kill(i);
    }
  }
  const Vec2 v = path.v + half;
  x[i] = path.x.x();
  y[i] = path.x.y();
  vx[i] = v.x();
  vy[i] = v.y();
  return path.crushed || leak.leaked || hasLeft(context.obstacles.domain().box, x[i], y[i]);
}

}  // namespace froude
