#include <froude/solver/fluid/pbf.h>

#include <froude/base/parallel.h>
#include <froude/solver/fluid/kernel.h>

namespace froude {
namespace {

// Defaults and their measurements: docs/decisions/solver-pbf.md.
constexpr double kCourant = 0.6;  // of the support radius a sub-step; 1 would be unstable by definition
constexpr double kTypicalStiffness = 0.15, kLargestStiffness = 0.3;
constexpr double kSmoothing = 0.05;  // XSPH (the paper's eq. 17)
constexpr int kMinSweeps = 2, kMaxSweeps = 30;
constexpr int kFreshSweeps = 300;       // where no pressure is known yet
constexpr double kTolerance = 2e-4;     // mean density gained in a sub-step
constexpr float kStabilization = 0.3f;  // share of the density error that is shifted away a sub-step

}  // namespace

Pbf::Pbf(const FluidDef& def, const DomainDef& domain, ParticlePool& pool)
    : ParticleFluid(def, domain, pool, {kCourant, kTypicalStiffness, kLargestStiffness, kSmoothing}) {}

double Pbf::pressureFactor() const { return kernel::kGradientMoment; }

// With λ of free bodies where the pressures bring them.
DensityLoop Pbf::withBodies(DensityLoop loop) const {
  if (loop.lambda != nullptr) loop.lambda = bodies_.answered();
  return loop;
}

void Pbf::solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  bodies_.startFrom({walls_.lambda(), pool.size()});
  warmStart(context, pool);
  solveDensity(context, pool, stats);  // lines 8–19
}

void Pbf::warmStart(const StepContext& context, ParticlePool& pool) {
  const auto pressure = pool.column(pressure_), density = pool.column(density_);
  const auto unit = static_cast<float>(pressureUnit(context.dt));
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      kappa_[i] = unit * pressure[i];
      // The velocity is to keep each density as it was, so that pressures answer to the rate of compression only:
      // answering to its sum as well, kept pressures wind up and a deep fluid bounces. What has room may be compressed
      // up to its rest density.
      target_[i] = density[i] == 0.0f ? 0.0f : std::max(density[i], 1.0f - kLoose);
    }
  });
  // What is squeezed between a body and another solid bears nothing: the gap is narrower than a particle.
  walls_.forEachFilm([&](std::uint32_t i) {
    target_[i] = kNever;
    kappa_[i] = 0.0f;
  });
  // A jet that comes out becomes dense row by row; that is no compression.
  for (const Carried& c : carried_) target_[c.particle] = 0.0f;
  runDisplacement(context, kappa_.data(), nullptr);
}

void Pbf::solveDensity(const StepContext& context, ParticlePool& pool, StepStats& stats) {
  const auto density = pool.column(density_);
  const bool fresh = largestPressure_ == 0.0;  // nothing was there to warm-start from
  const PressureUpdate update{target_.data(), diagonal_.data(), kappa_.data(), change_.data(),
                              static_cast<float>(kRelaxation)};
  double excess = runDensity(context, withBodies(densityLoop(density.data(), diagonal_.data(), update)));
  bodies_.holdBack(diagonal_.data());
  int sweep = 0;
  const auto count = static_cast<double>(pool.size());
  if (fresh && excess / count > kTolerance) {
    for (std::size_t i = 0; i < pool.size(); ++i) smoothX_[i] = density[i] - target_[i];
    liftFromCoarse(context, pool, smoothX_.data());
    runDisplacement(context, change_.data(), kappa_.data());
    bodies_.follow(kappa_.data());
    excess = runDensity(context, withBodies(densityLoop(density.data(), nullptr, update)));
  }
  for (; !solved(excess / count, sweep, fresh); ++sweep) {
    runDisplacement(context, change_.data(), kappa_.data());
    bodies_.follow(kappa_.data());
    excess = runDensity(context, withBodies(densityLoop(density.data(), nullptr, update)));
  }
  bodies_.settle(kappa_.data());
  stats.sweeps = sweep + 1;
  stabilize(context, pool);
  judgeDensity(context, pool, stats);
}

// `excess`: mean density gained in the sub-step.
bool Pbf::solved(double excess, int sweep, bool fresh) const {
  if (def_.sweeps > 0) return sweep == def_.sweeps;
  if (sweep < kMinSweeps) return false;
  if (sweep >= (fresh ? kFreshSweeps : kMaxSweeps)) return true;
  return excess < (fresh ? 0.1 : 1.0) * kTolerance;
}

// Density that is left above rest is shifted away without becoming velocity, as pre-stabilisation in Macklin et al.,
// "Unified particle physics", ACM Trans. Graph. 33 (2014), section 4.4: first order in time, it cannot oscillate.
void Pbf::stabilize(const StepContext& context, ParticlePool& pool) {
  const auto density = pool.column(density_);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      change_[i] = kStabilization * std::max(0.0f, density[i] - 1.0f) / std::max(diagonal_[i], kSmallestDiagonal);
      solvedX_[i] = shiftX_[i];
      solvedY_[i] = shiftY_[i];
    }
  });
  runDisplacement(context, change_.data(), nullptr, false);
  runDensity(context, withBodies(densityLoop(density.data(), nullptr, {})));
}

}  // namespace froude
