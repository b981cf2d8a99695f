// The caller's force: felt at the start of a sub-step, where it bounds the step, and given to velocities. A fluid is
// pushed once, before its pressures answer; half a push after them would leave every resting fluid moving. Bullets are
// pushed by half before and half after their flight, as gravity does it.
#include <froude/base/parallel.h>
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

using Push = std::array<AlignedArray<double>, 2>;

void evaluate(const ForceCallback& force, Species species, const ParticlePool& pool, double time, Push& push) {
  push[0].resize(pool.size());
  push[1].resize(pool.size());
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 a = force({species, static_cast<std::uint32_t>(i), {x[i], y[i]}, {vx[i], vy[i]}, time});
      push[0][i] = a.x();
      push[1][i] = a.y();
    }
  });
}

// What is not finite is no bound; it breaks the velocities and is found there.
double largest(const Push& push) {
  return std::sqrt(parallelMax(push[0].size(), 0.0, [&](std::size_t begin, std::size_t end) {
    double most = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const double square = push[0][i] * push[0][i] + push[1][i] * push[1][i];
      if (std::isfinite(square)) most = std::max(most, square);
    }
    return most;
  }));
}

// Adds dt times the push to the velocities, and what that gave to the particles to the accounts.
void give(const Push& push, double dt, double mass, ParticlePool& pool, StepStats& stats) {
  const auto vx = pool.vx(), vy = pool.vy();
  const std::size_t n = pool.size();
  stats.gravityWork +=
      mass * parallelSum(n, [&](std::size_t begin, std::size_t end) {
        double work = 0.0;
        for (std::size_t i = begin; i < end; ++i) {
          work += dt * (push[0][i] * (vx[i] + 0.5 * dt * push[0][i]) + push[1][i] * (vy[i] + 0.5 * dt * push[1][i]));
        }
        return work;
      });
  for (const int axis : {0, 1}) {
    const AlignedArray<double>& a = push[static_cast<std::size_t>(axis)];
    const auto v = axis == 0 ? vx : vy;
    stats.gravityImpulse[axis] += mass * dt * parallelSum(n, [&](std::size_t begin, std::size_t end) {
                                    double sum = 0.0;
                                    for (std::size_t i = begin; i < end; ++i) {
                                      v[i] += dt * a[i];
                                      sum += a[i];
                                    }
                                    return sum;
                                  });
  }
}

}  // namespace

void World::Impl::feelForce() {
  forceScale = 0.0;
  if (!def.force) return;
  if (fluid != nullptr) {
    evaluate(def.force, Species::Fluid, *fluid, time, fluidPush);
    forceScale = largest(fluidPush);
  }
  if (bullets != nullptr) {
    evaluate(def.force, Species::Bullet, *bullets, time, bulletPush);
    forceScale = std::max(forceScale, largest(bulletPush));
  }
}

void World::Impl::pushByForce(double dt, StepStats& stats) {
  if (!def.force) return;
  if (fluid != nullptr) give(fluidPush, dt, massOf(*fluid), *fluid, stats);
  if (bullets != nullptr) give(bulletPush, 0.5 * dt, massOf(*bullets), *bullets, stats);
}

void World::Impl::pushBulletsAgain(double dt, StepStats& stats) {
  if (!def.force || bullets == nullptr) return;
  evaluate(def.force, Species::Bullet, *bullets, time + dt, bulletEndPush);
  give(bulletEndPush, 0.5 * dt, massOf(*bullets), *bullets, stats);
}

}  // namespace froude
