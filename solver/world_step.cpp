// The stages of a sub-step.
#include <froude/base/parallel.h>
#include <froude/solver/particle_sums.h>
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

constexpr double kLargestTurn = 0.5;         // [rad] of a body in a sub-step
constexpr double kLargestBodyTravel = 0.25;  // of the support radius in a sub-step, where there is a fluid
// A heap that is thrown together is met in small steps; what is faster yet is followed to its impacts.
constexpr double kShortestBodyStep = 1.0 / 960.0;  // [s]
constexpr double kSoftStep = 1.0 / 240.0;          // [s] longest of soft bodies, which divide it further
// Of the support radius; a soft wall that is stopped within a sub-step stands that much farther in or out of the fluid.
constexpr double kLargestSoftTravel = 0.125;
constexpr double kRoom = 0.85;  // [dx] between a particle that a nozzle lets in and any other

double wrapped(double x, double low, double high) { return x - std::floor((x - low) / (high - low)) * (high - low); }

}  // namespace

StepReport World::substep(double maxDt) {
  Impl& w = *impl_;
  StepReport report;
  if (!(maxDt > 0.0)) return report;
  w.ledger.steps += w.insideStep ? 0 : 1;
  if (!w.insideStep) w.events.clear();
  w.quarantine();
  w.admitEdits();
  w.openAccounts();
  w.feelForce();
  StepBound bound = w.chooseStep(maxDt);
  const StepLimit first = bound.limit;
  if (w.needsUndo()) w.snapshot.save([&](Archive& a) { w.archive(a); });
  for (int halving = 0;; ++halving) {
    StepStats stats;
    w.events.beginAttempt();
    w.advance(bound.dt, stats);
    w.judge(stats, bound.dt);
    if (stats.trouble == Trouble::None || !w.needsUndo()) {
      w.retire();
      w.emit(bound.dt);
      w.account(stats, bound.dt);
      report.dt = bound.dt;
      report.substeps = 1;
      report.limit = bound.limit;
      break;
    }
    w.snapshot.load([&](Archive& a) { w.archive(a); });
    w.events.dropAttempt();
    ++report.rejected;
    if (w.def.timeStep || halving == w.def.limits.halvings) {
      report.limit = first;
      report.trouble = stats.trouble;
      report.troubleValue = stats.troubleValue;
      report.troubleLimit = stats.troubleLimit;
      report.troubleAt = stats.troubleAt;
      break;
    }
    bound = {0.5 * bound.dt, StepLimit::Undone};
  }
  ++w.version;
  w.ledger.rejected += static_cast<std::uint64_t>(report.rejected);
  w.ledger.limits[static_cast<std::size_t>(report.limit)] += static_cast<std::uint64_t>(report.substeps);
  return report;
}

StepReport World::step(double dt) {
  StepReport total;
  if (!(dt > 0.0) || !std::isfinite(dt)) return total;
  ++impl_->ledger.steps;
  impl_->insideStep = true;
  impl_->events.clear();
  const double end = time() + dt;
  // The last sub-step ends at the end to rounding; what is left is then below the resolution of time.
  while (end - time() > 1e-12 * std::max(1.0, end)) {
    const StepReport part = substep(end - time());
    total.dt += part.dt;
    total.substeps += part.substeps;
    total.rejected += part.rejected;
    total.limit = part.limit;
    total.trouble = part.trouble;
    total.troubleValue = part.troubleValue;
    total.troubleLimit = part.troubleLimit;
    total.troubleAt = part.troubleAt;
    if (!part.ok()) break;
  }
  impl_->insideStep = false;
  return total;
}

StepBound World::Impl::chooseStep(double maxDt) const {
  if (def.timeStep) return {*def.timeStep, StepLimit::Literal};
  StepBound bound{kFreeStep, StepLimit::Requested};
  if (fluidModel != nullptr) {
    const StepBound fluidBound = fluidModel->stepBound(*fluid, present.maxSpeed, accelerationScale());
    bound.tighten(fluidBound.dt, fluidBound.limit);
  }
  if (ballistic != nullptr) bound.tighten(bulletStepBound(*def.bullet, accelerationScale()), StepLimit::Bullet);
  if (soft != nullptr) {
    bound.tighten(kSoftStep, StepLimit::Soft);
    if (fluidModel != nullptr && fluidModel->feelsSoftWalls()) {
      const double speed = soft->fastest();
      if (speed > 0.0) bound.tighten(kLargestSoftTravel * fluidModel->supportRadius() / speed, StepLimit::Wall);
    }
    if (present.maxSpeed > 0.0) bound.tighten(soft->spacing() / present.maxSpeed, StepLimit::Soft);
  }
  if (bodies.anyMoves()) {
    const double spin = bodies.maxSpin();
    if (spin > 0.0) bound.tighten(kLargestTurn / spin, StepLimit::Spin);
    const double speed = bodies.maxSurfaceSpeed();
    if (fluidModel != nullptr && speed > 0.0) {
      bound.tighten(kLargestBodyTravel * fluidModel->supportRadius() / speed, StepLimit::Wall);
    }
  }
  if (bodies.anyFree()) bound.tighten(std::max(kShortestBodyStep, rigid.travelTime(bodies)), StepLimit::Body);
  if (maxDt <= bound.dt) return {maxDt, StepLimit::Requested};
  // Two equal halves instead of a full step and a sliver.
  if (maxDt < 2.0 * bound.dt) bound.dt = 0.5 * maxDt;
  return bound;
}

// What came in broken (a user's columns, say) is taken out before it spreads.
void World::Impl::quarantine() {
  if (started && !edited && present.finite) return;  // nothing came in since the last sub-step was found sound
  auto check = [&](ParticlePool& pool, double mass) {
    if (sumParticles(pool, def.simd).finite()) return;
    const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
    const double bad = parallelSum(pool.size(), [&](std::size_t begin, std::size_t end) {
      double count = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        if (std::isfinite(x[i] + y[i] + vx[i] + vy[i])) continue;
        pool.kill(static_cast<std::uint32_t>(i));
        ++count;
      }
      return count;
    });
    if (bad > 0.0) {
      ledger.quarantined += static_cast<std::uint64_t>(bad);
      ledger.massRetired += &pool == fluid.get() ? bad * mass : 0.0;
      pool.compact();
    }
  };
  if (fluid != nullptr) check(*fluid, fluidModel->particleMass());
  if (bullets != nullptr) check(*bullets, ballistic->mass());
}

void World::Impl::advance(double dt, StepStats& stats) {
  moveBodies(dt);
  const double reach = (fluidModel != nullptr ? fluidModel->supportRadius() : 0.0) +
                       (def.bullet ? def.bullet->radius : 0.0) + present.maxSpeed * dt + dt * dt * accelerationScale();
  if (anyParticles()) obstacles->beginStep(bodies, dt, 2.0 * reach);
  obstaclesBehind = !anyParticles();
  impulses.reset(bodies);
  FreeBodies freeBodies(bodies, *obstacles);
  freeBodies.begin(dt, 2.0 * reach);
  const bool wet = soft != nullptr && fluidModel != nullptr && fluidModel->feelsSoftWalls();
  SoftWalls* softWalls = wet ? &soft->showWalls(dt, fluidModel->supportRadius()) : nullptr;
  const StepContext context{time,
                            dt,
                            gravity,
                            *obstacles,
                            def.simd,
                            fluidCarried,
                            events.leakRecorder(),
                            bodies.anyFree() ? &freeBodies : nullptr,
                            softWalls,
                            present.maxSpeed,
                            accelerationScale()};
  pushByForce(dt, stats);
  if (fluidModel != nullptr) {
    impulses.setRecorder(events.listenTo(Species::Fluid, *fluid, bodies, time, dt));
    fluidModel->advance(context, *fluid, impulses, stats);
    events.finishSpecies();
    if (stats.trouble != Trouble::None) return;  // undone, or the end
  }
  if (ballistic != nullptr) {
    impulses.setRecorder(events.listenTo(Species::Bullet, *bullets, bodies, time, dt));
    ballistic->advance(context, *bullets, impulses, stats);
    events.finishSpecies();
  }
  if (soft != nullptr) {
    MetFluid met;
    if (fluid != nullptr) {
      met = {fluid.get(), 1.0 / fluidModel->particleMass(), 0.5 * def.fluid->spacing, filterOf(Species::Fluid), wet};
    }
    soft->advance(context, def.softSettings, bodies, fluid != nullptr ? &met : nullptr, impulses, stats);
  }
  explainLeaks(dt);
  finishForce(dt, stats);
  pushBodies(dt);
  publishBodies(dt);
  time += dt;
}

// With the pressure of the sub-step before; particles then meet the bodies where that brings them.
void World::Impl::moveBodies(double dt) {
  bodies.beginStep(time, dt);
  rigidStats = {};
  if (!bodies.anyFree()) return;
  const auto gravityAt = [&](const Vec2& x) { return gravity.at(x, time); };
  const RigidStep step{dt, gravityAt, gravityScale};
  pressureBefore.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    FreeState& f = bodies.freeState(i);
    pressureBefore[i] = {dt * f.pressure.x(), dt * f.pressure.y(), dt * f.pressureTorque};
  }
  rigid.advance(step, bodies, rigidStats);
}

// What particles gave, less what the bodies have of it already.
void World::Impl::pushBodies(double dt) {
  for (std::size_t i = 0; bodies.anyFree() && i < bodies.size(); ++i) {
    if (!bodies.isFree(i)) continue;
    const auto owner = static_cast<int>(i);
    const BodyMotion& m = bodies.motion(i);
    const Vec2 center = m.position + dt * m.velocity;
    const Vec2& impulse = impulses.impulse(owner);
    const Wrench& had = pressureBefore[i];
    giveImpulse(bodies, i,
                {impulse.x() - had[0], impulse.y() - had[1], impulses.moment(owner) - cross(center, impulse) - had[2]});
  }
}

// The body as it stands between sub-steps.
BodyState World::Impl::stateOf(std::size_t i) const {
  const BodyMotion& m = bodies.motion(i);
  const bool free = bodies.isFree(i);
  const FreeState& f = bodies.freeState(i);
  BodyState state;
  state.angle = m.angle;
  state.transform = m.transform();
  if (free) state.transform.position = state.transform.toWorld(-bodies.frameOrigin(i));
  state.velocity = free ? f.velocity : m.velocity;
  state.spin = free ? f.spin : m.spin;
  state.asleep = f.asleep != 0.0;
  return state;
}

// From the frame's origin to the centre of mass at the start of the sub-step, where contacts are felt.
Vec2 World::Impl::centerArmBefore(std::size_t i, double dt) const {
  const BodyMotion& m = bodies.motion(i);
  return Rotation::of(m.angle - dt * m.spin).apply(bodies.definition(i).shape->centroid() - bodies.frameOrigin(i));
}

void World::Impl::publishBodies(double dt) {
  const bool anyFree = bodies.anyFree();
  bodies.finishStep(dt);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto owner = static_cast<int>(i);
    const Vec2 center =
        bodies.motion(i).transform().toWorld(bodies.definition(i).shape->centroid() - bodies.frameOrigin(i));
    BodyState state = stateOf(i);
    state.force = impulses.impulse(owner) / dt;
    state.torque = (impulses.moment(owner) - cross(center, impulses.impulse(owner))) / dt;
    if (anyFree) {
      const BodyImpulse& felt = rigid.felt(i);
      state.force += felt.impulse / dt;
      state.torque += (felt.moment - cross(centerArmBefore(i, dt), felt.impulse)) / dt;
    }
    bodyStates[i] = state;
  }
}

void World::Impl::judge(StepStats& stats, double dt) {
  judged.reset();
  membersChanged = false;
  if (stats.trouble != Trouble::None || !needsUndo()) return;
  judged = balance();
  const Balance& after = *judged;
  auto fail = [&](Trouble why, double value, double limit) {
    stats.trouble = why;
    stats.troubleValue = value;
    stats.troubleLimit = limit;
    if (fluidModel != nullptr) stats.troubleAt = fastestParticle();
  };
  if (!after.finite || !std::isfinite(stats.maxCompression)) {
    fail(Trouble::NonFinite, std::nan(""), 0.0);
    return;
  }
  if (fluidModel != nullptr) {
    const double travel = after.maxSpeed * dt / fluidModel->farthestTravel();
    if (travel > def.limits.displacement) {
      fail(Trouble::Displacement, travel, def.limits.displacement);
      return;
    }
    if (const double compression = fluidModel->judgedCompression(stats); compression > def.limits.compression) {
      fail(Trouble::Compression, compression, def.limits.compression);
      return;
    }
  }
  const double gain = (after.energy() - ledger.energy0 - ledger.work - outsideWork(stats, after, dt)) / energyScale();
  if (gain > def.limits.energyGain) fail(Trouble::EnergyGain, gain, def.limits.energyGain);
}

// What stands where a nozzle lets particles in during a sub-step.
void World::Impl::findMouth(const EmitterDef& nozzle, double dt) {
  const double dx = def.fluid->spacing;
  Box box;
  for (const Vec2& p : {nozzle.from, nozzle.to}) {
    box.include(p);
    box.include(Vec2(p + dt * nozzle.speed * leftNormal(nozzle.to - nozzle.from).normalized()));
  }
  box = box.grown(2.0 * dx);
  mouth.clear();
  for (std::size_t i = 0; i < fluid->size(); ++i) {
    const Vec2 at(fluid->x()[i], fluid->y()[i]);
    if (box.contains(at)) mouth.push_back(at);
  }
}

// A particle that were put among others would be thrown out by their pressure. Rows of a nozzle are a spacing apart.
bool World::Impl::hasRoom(const Vec2& at) {
  const double least = kRoom * def.fluid->spacing;
  for (const Vec2& other : mouth) {
    if ((other - at).squaredNorm() < least * least) return false;
  }
  mouth.push_back(at);
  return true;
}

void World::Impl::emit(double dt) {
  for (std::size_t k = 0; k < emitters.size(); ++k) {
    Emitter& emitter = emitters[k];
    const bool isFluid = emitter.def().kind == EmitterDef::Kind::Fluid;
    ParticlePool& pool = isFluid ? *fluid : *bullets;
    const double mass = isFluid ? fluidModel->particleMass() : ballistic->mass();
    const auto sourceColumn = isFluid ? fluidSource : bulletSource;
    const auto expiresColumn = isFluid ? fluidExpires : bulletExpires;
    const double start = time - dt;
    const std::size_t pending = emitter.pending(start, dt);
    if (pending == 0) continue;
    const auto tag = static_cast<std::uint32_t>(k + 1);
    const std::size_t live = countWith(pool, sourceColumn, tag);
    if (emitter.def().policy == GrowthPolicy::RecycleOldest && live + pending > emitter.def().limit) {
      const std::size_t old = markOldestWith(pool, sourceColumn, tag, live + pending - emitter.def().limit);
      ledger.recycled += old;
      std::uint64_t removed = 0;
      remove(pool, mass, removed);
    }
    if (isFluid) findMouth(emitter.def(), dt);
    auto place = [&](const Vec2& position, const Vec2& velocity) {
      if (isFluid && !hasRoom(position)) {
        ++ledger.refused;
        return;
      }
      const ParticleHandle handle = pool.tryCreate();
      if (handle.isNull()) {
        ++ledger.refused;
        return;
      }
      membersChanged = true;
      const std::size_t i = pool.size() - 1;
      pool.x()[i] = position.x();
      pool.y()[i] = position.y();
      pool.vx()[i] = velocity.x();
      pool.vy()[i] = velocity.y();
      pool.column(sourceColumn)[i] = tag;
      pool.column(expiresColumn)[i] = emitter.expiry(time);
      if (isFluid) {
        // A piston: what has come less than the support radius far is not pushed back into the nozzle.
        const double way = velocity.normalized().dot(position - emitter.def().from);
        pool.column(*fluidCarried)[i] = time + (fluidModel->supportRadius() - way) / emitter.def().speed;
      }
      ++ledger.emitted;
      if (isFluid) ledger.massEmitted += mass;
      ledger.impulse += mass * velocity;
      ledger.work += mass * (0.5 * velocity.squaredNorm() + potentialOf(position));
    };
    const std::uint64_t before = emitter.refused();
    // More than the limit in one sub-step would be its own oldest.
    const bool recycles = emitter.def().policy == GrowthPolicy::RecycleOldest;
    emitter.emit(start, dt, place, recycles ? emitter.def().limit : emitter.room(live));
    ledger.refused += emitter.refused() - before;
  }
}

void World::Impl::tellSinks(const ParticlePool& pool) {
  if (!events.settings.sinks) return;
  const Species species = &pool == fluid.get() ? Species::Fluid : Species::Bullet;
  for (std::uint32_t i = 0; i < pool.size(); ++i) {
    if (!pool.isMarked(i)) continue;
    const Vec2 at(pool.x()[i], pool.y()[i]);
    events.addSink({species, pool.handleAt(i), static_cast<std::uint32_t>(sinks.sinkAt(at)), at, time});
  }
}

void World::Impl::retire() {
  const Box& box = def.domain.box;
  auto wrapAndMark = [&](ParticlePool& pool, std::size_t begin, std::size_t end) {
    const auto x = pool.x(), y = pool.y();
    for (std::size_t i = begin; i < end; ++i) {
      const bool inside = x[i] >= box.min.x() && x[i] < box.max.x() && y[i] >= box.min.y() && y[i] < box.max.y();
      if (inside) continue;
      if (def.domain.periodicX) x[i] = wrapped(x[i], box.min.x(), box.max.x());
      if (def.domain.periodicY) y[i] = wrapped(y[i], box.min.y(), box.max.y());
      if (!box.contains({x[i], y[i]})) pool.kill(static_cast<std::uint32_t>(i));
    }
  };
  auto takenOut = [&](ParticlePool& pool, double mass, ColumnId<double> expires) {
    if (!sinks.empty() && sinks.mark(pool) > 0) {
      tellSinks(pool);
      remove(pool, mass, ledger.sunk);
    }
    if (anyLifetime && markExpired(pool, expires, time) > 0) remove(pool, mass, ledger.expired);
  };
  std::uint64_t crushed = 0;  // what the models marked; their own counters have it
  if (fluid != nullptr) {
    remove(*fluid, fluidModel->particleMass(), crushed);
    parallelFor(fluid->size(), [&](std::size_t begin, std::size_t end) { wrapAndMark(*fluid, begin, end); });
    remove(*fluid, fluidModel->particleMass(), ledger.retired);
    takenOut(*fluid, fluidModel->particleMass(), fluidExpires);
  }
  if (bullets != nullptr) {
    // Bullets know the blocks in which one was marked or left; most steps of most blocks have none.
    const auto left = ballistic->left();
    if (bullets->anyMarked() || std::any_of(left.begin(), left.end(), [](std::uint8_t any) { return any != 0; })) {
      const std::size_t crushedBefore = crushed;
      remove(*bullets, ballistic->mass(), crushed);
      const bool moved = crushed != crushedBefore;  // indices are not those of the blocks any more
      parallelFor(bullets->size(), [&](std::size_t begin, std::size_t end) {
        if (moved || left[begin / kBlockSize] != 0) wrapAndMark(*bullets, begin, end);
      });
      remove(*bullets, ballistic->mass(), ledger.retired);
    }
    takenOut(*bullets, ballistic->mass(), bulletExpires);
  }
}

}  // namespace froude
