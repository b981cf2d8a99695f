#include <froude/solver/fluid/wcsph.h>

#include <bit>
#include <cstdlib>
#include <cstdio>
#include <utility>

#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

double env(const char* name, double v) { const char* s = std::getenv(name); return s ? std::atof(s) : v; }
const double kCourant = env("W_COURANT", 0.2);  // of the support radius a sub-step
const double kMach = env("W_MACH", 0.1);       // largest speed that is to be expected, over c
const double kMostMach = 0.12;    // speed inside the fluid at which c is raised
const double kAcoustic = env("W_AC", 1.0);     // units/(c + v) an acoustic step; 2 is where it would be unstable
constexpr int kMostSteps = 64;    // acoustic ones a sub-step
const float kEven = env("W_EVEN", 1.0);   // of S, times the way in units, by which a particle gives way to an uneven neighbourhood
const float kMostEven = 0.3f;
const float kStray = env("W_STRAY", 0.07);   // of the same, by which a particle strays
const int kClamp = env("W_CLAMP", 1), kStart = env("W_START", 1);
constexpr double kStartSweeps = 40.0;  // at most, times √N
constexpr float kStartStep = 0.6f;
constexpr float kInnerDiagonal = 0.5f;  // half of the largest eigenvalue of div grad inside a fluid
const float kStiffest = env("W_STIFF", 1.2);
constexpr double kStartTolerance = 1e-3;

// In [−1, 1), from a particle's handle and the time: the same on any number of threads, straight through or resumed.
float stray(std::uint64_t seed) {
  seed += 0x9e3779b97f4a7c15ull;  // splitmix64, Steele et al., OOPSLA 2014
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9ull;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebull;
  seed ^= seed >> 31;
  return static_cast<float>(static_cast<std::int64_t>(seed) >> 40) / 8388608.0f;
}

}  // namespace

Wcsph::Wcsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : ParticleFluid(def, domain, pool, {kCourant, kInfinity, kInfinity, 0.0}) {}

void Wcsph::archive(Archive& a) { a.value("sound speed", soundSpeed_); }

double Wcsph::acousticStep(double speed) const { return kAcoustic * unit_ / (soundSpeed_ + speed); }

StepBound Wcsph::stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const {
  StepBound bound = ParticleFluid::stepBound(pool, maxSpeed, gravity);
  if (soundSpeed_ > 0.0) bound.tighten(kMostSteps * acousticStep(maxSpeed), StepLimit::Acoustic);
  return bound;
}

void Wcsph::solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  for (AlignedArray<float>* a : {&excess_, &nextExcess_, &moveX_, &moveY_, &fallX_, &fallY_, &wayX_, &wayY_, &share_}) {
    a->resize(pool.size());
  }
  const bool fresh = soundSpeed_ == 0.0;
  findArrangement(context, nextExcess_.data(), diagonal_.data());
  findWallGain(context, context.dt);
  chooseSoundSpeed(context, pool);
  const int steps = def_.sweeps > 0 ? def_.sweeps
                                    : static_cast<int>(std::ceil(context.dt / acousticStep(flowSpeed_) * (1.0 - 1e-9)));
  start(context, pool, steps);
  bodies_.startFrom({wallGain_.data(), pool.size()});
  if (fresh && kStart) findStartPressure(context);
  for (int k = 0; k < steps; ++k) {
    takePressures();
    kick(context, steps);
    compress(context, moveX_.data(), moveY_.data(), def_.compressible.densityDiffusion, 1.0 / steps);
    drift();
  }
  finish(context, pool, steps);
  stats.sweeps = steps;
  judgeDensity(context, pool, stats);
}

// A stray drop is no reason for a stiffer fluid: speeds count where kernels are full, and those of walls.
void Wcsph::chooseSoundSpeed(const StepContext& context, const ParticlePool& pool) {
  const auto vx = pool.vx(), vy = pool.vy();
  flowSpeed_ = std::sqrt(parallelMax(pool.size(), 0.0, [&](std::size_t begin, std::size_t end) {
    double most = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      if (!arrangement_.atSurface(i)) most = std::max(most, vx[i] * vx[i] + vy[i] * vy[i]);
    }
    return most;
  }));
  if (def_.compressible.soundSpeed > 0.0) {
    soundSpeed_ = def_.compressible.soundSpeed;
    return;
  }
  double speed = flowSpeed_;
  walls_.forEachLink([&](const WallLink& link) {
    const Vec2 at(predictedX_[link.particle], predictedY_[link.particle]);
    speed = std::max(speed, context.obstacles.surfaceVelocityAt(link.owner, at, Vec2(link.normalX, link.normalY)).norm());
  });
  if (soundSpeed_ == 0.0) {
    // What falls by the fluid's own extent, or is fast already.
    const auto [left, right] = std::minmax_element(pool.x().begin(), pool.x().end());
    const auto [low, high] = std::minmax_element(pool.y().begin(), pool.y().end());
    const double extent = std::max({*right - *left, *high - *low, def_.spacing});
    speed = std::max({speed, context.maxSpeed, std::sqrt(context.acceleration * extent), def_.viscosity / extent});
    soundSpeed_ = std::max(speed, 1e-9 * extent) / kMach;
  }
  if (speed > kMostMach * soundSpeed_) soundSpeed_ = speed / kMach;
}

void Wcsph::start(const StepContext& context, const ParticlePool& pool, int steps) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const auto density = pool.column(density_);
  const double dt = context.dt / steps, perUnit = dt / unit_;
  stiffness_ = static_cast<float>(soundSpeed_ * soundSpeed_ * perUnit * perUnit);
  background_ = static_cast<float>(def_.compressible.backgroundPressure / (def_.density * soundSpeed_ * soundSpeed_));
  constexpr auto kUnits = static_cast<float>(lattice::kUnitsPerSpacing);
  if (arrangement_.hasSurface()) background_ = 0.0f;
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 g = context.gravity.at({x[i], y[i]}, context.time);
      fallX_[i] = static_cast<float>(dt * g.x() * perUnit);
      fallY_[i] = static_cast<float>(dt * g.y() * perUnit);
      moveX_[i] = static_cast<float>((vx[i] - context.dt * g.x()) * perUnit);
      moveY_[i] = static_cast<float>((vy[i] - context.dt * g.y()) * perUnit);
      // Back from where it was predicted to where it is.
      wayX_[i] = static_cast<float>(-context.dt / unit_ * vx[i]);
      wayY_[i] = static_cast<float>(-context.dt / unit_ * vy[i]);
      latticeX_[i] = lattice::sum(latticeX_[i], static_cast<std::int32_t>(std::lrintf(wayX_[i] * kUnits)));
      latticeY_[i] = lattice::sum(latticeY_[i], static_cast<std::int32_t>(std::lrintf(wayY_[i] * kUnits)));
      excess_[i] = density[i] > 0.0f ? density[i] - 1.0f : 0.0f;
      kappa_[i] = solvedX_[i] = solvedY_[i] = target_[i] = 0.0f;
    }
  });
  walls_.forEachFilm([&](std::uint32_t i) { target_[i] = kNever; });
  const Matrices<const float> b = arrangement_.correction();
  const bool walls = walls_.any();
  const auto volume = static_cast<float>(volume_);
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const float gx = walls ? walls_.gradientX()[i] : 0.0f, gy = walls ? walls_.gradientY()[i] : 0.0f;
    const float sx = arrangement_.skewX[i], sy = arrangement_.skewY[i];
    const float bx = b.xx[i] * sx + b.xy[i] * sy, by = b.xy[i] * sx + b.yy[i] * sy;
    const float square = b.xx[i] * b.xx[i] + b.yy[i] * b.yy[i] + 2.0f * b.xy[i] * b.xy[i];
    diagonal_[i] = (bx + 2.0f * gx) * (bx + 2.0f * gx) + (by + 2.0f * gy) * (by + 2.0f * gy) + 0.5f * square * volume * volume * diagonal_[i];
  }
  limitStiffness();
}

// The pressures that a fluid has which is let go: those that take the divergence out of its acceleration. Without them a
// tank at rest would bounce for seconds. Sweeps with momentum (heavy ball, Polyak 1964) for a system of √N rows.
void Wcsph::findStartPressure(const StepContext& context) {
  const std::size_t n = grid_.size();
  const double rows = std::sqrt(static_cast<double>(n));
  const auto momentum = static_cast<float>(std::pow((rows - 1.0) / (rows + 1.0), 2));
  const float stiffness = std::exchange(stiffness_, 1.0f);
  AlignedArray<float>& last = smoothX_;
  std::fill_n(last.begin(), n, 0.0f);
  std::fill_n(excess_.begin(), n, 0.0f);
  for (std::size_t i = 0; i < n; ++i) share_[i] = kStartStep / std::max(diagonal_[i], kInnerDiagonal);
  double first = 0.0;
  for (int sweep = 0; sweep < static_cast<int>(kStartSweeps * rows); ++sweep) {
    takePressures();
    std::copy_n(fallX_.begin(), n, velocityX_.begin());
    std::copy_n(fallY_.begin(), n, velocityY_.begin());
    accelerate(context, velocityX_.data(), velocityY_.data(), nullptr);
    compress(context, velocityX_.data(), velocityY_.data(), 0.0, 0.0);
    const double error = parallelSum(n, [&](std::size_t begin, std::size_t end) {
      double part = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        const float gain = arrangement_.atSurface(i) ? std::max(excess_[i] - nextExcess_[i], -nextExcess_[i]) : excess_[i] - nextExcess_[i];
        excess_[i] = nextExcess_[i] + gain + momentum * (nextExcess_[i] - last[i]);
        part += static_cast<double>(std::abs(gain));
        last[i] = nextExcess_[i];
      }
      return part;
    });
    if (std::getenv("W_DBG") && sweep < 60) { std::size_t w = 0; for (std::size_t i = 0; i < n; ++i) if (std::abs(excess_[i]) > std::abs(excess_[w])) w = i; std::fprintf(stderr, "%d %g max %g at %g %g lambda %g g %g %g diag %g dens %d\n", sweep, error, excess_[w], predictedX_[w], predictedY_[w], walls_.lambda()[w], walls_.gradientX()[w], walls_.gradientY()[w], diagonal_[w], (int)arrangement_.place(w)); }
    if (sweep == 0) first = error;
    if (error <= kStartTolerance * first) break;
  }
  const float compliance = 1.0f / stiffness;
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) excess_[i] *= compliance;
  });
  stiffness_ = stiffness;
  limitStiffness();
}

// Where walls make a corner, pressures push harder and densities gain more: there the fluid is softer, or the acoustic
// steps of all would have to be shorter. Its pressure is the same at rest.
void Wcsph::limitStiffness() {
  for (std::size_t i = 0; i < grid_.size(); ++i) share_[i] = std::min(1.0f, kStiffest / std::max(diagonal_[i], kSmallestDiagonal));
}

// Tait's exponent is 7.
void Wcsph::takePressures() {
  const Matrices<const float> b = arrangement_.correction();
  const bool tait = def_.compressible.equation == EquationOfState::Tait;
  const auto volume = static_cast<float>(volume_);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (arrangement_.atSurface(i) && kClamp) excess_[i] = std::max(0.0f, excess_[i]);
      float kappa = excess_[i];
      if (tait) {
        const float r = 1.0f + kappa, r3 = r * r * r;
        kappa = (r3 * r3 * r - 1.0f) / 7.0f;
      }
      kappa = target_[i] == kNever ? 0.0f : stiffness_ * (kappa + background_);
      change_[i] = kappa;
      arrangement_.xx[i] = volume * kappa * b.xx[i];
      arrangement_.xy[i] = volume * kappa * b.xy[i];
      arrangement_.yy[i] = volume * kappa * b.yy[i];
    }
  });
}

// To `shift` and on top of u what the pressures do.
void Wcsph::accelerate(const StepContext& context, float* ux, float* uy, float* kappa) {
  const ForceLoop loop{change_.data(),
                       {arrangement_.xx.data(), arrangement_.xy.data(), arrangement_.yy.data()},
                       walls_.any() ? walls_.gradientX() : nullptr,
                       walls_.gradientY(),
                       walls_.tangent(),
                       shiftX_.data(),
                       shiftY_.data(),
                       ux,
                       uy,
                       kappa};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.force(pairs, loop, begin, end); });
}

void Wcsph::kick(const StepContext& context, int steps) {
  accelerate(context, moveX_.data(), moveY_.data(), kappa_.data());
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    c.spared += steps * Vec2(static_cast<double>(shiftX_[i]), static_cast<double>(shiftY_[i]));
    moveX_[i] -= shiftX_[i];
    moveY_[i] -= shiftY_[i];
    shiftX_[i] = shiftY_[i] = fallX_[i] = fallY_[i] = 0.0f;
  }
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      moveX_[i] += fallX_[i];
      moveY_[i] += fallY_[i];
      solvedX_[i] += shiftX_[i];
      solvedY_[i] += shiftY_[i];
    }
  });
  bodies_.follow(kappa_.data(), steps);
}

void Wcsph::compress(const StepContext& context, const float* ux, const float* uy, double diffusion, double wallShare) {
  // The matrices are free again: the volume goes with the gradients.
  const Matrices<const float> b = arrangement_.correction();
  const auto volume = static_cast<float>(volume_);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      arrangement_.xx[i] = volume * b.xx[i];
      arrangement_.xy[i] = volume * b.xy[i];
      arrangement_.yy[i] = volume * b.yy[i];
    }
  });
  const RateLoop loop{ux,
                      uy,
                      excess_.data(),
                      shiftX_.data(),
                      shiftY_.data(),
                      {arrangement_.xx.data(), arrangement_.xy.data(), arrangement_.yy.data()},
                      -1.0f / stiffness_,
                      static_cast<float>(2.0 * diffusion * volume_) * std::sqrt(stiffness_),
                      walls_.any() ? walls_.gradientX() : nullptr,
                      walls_.gradientY(),
                      bodies_.answered(),
                      static_cast<float>(wallShare),
                      share_.data(),
                      nextExcess_.data()};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.rate(pairs, loop, begin, end); });
  excess_.swap(nextExcess_);
}

void Wcsph::drift() {
  constexpr auto kUnits = static_cast<float>(lattice::kUnitsPerSpacing);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      wayX_[i] += moveX_[i];
      wayY_[i] += moveY_[i];
      latticeX_[i] = lattice::sum(latticeX_[i], static_cast<std::int32_t>(std::lrintf(moveX_[i] * kUnits)));
      latticeY_[i] = lattice::sum(latticeY_[i], static_cast<std::int32_t>(std::lrintf(moveY_[i] * kUnits)));
    }
  });
}

// What counts as velocity is in `solved`, the way in `shift`: away from where neighbours are nearer as well, in
// proportion to the way of the fastest, and a little astray, or rows that the flow shears would stay rows until they
// burst.
void Wcsph::finish(const StepContext& context, ParticlePool& pool, int steps) {
  const auto density = pool.column(density_);
  const auto count = static_cast<float>(steps);
  const auto way = static_cast<float>(2.0 * context.dt / unit_ * flowSpeed_);
  const float even = std::min(kMostEven, kEven * way), astray = kStray * std::min(kMostEven, way);
  const auto moment = std::bit_cast<std::uint64_t>(context.time);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      solvedX_[i] *= count;
      solvedY_[i] *= count;
      kappa_[i] *= count;
      shiftX_[i] = wayX_[i];
      shiftY_[i] = wayY_[i];
      density[i] = 1.0f + excess_[i];
      if (!arrangement_.deep(i)) continue;
      const std::uint64_t seed = moment + 2 * i;
      shiftX_[i] += astray * stray(seed) - even * arrangement_.skewX[i];
      shiftY_[i] += astray * stray(seed + 1) - even * arrangement_.skewY[i];
    }
  });
  for (const Carried& c : carried_) {
    shiftX_[c.particle] = wayX_[c.particle];
    shiftY_[c.particle] = wayY_[c.particle];
  }
  laplacianMoment_ = arrangement_.laplacianMoment();
  bodies_.settle(kappa_.data());
}

std::size_t Wcsph::memoryBytes() const {
  return ParticleFluid::memoryBytes() + 10 * moveX_.capacity() * sizeof(float);
}

}  // namespace froude
