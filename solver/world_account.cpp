// Mass, momentum and energy: what there is, what came and went, and what the summary says of it.
#include <froude/solver/particle_sums.h>
#include <froude/solver/world_impl.h>

namespace froude {

// From the domain's lowest point, so that it is never negative inside; none along a periodic axis.
double World::Impl::potentialOf(const Vec2& x) const {
  if (!gravity.isConstant()) return 0.0;
  const Vec2& g = gravity.constant();
  const Box& box = def.domain.box;
  double potential = 0.0;
  if (!def.domain.periodicX) potential -= g.x() * (x.x() - (g.x() > 0.0 ? box.max.x() : box.min.x()));
  if (!def.domain.periodicY) potential -= g.y() * (x.y() - (g.y() > 0.0 ? box.max.y() : box.min.y()));
  return potential;
}

Totals World::Impl::totalsOf(const ParticlePool& pool, double mass) const {
  const ParticleSums sums = sumParticles(pool, def.simd);
  Totals t;
  t.count = pool.size();
  if (t.count == 0) return t;
  const auto count = static_cast<double>(t.count);
  t.mass = mass * count;
  t.kinetic = 0.5 * mass * sums.speedSquared;
  t.potential = t.mass * potentialOf(Vec2(sums.x, sums.y) / count);  // linear in the position
  t.momentum = mass * Vec2(sums.vx, sums.vy);
  t.angular = mass * sums.angular;
  t.maxSpeed = std::sqrt(sums.maxSpeedSquared);
  return t;
}

Totals World::Impl::bodyTotals() const {
  Totals t;
  for (std::size_t i = 0; bodies.anyFree() && i < bodies.size(); ++i) {
    if (!bodies.isFree(i)) continue;
    const MassData& mass = bodies.mass(i);
    const FreeState& f = bodies.freeState(i);
    const Vec2& center = bodies.motion(i).position;
    t.mass += mass.mass;
    t.kinetic += 0.5 * (mass.mass * f.velocity.squaredNorm() + mass.inertia * f.spin * f.spin);
    t.potential += mass.mass * potentialOf(center);
    t.momentum += mass.mass * f.velocity;
    t.angular += mass.inertia * f.spin + mass.mass * cross(center, f.velocity);
  }
  return t;
}

Totals World::Impl::softTotals() const {
  Totals t;
  const SoftSums sums = soft->sums();
  t.count = soft->pool().size();
  t.mass = sums.mass;
  t.kinetic = sums.kinetic;
  t.strain = sums.strain;
  t.potential = sums.mass > 0.0 ? sums.mass * potentialOf(sums.massCenter / sums.mass) : 0.0;
  t.momentum = sums.momentum;
  t.angular = sums.angular;
  t.maxSpeed = sums.maxSpeed;
  return t;
}

Balance World::Impl::balance() const {
  Balance b;
  auto add = [&](const ParticlePool& pool, double mass) {
    const Totals t = totalsOf(pool, mass);
    b.kinetic += t.kinetic;
    b.potential += t.potential;
    b.momentum += t.momentum;
    b.mass += t.mass;
    b.maxSpeed = std::max(b.maxSpeed, t.maxSpeed);
  };
  if (fluid != nullptr) add(*fluid, fluidModel->particleMass());
  if (bullets != nullptr) add(*bullets, ballistic->mass());
  if (soft != nullptr) {
    const Totals t = softTotals();
    b.kinetic += t.kinetic;
    b.potential += t.potential;
    b.strain += t.strain;
    b.momentum += t.momentum;
    b.mass += t.mass;
    b.maxSpeed = std::max(b.maxSpeed, t.maxSpeed);
  }
  const Totals free = bodyTotals();
  b.kinetic += free.kinetic;
  b.potential += free.potential;
  b.momentum += free.momentum;
  b.mass += free.mass;
  b.finite = std::isfinite(b.kinetic + b.potential + b.strain + b.momentum.x() + b.momentum.y());
  return b;
}

void World::Impl::openAccounts() {
  if (started) return;
  started = true;
  present = balance();
  ledger.energy0 = present.energy();
  ledger.momentum0 = present.momentum;
  ledger.maxKinetic = present.kinetic;
}

// At least the energy of creeping by a tenth of a support radius in a hundredth of a second: a scene without gravity
// that is at rest has no energy of its own to measure a gain against.
double World::Impl::energyScale() const {
  double creep = 0.0;
  if (fluidModel != nullptr) {
    const double speed = 10.0 * fluidModel->supportRadius();
    creep = 0.5 * fluidModel->particleMass() * static_cast<double>(fluid->size()) * speed * speed;
  }
  if (soft != nullptr) {
    const double speed = 10.0 * soft->spacing();
    creep += 0.5 * soft->totalMass() * speed * speed;
  }
  return std::max({std::abs(ledger.energy0), ledger.maxKinetic, creep, 1e-300});
}

double World::Impl::outsideWork(const StepStats& stats, const Balance& after, double dt) const {
  double work = stats.gravityWork + stats.tensionWork + impulses.work() + rigidStats.work +
                (gravity.isConstant() ? 0.0 : rigidStats.gravityWork);
  if (gravity.isConstant()) {
    if (def.domain.periodicX) work += gravity.constant().x() * after.momentum.x() * dt;
    if (def.domain.periodicY) work += gravity.constant().y() * after.momentum.y() * dt;
  }
  return work;
}

Vec2 World::Impl::fastestParticle() const {
  Vec2 at(0.0, 0.0);
  double most = -1.0;
  const auto x = fluid->x(), y = fluid->y(), vx = fluid->vx(), vy = fluid->vy();
  for (std::size_t i = 0; i < fluid->size(); ++i) {
    const double speed = vx[i] * vx[i] + vy[i] * vy[i];
    if (!(speed > most) && !std::isnan(speed)) continue;
    most = speed;
    at = {x[i], y[i]};
    if (std::isnan(speed)) break;
  }
  return at;
}

void World::Impl::remove(ParticlePool& pool, double mass, std::uint64_t& counter) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const bool isFluid = &pool == fluid.get();
  if (!pool.anyMarked()) return;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (!pool.isMarked(static_cast<std::uint32_t>(i))) continue;
    ++count;
    const Vec2 v(vx[i], vy[i]);
    const double energy = 0.5 * v.squaredNorm() + potentialOf({x[i], y[i]});
    if (!std::isfinite(energy)) continue;
    ledger.impulse -= mass * v;
    ledger.work -= mass * energy;
  }
  counter += count;
  membersChanged = true;
  if (isFluid) ledger.massRetired += static_cast<double>(count) * mass;
  pool.compact();
}

void World::Impl::account(const StepStats& stats, double dt) {
  const Balance after = judged && !membersChanged ? *judged : balance();
  ledger.substeps += 1;
  ledger.particleSteps += (fluid ? fluid->size() : 0) + (bullets ? bullets->size() : 0) +
                          (soft ? soft->pool().size() * stats.softParts : 0);
  ledger.sweeps += static_cast<std::uint64_t>(stats.sweeps);
  ledger.wallHits += stats.wallHits;
  ledger.leaks += stats.leaks;
  ledger.crushed += stats.crushed;
  ledger.maxDensityError = std::max(ledger.maxDensityError, stats.maxCompression);
  ledger.densityErrorTime += stats.meanCompression * dt;
  ledger.impulse += stats.gravityImpulse + rigidStats.impulse - impulses.outside();
  ledger.work += outsideWork(stats, after, dt);
  ledger.maxKinetic = std::max(ledger.maxKinetic, after.kinetic);
  ledger.maxSpeed = std::max(ledger.maxSpeed, after.maxSpeed);
  const double gain = after.energy() - ledger.energy0 - ledger.work;
  ledger.energyDrift = std::max(ledger.energyDrift, gain / energyScale());
  ledger.dissipation = -gain;
  present = after;
}

}  // namespace froude
