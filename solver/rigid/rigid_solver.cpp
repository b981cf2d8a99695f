#include <froude/solver/rigid/rigid_solver.h>

#include <algorithm>

#include <froude/solver/contact/time_of_impact.h>

namespace froude {
namespace {

constexpr double kSubstep = 1.0 / 240.0;  // [s]
constexpr std::size_t kBlock = 256;       // bodies a task
constexpr std::size_t kCrewFrom = 64;     // contacts that are worth a second thread
// Of √(g·size): slower than this for so long, a body may sleep.
constexpr double kStillSpeed = 0.01;
constexpr double kStillTime = 0.5;  // [s]
constexpr double kFast = 0.5;       // thicknesses that a pair comes nearer in a step, from which on it is followed
constexpr int kImpactRounds = 3;
constexpr double kSlop = 1e-3;  // of the thickness: contacts are found this much before they touch

int substepsFor(double dt) { return std::max(1, static_cast<int>(std::ceil(dt / kSubstep - 1e-6))); }

}  // namespace

void RigidSolver::admitBodies(const BodySet& bodies) {
  if (version_ == bodies.version()) return;
  version_ = bodies.version();
  list_.rebuild(domain_, bodies);
  const std::size_t n = bodies.size() + 1;
  poses_.pose.assign(n, Transform());
  poses_.drift.assign(n, Vec2(0.0, 0.0));
  poses_.spread.assign(n, 0.0);
  poses_.thickness.assign(n, kInfinity);
  poses_.still.assign(n, 1);
  bodies_.assign(n, {});
  awake_.assign(n, 0);
  onBody_.assign(n, {0.0, 0.0, 0.0});
  felt_.assign(n, {});
  hinged_.clear();
  free_.assign(n, 0);
  isHinged_.assign(n, 0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    free_[i] = bodies.isFree(i) ? 1 : 0;
    if (!bodies.definition(i).hinge) continue;
    hinged_.push_back(static_cast<std::uint32_t>(i));
    isHinged_[i] = 1;
  }
  gravityOf_.resize(blockCount(n, kBlock));
  motorImpulse_.assign(hinged_.size(), 0.0);
  spinBefore_.assign(hinged_.size(), 0.0);
}

// A body can get as far as its velocity, what gravity and pressure add, and a little more for what others push.
void RigidSolver::findPoses(const RigidStep& step, const BodySet& bodies, Crew& crew) {
  crew.stage(bodies.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BodyMotion& m = bodies.motion(i);
      poses_.pose[i] = m.transform();
      const bool free = free_[i] != 0;
      const FreeState& f = bodies.freeState(i);
      const Vec2 v = free ? f.velocity : m.velocity;
      const double w = free ? f.spin : m.spin;
      awake_[i] = free && f.asleep == 0.0;
      const bool moves = free ? awake_[i] != 0 : v.squaredNorm() > 0.0 || w != 0.0;
      poses_.still[i] = moves ? 0 : 1;
      poses_.thickness[i] = free ? list_.thickness(i) : kInfinity;
      poses_.drift[i] = moves ? Vec2(step.dt * v) : Vec2(0.0, 0.0);
      poses_.spread[i] = kSlop * list_.thickness(i);
      if (!moves) continue;
      poses_.spread[i] += step.dt * std::abs(w) * bodies.radius(i);
      if (free) poses_.spread[i] += 2.0 * step.gravityScale * step.dt * step.dt + 0.5 * poses_.margin(i, i);
    }
  });
}

// Whoever touches one that is awake, or something that is driven, is awake with all that it touches.
void RigidSolver::wakeIslands(BodySet& bodies) {
  islands_.join(list_.touching(), free_);
  const auto n = static_cast<std::uint32_t>(bodies.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    if (awake_[i] != 0) islands_.stir(i);
  }
  islands_.stirByDriven(list_.touching(), free_, poses_.still);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (free_[i] == 0 || awake_[i] != 0 || islands_.rests(i)) continue;
    awake_[i] = 1;
    bodies.wake(i);
  }
}

// Bodies that touch nothing in this step.
void RigidSolver::findFlying(const BodySet& bodies) {
  flies_.assign(bodies.size() + 1, 1);
  for (const ContactRef& c : list_.touching()) flies_[c.bodyA] = flies_[c.bodyB] = 0;
}

void RigidSolver::loadBodies(const BodySet& bodies, Crew& crew) {
  crew.stage(bodies.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      SolverBody& b = bodies_[i];
      b = {};
      onBody_[i] = {0.0, 0.0, 0.0};
      if (free_[i] != 0) {
        if (awake_[i] == 0) continue;
        const FreeState& f = bodies.freeState(i);
        b.vx = f.velocity.x(), b.vy = f.velocity.y(), b.w = f.spin;
      } else {
        const BodyMotion& m = bodies.motion(i);
        b.vx = m.velocity.x(), b.vy = m.velocity.y(), b.w = m.spin;
      }
    }
  });
  bodies_.back() = {};
  onBody_.back() = {0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < hinged_.size(); ++k) spinBefore_[k] = bodies_[hinged_[k]].w;
}

Vec2 RigidSolver::accelerationOf(const RigidStep& step, const BodySet& bodies, std::size_t i) const {
  const SolverBody& b = bodies_[i];
  return step.gravity(poses_.pose[i].position + Vec2(b.dx, b.dy)) +
         bodies.mass(i).inverseMass * bodies.freeState(i).pressure;
}

void RigidSolver::integrateVelocities(const RigidStep& step, const BodySet& bodies, double h, RigidStats& stats,
                                      Crew& crew) {
  crew.stage(bodies.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::array<double, 3> sum{0.0, 0.0, 0.0};
    for (std::size_t i = begin; i < end; ++i) {
      if (awake_[i] == 0) continue;
      SolverBody& b = bodies_[i];
      const MassData& mass = bodies.mass(i);
      const FreeState& f = bodies.freeState(i);
      const Vec2 g = step.gravity(poses_.pose[i].position + Vec2(b.dx, b.dy));
      const Vec2 a = g + mass.inverseMass * f.pressure;
      b.vx += h * a.x();
      b.vy += h * a.y();
      b.w += h * mass.inverseInertia * f.pressureTorque;
      const Vec2 impulse = h * mass.mass * g;
      sum[0] += impulse.x();
      sum[1] += impulse.y();
      sum[2] += impulse.dot(Vec2(b.vx, b.vy)) - 0.5 * mass.inverseMass * impulse.squaredNorm();
    }
    gravityOf_[begin / kBlock] = sum;
  });
  // In the order of the blocks: the sum must not depend on threads.
  for (std::size_t block = 0; block < blockCount(bodies.size(), kBlock); ++block) {
    const auto& [x, y, work] = gravityOf_[block];
    stats.impulse += Vec2(x, y);
    stats.gravityWork += work;
  }
}

// The point of the hinge stays where it is: what is left of a motion is its turning about that point, with the momentum
// that it has about it. Exact, so that a pendulum integrates its angle alone.
void RigidSolver::solveHinges(const BodySet& bodies, double h, bool last, RigidStats& stats) {
  for (std::size_t k = 0; k < hinged_.size(); ++k) {
    const std::uint32_t i = hinged_[k];
    if (awake_[i] == 0) continue;
    SolverBody& b = bodies_[i];
    const MassData& mass = bodies.mass(i);
    const HingeDef& hinge = *bodies.definition(i).hinge;
    const Vec2 start = poses_.pose[i].rotation.apply(bodies.hingeAnchor(i));
    const Vec2 arm = -Rotation{b.c, b.s}.apply(start);  // from the hinge to the centre of mass
    const Vec2 v(b.vx, b.vy);
    const double inertia = mass.inertia + mass.mass * arm.squaredNorm();
    double w = (mass.inertia * b.w + mass.mass * cross(arm, v)) / inertia;
    if (hinge.motor) {
      const double most = hinge.motor->torque * h;
      const double impulse = std::clamp(motorImpulse_[k] + inertia * (hinge.motor->speed - w), -most, most);
      const double change = impulse - motorImpulse_[k];
      w += change / inertia;
      // Over the whole sub-step: what a brake takes of a velocity that never became motion is no work.
      if (last) stats.work += 0.5 * impulse * (spinBefore_[k] + w);
      motorImpulse_[k] = last ? 0.0 : impulse;
    }
    if (last) spinBefore_[k] = w;
    const Vec2 turned = cross(w, arm);
    const Vec2 impulse = mass.mass * (turned - v);
    stats.impulse += impulse;
    onBody_[i][0] += impulse.x(), onBody_[i][1] += impulse.y();
    onBody_[i][2] += mass.inertia * (w - b.w);
    b.vx = turned.x(), b.vy = turned.y(), b.w = w;
  }
}

void RigidSolver::integratePositions(const RigidStep& step, const BodySet& bodies, double h, Crew& crew) {
  crew.stage(bodies.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      SolverBody& b = bodies_[i];
      if ((poses_.still[i] != 0 && awake_[i] == 0) || isHinged_[i] != 0) continue;
      const double w = b.w + b.pw;
      const Rotation turn = Rotation::of(b.turn + h * w);
      b.dx += h * (b.vx + b.px);
      b.dy += h * (b.vy + b.py);
      if (flies_[i] != 0) {  // nothing but gravity acts: exactly on its parabola
        const Vec2 back = 0.5 * h * h * accelerationOf(step, bodies, i);
        b.dx -= back.x(), b.dy -= back.y();
      }
      b.turn += h * w;
      b.c = turn.c, b.s = turn.s;
      b.px = b.py = b.pw = 0.0;
    }
  });
}

// What sleepers bear they bear on, as in their last sub-step awake.
void RigidSolver::addSleeping(double dt) {
  for (const ContactRef& ref : list_.touching()) {
    if (awake_[ref.bodyA] != 0 || awake_[ref.bodyB] != 0) continue;
    const Contact& c = list_.contacts()[ref.contact];
    for (std::uint32_t k = 0; k < c.count; ++k) {
      const ContactPoint& p = c.points[k];
      const Vec2 impulse = dt * (p.normalForce * c.normal + p.tangentForce * leftNormal(c.normal));
      auto give = [&](std::uint32_t body, const Vec2& to) {
        std::array<double, 3>& sum = onBody_[body];
        sum[0] += to.x(), sum[1] += to.y(), sum[2] += cross(Vec2(p.at - poses_.pose[body].position), to);
      };
      give(c.bodyA, -impulse);
      give(c.bodyB, impulse);
    }
  }
}

// Hinged bodies turn about their hinge, and their velocity with them: of the angle alone this is the symplectic Euler
// method, which keeps a pendulum's swing.
void RigidSolver::turnHinged(const BodySet& bodies, double h, RigidStats& stats) {
  for (const std::uint32_t i : hinged_) {
    if (awake_[i] == 0) continue;
    SolverBody& b = bodies_[i];
    b.turn += h * (b.w + b.pw);
    const Rotation turn = Rotation::of(b.turn);
    const Vec2 start = poses_.pose[i].rotation.apply(bodies.hingeAnchor(i));
    const Vec2 now = turn.apply(start);
    const Vec2 v = cross(b.w, Vec2(-now));
    const Vec2 impulse = bodies.mass(i).mass * (v - Vec2(b.vx, b.vy));
    stats.impulse += impulse;
    onBody_[i][0] += impulse.x(), onBody_[i][1] += impulse.y();
    b.dx = start.x() - now.x(), b.dy = start.y() - now.y();
    b.vx = v.x(), b.vy = v.y();
    b.c = turn.c, b.s = turn.s;
    b.px = b.py = b.pw = 0.0;
  }
}

void RigidSolver::storeMotions(const RigidStep& step, BodySet& bodies, Crew& crew) {
  const double rate = 1.0 / step.dt;
  crew.stage(bodies.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      felt_[i] = {{onBody_[i][0], onBody_[i][1]}, onBody_[i][2]};
      if (free_[i] == 0) continue;
      const SolverBody& b = bodies_[i];
      FreeState& f = bodies.freeState(i);
      if (awake_[i] != 0) {
        f.velocity = {b.vx, b.vy};
        f.spin = b.w;
      }
      bodies.setMotion(i, rate * Vec2(b.dx, b.dy), rate * b.turn);
    }
  });
}

// Pairs without contact points that come much nearer to each other in the step are followed to where they meet, and
// what contacts move stops there until the next step. Pairs with points are the contact solver's matter.
void RigidSolver::stopAtImpacts(const RigidStep& step, BodySet& bodies, Crew& crew) {
  for (int round = 0; round < kImpactRounds; ++round) {  // what stops may be in the way of what follows
    findFastPairs(step, bodies);
    if (fastPairs_.empty() || !stopFastPairs(step, bodies, crew)) return;
  }
}

void RigidSolver::findFastPairs(const RigidStep& step, const BodySet& bodies) {
  fastPairs_.clear();
  const auto n = static_cast<std::uint32_t>(bodies.size());
  auto way = [&](std::uint32_t i) { return i == n ? Vec2(0.0, 0.0) : Vec2(step.dt * bodies.motion(i).velocity); };
  auto sweep = [&](std::uint32_t i) {
    return i == n ? 0.0 : step.dt * std::abs(bodies.motion(i).spin) * bodies.radius(i);
  };
  travel_.resize(n + 1);
  for (std::uint32_t i = 0; i <= n; ++i) travel_[i] = 1.000001 * (way(i).norm() + sweep(i));
  for (const ContactRef& c : list_.apart()) {
    const double much = kFast * std::min(poses_.thickness[c.bodyA], poses_.thickness[c.bodyB]);
    if (travel_[c.bodyA] + travel_[c.bodyB] <= much || (awake_[c.bodyA] == 0 && awake_[c.bodyB] == 0)) continue;
    const double nearer = (way(c.bodyB) - way(c.bodyA)).norm() + sweep(c.bodyA) + sweep(c.bodyB);
    if (nearer > much) fastPairs_.push_back({c.contact, step.dt});
  }
}

bool RigidSolver::stopFastPairs(const RigidStep& step, BodySet& bodies, Crew& crew) {
  const std::vector<Contact>& contacts = list_.contacts();
  auto motionOf = [&](std::uint32_t i) {
    if (i == bodies.size()) return RigidMotion{Transform(), {0.0, 0.0}, 0.0};
    const BodyMotion& m = bodies.motion(i);
    return RigidMotion{poses_.pose[i], m.velocity, m.spin};
  };
  crew.stage(fastPairs_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Contact& c = contacts[fastPairs_[k].contact];
      const ConvexShape& a = list_.shape(c.a);
      const ConvexShape& b = list_.shape(c.b);
      const double target = kSlop * std::min(a.innerRadius(), b.innerRadius());
      const TimeOfImpact impact = timeOfImpact(a, motionOf(c.bodyA), b, motionOf(c.bodyB), step.dt, target);
      const bool stops = impact.status == ImpactStatus::Hit || impact.status == ImpactStatus::Failed;
      if (stops) fastPairs_[k].time = impact.time;
    }
  });
  impact_.assign(bodies.size() + 1, step.dt);
  for (const FastPair& pair : fastPairs_) {
    const Contact& c = contacts[pair.contact];
    for (const std::uint32_t i : {c.bodyA, c.bodyB}) impact_[i] = std::min(impact_[i], pair.time);
  }
  bool any = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (impact_[i] >= step.dt || awake_[i] == 0 || isHinged_[i] != 0) continue;
    const BodyMotion& m = bodies.motion(i);
    bodies.setMotion(i, impact_[i] / step.dt * m.velocity, impact_[i] / step.dt * m.spin);
    any = true;
  }
  return any;
}

// An island sleeps when all of it has hardly moved for a while.
void RigidSolver::fallAsleep(const RigidStep& step, BodySet& bodies, RigidStats& stats) {
  const auto n = static_cast<std::uint32_t>(bodies.size());
  islands_.calm();
  for (std::uint32_t i = 0; i < n; ++i) {
    if (awake_[i] == 0) continue;
    FreeState& f = bodies.freeState(i);
    const double speed = f.velocity.norm() + std::abs(f.spin) * bodies.radius(i);
    const bool driven = isHinged_[i] != 0 && bodies.definition(i).hinge->motor;
    const bool pushed = f.pressure.squaredNorm() > 0.0 || driven;
    const bool still = speed < kStillSpeed * std::sqrt(step.gravityScale * bodies.radius(i)) && !pushed;
    f.stillFor = still ? f.stillFor + step.dt : 0.0;
    if (f.stillFor < kStillTime) islands_.stir(i);
  }
  islands_.stirByDriven(list_.touching(), free_, poses_.still);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (awake_[i] == 0 || !islands_.rests(i)) continue;
    FreeState& f = bodies.freeState(i);
    stats.impulse -= bodies.mass(i).mass * f.velocity;
    f.asleep = 1.0;
    f.velocity = {0.0, 0.0};
    f.spin = 0.0;
    bodies.setMotion(i, {0.0, 0.0}, 0.0);
  }
}

void RigidSolver::advance(const RigidStep& step, BodySet& bodies, RigidStats& stats) {
  admitBodies(bodies);
  const int substeps = substepsFor(step.dt);
  const double h = step.dt / substeps;
  Crew::run(list_.contacts().size() >= kCrewFrom, [&](Crew& crew) {
    findPoses(step, bodies, crew);
    list_.update(bodies, poses_, crew);
    wakeIslands(bodies);
    loadBodies(bodies, crew);
    findFlying(bodies);
    solver_.prepare(list_, bodies, poses_, awake_, {h, step.dt, step.gravityScale}, crew);
    for (int k = 0; k < substeps; ++k) {
      integrateVelocities(step, bodies, h, stats, crew);
      solver_.warmStart(bodies_, crew);
      solveHinges(bodies, h, false, stats);
      solver_.solve(bodies_, crew);
      solveHinges(bodies, h, false, stats);
      solver_.push(bodies_, crew);
      integratePositions(step, bodies, h, crew);
      turnHinged(bodies, h, stats);
      solver_.bounce(bodies_, crew);
      solveHinges(bodies, h, true, stats);
    }
    const ContactTotals totals = solver_.finish(bodies_, list_, onBody_, crew);
    stats.impulse += totals.outside;
    stats.work += totals.work;
    addSleeping(step.dt);
    storeMotions(step, bodies, crew);
    stopAtImpacts(step, bodies, crew);
  });
  fallAsleep(step, bodies, stats);
}

double RigidSolver::travelTime(const BodySet& bodies) const {
  double time = kInfinity;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies.isFree(i)) continue;
    const double speed = bodies.freeState(i).velocity.norm();
    if (speed > 0.0) time = std::min(time, 0.5 * bodies.thickness(i) / speed);
  }
  return time;
}

void RigidSolver::archive(const BodySet& bodies, Archive& a) {
  if (a.loading()) version_ = ~std::uint64_t{0};
  admitBodies(bodies);
  list_.archive(a);
}

}  // namespace froude
