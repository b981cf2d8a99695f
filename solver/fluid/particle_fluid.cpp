#include <froude/solver/fluid/particle_fluid.h>

#include <array>
#include <limits>

#include <froude/base/parallel.h>
#include <froude/solver/coupling/free_bodies.h>
#include <froude/solver/coupling/leak_check.h>
#include <froude/solver/fluid/fluid_cells.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/lattice_sums.h>

namespace froude {
namespace {

constexpr double kDisplaced = 0.02;  // [dx] by which a wall has kept a particle from where it was to go
constexpr double kCellSlack = 1.05;  // cells are larger than the support, for motion inside a solve

}  // namespace

ParticleFluid::ParticleFluid(const FluidDef& def, const DomainDef& domain, ParticlePool& pool, const Settings& settings)
    : def_(def),
      domain_(domain),
      unit_(supportOf(def) / kernel::kSupport),
      volume_(latticeVolume(def.spacing / unit_, settings.kernel)),
      pressure_(pool.addColumn<float>("pressure", ColumnKind::State)),
      density_(pool.addColumn<float>("density", ColumnKind::State)),
      walls_(unit_,
             settings.kernel == kernel::Kind::Blend ? latticeRecession(def.spacing / unit_, settings.kernel) : 0.0,
             settings.kernel, {def.group, def.collidesWith}),
      tension_(def, unit_, volume_, settings.kernel),
      settings_(settings) {
  if (def.courant > 0.0) settings_.courant = def.courant;
}

double ParticleFluid::supportRadius() const { return kernel::kSupport * unit_; }
double ParticleFluid::particleMass() const { return def_.density * def_.spacing * def_.spacing; }
double ParticleFluid::pressureUnit(double dt) const { return dt * dt / (unit_ * unit_); }

StepBound ParticleFluid::stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const {
  StepBound bound = flowBound(pool, maxSpeed, gravity);
  tightenByViscosity(pool, bound);
  if (tension_.any()) bound.tighten(tension_.longestStep(), StepLimit::Tension);
  return bound;
}

StepBound ParticleFluid::flowBound(const ParticlePool& pool, double maxSpeed, double gravity) const {
  StepBound bound;
  const double support = supportRadius();
  if (maxSpeed > 0.0) bound.tighten(settings_.courant * support / maxSpeed, StepLimit::Courant);
  if (gravity > 0.0) bound.tighten(0.25 * std::sqrt(support / gravity), StepLimit::Acceleration);
  PressureScale pressure = pressureScale(pool);
  if (pressure.largest == 0.0 && !pool.empty()) {
    // Nothing is known yet: at most what the whole fluid would weigh as one column.
    const auto [left, right] = std::minmax_element(pool.x().begin(), pool.x().end());
    const auto [low, high] = std::minmax_element(pool.y().begin(), pool.y().end());
    pressure.largest = gravity * std::max(*right - *left, *high - *low);
    pressure.typical = 0.5 * pressure.largest;
  }
  const double stiffness = std::max(std::min(2.0 * pressure.typical, pressure.largest) / settings_.typicalStiffness,
                                    pressure.largest / settings_.largestStiffness);
  if (stiffness > 0.0) bound.tighten(def_.spacing / std::sqrt(stiffness), StepLimit::Pressure);
  return bound;
}

// The typical pressure is Σp²/Σp: two thirds of the highest in a fluid at rest, and little moved by the peaks of a
// splash, which last a step or two.
ParticleFluid::PressureScale ParticleFluid::pressureScale(const ParticlePool& pool) const {
  const auto pressure = pool.column(pressure_);
  const std::size_t n = pool.size();
  struct Part {
    double sum, squares, largest;
  };
  const auto all = reduceBlocks<Part>(
      n, {0.0, 0.0, 0.0},
      [&](std::size_t begin, std::size_t end) {
        // Eight lanes, so that no addition waits for the one before it.
        std::array<float, 8> sum{}, squares{}, largest{};
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t lane = i % 8;
          sum[lane] += std::abs(pressure[i]);
          squares[lane] += pressure[i] * pressure[i];
          largest[lane] = std::max(largest[lane], std::abs(pressure[i]));
        }
        Part part{0.0, 0.0, 0.0};
        for (std::size_t lane = 0; lane < 8; ++lane) {
          part.sum += static_cast<double>(sum[lane]);
          part.squares += static_cast<double>(squares[lane]);
          part.largest = std::max(part.largest, static_cast<double>(largest[lane]));
        }
        return part;
      },
      [](const Part& a, const Part& b) {
        return Part{a.sum + b.sum, a.squares + b.squares, std::max(a.largest, b.largest)};
      });
  return {all.largest, all.sum > 0.0 ? all.squares / all.sum : 0.0};
}

void ParticleFluid::advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) {
  if (pool.empty()) {
    bodies_.begin(context.freeBodies, context.softWalls, bodyUnits(context.dt));
    bodies_.settle(nullptr);
    return;
  }
  if (overTurned(context, stats)) return;
  resizeScratch(pool.size());
  largestPressure_ = pressureScale(pool).largest;
  predict(context, pool, impulses, stats);
  sortByCell(context, pool);
  meetWalls(context);
  if (tension_.any()) pullSurface(context, pool, impulses);
  linkBodies(context);
  solvePressure(context, pool, stats);
  if (overTurned(context, stats)) return;
  finishPositions(context, pool, impulses, stats);
  if (tension_.any()) stats.tensionWork += tensionWork(context, pool);
  applyViscosity(context, pool, impulses);
  bookCarried(context, pool, impulses);
}

void ParticleFluid::predict(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const DiscContact point{0.0, 0.0, 0.0, filter(), true};
  const double dt = context.dt;
  auto travel = [&](std::size_t i) { return Vec2(predictedX_[i] - x[i], predictedY_[i] - y[i]).norm(); };
  contacts_.begin(pool.size());
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool carried = context.carriedUntil && pool.column(*context.carriedUntil)[i] > context.time;
      const Vec2 g = carried ? Vec2(0.0, 0.0) : context.gravity.at({x[i], y[i]}, context.time);
      // Until the positions say what the velocity is, it carries the prediction through the sort.
      vx[i] += dt * g.x();
      vy[i] += dt * g.y();
      predictedX_[i] = x[i] + dt * vx[i];
      predictedY_[i] = y[i] + dt * vy[i];
    }
    forEachWithin(context.obstacles, x, y, begin, end, travel, [&](std::size_t i) {
      const Vec2 at(x[i], y[i]), v(vx[i], vy[i]);
      if (context.obstacles.freeDistance(at, point.filter) > dt * v.norm()) return;
      PathResult path;
      followPath(context.obstacles, at, v, dt, point, path);
      if (path.contacts == 0) return;
      contacts_.addMean(i, path, at, v, dt);
      vx[i] = (path.x.x() - x[i]) / dt;
      vy[i] = (path.x.y() - y[i]) / dt;
      predictedX_[i] = path.x.x();
      predictedY_[i] = path.x.y();
    });
  });
  stats.gravityImpulse +=
      context.gravity.isConstant()
          ? Vec2(particleMass() * static_cast<double>(pool.size()) * dt * context.gravity.constant())
          : Vec2(0.0, 0.0);
  contacts_.book(particleMass(), impulses);
}

void ParticleFluid::sortByCell(const StepContext& context, ParticlePool& pool) {
  const std::size_t n = pool.size();
  wrapPeriodic(pool);
  grid_.build({predictedX_.data(), n}, {predictedY_.data(), n},
              fluidFrame(domain_, {predictedX_.data(), n}, {predictedY_.data(), n}, kCellSlack * supportRadius()));
  if (!grid_.sorted()) pool.permute(grid_.order());
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const double perSpacing = 1.0 / unit_;
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      predictedX_[i] = x[i] + context.dt * vx[i];
      predictedY_[i] = y[i] + context.dt * vy[i];
      latticeX_[i] = lattice::coordinate((predictedX_[i] - domain_.box.min.x()) * perSpacing);
      latticeY_[i] = lattice::coordinate((predictedY_[i] - domain_.box.min.y()) * perSpacing);
      shiftX_[i] = shiftY_[i] = 0.0f;
    }
  });
  findOccupiedCells(grid_, occupied_);
  findCarried(context, pool);
}

// What a nozzle carries is a piston to the rest: it neither falls nor gives way. What it is spared goes to the books as
// the nozzle's.
void ParticleFluid::findCarried(const StepContext& context, const ParticlePool& pool) {
  carried_.clear();
  if (!context.carriedUntil) return;
  const auto until = pool.column(*context.carriedUntil);
  for (std::uint32_t i = 0; i < pool.size(); ++i) {
    if (until[i] > context.time) carried_.push_back({i, {0.0, 0.0}});
  }
}

void ParticleFluid::holdCarried(bool asVelocity) {
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    if (asVelocity) c.spared += Vec2(static_cast<double>(shiftX_[i]), static_cast<double>(shiftY_[i]));
    shiftX_[i] = shiftY_[i] = 0.0f;
    latticeX_[i] = lattice::coordinate((predictedX_[i] - domain_.box.min.x()) / unit_);
    latticeY_[i] = lattice::coordinate((predictedY_[i] - domain_.box.min.y()) / unit_);
  }
}

void ParticleFluid::meetWalls(const StepContext& context) {
  const std::size_t n = grid_.size();
  walls_.build(context.obstacles, context.softWalls, grid_, {predictedX_.data(), n}, {predictedY_.data(), n});
  findCellRuns(grid_, occupied_, walls_.hidden(), runs_);
}

void ParticleFluid::linkBodies(const StepContext& context) {
  const std::size_t n = grid_.size();
  bodies_.begin(context.freeBodies, context.softWalls, bodyUnits(context.dt));
  bodies_.link(walls_, {predictedX_.data(), n}, {predictedY_.data(), n});
}

PairFrame ParticleFluid::frame() const {
  const Vec2 period = domain_.box.size() / unit_;
  return {&grid_,
          occupied_,
          runs_.data(),
          latticeX_.data(),
          latticeY_.data(),
          domain_.periodicX ? lattice::coordinate(period.x()) : 0,
          domain_.periodicY ? lattice::coordinate(period.y()) : 0,
          walls_.hidden(),
          settings_.kernel,
          near_.empty() ? nullptr : near_.data()};
}

void ParticleFluid::findNear(const StepContext& context) {
  const PairLoops& loops = pairLoops(context.simd);
  if (loops.near == nullptr) return;
  near_.resize(kNearRow * grid_.size());
  const PairFrame pairs = frame();
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.near(pairs, near_.data(), begin, end); });
}

DensityLoop ParticleFluid::densityLoop(float* density, float* diagonal, const PressureUpdate& update) const {
  return {walls_.any() ? walls_.lambda() : nullptr,
          walls_.gradientX(),
          walls_.gradientY(),
          shiftX_.data(),
          shiftY_.data(),
          density,
          diagonal,
          update};
}

double ParticleFluid::runDensity(const StepContext& context, const DensityLoop& loop) {
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  return sumOverCells([&](std::size_t begin, std::size_t end) { return loops.density(pairs, loop, begin, end); });
}

void ParticleFluid::runDisplacement(const StepContext& context, const float* pressure, float* kappa, bool asVelocity) {
  const PairFrame pairs = frame();
  const DisplacementLoop loop{pressure,
                              walls_.any() ? walls_.gradientX() : nullptr,
                              walls_.gradientY(),
                              walls_.tangent(),
                              shiftX_.data(),
                              shiftY_.data(),
                              nextX_.data(),
                              nextY_.data(),
                              kappa};
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.displace(pairs, loop, begin, end); });
  latticeX_.swap(nextX_);
  latticeY_.swap(nextY_);
  holdCarried(asVelocity);
}

void ParticleFluid::findArrangement(const StepContext& context, float* density, float* squares) {
  arrangement_.resize(grid_.size());
  const MomentLoop loop = arrangement_.moments(walls_, density, squares);
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.moments(pairs, loop, begin, end); });
  arrangement_.judge(grid_, occupied_, walls_, volume_, density);
}

// λ grows where a wall comes nearer: the same as if the particle went the other way.
void ParticleFluid::findWallGain(const StepContext& context, double time) {
  wallGain_.resize(grid_.size());
  std::fill(wallGain_.begin(), wallGain_.end(), 0.0f);
  walls_.forEachLink([&](const WallLink& link) {
    if (link.owner < 0) return;
    const Vec2 at(predictedX_[link.particle], predictedY_[link.particle]);
    const Vec2 way = time / unit_ * context.obstacles.velocityAt(link.owner, at);
    const Vec2 gradient(static_cast<double>(link.gradientX), static_cast<double>(link.gradientY));
    wallGain_[link.particle] -= static_cast<float>(way.dot(gradient));
  });
  bodies_.soft().addGain(time, wallGain_.data());
}

void ParticleFluid::buildCoarse(const StepContext& context, const float* density) {
  coarse_.build(context.obstacles, filter(), grid_, occupied_, density);
}

void ParticleFluid::solveCoarse(const float* excess) {
  const std::size_t n = grid_.size();
  coarse_.solve(grid_, {predictedX_.data(), n}, {predictedY_.data(), n}, excess, change_.data());
}

// To `change_`, from the excess of density of each particle.
void ParticleFluid::liftFromCoarse(const StepContext& context, const ParticlePool& pool, const float* excess) {
  buildCoarse(context, pool.column(density_).data());
  solveCoarse(excess);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) change_[i] = std::max(0.0f, change_[i]);
  });
}

void ParticleFluid::judgeDensity(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  const auto density = pool.column(density_), pressure = pool.column(pressure_);
  const std::size_t n = pool.size();
  const auto unit = static_cast<float>(1.0 / pressureUnit(context.dt));
  // A film is as dense as its gap is narrow; that is no compression of the fluid. 0: when it comes out it is new.
  walls_.forEachFilm([&](std::uint32_t i) { density[i] = 0.0f; });
  struct Part {
    double compression;
    float density, pressure;
  };
  const auto all = reduceBlocks<Part>(
      n, {0.0, 0.0f, 0.0f},
      [&](std::size_t begin, std::size_t end) {
        std::array<float, 8> sum{}, dense{}, high{};
        bool finite = true;
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t lane = i % 8;
          const float above = density[i] - 1.0f;
          pressure[i] = unit * kappa_[i];
          sum[lane] += std::max(0.0f, above);
          dense[lane] = std::max(dense[lane], above);
          high[lane] = std::max(high[lane], std::abs(pressure[i]));
          finite = finite && std::abs(above) < std::numeric_limits<float>::infinity();
        }
        Part part{0.0, finite ? 0.0f : std::numeric_limits<float>::infinity(), 0.0f};
        for (std::size_t lane = 0; lane < 8; ++lane) {
          part.compression += static_cast<double>(sum[lane]);
          part.density = std::max(part.density, dense[lane]);
          part.pressure = std::max(part.pressure, high[lane]);
        }
        return part;
      },
      [](const Part& a, const Part& b) {
        return Part{a.compression + b.compression, std::max(a.density, b.density), std::max(a.pressure, b.pressure)};
      });
  stats.meanCompression = all.compression / static_cast<double>(n);
  stats.maxCompression = static_cast<double>(all.density);
  largestPressure_ = static_cast<double>(all.pressure);
}

void ParticleFluid::finishPositions(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses,
                                    StepStats& stats) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const DiscContact point{0.0, 0.0, 0.0, filter(), true};
  const double dt = context.dt, rate = 1.0 / dt;
  const auto density = pool.column(density_);
  auto travel = [&](std::size_t i) { return Vec2(predictedX_[i] - x[i], predictedY_[i] - y[i]).norm(); };
  contacts_.begin(pool.size());
  crushed_.assign(blockCount(pool.size()), 0);
  if (leaks_.size() < crushed_.size()) leaks_.resize(crushed_.size());
  for (std::vector<ParticleLeak>& block : leaks_) block.clear();
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      predictedX_[i] += unit_ * static_cast<double>(shiftX_[i]);
      predictedY_[i] += unit_ * static_cast<double>(shiftY_[i]);
    }
    forEachWithin(context.obstacles, x, y, begin, end, travel, [&](std::size_t i) {
      const Vec2 at(x[i], y[i]);
      Vec2 to(predictedX_[i], predictedY_[i]);
      if (context.obstacles.freeDistance(at, point.filter) > (to - at).norm()) return;
      PathResult path;
      const Vec2 v = (to - at) / dt;
      followPath(context.obstacles, at, v, dt, point, path);
      if (path.contacts > 0) {
        // Where it stops is one thing, what it keeps of its velocity another: the shift of the stabilisation is no
        // velocity, and one that a wall stops is none either.
        const Vec2 solved =
            unit_ * Vec2(static_cast<double>(solvedX_[i] - shiftX_[i]), static_cast<double>(solvedY_[i] - shiftY_[i]));
        const Vec2 before = v + solved / dt;
        const Vec2 shift = (path.x - at - dt * alongWalls(before, path)) / unit_;
        shiftX_[i] = solvedX_[i] + static_cast<float>(shift.x());
        shiftY_[i] = solvedY_[i] + static_cast<float>(shift.y());
        // As it will be computed from the shift, for the books.
        const Vec2 shifted(static_cast<double>(shiftX_[i] - solvedX_[i]),
                           static_cast<double>(shiftY_[i] - solvedY_[i]));
        const Vec2 after = (path.x - at - unit_ * shifted) / dt;
        // It is not where its density was found: to the next sub-step it is new.
        if ((path.x - to).norm() > kDisplaced * unit_) density[i] = 0.0f;
        to = path.x;
        path.x = at + dt * after;
        contacts_.addMean(i, path, at, before, dt);
        path.x = to;
      }
      if (const PathLeak leak = checkPath(context.obstacles, at, to, point, path); leak.leaked) {
        // Only what is squeezed can be here: it has no free place.
        const auto particle = static_cast<std::uint32_t>(i);
        if (path.crushed || target_[i] == kNever)
          ++crushed_[begin / kBlockSize];
        else
          leaks_[begin / kBlockSize].push_back({particle, at, to, leak.inside, leak.body, leak.at});
        pool.kill(particle);
      }
      predictedX_[i] = to.x();
      predictedY_[i] = to.y();
    });
    for (std::size_t i = begin; i < end; ++i) {
      // The shift of the stabilisation is no velocity.
      vx[i] = (predictedX_[i] - x[i] - unit_ * static_cast<double>(shiftX_[i] - solvedX_[i])) * rate;
      vy[i] = (predictedY_[i] - y[i] - unit_ * static_cast<double>(shiftY_[i] - solvedY_[i])) * rate;
      x[i] = predictedX_[i];
      y[i] = predictedY_[i];
    }
  });
  stats.wallHits += contacts_.size();
  if (!context.gravity.isConstant()) addFieldGravity(context, pool, stats);
  for (const std::uint32_t n : crushed_) stats.crushed += n;
  for (const std::vector<ParticleLeak>& block : leaks_) {
    stats.leaks += block.size();
    if (context.leaks == nullptr) continue;
    for (const ParticleLeak& leak : block) context.leaks->add(leak);
  }
  contacts_.book(particleMass(), impulses);
  // The pressure on the walls: each sweep moved its particle by −2κg, and along the wall by the share λ of what it did
  // there.
  const double unit = particleMass() * unit_ / dt;
  std::size_t softLinks = 0;
  walls_.forEachLink([&](const WallLink& link) {
    const std::uint32_t i = link.particle;
    const Vec2 gradient(link.gradientX, link.gradientY);
    Vec2 impulse = 2.0 * unit * static_cast<double>(kappa_[i]) * gradient;
    if (walls_.tangent()[i] > 0.0f) {
      const Vec2 along = leftNormal(Vec2(walls_.gradientX()[i], walls_.gradientY()[i]).normalized());
      impulse -= unit * static_cast<double>(link.lambda) * along.dot(Vec2(solvedX_[i], solvedY_[i])) * along;
    }
    if (isSoftOwner(link.owner)) {
      bodies_.soft().give(softLinks++, impulse);
      return;
    }
    const Vec2 at(x[i], y[i]);
    impulses.add(link.owner, at, impulse, context.obstacles.velocityAt(link.owner, at));
  });
}

// The impulse of the field was taken at the old positions; its work is by the midpoint rule along the path.
void ParticleFluid::addFieldGravity(const StepContext& context, const ParticlePool& pool, StepStats& stats) const {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const double mass = particleMass(), dt = context.dt;
  auto sum = [&](auto&& term) {
    return mass * dt * parallelSum(pool.size(), [&](std::size_t begin, std::size_t end) {
             double total = 0.0;
             for (std::size_t i = begin; i < end; ++i) total += term(Vec2(x[i], y[i]), Vec2(vx[i], vy[i]));
             return total;
           });
  };
  const Gravity& g = context.gravity;
  const double t = context.time;
  stats.gravityImpulse.x() += sum([&](const Vec2& at, const Vec2& v) { return g.at(at - dt * v, t).x(); });
  stats.gravityImpulse.y() += sum([&](const Vec2& at, const Vec2& v) { return g.at(at - dt * v, t).y(); });
  stats.gravityWork += sum([&](const Vec2& at, const Vec2& v) { return g.at(at - 0.5 * dt * v, t + 0.5 * dt).dot(v); });
}

void ParticleFluid::bookCarried(const StepContext& context, const ParticlePool& pool, ImpulseLedger& impulses) const {
  for (const Carried& c : carried_) {
    const Vec2 at(pool.x()[c.particle], pool.y()[c.particle]), v(pool.vx()[c.particle], pool.vy()[c.particle]);
    const Vec2 fall = context.dt * context.gravity.at(at, context.time);
    impulses.add(-1, at, particleMass() * (unit_ / context.dt * c.spared + fall), v);
  }
}

void ParticleFluid::wrapPeriodic(ParticlePool& pool) {
  if (!domain_.periodicX && !domain_.periodicY) return;
  const auto x = pool.x(), y = pool.y();
  // The whole path is moved by a period, so that velocity = displacement/dt stays true.
  auto wrap = [](double& predicted, double& at, double low, double length) {
    const double turns = std::floor((predicted - low) / length);
    predicted -= turns * length;
    at -= turns * length;
  };
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (domain_.periodicX) wrap(predictedX_[i], x[i], domain_.box.min.x(), domain_.box.size().x());
    if (domain_.periodicY) wrap(predictedY_[i], y[i], domain_.box.min.y(), domain_.box.size().y());
  }
}

void ParticleFluid::resizeScratch(std::size_t n) {
  for (AlignedArray<double>* a : {&predictedX_, &predictedY_}) a->resize(n);
  for (AlignedArray<std::int32_t>* a : {&latticeX_, &latticeY_, &nextX_, &nextY_}) a->resize(n);
  for (AlignedArray<float>* a : {&shiftX_, &shiftY_, &solvedX_, &solvedY_, &kappa_, &change_, &target_, &diagonal_,
                                 &velocityX_, &velocityY_, &smoothX_, &smoothY_}) {
    a->resize(n);
  }
}

std::size_t ParticleFluid::memoryBytes() const {
  return 2 * predictedX_.capacity() * sizeof(double) + 16 * shiftX_.capacity() * sizeof(float) + grid_.memoryBytes() +
         walls_.memoryBytes() + coarse_.memoryBytes() + arrangement_.memoryBytes() +
         wallGain_.capacity() * sizeof(float) + tension_.memoryBytes();
}

}  // namespace froude
