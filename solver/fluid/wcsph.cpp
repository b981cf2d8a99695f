#include <froude/solver/fluid/wcsph.h>

#include <cstdlib>
#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

double env(const char* name, double v) { const char* s = std::getenv(name); return s ? std::atof(s) : v; }
const double kCourant = env("W_COURANT", 0.2);         // of the support radius a sub-step
const double kMach = env("W_MACH", 0.1);            // v/c
const double kAcoustic = env("W_AC", 1.0);        // dx/(c + v) an acoustic step
const float kDiffusion = env("W_DELTA", 0.1);
const float kEven = env("W_EVEN", 0.1);
const float kSmoothing = env("W_XSPH", 0.0);
const int kTic = env("W_TIC", 1), kClamp = env("W_CLAMP", 1);
constexpr float kFull = 0.97f;  // density from which a kernel counts as full
constexpr float kSkew = 0.3f;   // |S + g| from which it does not
constexpr int kMostSteps = 64;

}  // namespace

Wcsph::Wcsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : ParticleFluid(def, domain, pool, {kCourant, kInfinity, kInfinity, kSmoothing}) {}

void Wcsph::archive(Archive& a) { a.value("sound speed", soundSpeed_); }

double Wcsph::acousticStep(double speed) const { return kAcoustic * unit_ / (soundSpeed_ + speed); }

StepBound Wcsph::stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const {
  StepBound bound = ParticleFluid::stepBound(pool, maxSpeed, gravity);
  if (soundSpeed_ > 0.0) bound.tighten(kMostSteps * acousticStep(maxSpeed), StepLimit::Acoustic);
  return bound;
}

void Wcsph::solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  findArrangement(context, pool);
  findWallGain(context);
  chooseSoundSpeed(context, pool);
  const double speed = static_cast<double>(maxSpeed_);
  const int steps = static_cast<int>(std::ceil(context.dt / acousticStep(speed) * (1.0 - 1e-9)));
  start(context, pool, steps);
  for (int k = 0; k < steps; ++k) {
    takePressures();
    accelerate(context);
    compress(context);
    drift();
  }
  finish(context, pool, steps);
  stats.sweeps = steps;
  judgeDensity(context, pool, stats);
}

void Wcsph::findArrangement(const StepContext& context, ParticlePool& pool) {
  const std::size_t n = pool.size();
  for (AlignedArray<float>* a : {&momentXX_, &momentXY_, &momentYY_, &skewX_, &skewY_, &wallGain_, &excess_,
                                 &nextExcess_, &moveX_, &moveY_, &wayX_, &wayY_, &fallX_, &fallY_}) {
    a->resize(n);
  }
  place_.resize(n);
  const MomentLoop loop{walls_.any() ? walls_.lambda() : nullptr,
                        target_.data(),
                        skewX_.data(),
                        skewY_.data(),
                        diagonal_.data(),
                        {momentXX_.data(), momentXY_.data(), momentYY_.data()}};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.moments(pairs, loop, begin, end); });
  const float *lambda = walls_.lambda(), *wallX = walls_.gradientX(), *wallY = walls_.gradientY();
  const bool walls = walls_.any();
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float x = static_cast<float>(volume_) * skewX_[i] + (walls ? wallX[i] : 0.0f), y = static_cast<float>(volume_) * skewY_[i] + (walls ? wallY[i] : 0.0f);
      if (volume_ < 1.0) {
        target_[i] = static_cast<float>(volume_) * (target_[i] - (walls ? lambda[i] : 0.0f)) + (walls ? lambda[i] : 0.0f);
        momentXX_[i] *= static_cast<float>(volume_); momentXY_[i] *= static_cast<float>(volume_); momentYY_[i] *= static_cast<float>(volume_);
      }
      const bool full = target_[i] > kFull && x * x + y * y < kSkew * kSkew;
      place_[i] = !full                       ? GradientCorrection::Place::AtSurface
                  : walls && lambda[i] > 0.0f ? GradientCorrection::Place::AtWall
                                              : GradientCorrection::Place::Inside;
    }
  });
  double tr = 0.0; for (std::size_t i = 0; i < n; ++i) tr += 0.5 * (momentXX_[i] + momentYY_[i]); laplacianMoment_ = tr / n;
  correction_.build(grid_, occupied_, {momentXX_.data(), momentXY_.data(), momentYY_.data()}, place_.data());
}

void Wcsph::findWallGain(const StepContext& context) {
  std::fill(wallGain_.begin(), wallGain_.end(), 0.0f);
  walls_.forEachLink([&](const WallLink& link) {
    if (link.owner < 0) return;
    const Vec2 at(predictedX_[link.particle], predictedY_[link.particle]);
    const Vec2 way = context.obstacles.velocityAt(link.owner, at) / unit_;
    const Vec2 gradient(static_cast<double>(link.gradientX), static_cast<double>(link.gradientY));
    wallGain_[link.particle] -= static_cast<float>(way.dot(gradient));
  });
}

void Wcsph::chooseSoundSpeed(const StepContext& context, const ParticlePool& pool) {
  const auto vx = pool.vx(), vy = pool.vy();
  double inside = 0.0, any = 0.0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const double v = vx[i] * vx[i] + vy[i] * vy[i];
    any = std::max(any, v);
    if (place_[i] != GradientCorrection::Place::AtSurface) inside = std::max(inside, v);
  }
  maxSpeed_ = static_cast<float>(std::sqrt(inside));
  double speed = std::sqrt(inside);
  walls_.forEachLink([&](const WallLink& link) {
    const Vec2 at(predictedX_[link.particle], predictedY_[link.particle]);
    speed = std::max(speed, context.obstacles.surfaceVelocityAt(link.owner, at, Vec2(link.normalX, link.normalY)).norm());
  });
  if (soundSpeed_ == 0.0) {
    speed = std::max(speed, std::sqrt(any));
    const auto [left, right] = std::minmax_element(pool.x().begin(), pool.x().end());
    const auto [low, high] = std::minmax_element(pool.y().begin(), pool.y().end());
    double gravity = 0.0;
    for (std::size_t i = 0; i < pool.size(); ++i)
      gravity = std::max(gravity, context.gravity.at({pool.x()[i], pool.y()[i]}, context.time).norm());
    speed = std::max(speed, std::sqrt(gravity * std::max(*right - *left, *high - *low)));
    soundSpeed_ = speed / kMach;
  }
  if (speed > 1.2 * kMach * soundSpeed_) soundSpeed_ = speed / kMach;
}

void Wcsph::start(const StepContext& context, ParticlePool& pool, int steps) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const auto density = pool.column(density_), pressure = pool.column(pressure_);
  const double dt = context.dt / steps, unit = dt / unit_;
  const double c = soundSpeed_ * unit;
  stiffness_ = static_cast<float>(c * c);
  const auto toExcess = static_cast<float>(1.0 / (soundSpeed_ * soundSpeed_));
  (void)toExcess, (void)pressure;
  constexpr auto kUnits = static_cast<float>(lattice::kUnitsPerSpacing);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 g = context.gravity.at({x[i], y[i]}, context.time);
      fallX_[i] = static_cast<float>(g.x() * dt * unit);
      fallY_[i] = static_cast<float>(g.y() * dt * unit);
      moveX_[i] = static_cast<float>((vx[i] - context.dt * g.x()) * unit);
      moveY_[i] = static_cast<float>((vy[i] - context.dt * g.y()) * unit);
      const auto backX = static_cast<float>(vx[i] * unit * steps), backY = static_cast<float>(vy[i] * unit * steps);
      wayX_[i] = -backX;
      wayY_[i] = -backY;
      latticeX_[i] = lattice::difference(latticeX_[i], static_cast<std::int32_t>(std::lrintf(backX * kUnits)));
      latticeY_[i] = lattice::difference(latticeY_[i], static_cast<std::int32_t>(std::lrintf(backY * kUnits)));
      excess_[i] = density[i] > 0.0f ? density[i] - 1.0f : 0.0f;
      wallGain_[i] *= static_cast<float>(dt);
      kappa_[i] = 0.0f;
      solvedX_[i] = solvedY_[i] = 0.0f;
      if (kTic && place_[i] == GradientCorrection::Place::Inside && excess_[i] < 0.0f) {
        skewX_[i] = -skewX_[i];
        skewY_[i] = -skewY_[i];
      }
    }
  });
}

void Wcsph::takePressures() {
  const Matrices<const float> b = correction_.matrices();
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (kClamp && place_[i] == GradientCorrection::Place::AtSurface) excess_[i] = std::max(0.0f, excess_[i]);
      const float kappa = stiffness_ * excess_[i];
      change_[i] = kappa;
      momentXX_[i] = static_cast<float>(volume_) * kappa * b.xx[i];
      momentXY_[i] = static_cast<float>(volume_) * kappa * b.xy[i];
      momentYY_[i] = static_cast<float>(volume_) * kappa * b.yy[i];
      shiftX_[i] = shiftY_[i] = 0.0f;
    }
  });
}

void Wcsph::accelerate(const StepContext& context) {
  const PushLoop loop{change_.data(),
                      {momentXX_.data(), momentXY_.data(), momentYY_.data()},
                      skewX_.data(),
                      skewY_.data(),
                      walls_.any() ? walls_.gradientX() : nullptr,
                      walls_.gradientY(),
                      walls_.tangent(),
                      shiftX_.data(),
                      shiftY_.data(),
                      moveX_.data(),
                      moveY_.data(),
                      kappa_.data()};
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.push(pairs, loop, begin, end); });
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      moveX_[i] += fallX_[i];
      moveY_[i] += fallY_[i];
      solvedX_[i] += shiftX_[i];
      solvedY_[i] += shiftY_[i];
    }
  });
}

void Wcsph::compress(const StepContext& context) {
  static AlignedArray<float> q[3];
  const auto scaledB = [&] { const auto m = correction_.matrices(); for (auto& a : q) a.resize(grid_.size()); for (std::size_t i = 0; i < grid_.size(); ++i) q[0][i] = static_cast<float>(volume_) * m.xx[i], q[1][i] = static_cast<float>(volume_) * m.xy[i], q[2][i] = static_cast<float>(volume_) * m.yy[i]; return Matrices<const float>{q[0].data(), q[1].data(), q[2].data()}; };
  const RateLoop loop{moveX_.data(),
                      moveY_.data(),
                      excess_.data(),
                      shiftX_.data(),
                      shiftY_.data(),
                      scaledB(),
                      -1.0f / stiffness_,
                      2.0f * kDiffusion * std::sqrt(stiffness_) * static_cast<float>(volume_),
                      walls_.any() ? walls_.gradientX() : nullptr,
                      walls_.gradientY(),
                      wallGain_.data(),
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

void Wcsph::finish(const StepContext& context, ParticlePool& pool, int steps) {
  const auto density = pool.column(density_);
  const auto count = static_cast<float>(steps);
  const float even = kEven * std::min(0.3f / std::max(1e-6f, kEven), 2.0f * static_cast<float>(context.dt / unit_) * maxSpeed_);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      solvedX_[i] *= count;
      solvedY_[i] *= count;
      shiftX_[i] = wayX_[i];
      shiftY_[i] = wayY_[i];
      kappa_[i] *= count;
      static const float kJit = env("W_JIT", 0.0);
      static const float kJitAll = env("W_JITALL", 0.0);
      if (correction_.deep(i) && (context.time == 0.0 || kJitAll > 0)) {
        auto hash = [&](std::uint64_t v) { v *= 0x9E3779B97F4A7C15ull; v ^= v >> 29; v *= 0xBF58476D1CE4E5B9ull; v ^= v >> 32; return static_cast<float>((v >> 40) / 8388608.0 - 1.0); };
        const float amp = (context.time == 0.0 ? kJit : 0.0f) + kJitAll * std::min(0.3f, 2.0f * static_cast<float>(context.dt / unit_) * maxSpeed_);
        const auto seed = static_cast<std::uint64_t>(context.time * 1e9);
        shiftX_[i] += amp * hash(2 * i + 7 + seed), shiftY_[i] += amp * hash(2 * i + 8 + seed);
      }
      if (correction_.deep(i)) {
        const float s = kTic && place_[i] == GradientCorrection::Place::Inside && density[i] > 0.0f && density[i] < 1.0f ? -even : even;
        shiftX_[i] -= s * static_cast<float>(volume_) * skewX_[i];
        shiftY_[i] -= s * static_cast<float>(volume_) * skewY_[i];
      }
    }
  });
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) density[i] = 1.0f + excess_[i];
  });
  bodies_.settle(kappa_.data());
}

std::size_t Wcsph::memoryBytes() const {
  return ParticleFluid::memoryBytes() + correction_.memoryBytes() + 14 * moveX_.capacity() * sizeof(float) +
         place_.capacity();
}

}  // namespace froude
