#include <froude/solver/fluid/dfsph.h>

#include <limits>

#include <froude/base/parallel.h>
#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

double env(const char* name, double value) { const char* s = std::getenv(name); return s ? std::atof(s) : value; }
const double kCourant = env("DF_C", 0.3);  // of the support radius a sub-step
const double kTypicalStiffness = env("DF_T", 0.15), kLargestStiffness = env("DF_L", 0.3);
const double kSmoothing = env("DF_S", 0.0);
const int kMinSweeps = (int)env("DF_MIN", 2), kMaxSweeps = (int)env("DF_MAX", 100);
const int kFreshSweeps = 1000;
const double kTolerance = env("DF_TOL", 1e-4);
const double kFull = env("DF_FULL", 0.97);       // density
const double kSkew = env("DF_SKEW", 0.3);       // |∇C|
const int kShiftSweeps = (int)env("DF_SH", 1);
const double kShare = env("DF_SHARE", 0.3);
const int kB = (int)env("DF_B", 1);
const double kBack = env("DF_BACK", 0.0);
const double kNegD = env("DF_NEGD", 0.0);

}  // namespace

Dfsph::Dfsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : ParticleFluid(def, domain, pool, {kCourant, kTypicalStiffness, kLargestStiffness, kSmoothing}) {}

void Dfsph::solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  prepare(context, pool);
  solveDivergence(context, pool, stats);
  solveDensity(context, pool, stats);
  judgeDensity(context, pool, stats);
}

// λ grows where a wall comes nearer: the same as if the particle went the other way.
void Dfsph::findWallGain(const StepContext& context) {
  std::fill(wallGain_.begin(), wallGain_.end(), 0.0f);
  const double scale = context.dt / dx_;
  walls_.forEachLink([&](const WallLink& link) {
    if (link.owner < 0) return;
    const Vec2 at(predictedX_[link.particle], predictedY_[link.particle]);
    const Vec2 way = scale * context.obstacles.velocityAt(link.owner, at);
    wallGain_[link.particle] -= static_cast<float>(way.x()) * link.gradientX + static_cast<float>(way.y()) * link.gradientY;
  });
}

void Dfsph::prepare(const StepContext& context, ParticlePool& pool) {
  const std::size_t n = pool.size();
  for (AlignedArray<float>* a : {&totalX_, &totalY_, &least_, &wallGain_, &skewX_, &skewY_}) a->resize(n);
  for (Field* f : {&correction_, &scaled_}) f->xx.resize(n), f->xy.resize(n), f->yy.resize(n);
  findWallGain(context);
  const auto vx = pool.vx(), vy = pool.vy();
  const auto pressure = pool.column(pressure_), density = pool.column(density_);
  const MomentLoop loop{walls_.any() ? walls_.lambda() : nullptr, walls_.gradientX(), walls_.gradientY(),
                        density.data(), skewX_.data(), skewY_.data(), diagonal_.data(), correction_.out()};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.moments(pairs, loop, begin, end); });
  const auto unit = static_cast<float>(pressureUnit(context.dt));
  const double way = context.dt / dx_;
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      totalX_[i] = static_cast<float>(way * vx[i]);
      totalY_[i] = static_cast<float>(way * vy[i]);
      const float gx = walls_.any() ? walls_.gradientX()[i] : 0.0f, gy = walls_.any() ? walls_.gradientY()[i] : 0.0f;
      const float ax = skewX_[i] + gx, ay = skewY_[i] + gy;
      const bool full = density[i] > (float)kFull && ax * ax + ay * ay < (float)(kSkew * kSkew);
      const float xx = correction_.xx[i], xy = correction_.xy[i], yy = correction_.yy[i], det = xx * yy - xy * xy;
      const bool corrected = kB > 0 && full && (walls_.any() ? walls_.lambda()[i] : 0.0f) == 0.0f && det > 0.5f;
      const float b0 = corrected ? 1.0f / det : 1.0f;
      correction_.xx[i] = corrected ? yy * b0 : 1.0f;
      correction_.yy[i] = corrected ? xx * b0 : 1.0f;
      correction_.xy[i] = corrected ? -xy * b0 : 0.0f;
      const float cx = correction_.xx[i] * skewX_[i] + correction_.xy[i] * skewY_[i], cy = correction_.xy[i] * skewX_[i] + correction_.yy[i] * skewY_[i];
      const float b2 = correction_.xx[i] * correction_.xx[i] + correction_.yy[i] * correction_.yy[i] + 2.0f * correction_.xy[i] * correction_.xy[i];
      diagonal_[i] = (cx + gx) * (cx + 2.0f * gx) + (cy + gy) * (cy + 2.0f * gy) + 0.5f * b2 * diagonal_[i];
      least_[i] = full ? -1e30f : 0.0f;
      kappa_[i] = std::max(unit * pressure[i], least_[i]);
      target_[i] = full ? 0.0f : std::max(0.0f, 1.0f - kLoose - density[i]);
    }
  });
  walls_.forEachFilm([&](std::uint32_t i) {
    target_[i] = kNever;
    kappa_[i] = least_[i] = 0.0f;
  });
}

void Dfsph::push(const StepContext& context, const float* pressure, float* kappa) {
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      scaled_.xx[i] = pressure[i] * correction_.xx[i];
      scaled_.xy[i] = pressure[i] * correction_.xy[i];
      scaled_.yy[i] = pressure[i] * correction_.yy[i];
    }
  });
  const PushLoop loop{pressure, scaled_.in(), skewX_.data(), skewY_.data(), walls_.any() ? walls_.gradientX() : nullptr,
                      walls_.gradientY(), walls_.tangent(), shiftX_.data(), shiftY_.data(), totalX_.data(), totalY_.data(), kappa};
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

void Dfsph::solveDivergence(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  const bool fresh = largestPressure_ == 0.0;
  const auto count = static_cast<double>(pool.size());
  bodies_.startFrom({wallGain_.data(), pool.size()});
  bodies_.holdBack(diagonal_.data());
  const PressureUpdate update{target_.data(), diagonal_.data(), kappa_.data(), change_.data(),
                              static_cast<float>(kRelaxation), least_.data()};
  auto run = [&] {
    const DivergenceLoop loop{totalX_.data(), totalY_.data(), correction_.in(), walls_.any() ? walls_.gradientX() : nullptr,
                              walls_.gradientY(), bodies_.answered(), update};
    const PairFrame pairs = frame();
    const PairLoops& loops = pairLoops(context.simd);
    return sumOverCells([&](std::size_t begin, std::size_t end) { return loops.divergence(pairs, loop, begin, end); }) /
           count;
  };
  push(context, kappa_.data(), nullptr);
  double excess = run();
  int sweep = 0;
  const double tolerance = (fresh ? 0.1 : 1.0) * kTolerance;
  const int most = fresh ? kFreshSweeps : kMaxSweeps;
  while (sweep < most && (sweep < kMinSweeps || excess > tolerance)) {
    push(context, change_.data(), kappa_.data());
    bodies_.follow(kappa_.data());
    excess = run();
    ++sweep;
  }
  bodies_.settle(kappa_.data());
  stats.sweeps = sweep + 1;
}

void Dfsph::solveDensity(const StepContext& context, ParticlePool& pool, StepStats&) {
  const std::size_t n = pool.size();
  const auto density = pool.column(density_);
  constexpr auto kUnits = static_cast<float>(lattice::kUnitsPerSpacing);
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      solvedX_[i] = shiftX_[i];
      solvedY_[i] = shiftY_[i];
      latticeX_[i] = lattice::sum(latticeX_[i], static_cast<std::int32_t>(std::lrintf(shiftX_[i] * kUnits)));
      latticeY_[i] = lattice::sum(latticeY_[i], static_cast<std::int32_t>(std::lrintf(shiftY_[i] * kUnits)));
    }
  });
  if (kBack > 0) parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (least_[i] == 0.0f) continue;
      const float gx = walls_.any() ? walls_.gradientX()[i] : 0.0f, gy = walls_.any() ? walls_.gradientY()[i] : 0.0f;
      float sx = -2.0f * (float)kBack * (skewX_[i] + gx), sy = -2.0f * (float)kBack * (skewY_[i] + gy);
      shiftX_[i] += sx; shiftY_[i] += sy;
      latticeX_[i] = lattice::sum(latticeX_[i], static_cast<std::int32_t>(std::lrintf(sx * kUnits)));
      latticeY_[i] = lattice::sum(latticeY_[i], static_cast<std::int32_t>(std::lrintf(sy * kUnits)));
    }
  });
  for (int k = 0; k < kShiftSweeps; ++k) {
    runDensity(context, densityLoop(density.data(), nullptr, {}));
    parallelFor(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const bool full = least_[i] < 0.0f;
        const float off = density[i] - 1.0f;
        change_[i] = (float)kShare * std::max(full ? (float)(-kNegD) : 0.0f, off) / std::max(diagonal_[i], kSmallestDiagonal);
      }
    });
    runDisplacement(context, change_.data(), nullptr, false);
  }
  runDensity(context, densityLoop(density.data(), nullptr, {}));
}

std::size_t Dfsph::memoryBytes() const { return ParticleFluid::memoryBytes() + 4 * totalX_.capacity() * sizeof(float); }

}  // namespace froude
