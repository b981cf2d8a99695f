// The caller's force: felt at the start of a sub-step, where it bounds the step, and given to velocities. A fluid is
// pushed once, before its pressures answer; half a push after them would leave every resting fluid moving. Bullets are
// pushed by half before and half after their flight, as gravity does it; the second half is felt at the velocity that
// the first push predicts (Heun's method), so that a drag is right to second order.
#include <froude/base/parallel.h>
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

using Push = std::array<AlignedArray<double>, 2>;

Vec2 at(const Push& push, std::uint32_t slot) { return {push[0][slot], push[1][slot]}; }

// By slot, so that it is found again after the pool was sorted. `lead` [s]: how far ahead of the columns the velocity
// is that the force sees.
void evaluate(const ForceCallback& force, Species species, const ParticlePool& pool, double time, Push& push,
              double lead = 0.0) {
  for (AlignedArray<double>& axis : push) {
    if (axis.size() < pool.capacity()) axis.resize(pool.capacity());
  }
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const auto slot = pool.slots();
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec2 v(vx[i], vy[i]);
      if (lead > 0.0) v += lead * at(push, slot[i]);
      const Vec2 a = force({species, static_cast<std::uint32_t>(i), {x[i], y[i]}, v, time});
      push[0][slot[i]] = a.x();
      push[1][slot[i]] = a.y();
    }
  });
}

// What is not finite is no bound; it breaks the velocities and is found there.
double largest(const ParticlePool& pool, const Push& push) {
  const auto slot = pool.slots();
  return std::sqrt(parallelMax(pool.size(), 0.0, [&](std::size_t begin, std::size_t end) {
    double most = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const double square = at(push, slot[i]).squaredNorm();
      if (std::isfinite(square)) most = std::max(most, square);
    }
    return most;
  }));
}

// Sum over the particles of term(push, velocity).
template <typename Term>
double sumOver(const ParticlePool& pool, const Push& push, Term&& term) {
  const auto vx = pool.vx(), vy = pool.vy();
  const auto slot = pool.slots();
  return parallelSum(pool.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += term(at(push, slot[i]), Vec2(vx[i], vy[i]));
    return sum;
  });
}

// Adds dt times the push to the velocities, and the impulse to the accounts.
void give(const Push& push, double dt, double mass, ParticlePool& pool, StepStats& stats) {
  const auto vx = pool.vx(), vy = pool.vy();
  const auto slot = pool.slots();
  stats.gravityImpulse.x() += mass * dt * sumOver(pool, push, [](const Vec2& a, const Vec2&) { return a.x(); });
  stats.gravityImpulse.y() += mass * dt * sumOver(pool, push, [](const Vec2& a, const Vec2&) { return a.y(); });
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vx[i] += dt * push[0][slot[i]];
      vy[i] += dt * push[1][slot[i]];
    }
  });
}

// What giving `dt` times the push to bullets adds to their kinetic energy.
double workOn(const ParticlePool& pool, const Push& push, double dt) {
  return dt * sumOver(pool, push, [&](const Vec2& a, const Vec2& v) { return a.dot(v + 0.5 * dt * a); });
}

}  // namespace

void World::Impl::feelForce() {
  forceScale = 0.0;
  if (!def.force) return;
  if (fluid != nullptr) {
    evaluate(def.force, Species::Fluid, *fluid, time, fluidPush);
    forceScale = largest(*fluid, fluidPush);
  }
  if (bullets != nullptr) {
    evaluate(def.force, Species::Bullet, *bullets, time, bulletPush);
    forceScale = std::max(forceScale, largest(*bullets, bulletPush));
  }
}

void World::Impl::pushByForce(double dt, StepStats& stats) {
  if (!def.force) return;
  if (fluid != nullptr) give(fluidPush, dt, massOf(*fluid), *fluid, stats);
  if (bullets == nullptr) return;
  stats.gravityWork += massOf(*bullets) * workOn(*bullets, bulletPush, 0.5 * dt);
  give(bulletPush, 0.5 * dt, massOf(*bullets), *bullets, stats);
}

void World::Impl::finishForce(double dt, StepStats& stats) {
  if (!def.force) return;
  // The work on a fluid is along the way that its pressures let it go: none on one that rests.
  if (fluid != nullptr) {
    stats.gravityWork +=
        massOf(*fluid) * dt * sumOver(*fluid, fluidPush, [](const Vec2& a, const Vec2& v) { return a.dot(v); });
  }
  if (bullets == nullptr) return;
  for (const std::size_t axis : {0, 1}) bulletEndPush[axis] = bulletPush[axis];
  evaluate(def.force, Species::Bullet, *bullets, time + dt, bulletEndPush, 0.5 * dt);
  stats.gravityWork += massOf(*bullets) * workOn(*bullets, bulletEndPush, 0.5 * dt);
  give(bulletEndPush, 0.5 * dt, massOf(*bullets), *bullets, stats);
}

}  // namespace froude
