#include <froude/solver/fluid/wcsph.h>

#include <bit>
#include <utility>

#include <froude/base/error.h>
#include <froude/base/random.h>
#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

// Measurements: docs/decisions/solver-wcsph.md.
constexpr double kCourant = 0.2;  // of the support radius a sub-step
// Walls, gradients and cells stand still in a sub-step: κ of twice the typical and of the highest pressure, from which
// a row of particles swings against them, and gains by it.
constexpr double kTypicalStiffness = 0.3, kLargestStiffness = 0.6;
constexpr float kLone = 0.5f;       // density below which nothing pulls at a particle
constexpr double kMach = 0.1;       // largest speed that is to be expected, over c
constexpr double kMostMach = 0.12;  // inside the fluid; beyond, c is raised
constexpr double kAcoustic = 1.0;   // units/(c + v) an acoustic step; from 2 on a lattice would be unstable
// Of the change of ρ' in an acoustic step, added to ρ' where a surface is tense: a drop that has drawn itself round
// would ring for long.
constexpr float kDamping = 0.5f;
constexpr int kMostSteps = 64;     // acoustic ones a sub-step
constexpr float kStiffest = 1.2f;  // diagonal of div grad from which a fluid is made softer
// Of what densities differ from the sum over particles, taken back in an acoustic step; and at most in a sub-step.
constexpr double kReturn = 1e-3, kMostReturn = 0.1;
// Of S, by which a particle gives way to an uneven neighbourhood, and by which it strays: times twice the way of the
// fastest in units, at most kMostWay.
constexpr float kEven = 1.0f, kStray = 0.07f, kMostWay = 0.3f;

// In [−1, 1)², from a particle's place in the order of the cells and the time: the same on any number of threads,
// straight through or resumed.
std::array<float, 2> stray(std::size_t i, std::uint64_t time) {
  const auto words = philox(
      {static_cast<std::uint32_t>(i), 0, static_cast<std::uint32_t>(time), static_cast<std::uint32_t>(time >> 32)},
      {0, 0});
  auto number = [](std::uint32_t word) { return static_cast<float>(word >> 8) * 0x1p-23f - 1.0f; };
  return {number(words[0]), number(words[1])};
}

}  // namespace

double acousticStepAt(const FluidDef& def, double speed) {
  const double sound = def.compressible.soundSpeed > 0.0
                           ? def.compressible.soundSpeed
                           : std::max(speed, std::sqrt(def.surfaceTension / (def.density * def.spacing))) / kMach;
  return kAcoustic * supportOf(def) / kernel::kSupport / (sound + speed);
}

Wcsph::Wcsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : ParticleFluid(def, domain, pool,
                    {kCourant, kTypicalStiffness, kLargestStiffness, 0.0, kernel::Kind::WendlandC2}) {
  if (!(def.compressible.support >= 2.0 && def.compressible.support <= 6.0)) {
    throw Error("the support of wcsph is 2 to 6 spacings");
  }
}

void Wcsph::archive(Archive& a) { a.value("sound speed", soundSpeed_); }

double Wcsph::acousticStep(double speed) const { return kAcoustic * unit_ / (soundSpeed_ + speed); }

StepBound Wcsph::stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const {
  StepBound bound = ParticleFluid::stepBound(pool, maxSpeed, gravity);
  if (soundSpeed_ == 0.0) return bound;
  // The largest speed, not `flowSpeed_`: that one is not part of the state.
  bound.tighten(kMostSteps * acousticStep(maxSpeed), StepLimit::Acoustic);
  const double alpha = def_.compressible.artificialViscosity;
  if (alpha > 0.0) bound.tighten(unit_ / (alpha * soundSpeed_), StepLimit::Viscosity);
  return bound;
}

void Wcsph::solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  for (AlignedArray<float>* a : {&excess_, &nextExcess_, &least_, &share_, &sign_}) a->resize(pool.size());
  const bool fresh = soundSpeed_ == 0.0;
  findNear(context);
  findArrangement(context, nextExcess_.data(), diagonal_.data());
  findWallGain(context, context.dt);
  chooseSoundSpeed(context, pool);
  const double wanted = std::ceil(context.dt / acousticStep(flowSpeed_) * (1.0 - 1e-9));
  const int steps = def_.sweeps > 0 ? def_.sweeps : static_cast<int>(std::min(wanted, 2.0 * kMostSteps));
  start(context, pool, steps, fresh);
  bodies_.startFrom({wallGain_.data(), pool.size()});
  if (fresh) findStartPressure(context);
  takePressures(true);
  for (int k = 0; k < steps; ++k) {
    kick(context, k, steps);
    compressAndDrift(context, steps, k + 1 == steps);
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
  double speed = std::max(flowSpeed_, tension_.fastestWave());
  walls_.forEachLink([&](const WallLink& link) {
    const Vec2 at(predictedX_[link.particle], predictedY_[link.particle]);
    speed =
        std::max(speed, context.obstacles.surfaceVelocityAt(link.owner, at, Vec2(link.normalX, link.normalY)).norm());
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

void Wcsph::start(const StepContext& context, const ParticlePool& pool, int steps, bool fresh) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const auto density = pool.column(density_);
  const double dt = context.dt / steps, perUnit = dt / unit_;
  stiffness_ = static_cast<float>(soundSpeed_ * soundSpeed_ * perUnit * perUnit);
  background_ = static_cast<float>(def_.compressible.backgroundPressure / (def_.density * soundSpeed_ * soundSpeed_));
  const double perSpacing = 1.0 / unit_;
  const bool open = arrangement_.hasSurface();
  if (open) background_ = 0.0f;
  taken_ = Vec2(0.0, 0.0);
  const auto back = fresh ? 0.0f : static_cast<float>(std::min(kMostReturn, kReturn * steps));
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 g = context.gravity.at({x[i], y[i]}, context.time);
      fallX_[i] = static_cast<float>(dt * g.x() * perUnit);
      fallY_[i] = static_cast<float>(dt * g.y() * perUnit);
      moveX_[i] = static_cast<float>((vx[i] - context.dt * g.x()) * perUnit);
      moveY_[i] = static_cast<float>((vy[i] - context.dt * g.y()) * perUnit);
      // Back from where it was predicted to where it is.
      latticeX_[i] = lattice::coordinate((x[i] - domain_.box.min.x()) * perSpacing);
      latticeY_[i] = lattice::coordinate((y[i] - domain_.box.min.y()) * perSpacing);
      excess_[i] = density[i] > 0.0f ? density[i] - 1.0f : 0.0f;
      if (!arrangement_.atSurface(i)) excess_[i] += back * (nextExcess_[i] - 1.0f - excess_[i]);
      least_[i] = nextExcess_[i] < kLone ? 0.0f : -kNever;
      sign_[i] = open && arrangement_.inside(i) && excess_[i] < 0.0f ? -1.0f : 1.0f;
      kappa_[i] = solvedX_[i] = solvedY_[i] = target_[i] = 0.0f;
    }
  });
  if (tension_.any()) spreadTension(context, steps);
  walls_.forEachFilm([&](std::uint32_t i) { target_[i] = kNever; });
  for (const Carried& c : carried_) {  // goes its own way, without gravity, whatever others give back
    const std::uint32_t i = c.particle;
    fallX_[i] = fallY_[i] = 0.0f;
    moveX_[i] = static_cast<float>(vx[i] * perUnit);
    moveY_[i] = static_cast<float>(vy[i] * perUnit);
    sign_[i] = 1.0f;
  }
  findDiagonal();
  limitStiffness();
}

// All that the outline pulls is in the velocities: back out of them, and a share of it into each acoustic step.
void Wcsph::spreadTension(const StepContext& context, int steps) {
  const double whole = tension_.unit() * context.dt * context.dt / (steps * unit_), share = whole / steps;
  auto give = [&](std::uint32_t i, const Vec2& pull) {
    moveX_[i] -= static_cast<float>(whole * pull.x());
    moveY_[i] -= static_cast<float>(whole * pull.y());
    fallX_[i] += static_cast<float>(share * pull.x());
    fallY_[i] += static_cast<float>(share * pull.y());
  };
  tension_.forEachPull([&](const SurfaceTension::Pull& p) {
    give(p.first, p.pull);
    give(p.second, -p.pull);
  });
  tension_.forEachWallPull([&](const SurfaceTension::WallPull& p) { give(p.particle, p.pull); });
}

// Of div grad, as dfsph's, with the mirror image of the fluid behind walls: (BS + 2g)² + Σ|B∇W|².
void Wcsph::findDiagonal() {
  const Matrices<const float> b = arrangement_.correction();
  const bool walls = walls_.any();
  const auto volume = static_cast<float>(volume_);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float gx = walls ? walls_.gradientX()[i] : 0.0f, gy = walls ? walls_.gradientY()[i] : 0.0f;
      const float sx = arrangement_.skewX[i], sy = arrangement_.skewY[i];
      const float x = b.xx[i] * sx + b.xy[i] * sy + 2.0f * gx, y = b.xy[i] * sx + b.yy[i] * sy + 2.0f * gy;
      const float square = b.xx[i] * b.xx[i] + b.yy[i] * b.yy[i] + 2.0f * b.xy[i] * b.xy[i];
      diagonal_[i] = x * x + y * y + 0.5f * square * volume * volume * diagonal_[i];
    }
  });
}

// Where walls make a corner, pressures push harder and densities gain more: there the fluid is softer, or the acoustic
// steps of all would have to be shorter. Its pressure is the same at rest.
void Wcsph::limitStiffness() {
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      share_[i] = std::min(1.0f, kStiffest / std::max(diagonal_[i], kSmallestDiagonal));
    }
  });
}

// Tait's exponent is 7.
void Wcsph::takePressures(bool byEquation) {
  const Matrices<const float> b = arrangement_.correction();
  const bool tait = byEquation && def_.compressible.equation == EquationOfState::Tait;
  const auto volume = static_cast<float>(volume_);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      excess_[i] = std::max(least_[i], excess_[i]);
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
ForceLoop Wcsph::forceLoop(float* ux, float* uy) {
  ForceLoop loop;
  loop.pressure = change_.data();
  loop.sign = sign_.data();
  loop.scaled = {arrangement_.xx.data(), arrangement_.xy.data(), arrangement_.yy.data()};
  loop.wallX = walls_.any() ? walls_.gradientX() : nullptr;
  loop.wallY = walls_.gradientY();
  loop.tangent = walls_.tangent();
  loop.shiftX = shiftX_.data();
  loop.shiftY = shiftY_.data();
  loop.ux = ux;
  loop.uy = uy;
  return loop;
}

void Wcsph::accelerate(const StepContext& context, const ForceLoop& loop) {
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  pairSums_.resize(blockCount(occupied_.size(), kCellBlock));
  parallelFor(occupied_.size(), kCellBlock, [&](std::size_t begin, std::size_t end) {
    pairSums_[begin / kCellBlock] = loops.force(pairs, loop, begin, end);
  });
  for (const std::array<double, 2>& sum : pairSums_) taken_ += Vec2(sum[0], sum[1]);
}

void Wcsph::kick(const StepContext& context, int step, int steps) {
  ForceLoop loop = forceLoop(moveX_.data(), moveY_.data());
  loop.kappa = kappa_.data();
  loop.fallX = fallX_.data();
  loop.fallY = fallY_.data();
  loop.totalX = solvedX_.data();
  loop.totalY = solvedY_.data();
  accelerate(context, loop);
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    c.spared += steps * Vec2(static_cast<double>(shiftX_[i]), static_cast<double>(shiftY_[i]));
    moveX_[i] -= shiftX_[i];
    moveY_[i] -= shiftY_[i];
    shiftX_[i] = shiftY_[i] = solvedX_[i] = solvedY_[i] = 0.0f;
  }
  bodies_.follow(kappa_.data(), steps, (step + 1.0) / steps);
}

RateLoop Wcsph::rateLoop(const float* ux, const float* uy) {
  RateLoop loop;
  loop.ux = ux;
  loop.uy = uy;
  loop.excess = excess_.data();
  loop.ax = shiftX_.data();
  loop.ay = shiftY_.data();
  loop.correction = arrangement_.correction();
  loop.volume = static_cast<float>(volume_);
  loop.slope = -1.0f / stiffness_;
  loop.wallX = walls_.any() ? walls_.gradientX() : nullptr;
  loop.wallY = walls_.gradientY();
  loop.wallGain = bodies_.answered();
  loop.share = share_.data();
  loop.next = nextExcess_.data();
  return loop;
}

void Wcsph::compress(const StepContext& context, const RateLoop& loop) {
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.rate(pairs, loop, begin, end); });
  excess_.swap(nextExcess_);
}

// And all that the next acoustic step begins with: pressures and places.
void Wcsph::compressAndDrift(const StepContext& context, int steps, bool last) {
  RateLoop loop = rateLoop(moveX_.data(), moveY_.data());
  loop.diffusion = static_cast<float>(2.0 * def_.compressible.densityDiffusion) * std::sqrt(stiffness_);
  loop.wallShare = static_cast<float>(1.0 / steps);
  loop.newX = nextX_.data();
  loop.newY = nextY_.data();
  if (!last) {
    loop.state = {least_.data(),
                  stiffness_,
                  background_,
                  def_.compressible.equation == EquationOfState::Tait,
                  tension_.any() ? kDamping : 0.0f,
                  change_.data(),
                  {arrangement_.xx.data(), arrangement_.xy.data(), arrangement_.yy.data()}};
  }
  compress(context, loop);
  latticeX_.swap(nextX_);
  latticeY_.swap(nextY_);
  if (!last) quietFilms();
}

// A film bears nothing.
void Wcsph::quietFilms() {
  walls_.forEachFilm(
      [&](std::uint32_t i) { change_[i] = arrangement_.xx[i] = arrangement_.xy[i] = arrangement_.yy[i] = 0.0f; });
}

// What counts as velocity is in `solved`, the way in `shift`: away from where neighbours are nearer as well, in
// proportion to the way of the fastest, and a little astray, or rows that the flow shears would stay rows until they
// burst.
void Wcsph::finish(const StepContext& context, ParticlePool& pool, int steps) {
  const auto density = pool.column(density_);
  const auto count = static_cast<float>(steps);
  giveBack();
  const float way = std::min(kMostWay, static_cast<float>(2.0 * context.dt / unit_ * flowSpeed_));
  const float even = kEven * way, astray = kStray * way;
  const double perSpacing = 1.0 / unit_;
  // From where it was predicted to where the acoustic steps have brought it.
  auto drifted = [&](double predicted, double low, std::int32_t now) {
    return static_cast<float>(lattice::difference(now, lattice::coordinate((predicted - low) * perSpacing))) *
           static_cast<float>(1.0 / lattice::kUnitsPerSpacing);
  };
  const auto moment = std::bit_cast<std::uint64_t>(context.time);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      solvedX_[i] *= count;
      solvedY_[i] *= count;
      kappa_[i] *= count;
      shiftX_[i] = drifted(predictedX_[i], domain_.box.min.x(), latticeX_[i]);
      shiftY_[i] = drifted(predictedY_[i], domain_.box.min.y(), latticeY_[i]);
      density[i] = 1.0f + excess_[i];
      if (!arrangement_.closed(i)) continue;
      const float sx = arrangement_.skewX[i] + (walls_.any() ? walls_.gradientX()[i] : 0.0f);
      const float sy = arrangement_.skewY[i] + (walls_.any() ? walls_.gradientY()[i] : 0.0f);
      const auto [x, y] = stray(i, moment);
      shiftX_[i] += astray * x - even * sx;
      shiftY_[i] += astray * y - even * sy;
    }
  });
  for (const Carried& c : carried_) shiftX_[c.particle] = shiftY_[c.particle] = 0.0f;
  laplacianMoment_ = arrangement_.laplacianMoment();
  // Of Monaghan's term in two dimensions (Rep. Prog. Phys. 68 (2005), eq. 4.6), h half the support radius.
  pairViscosity_ = def_.compressible.artificialViscosity * soundSpeed_ * unit_ / 8.0;
  bodies_.settle(kappa_.data());
}

// What particles in tension took for themselves, over all acoustic steps, comes back to all of them alike.
void Wcsph::giveBack() {
  const double tense = parallelSum(grid_.size(), [&](std::size_t begin, std::size_t end) {
    double part = 0.0;
    for (std::size_t i = begin; i < end; ++i) part += sign_[i] < 0.0f ? 1.0 : 0.0;
    return part;
  });
  if (tense == 0.0) return;
  const auto x = static_cast<float>(taken_.x() / tense), y = static_cast<float>(taken_.y() / tense);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (sign_[i] > 0.0f) continue;
      solvedX_[i] -= x;
      solvedY_[i] -= y;
    }
  });
}

std::size_t Wcsph::memoryBytes() const { return ParticleFluid::memoryBytes() + 5 * excess_.capacity() * sizeof(float); }

}  // namespace froude
