#include <froude/solver/fluid/dfsph.h>

#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

// Defaults and their measurements: docs/decisions/solver-dfsph.md.
constexpr double kCourant = 0.4;  // of the support radius a sub-step
constexpr double kTypicalStiffness = 0.15, kLargestStiffness = 0.3;
constexpr double kSmoothing = 0.03;  // XSPH
constexpr int kMinSweeps = 2, kMaxSweeps = 100;
constexpr int kFreshSweeps = 1000;          // where no pressure is known yet
constexpr double kTolerance = 1e-4;         // mean change of density in a sub-step
constexpr double kSoftStrict = 0.1;         // of it, where pressures act on soft bodies: what is left of them drives
constexpr double kDensityTolerance = 2e-4;  // mean compression
constexpr int kDensitySweeps = 5;
constexpr float kStep = 0.8f, kMomentum = 0.4f;  // of a sweep; the spectral radius is 2.5 (walls included)
constexpr float kShare = 0.5f;                   // of a density error that such a sweep takes away
constexpr float kReturn = 3e-4f;                 // share of a density error that the velocities take back in a sub-step
constexpr float kEven = 0.2f;                    // share of S by which a particle gives way to an uneven neighbourhood
constexpr float kNoFloor = -1e30f;

}  // namespace

Dfsph::Dfsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : ParticleFluid(def, domain, pool, {kCourant, kTypicalStiffness, kLargestStiffness, kSmoothing}) {}

void Dfsph::solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  // What the constants below take a sub-step is meant for one that the flow asks for.
  const StepBound own = flowBound(pool, context.maxSpeed, context.acceleration);
  pace_ = std::min(1.0, context.dt / std::min(own.dt, kFreeStep));
  for (AlignedArray<float>* a : {&totalX_, &totalY_, &least_}) a->resize(pool.size());
  tense_.resize(pool.size());
  findArrangement(context, pool.column(density_).data(), diagonal_.data());
  findWallGain(context, context.dt);
  prepareSystem(pool);
  warmStart(context, pool);
  solveDivergence(context, pool, stats);
  solveDensity(context, pool);
  judgeDensity(context, pool, stats);
}

// What the pressures are to reach, what they may be, and the diagonal of their system:
// (BS + g)·(BS + 2g) + Σ|B∇W|², the last for a neighbourhood that is the same all round.
void Dfsph::prepareSystem(const ParticlePool& pool) {
  const auto pressure = pool.column(pressure_), density = pool.column(density_);
  const Matrices<const float> b = arrangement_.correction();
  const bool walls = walls_.any(), open = arrangement_.hasSurface();
  const float back = kReturn * static_cast<float>(pace_);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool surface = arrangement_.atSurface(i), inside = arrangement_.inside(i);
      // Nothing hangs on a wall either: drawn into it, particles of a full closed tank burst.
      least_[i] = inside ? kNoFloor : 0.0f;
      // Inside, a fraction of what is too dense goes back, less than the sweeps of a sub-step take off the smoothest
      // error: more, and a deep fluid bounces. What has room at a surface may be compressed up to its rest density.
      target_[i] = surface ? std::max(0.0f, 1.0f - kLoose - density[i]) : -back * std::max(0.0f, density[i] - 1.0f);
      const float gx = walls ? walls_.gradientX()[i] : 0.0f, gy = walls ? walls_.gradientY()[i] : 0.0f;
      const float x = b.xx[i] * arrangement_.skewX[i] + b.xy[i] * arrangement_.skewY[i],
                  y = b.xy[i] * arrangement_.skewX[i] + b.yy[i] * arrangement_.skewY[i];
      const float square = b.xx[i] * b.xx[i] + b.yy[i] * b.yy[i] + 2.0f * b.xy[i] * b.xy[i];
      diagonal_[i] = (x + gx) * (x + 2.0f * gx) + (y + gy) * (y + 2.0f * gy) + 0.5f * square * diagonal_[i];
      tense_[i] = open && inside && pressure[i] < 0.0f;
      if (tense_[i] == 0) continue;
      // Of κᵢ + κⱼ the own pressure changes its sign.
      diagonal_[i] -= 2.0f * (x * x + y * y);
      arrangement_.skewX[i] = -arrangement_.skewX[i];
      arrangement_.skewY[i] = -arrangement_.skewY[i];
    }
  });
  for (const Carried& c : carried_) {  // goes its own way, whatever others give back
    if (tense_[c.particle] == 0) continue;
    tense_[c.particle] = 0;
    arrangement_.skewX[c.particle] = -arrangement_.skewX[c.particle];
    arrangement_.skewY[c.particle] = -arrangement_.skewY[c.particle];
  }
  // What is squeezed between a body and another solid bears nothing: the gap is narrower than a particle.
  walls_.forEachFilm([&](std::uint32_t i) {
    target_[i] = kNever;
    least_[i] = 0.0f;
  });
}

void Dfsph::warmStart(const StepContext& context, const ParticlePool& pool) {
  const auto vx = pool.vx(), vy = pool.vy();
  const auto pressure = pool.column(pressure_);
  const auto unit = static_cast<float>(pressureUnit(context.dt));
  const double way = context.dt / unit_;
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      totalX_[i] = static_cast<float>(way * vx[i]);
      totalY_[i] = static_cast<float>(way * vy[i]);
      kappa_[i] = target_[i] == kNever ? 0.0f : std::max(unit * pressure[i], least_[i]);
    }
  });
  push(context, kappa_.data(), nullptr);
}

// Displacement by κ; `kappa`, where it is not null, takes it too.
void Dfsph::push(const StepContext& context, const float* pressure, float* kappa) {
  const Matrices<const float> b = arrangement_.correction();
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      arrangement_.xx[i] = pressure[i] * b.xx[i];
      arrangement_.xy[i] = pressure[i] * b.xy[i];
      arrangement_.yy[i] = pressure[i] * b.yy[i];
    }
  });
  const PushLoop loop{pressure,
                      {arrangement_.xx.data(), arrangement_.xy.data(), arrangement_.yy.data()},
                      arrangement_.skewX.data(),
                      arrangement_.skewY.data(),
                      walls_.any() ? walls_.gradientX() : nullptr,
                      walls_.gradientY(),
                      walls_.tangent(),
                      shiftX_.data(),
                      shiftY_.data(),
                      totalX_.data(),
                      totalY_.data(),
                      kappa};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.push(pairs, loop, begin, end); });
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    c.spared += Vec2(static_cast<double>(shiftX_[i]), static_cast<double>(shiftY_[i]));
    totalX_[i] -= shiftX_[i];
    totalY_[i] -= shiftY_[i];
    shiftX_[i] = shiftY_[i] = 0.0f;
  }
}

// What the displacements add to the densities, on the mean, and the change of κ that takes it away.
double Dfsph::runDivergence(const StepContext& context) {
  // A free body follows the pressures sweep by sweep: with momentum a light one is thrown to and fro.
  const bool free = bodies_.anyRigid();
  const PressureUpdate update{target_.data(),
                              diagonal_.data(),
                              kappa_.data(),
                              change_.data(),
                              free ? static_cast<float>(kRelaxation) : kStep,
                              least_.data(),
                              free ? 0.0f : kMomentum};
  const DivergenceLoop loop{totalX_.data(),
                            totalY_.data(),
                            arrangement_.correction(),
                            walls_.any() ? walls_.gradientX() : nullptr,
                            walls_.gradientY(),
                            bodies_.answered(),
                            update};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  const double sum =
      sumOverCells([&](std::size_t begin, std::size_t end) { return loops.divergence(pairs, loop, begin, end); });
  return sum / static_cast<double>(grid_.size());
}

void Dfsph::solveDivergence(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  const bool fresh = largestPressure_ == 0.0;  // nothing was there to warm-start from
  const double strict = bodies_.anySoft() ? kSoftStrict : 1.0;
  const double tolerance = (fresh ? 0.1 : 1.0) * pace_ * strict * kTolerance;
  const int most = fresh ? kFreshSweeps : kMaxSweeps;
  bodies_.startFrom({wallGain_.data(), pool.size()});
  bodies_.holdBack(diagonal_.data());
  std::fill(change_.begin(), change_.end(), 0.0f);
  double error = runDivergence(context);
  int sweep = 0;
  auto solved = [&] {
    if (def_.sweeps > 0) return sweep == def_.sweeps;
    return sweep >= most || (sweep >= kMinSweeps && error < tolerance);
  };
  for (; !solved(); ++sweep) {
    push(context, change_.data(), kappa_.data());
    bodies_.follow(kappa_.data());
    error = runDivergence(context);
  }
  giveBack();
  bodies_.settle(kappa_.data());
  stats.sweeps = sweep + 1;
}

// What particles in tension took for themselves comes back to all of them alike.
void Dfsph::giveBack() {
  const Matrices<const float> b = arrangement_.correction();
  struct Part {
    double x, y, count;
  };
  const auto taken = reduceBlocks<Part>(
      grid_.size(), {0.0, 0.0, 0.0},
      [&](std::size_t begin, std::size_t end) {
        Part part{0.0, 0.0, 0.0};
        for (std::size_t i = begin; i < end; ++i) {
          if (tense_[i] == 0) continue;
          const float twice = 2.0f * kappa_[i];
          part.x -= static_cast<double>(twice * (b.xx[i] * arrangement_.skewX[i] + b.xy[i] * arrangement_.skewY[i]));
          part.y -= static_cast<double>(twice * (b.xy[i] * arrangement_.skewX[i] + b.yy[i] * arrangement_.skewY[i]));
          part.count += 1.0;
        }
        return part;
      },
      [](const Part& p, const Part& q) {
        return Part{p.x + q.x, p.y + q.y, p.count + q.count};
      });
  if (taken.count == 0.0) return;
  const auto x = static_cast<float>(taken.x / taken.count), y = static_cast<float>(taken.y / taken.count);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (tense_[i] == 0) continue;
      shiftX_[i] -= x;
      shiftY_[i] -= y;
    }
  });
}

// Away from where neighbours are nearer: under negative pressure they would clump.
void Dfsph::evenOut() {
  constexpr auto kUnits = static_cast<float>(lattice::kUnitsPerSpacing);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      solvedX_[i] = shiftX_[i];
      solvedY_[i] = shiftY_[i];
      if (arrangement_.deep(i) || tense_[i] != 0) {
        const float even = tense_[i] != 0 ? -kEven : kEven;
        shiftX_[i] -= even * arrangement_.skewX[i];
        shiftY_[i] -= even * arrangement_.skewY[i];
      }
      latticeX_[i] = lattice::sum(latticeX_[i], static_cast<std::int32_t>(std::lrintf(shiftX_[i] * kUnits)));
      latticeY_[i] = lattice::sum(latticeY_[i], static_cast<std::int32_t>(std::lrintf(shiftY_[i] * kUnits)));
      if (target_[i] != kNever) target_[i] = 1.0f;
    }
  });
  holdCarried(false);
}

void Dfsph::solveDensity(const StepContext& context, ParticlePool& pool) {
  evenOut();
  std::fill_n(smoothX_.begin(), pool.size(), 0.0f);  // a κ that starts from nothing in each sweep
  const PressureUpdate update{target_.data(), diagonal_.data(), smoothX_.data(), change_.data(), kShare};
  const DensityLoop loop = densityLoop(pool.column(density_).data(), nullptr, update);
  const auto count = static_cast<double>(pool.size());
  for (int sweep = 0;; ++sweep) {
    const double compression = runDensity(context, loop) / count;
    if (compression < kDensityTolerance || sweep == kDensitySweeps) return;
    runDisplacement(context, change_.data(), nullptr, false);
  }
}

std::size_t Dfsph::memoryBytes() const {
  return ParticleFluid::memoryBytes() + 3 * totalX_.capacity() * sizeof(float) + tense_.capacity();
}

}  // namespace froude
