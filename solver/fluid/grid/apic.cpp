#include <froude/solver/fluid/grid/apic.h>

#include <utility>

#include <froude/base/error.h>
#include <froude/base/parallel.h>
#include <froude/solver/fluid/fluid_extent.h>

namespace froude {
namespace {

constexpr double kCourant = 5.0;  // cells a sub-step
constexpr double kMostCourant = 7.0;
// Cells of a higher Reynolds number feel no friction: what the transfers smooth out is more.
constexpr double kMostReynolds = 1000.0;
constexpr double kResolved = 0.0025;  // largest ν·dt/H², H the smaller extent of the fluid
constexpr int kSmoothed = 3;          // faces to either side that a velocity is smoothed over
constexpr std::size_t kCells = TileGrid::kCells;
constexpr std::size_t kTileBlock = 4;  // tiles a task

CutGrid gridOver(const DomainDef& domain, double spacing) {
  CutGrid grid{domain.box.min, 2.0 * spacing};
  const Vec2 size = domain.box.size();
  if (domain.periodicX) grid.periodX = static_cast<std::int32_t>(std::lround(size.x() / grid.size));
  if (domain.periodicX) grid.size = size.x() / grid.periodX;
  if (domain.periodicY) grid.periodY = static_cast<std::int32_t>(std::lround(size.y() / grid.size));
  if (domain.periodicY && !domain.periodicX) grid.size = size.y() / grid.periodY;
  return grid;
}

}  // namespace

Apic::Apic(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : def_(def),
      domain_(domain),
      grid_(gridOver(domain, def.spacing)),
      pressure_(pool.addColumn<float>("pressure", ColumnKind::State)),
      density_(pool.addColumn<float>("density", ColumnKind::State)),
      gradient_{pool.addColumn<float>("du/dx", ColumnKind::State), pool.addColumn<float>("du/dy", ColumnKind::State),
                pool.addColumn<float>("dv/dx", ColumnKind::State), pool.addColumn<float>("dv/dy", ColumnKind::State)} {
  if (def.surfaceTension > 0.0)
    throw Error("surface tension is not in this version of apic; pbf, dfsph and wcsph have it");
  const Vec2 size = domain.box.size();
  if (domain.periodicX && domain.periodicY && std::abs(grid_.periodY * grid_.size - size.y()) > 1e-9 * size.y()) {
    throw Error(
        "apic's square cells do not fit a domain of these two periods; make both whole numbers of two spacings");
  }
}

double Apic::supportRadius() const { return 2.0 * def_.spacing; }
double Apic::farthestTravel() const { return 2.0 * kMostCourant * grid_.size; }
double Apic::particleMass() const { return def_.density * def_.spacing * def_.spacing; }

// Of what a cell's size sees: the fluid's speed, or that of its waves.
double Apic::cellReynolds(double speed, double acceleration) const {
  return grid_.size * std::max(speed, std::sqrt(acceleration * grid_.size)) / def_.viscosity;
}

StepBound Apic::stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const {
  StepBound bound;
  const double way = (def_.courant > 0.0 ? def_.courant : kCourant) * grid_.size;
  // v·dt + g·dt² = way
  const double root = std::sqrt(maxSpeed * maxSpeed + 4.0 * gravity * way);
  if (root > 0.0) bound.tighten(2.0 * way / (maxSpeed + root), StepLimit::Courant);
  if (def_.viscosity > 0.0 && cellReynolds(maxSpeed, gravity) <= kMostReynolds) {
    const double extent = smallerExtent(pool, domain_, def_.spacing);
    bound.tighten(kResolved * extent * extent / def_.viscosity, StepLimit::Viscosity);
  }
  return bound;
}

void Apic::advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) {
  if (pool.empty()) {
    GridBodies untouched;
    untouched.begin(context.freeBodies, def_.density, grid_.size, context.dt);
    untouched.settle(nullptr);
    return;
  }
  if (overTurned(context, stats)) return;
  sortParticles(pool);
  cutCells(context);
  loadParticles(pool);
  findCarried(context, pool);
  faces_.collect(particles_, columns(), context.simd);
  keepDifferences(context, pool);
  const Vec2 fall = addGravity(context, pool);
  stats.gravityImpulse += fall;
  faces_.extrapolate(1);
  const double full = grid_.size * grid_.size / (def_.spacing * def_.spacing);
  solver_.begin(grid_, cuts_, centers_, particles_, full, context.freeBodies, faces_);
  startPressure(context, pool);
  stats.sweeps = rub(context);
  const std::span<const Wrench> drag = rubbed_ ? viscosity_.drag() : std::span<const Wrench>();
  stats.sweeps += solver_.project(context, def_.density, faces_, drag).iterations;
  if (overTurned(context, stats)) return;
  stats.sweeps += solver_.evenOut(faces_).iterations;
  const auto [most, mean, whole] = solver_.compression();
  stats.maxCompression = most;
  stats.meanCompression = mean;
  overFull_ = whole;
  spreadChange();
  faces_.extrapolate(1);
  holdWalls(context);
  const double farthest = context.dt * (context.maxSpeed + context.dt * context.acceleration) / grid_.size;
  faces_.extrapolate(static_cast<int>(std::ceil(std::min(farthest, 2.0 * kMostCourant))) + kSmoothed + 1);
  moveParticles(context, pool);
  addDifferences();
  if (!context.gravity.isConstant()) addGravityWork(context, pool, stats);
  bookWalls(context, takeVelocities(pool) - fall, impulses);
  holdCarried(context, pool, impulses);
  takePressure(context, pool);
  meetWalls(context, pool, impulses, stats);
}

void Apic::sortParticles(ParticlePool& pool) {
  particles_.build(pool.x(), pool.y(), grid_);
  if (!particles_.sorted()) pool.permute(particles_.order());
}

GridParticles Apic::columns() const {
  return {
      x_.data(),
      y_.data(),
      u_.data(),
      v_.data(),
      {gradientScratch_[0].data(), gradientScratch_[1].data(), gradientScratch_[2].data(), gradientScratch_[3].data()}};
}

void Apic::loadParticles(const ParticlePool& pool) {
  const std::size_t n = pool.size();
  for (AlignedArray<float>* a : {&x_, &y_, &u_, &v_, &dx_, &dy_}) a->resize(n);
  for (AlignedArray<float>& a : gradientScratch_) a.resize(n);
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const double perCell = 1.0 / grid_.size;
  const auto size = static_cast<float>(grid_.size);
  const TileGrid& tiles = particles_.tiles();
  std::array<std::span<const float>, 4> gradient;
  for (std::size_t c = 0; c < 4; ++c) gradient[c] = pool.column(gradient_[c]);
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t <= end; ++t) {
      const TileIndex at = tiles.tile(t).at;
      const double firstX = at.x * static_cast<double>(kTileSide), firstY = at.y * static_cast<double>(kTileSide);
      const std::uint32_t first = particles_.start(t)[0], last = particles_.start(t)[kCells];
      for (std::uint32_t k = first; k < last; ++k) {
        x_[k] = static_cast<float>((x[k] - grid_.origin.x()) * perCell - firstX);
        y_[k] = static_cast<float>((y[k] - grid_.origin.y()) * perCell - firstY);
        u_[k] = static_cast<float>(vx[k]);
        v_[k] = static_cast<float>(vy[k]);
        for (std::size_t c = 0; c < 4; ++c) gradientScratch_[c][k] = size * gradient[c][k];
      }
    }
  });
}

// A field of gravity is taken at the faces; what it gives is what the particles then have of it.
Vec2 Apic::addGravity(const StepContext& context, const ParticlePool& pool) {
  const double dt = context.dt;
  const Gravity& gravity = context.gravity;
  if (gravity.isConstant()) {
    const Vec2 g = gravity.constant();
    faces_.add(static_cast<float>(dt * g.x()), static_cast<float>(dt * g.y()));
    return particleMass() * static_cast<double>(pool.size()) * dt * g;
  }
  const TileGrid& tiles = particles_.tiles();
  const double perCell = particleMass() * dt;
  return reduceBlocks<Vec2>(
      tiles.size(), Vec2(0.0, 0.0),
      [&](std::size_t begin, std::size_t end) {
        Vec2 impulse(0.0, 0.0);
        for (std::size_t place = (begin + 1) * kCells; place < (end + 1) * kCells; ++place) {
          const auto [i, j] = tiles.cell(place);
          const Vec2 corner = grid_.origin + grid_.size * Vec2(i, j);
          if (faces_.x.known[place] > 0.0f) {
            const double g = gravity.at(corner + Vec2(0.0, 0.5 * grid_.size), context.time).x();
            faces_.x.value[place] += static_cast<float>(dt * g);
            impulse.x() += perCell * g * static_cast<double>(faces_.x.weight[place]);
          }
          if (faces_.y.known[place] > 0.0f) {
            const double g = gravity.at(corner + Vec2(0.5 * grid_.size, 0.0), context.time).y();
            faces_.y.value[place] += static_cast<float>(dt * g);
            impulse.y() += perCell * g * static_cast<double>(faces_.y.weight[place]);
          }
        }
        return impulse;
      },
      [](const Vec2& x, const Vec2& y) { return Vec2(x + y); });
}

// The solve starts from what the particles of each cell had, so that no pressure is state beside theirs.
void Apic::startPressure(const StepContext& context, const ParticlePool& pool) {
  const TileGrid& tiles = particles_.tiles();
  const auto pressure = pool.column(pressure_);
  const std::span<float> start = solver_.values();
  const auto unit = static_cast<float>(context.dt * context.dt / (grid_.size * grid_.size));
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t <= end; ++t) {
      const std::uint32_t* cell = particles_.start(t);
      for (std::size_t c = 0; c < kCells; ++c) {
        if (cell[c] == cell[c + 1]) continue;
        float sum = 0.0f;
        for (std::uint32_t k = cell[c]; k < cell[c + 1]; ++k) sum += pressure[k];
        start[t * kCells + c] = unit * sum / static_cast<float>(cell[c + 1] - cell[c]);
      }
    }
  });
}

// Friction acts on velocities that are free of divergence; what it changes is kept, and the pressure asked again.
int Apic::rub(const StepContext& context) {
  rubbed_ = def_.viscosity > 0.0 && cellReynolds(context.maxSpeed, context.acceleration) <= kMostReynolds;
  if (!rubbed_) return 0;
  const int iterations = solver_.foresee(context, def_.density, faces_).iterations;
  const int more = viscosity_.smooth(context, grid_, def_.density, def_.viscosity, solver_, faces_);
  const TileGrid& tiles = particles_.tiles();
  for (FaceComponent* c : {&faces_.x, &faces_.y}) {
    parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t place = (begin + 1) * kCells; place < (end + 1) * kCells; ++place) {
        c->value[place] -= c->change[place];
      }
    });
  }
  return iterations + more;
}

// Faces that particles reach but no pressure acts on feel what those beside them feel: a fluid's outermost layer goes
// with it, and so does what lies along a wall; what flies alone goes straight on. A particle reaches two faces far.
void Apic::spreadChange() {
  faces_.spread(&FaceComponent::change, 2);
  faces_.spread(&FaceComponent::shift, 2);
  const TileGrid& tiles = particles_.tiles();
  for (FaceComponent* c : {&faces_.x, &faces_.y}) {
    parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t place = (begin + 1) * kCells; place < (end + 1) * kCells; ++place) {
        const float more = c->known[place] * c->change[place];
        c->value[place] += c->solved[place] == 0.0f ? more : 0.0f;
      }
    });
  }
}

// FLIP: what a particle's velocity differs from the grid's by before the step, it has after it. J. U. Brackbill & H. M.
// Ruppel, J. Comput. Phys. 65, 1986. Its way is the grid's.
void Apic::keepDifferences(const StepContext& context, const ParticlePool& pool) {
  if (def_.flip == 0.0) return;
  keptX_.resize(pool.size());
  keptY_.resize(pool.size());
  const TileGrid& tiles = particles_.tiles();
  const TransferLoops& loops = transferLoops(context.simd);
  const GridParticles in = columns();
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    TileWindow velocity;
    for (std::size_t t = begin + 1; t <= end; ++t) {
      if (particles_.empty(t)) continue;
      const std::uint32_t first = particles_.start(t)[0], last = particles_.start(t)[kCells];
      faces_.fillWindow(t, faces_.x.value, faces_.y.value, velocity);
      loops.sample(in, velocity, first, last, keptX_.data(), keptY_.data());
      for (std::uint32_t k = first; k < last; ++k) {
        keptX_[k] = u_[k] - keptX_[k];
        keptY_[k] = v_[k] - keptY_[k];
      }
    }
  });
}

void Apic::addDifferences() {
  if (def_.flip == 0.0) return;
  const auto share = static_cast<float>(def_.flip);
  parallelFor(keptX_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      u_[k] += share * keptX_[k];
      v_[k] += share * keptY_[k];
    }
  });
}

void Apic::moveParticles(const StepContext& context, ParticlePool& pool) {
  const TileGrid& tiles = particles_.tiles();
  const TransferLoops& loops = transferLoops(context.simd);
  const auto time = static_cast<float>(context.dt / grid_.size);
  const GridParticles in = columns();
  GridMotion out{u_.data(), v_.data(), {}, dx_.data(), dy_.data()};
  for (std::size_t c = 0; c < 4; ++c) out.gradient[c] = pool.column(gradient_[c]).data();
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    TileWindow velocity, smooth, shift;
    for (std::size_t t = begin + 1; t <= end; ++t) {
      if (particles_.empty(t)) continue;
      faces_.fillWindow(t, faces_.x.value, faces_.y.value, velocity);
      faces_.fillWindow(t, faces_.x.shift, faces_.y.shift, shift);
      loops.smooth(velocity, smooth);
      loops.take(in, velocity, smooth, shift, time, particles_.start(t)[0], particles_.start(t)[kCells], out);
    }
  });
  const auto perSize = static_cast<float>(1.0 / grid_.size);
  for (std::size_t c = 0; c < 4; ++c) {
    float* g = out.gradient[c];
    parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) g[k] *= perSize;
    });
  }
}

// p/ρ of its cell, and by the gradient there to where it is; the density at the start of the sub-step.
void Apic::takePressure(const StepContext& context, ParticlePool& pool) {
  const TileGrid& tiles = particles_.tiles();
  const auto pressure = pool.column(pressure_), density = pool.column(density_);
  const std::span<const float> filled = solver_.densities();
  const std::span<const float> q = std::as_const(solver_).values();
  const auto rate = static_cast<float>(1.0 / context.dt), size = static_cast<float>(grid_.size),
             unit = size * size * rate * rate;
  parallelFor(tiles.size(), kTileBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin + 1; t <= end; ++t) {
      if (particles_.empty(t)) continue;
      const std::uint32_t* start = particles_.start(t);
      TileHalo changeX, changeY, solvedX, solvedY;
      tiles.loadHalo(faces_.x.change.data(), t, changeX);
      tiles.loadHalo(faces_.y.change.data(), t, changeY);
      tiles.loadHalo(faces_.x.solved.data(), t, solvedX);
      tiles.loadHalo(faces_.y.solved.data(), t, solvedY);
      for (std::int32_t j = 0; j < kTileSide; ++j) {
        std::array<float, kTileSide> alongX, alongY;
        auto means = [&](const TileHalo& change, const TileHalo& solved, int di, int dj, float* to) {
          const float *here = solved.row(j), *there = solved.row(j + dj) + di;
          const float *own = change.row(j), *next = change.row(j + dj) + di;
          for (std::int32_t i = 0; i < kTileSide; ++i) {
            const float count = here[i] + there[i], sum = here[i] * own[i] + there[i] * next[i];
            to[i] = -size * rate * (count > 0.0f ? sum / (count > 0.0f ? count : 1.0f) : 0.0f);
          }
        };
        means(changeX, solvedX, 1, 0, alongX.data());
        means(changeY, solvedY, 0, 1, alongY.data());
        for (std::int32_t i = 0; i < kTileSide; ++i) {
          const std::int32_t c = j * kTileSide + i;
          if (start[c] == start[c + 1]) continue;
          const float gx = alongX[static_cast<std::size_t>(i)], gy = alongY[static_cast<std::size_t>(i)];
          const float base = unit * q[t * kCells + static_cast<std::size_t>(c)];
          const auto middleX = static_cast<float>(i) + 0.5f, middleY = static_cast<float>(j) + 0.5f;
          for (std::uint32_t k = start[c]; k < start[c + 1]; ++k) {
            density[k] = filled[t * kCells + static_cast<std::size_t>(c)];
            pressure[k] = base + (gx * (x_[k] - middleX) + gy * (y_[k] - middleY));
          }
        }
      }
    }
  });
}

// Returns what momentum the particles gained [kg/s].
Vec2 Apic::takeVelocities(ParticlePool& pool) const {
  const auto vx = pool.vx(), vy = pool.vy();
  return particleMass() * reduceBlocks<Vec2>(
                              pool.size(), Vec2(0.0, 0.0),
                              [&](std::size_t begin, std::size_t end) {
                                Vec2 gain(0.0, 0.0);
                                for (std::size_t k = begin; k < end; ++k) {
                                  const auto u = static_cast<double>(u_[k]), v = static_cast<double>(v_[k]);
                                  gain += Vec2(u - vx[k], v - vy[k]);
                                  vx[k] = u;
                                  vy[k] = v;
                                }
                                return gain;
                              },
                              [](const Vec2& a, const Vec2& b) { return Vec2(a + b); });
}

// By the midpoint rule along each particle's way.
void Apic::addGravityWork(const StepContext& context, const ParticlePool& pool, StepStats& stats) const {
  const auto x = pool.x(), y = pool.y();
  const double middle = context.time + 0.5 * context.dt;
  stats.gravityWork += particleMass() * parallelSum(pool.size(), [&](std::size_t begin, std::size_t end) {
                         double work = 0.0;
                         for (std::size_t k = begin; k < end; ++k) {
                           const Vec2 way = grid_.size * Vec2(static_cast<double>(dx_[k]), static_cast<double>(dy_[k]));
                           work += context.gravity.at(Vec2(x[k], y[k]) + 0.5 * way, middle).dot(way);
                         }
                         return work;
                       });
}

// What a nozzle carries is a piston to the rest: it keeps the velocity that it was let in with, whatever the grid gave
// it, at the nozzle's expense.
void Apic::holdCarried(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) {
  const auto way = static_cast<float>(context.dt / grid_.size);
  for (const Carried& c : carried_) {
    const std::uint32_t k = c.particle;
    const Vec2 given = c.velocity - Vec2(pool.vx()[k], pool.vy()[k]);
    impulses.add(-1, {pool.x()[k], pool.y()[k]}, -particleMass() * given, c.velocity);
    pool.vx()[k] = c.velocity.x();
    pool.vy()[k] = c.velocity.y();
    dx_[k] = way * static_cast<float>(c.velocity.x());
    dy_[k] = way * static_cast<float>(c.velocity.y());
  }
}

void Apic::findCarried(const StepContext& context, const ParticlePool& pool) {
  carried_.clear();
  if (!context.carriedUntil) return;
  const auto until = pool.column(*context.carriedUntil);
  for (std::uint32_t k = 0; k < pool.size(); ++k) {
    if (until[k] > context.time) carried_.push_back({k, {pool.vx()[k], pool.vy()[k]}});
  }
}

std::size_t Apic::memoryBytes() const {
  return faces_.memoryBytes() + particles_.memoryBytes() + solver_.memoryBytes() + viscosity_.memoryBytes() +
         cuts_.memoryBytes() + 10 * x_.capacity() * sizeof(float);
}

}  // namespace froude
