#include <froude/solver/soft/soft_bodies.h>

#include <algorithm>
#include <cmath>

#include <froude/base/parallel.h>
#include <froude/base/transform.h>

namespace froude {
namespace {

// Of the largest part with which the predictor alone would be stable, 2/ω. With the sweep a body at rest is stable up
// to 1.5 of it (measured); the rest is for what is compressed. A box of 200 kg that bounces on a block shows 4 % of the
// energy too much for moments at 0.8, 0.004 % at half of that: velocities are those of half a part before.
constexpr double kPartOfBound = 0.5;
constexpr double kUntangle = 0.02;         // of the way to the rest shape in a part
constexpr int kMostSweeps = 50;            // of a part
constexpr std::size_t kColorBlock = 1024;  // elements of a colour that one thread takes at once

// About the centre of mass.
struct Spin {
  Vec2 center{0, 0};
  double angular = 0.0, inertia = 0.0;
};

Spin spinOf(const SoftBody& b, const double* x, const double* y, const double* vx, const double* vy) {
  Spin s;
  for (std::size_t k = 0; k < b.points(); ++k) {
    s.center += b.mass[k] / b.totalMass * Vec2(x[k], y[k]);
  }
  for (std::size_t k = 0; k < b.points(); ++k) {
    const Vec2 arm = Vec2(x[k], y[k]) - s.center;
    s.inertia += b.mass[k] * arm.squaredNorm();
    s.angular += b.mass[k] * cross(arm, Vec2(vx[k], vy[k]));
  }
  return s;
}

template <typename Loop>
void forEachColor(const StrainElements& elements, Loop&& loop) {
  for (std::size_t c = 0; c + 1 < elements.colors.size(); ++c) {
    const std::size_t first = elements.colors[c], count = elements.colors[c + 1] - first;
    if (count <= kColorBlock) {
      loop(first, first + count);
    } else {
      parallelFor(count, kColorBlock, [&](std::size_t begin, std::size_t end) { loop(first + begin, first + end); });
    }
  }
}

}  // namespace

SoftBodies::SoftBodies(bool wet)
    : pool_(PoolSettings{1024, GrowthPolicy::Grow, "soft"}),
      mass_(pool_.addColumn<double>("mass", ColumnKind::State)),
      bodyOf_(pool_.addColumn<std::uint32_t>("body", ColumnKind::State)) {
  auto column = [&](const char* name) { return pool_.addColumn<double>(name, ColumnKind::State); };
  if (wet) wet_ = {column("force_x"), column("force_y"), column("next_vx"), column("next_vy")};
}

void SoftBodies::add(SoftDef def) {
  auto body = std::make_unique<SoftBody>(std::move(def));
  const SoftDef& d = body->def;
  const std::size_t count = body->points();
  pool_.reserve(pool_.size() + count);
  first_.push_back(pool_.size());
  const Transform pose = Transform::of(d.position, d.angle);
  Vec2 center(0.0, 0.0);
  for (std::size_t k = 0; k < count; ++k) center += body->mass[k] / body->totalMass * d.mesh->points[k];
  center = pose.toWorld(center);
  for (std::size_t k = 0; k < count; ++k) {
    pool_.create();
    const std::size_t i = pool_.size() - 1;
    const Vec2 at = pose.toWorld(d.mesh->points[k]);
    const Vec2 v = body->inverseMass[k] > 0.0 ? Vec2(d.velocity + cross(d.spin, Vec2(at - center))) : Vec2(0.0, 0.0);
    pool_.x()[i] = at.x();
    pool_.y()[i] = at.y();
    pool_.vx()[i] = v.x();
    pool_.vy()[i] = v.y();
    pool_.column(mass_)[i] = body->mass[k];
    pool_.column(bodyOf_)[i] = static_cast<std::uint32_t>(bodies_.size());
    if (!wet_) continue;
    pool_.column(wet_->nextX)[i] = v.x();
    pool_.column(wet_->nextY)[i] = v.y();
  }
  frequencySquared_ = std::max(frequencySquared_, body->frequencySquared);
  spacing_ = std::min(spacing_, d.spacing);
  totalMass_ += body->totalMass;
  bodies_.push_back(std::move(body));
  const std::size_t rows = pool_.size() + bodies_.size();
  for (auto* column : {&x_, &y_, &vx_, &vy_, &fx_, &fy_, &fromX_, &fromY_, &startX_, &startY_, &middleX_, &middleY_,
                       &inverseMass_, &free_}) {
    column->resize(rows);
  }
  for (std::size_t k = 0; k < count; ++k) inverseMass_[offset(bodies_.size() - 1) + k] = bodies_.back()->inverseMass[k];
  touches_.resize(bodies_.size());
  meetings_.resize(bodies_.size());
  pairs_.add(*bodies_.back(), offset(bodies_.size() - 1));
  if (wet_) addWalls(bodies_.size() - 1);
  gravityImpulse_.resize(bodies_.size());
  touchImpulse_.resize(bodies_.size());
  pressureImpulse_.resize(bodies_.size());
  momentumBefore_.resize(bodies_.size());
  gravityWork_.resize(bodies_.size());
  sweeps_.resize(bodies_.size());
}

int SoftBodies::partsOf(double dt, const SoftSettings& settings) const {
  double part = kPartOfBound * 2.0 / std::sqrt(std::max(frequencySquared_, 1e-300));
  if (settings.substeps > 0) part = std::min(part, 1.0 / (60.0 * settings.substeps));
  return static_cast<int>(std::clamp(std::ceil(dt / part * (1.0 - 1e-12)), 1.0, 1e6));
}

NodeColumns SoftBodies::columnsOf(std::size_t i) {
  const std::size_t o = offset(i);
  return {x_.data() + o, y_.data() + o, fx_.data() + o, fy_.data() + o, inverseMass_.data() + o};
}

void SoftBodies::load(const StepContext& context) {
  parallelFor(count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t o = offset(i), f = first_[i];
      Vec2 momentum(0.0, 0.0);
      for (std::size_t k = 0; k < body(i).points(); ++k) {
        x_[o + k] = startX_[o + k] = pool_.x()[f + k];
        y_[o + k] = startY_[o + k] = pool_.y()[f + k];
        vx_[o + k] = pool_.vx()[f + k];
        vy_[o + k] = pool_.vy()[f + k];
        momentum += body(i).mass[k] * Vec2(vx_[o + k], vy_[o + k]);
        free_[o + k] = context.obstacles.clearance({x_[o + k], y_[o + k]}) - 0.5 * body(i).def.thickness;
      }
      bodies_[i]->tangled = body(i).isTangled(x_.data() + o, y_.data() + o);
      momentumBefore_[i] = momentum;
      gravityImpulse_[i] = touchImpulse_[i] = pressureImpulse_[i] = Vec2(0.0, 0.0);
      gravityWork_[i] = 0.0;
      sweeps_[i] = 0;
      touches_[i].clear();
    }
  });
}

void SoftBodies::store() {
  parallelFor(count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t o = offset(i), f = first_[i];
      for (std::size_t k = 0; k < body(i).points(); ++k) {
        pool_.x()[f + k] = x_[o + k];
        pool_.y()[f + k] = y_[o + k];
        pool_.vx()[f + k] = vx_[o + k];
        pool_.vy()[f + k] = vy_[o + k];
      }
    }
  });
}

template <typename Visit>
void SoftBodies::forEachBody(Visit&& visit) {
  parallelFor(count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) visit(i);
  });
}

SoftColumns SoftBodies::columns() {
  return {x_.data(), y_.data(), fromX_.data(), fromY_.data(), vx_.data(), vy_.data(), inverseMass_.data()};
}

void SoftBodies::advance(const StepContext& context, const SoftSettings& settings, BodySet& bodies,
                         const MetFluid* fluid, ImpulseLedger& impulses, StepStats& stats) {
  const int parts = partsOf(context.dt, settings);
  const double dt = context.dt / parts;
  load(context);
  if (fluid != nullptr && fluid->feelsWalls) takePressure(context.dt);
  pushed_.begin(bodies);
  pairs_.find(bodies_, columns(), bodies, fluid, context.dt);
  const bool alone = pairs_.pairCount() == 0 && !bodies.anyFree();
  for (int p = 0; p < parts; ++p) {
    if (wet_ && p == parts / 2) rememberMiddle();
    const Part part{dt, static_cast<double>(p) / parts, static_cast<double>(p + 1) / parts};
    pushed_.advance(dt);
    pairs_.advanceFluid(dt);
    forEachBody([&](std::size_t i) {
      move(context, part, settings.tolerance, i);
      if (!alone) return;
      meetObstacles(context, part, i);
      finish(context, part, i);
    });
    if (!alone) {
      pairs_.resolve(columns(), bodies, pushed_, part.begin * context.dt, part.end * context.dt, pairTouches_);
      forEachBody([&](std::size_t i) { meetObstacles(context, part, i); });
      for (std::size_t i = 0; i < count(); ++i) meetFreeBodies(context, part, i);
      forEachBody([&](std::size_t i) { finish(context, part, i); });
    }
    book(impulses);
  }
  if (fluid != nullptr) pairs_.storeFluid(*fluid);
  if (wet_) foresee(context.dt, parts);
  store();
  pushed_.store(bodies, context.dt);
  stats.softParts += static_cast<std::uint64_t>(parts);
  report(impulses, stats);
  for (std::size_t i = 0; i < count(); ++i) tear(i);
}

void SoftBodies::report(ImpulseLedger& impulses, StepStats& stats) {
  for (std::size_t i = 0; i < count(); ++i) {
    stats.gravityImpulse += gravityImpulse_[i];
    stats.gravityWork += gravityWork_[i];
    stats.sweeps += sweeps_[i];
    if (!body(i).anyPinned) continue;
    Vec2 momentum(0.0, 0.0);
    for (std::size_t k = 0; k < body(i).points(); ++k) {
      momentum += body(i).mass[k] * Vec2(vx_[offset(i) + k], vy_[offset(i) + k]);
    }
    // What holds the pinned points gave the rest.
    const Vec2 held = momentum - momentumBefore_[i] - gravityImpulse_[i] - touchImpulse_[i] - pressureImpulse_[i];
    const std::size_t pin = offset(i) + body(i).def.pinned.front();
    impulses.add(-1, {x_[pin], y_[pin]}, -held, {0.0, 0.0});
  }
}

// Towards the best fit of the rest shape, without its speed (finish): momentum stays, energy only goes.
void SoftBodies::untangle(std::size_t i) {
  const SoftBody& b = body(i);
  const auto& rest = b.def.mesh->points;
  const NodeColumns n = columnsOf(i);
  Vec2 from(0.0, 0.0), to(0.0, 0.0);
  for (std::size_t k = 0; k < rest.size(); ++k) {
    from += b.mass[k] / b.totalMass * rest[k];
    to += b.mass[k] / b.totalMass * Vec2(n.x[k], n.y[k]);
  }
  double along = 0.0, turn = 0.0;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const Vec2 p = rest[k] - from, q = Vec2(n.x[k], n.y[k]) - to;
    along += b.mass[k] * p.dot(q);
    turn += b.mass[k] * cross(p, q);
  }
  const Rotation rotation = Rotation::of(std::atan2(turn, along));
  for (std::size_t k = 0; k < rest.size(); ++k) {
    if (n.inverseMass[k] == 0.0) continue;
    const Vec2 goal = to + rotation.apply(rest[k] - from);
    n.x[k] += kUntangle * (goal.x() - n.x[k]);
    n.y[k] += kUntangle * (goal.y() - n.y[k]);
  }
}

// Elastic forces where the points are, and their multipliers.
void SoftBodies::feelStrain(const StepContext& context, std::size_t i) {
  const SoftBody& b = body(i);
  const std::size_t o = offset(i), end = o + b.points();
  std::fill(fx_.begin() + o, fx_.begin() + end, 0.0);
  std::fill(fy_.begin() + o, fy_.begin() + end, 0.0);
  if (!b.inflated.empty()) inflate(i);
  if (wet_) {
    const double *x = &pool_.column(wet_->forceX)[first_[i]], *y = &pool_.column(wet_->forceY)[first_[i]];
    for (std::size_t k = 0; k < b.points(); ++k) {
      fx_[o + k] += x[k];
      fy_[o + k] += y[k];
    }
  }
  if (!b.isStrain()) {
    bodies_[i]->links.force(columnsOf(i));
    return;
  }
  StrainElements& elements = bodies_[i]->elements;
  const StrainLoops loops = strainLoops(b.strainModel(), context.simd);
  forEachColor(elements,
               [&](std::size_t low, std::size_t high) { loops.force(b.lame, elements, columnsOf(i), low, high); });
}

// Half of the pressure on each edge to each of its ends, outwards.
void SoftBodies::inflate(std::size_t i) {
  const NodeColumns n = columnsOf(i);
  const double half = 0.5 * body(i).def.pressure;
  for (const auto& [a, b] : body(i).inflated) {
    const double dx = n.x[b] - n.x[a], dy = n.y[b] - n.y[a];
    n.fx[a] += half * dy;
    n.fy[a] -= half * dx;
    n.fx[b] += half * dy;
    n.fy[b] -= half * dx;
  }
}

// One sweep, or as many as bring the change of the multipliers in a sweep below the tolerance, relative to themselves.
int SoftBodies::correct(const StepContext& context, std::size_t i, double dt, double tolerance) {
  SoftBody& b = *bodies_[i];
  if (tolerance == 0.0 || !b.isStrain()) {
    project(context, i, dt);
    return 1;
  }
  for (int sweep = 1;; ++sweep) {
    for (std::size_t k = 0; k < 3; ++k) b.before[k].assign(b.elements.given[k].span());
    project(context, i, dt);
    double change = 0.0, size = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t e = 0; e < b.elements.size(); ++e) {
        const double now = b.elements.given[k][e], step = now - b.before[k][e];
        size += now * now;
        change += step * step;
      }
    }
    if (change <= tolerance * tolerance * size || sweep == kMostSweeps) return sweep;
  }
}

void SoftBodies::project(const StepContext& context, std::size_t i, double dt) {
  SoftBody& b = *bodies_[i];
  if (!b.clusters.empty()) b.clusters.project(b.matching, dt * dt, columnsOf(i));
  if (!b.isStrain()) {
    b.links.project(dt * dt, columnsOf(i));
    return;
  }
  StrainElements& elements = b.elements;
  const StrainLoops loops = strainLoops(b.strainModel(), context.simd);
  forEachColor(elements, [&](std::size_t begin, std::size_t end) {
    loops.project(b.lame, dt * dt, elements, columnsOf(i), begin, end);
  });
}

void SoftBodies::move(const StepContext& context, const Part& part, double tolerance, std::size_t i) {
  const SoftBody& b = body(i);
  const std::size_t o = offset(i), end = o + b.points();
  const double dt = part.dt, time = context.time + part.begin * context.dt;
  feelStrain(context, i);
  const bool constant = context.gravity.isConstant();
  Vec2 g = context.gravity.constant(), impulse(0.0, 0.0);
  for (std::size_t k = o; k < end; ++k) {
    fromX_[k] = x_[k];
    fromY_[k] = y_[k];
    const double w = inverseMass_[k];
    if (w == 0.0) continue;
    if (!constant) g = context.gravity.at({x_[k], y_[k]}, time);
    impulse += dt / w * g;
    x_[k] += dt * (vx_[k] + dt * (g.x() + w * fx_[k]));
    y_[k] += dt * (vy_[k] + dt * (g.y() + w * fy_[k]));
  }
  gravityImpulse_[i] += impulse;
  sweeps_[i] += correct(context, i, dt, tolerance);
  if (b.tangled) untangle(i);
}

void SoftBodies::finish(const StepContext& context, const Part& part, std::size_t i) {
  const SoftBody& b = body(i);
  const std::size_t o = offset(i), end = o + b.points();
  const double dt = part.dt, time = context.time + part.begin * context.dt, rate = 1.0 / dt;
  const Spin before = b.tangled ? spinOf(b, &fromX_[o], &fromY_[o], &vx_[o], &vy_[o]) : Spin();
  for (std::size_t k = o; k < end; ++k) {
    vx_[k] = rate * (x_[k] - fromX_[k]);
    vy_[k] = rate * (y_[k] - fromY_[k]);
  }
  if (!context.gravity.isConstant()) {
    double work = 0.0;
    for (std::size_t k = o; k < end; ++k) {
      if (inverseMass_[k] == 0.0) continue;
      const Vec2 g = context.gravity.at({fromX_[k], fromY_[k]}, time);
      work += g.dot(Vec2(x_[k] - fromX_[k], y_[k] - fromY_[k])) / inverseMass_[k];
    }
    gravityWork_[i] += work;
  }
  if (b.tangled) {
    damp(i, 0.0);
    // Large corrections one after the other turn the body; it is to spin as it did.
    const Spin now = spinOf(b, &x_[o], &y_[o], &vx_[o], &vy_[o]);
    const double change = b.anyPinned || now.inertia == 0.0 ? 0.0 : (before.angular - now.angular) / now.inertia;
    for (std::size_t k = o; k < end; ++k) {
      vx_[k] -= change * (y_[k] - now.center.y());
      vy_[k] += change * (x_[k] - now.center.x());
    }
  } else if (b.def.damping > 0.0) {
    damp(i, std::exp(-b.def.damping * dt));
  }
}

}  // namespace froude
