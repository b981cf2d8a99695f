// The pressures with which a weakly compressible fluid starts.
#include <froude/solver/fluid/wcsph.h>

#include <utility>

#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

// The start pressure: sweeps at most, times √N; their step, halved where they diverge; errors over the first one.
constexpr double kStartSweeps = 40.0, kStartTolerance = 0.02, kDiverged = 1e2;
constexpr float kStartStep = 0.6f, kLeastStartStep = 0.05f;
constexpr float kProbe = 0.03f;         // way of the fastest along which its change of the rates is taken [units]
constexpr float kInnerDiagonal = 0.5f;  // half of the largest eigenvalue of div grad inside a fluid
// With a coarse level: sweeps after each of its corrections, their momentum, corrections at least and at most, and what
// the last may still change of the pressures.
constexpr int kBetween = 16, kLeastLifts = 4, kMostLifts = 12;
constexpr float kSmoothing = 0.8f;
constexpr double kOpen = 0.5;  // rows at a free surface that give all pressures their zero
constexpr double kLiftTolerance = 0.005;

}  // namespace

// To `turning_`: by how much the rates of the densities change in an acoustic step because the particles move on with
// the velocities that they have, −∇u:∇u; central differences along their ways. Of those at walls, which stand still in
// it, 0.
void Wcsph::findTurning(const StepContext& context) {
  const std::size_t n = grid_.size();
  turning_.resize(n);
  std::fill_n(turning_.begin(), n, 0.0f);
  if (!arrangement_.hasSurface()) return;  // nothing gives pressures their zero: the sweeps would run off
  const auto fastest = static_cast<float>(parallelMax(n, 0.0, [&](std::size_t begin, std::size_t end) {
    float most = 0.0f;
    for (std::size_t i = begin; i < end; ++i) most = std::max(most, std::hypot(moveX_[i], moveY_[i]));
    return static_cast<double>(most);
  }));
  if (fastest == 0.0f) return;
  std::fill_n(share_.begin(), n, 1.0f);
  for (const float side : {1.0f, -1.0f}) {
    const float way = side * kProbe / fastest * static_cast<float>(lattice::kUnitsPerSpacing);
    for (std::size_t i = 0; i < n; ++i) {
      nextX_[i] = lattice::sum(latticeX_[i], static_cast<std::int32_t>(std::lrintf(way * moveX_[i])));
      nextY_[i] = lattice::sum(latticeY_[i], static_cast<std::int32_t>(std::lrintf(way * moveY_[i])));
      excess_[i] = 0.0f;
    }
    latticeX_.swap(nextX_);
    latticeY_.swap(nextY_);
    RateLoop loop = rateLoop(moveX_.data(), moveY_.data());
    loop.wallShare = 0.0f;
    compress(context, loop);
    latticeX_.swap(nextX_);
    latticeY_.swap(nextY_);
    for (std::size_t i = 0; i < n; ++i) {
      if (walls_.any() && walls_.lambda()[i] > 0.0f) continue;
      turning_[i] += side * 0.5f * fastest / kProbe * excess_[i];
    }
  }
}

// The pressures that a fluid has which is let go: those that keep the rates of its densities as they are. Without them
// a tank at rest would bounce for seconds. Under a free surface, which gives them their zero, by two levels; else, or
// where these disagree, by sweeps with momentum (heavy ball, Polyak 1964) for a system of √N rows.
void Wcsph::findStartPressure(const StepContext& context) {
  const std::size_t n = grid_.size();
  const float stiffness = std::exchange(stiffness_, 1.0f), background = std::exchange(background_, 0.0f);
  const bool open = arrangement_.surfaceRows() > kOpen;
  if (open) buildCoarse(context, nextExcess_.data());
  findTurning(context);
  bool found = open && liftStartPressure(context);
  for (float step = kStartStep; !found && step > kLeastStartStep; step *= 0.5f) {
    startFromNothing(step);
    found = sweepStartPressure(context);
  }
  // Else it starts from none, and bounces.
  const float compliance = found ? 1.0f / stiffness : 0.0f;
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      excess_[i] = found ? excess_[i] * compliance : 0.0f;
      kappa_[i] = solvedX_[i] = solvedY_[i] = 0.0f;  // they served the sweeps
    }
  });
  stiffness_ = stiffness;
  background_ = background;
  taken_ = Vec2(0.0, 0.0);
  turning_ = AlignedArray<float>();
  dropCoarse();
  limitStiffness();
}

void Wcsph::startFromNothing(float step) {
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      share_[i] = step / std::max(diagonal_[i], kInnerDiagonal);
      excess_[i] = kappa_[i] = 0.0f;
    }
  });
}

// To `excess_` what an acoustic step under the pressures `excess_`, then in `nextExcess_`, makes of the densities.
void Wcsph::findStartRates(const StepContext& context) {
  const std::size_t n = grid_.size();
  takePressures(false);
  std::copy_n(fallX_.begin(), n, solvedX_.begin());
  std::copy_n(fallY_.begin(), n, solvedY_.begin());
  accelerate(context, forceLoop(solvedX_.data(), solvedY_.data()));
  RateLoop loop = rateLoop(solvedX_.data(), solvedY_.data());
  loop.wallShare = 0.0f;
  compress(context, loop);
}

// To `nextExcess_` the pressures before, to `excess_` those with what the rates that they leave ask for. Returns
// Σ|gain|.
double Wcsph::sweepStart(const StepContext& context, float momentum) {
  AlignedArray<float>& last = kappa_;
  findStartRates(context);
  return parallelSum(grid_.size(), [&](std::size_t begin, std::size_t end) {
    double part = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const float before = nextExcess_[i];
      const float gain = std::max(least_[i], excess_[i] + share_[i] * turning_[i]) - before;
      excess_[i] = before + gain + momentum * (before - last[i]);
      part += static_cast<double>(std::abs(gain));
      last[i] = before;
    }
    return part;
  });
}

// Takes away what a coarse level sees of the rates; returns by how much of all pressures.
double Wcsph::liftStart(const StepContext& context) {
  AlignedArray<float>&last = kappa_, &rates = solvedX_;
  const auto area = static_cast<float>(std::pow(def_.spacing / unit_, 2));
  findStartRates(context);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      rates[i] = area * ((excess_[i] - nextExcess_[i]) / share_[i] + turning_[i]);
    }
  });
  solveCoarse(rates.data());
  struct Part {
    double change, all;
  };
  const Part sum = reduceBlocks<Part>(
      grid_.size(), {0.0, 0.0},
      [&](std::size_t begin, std::size_t end) {
        Part part{0.0, 0.0};
        for (std::size_t i = begin; i < end; ++i) {
          excess_[i] = last[i] = std::max(least_[i], nextExcess_[i] + change_[i]);
          part.change += static_cast<double>(std::abs(change_[i]));
          part.all += static_cast<double>(std::abs(excess_[i]));
        }
        return part;
      },
      [](const Part& a, const Part& b) {
        return Part{a.change + b.change, a.all + b.all};
      });
  return sum.all > 0.0 ? sum.change / sum.all : 0.0;
}

// A coarse level carries what is smooth, sweeps what is not. Rows that alternate, which neither finds in so few, push
// nothing but themselves. False where that does not settle.
bool Wcsph::liftStartPressure(const StepContext& context) {
  startFromNothing(kStartStep);
  for (int lift = 1; lift <= kMostLifts; ++lift) {
    const double change = liftStart(context);
    for (int sweep = 0; sweep < kBetween; ++sweep) sweepStart(context, kSmoothing);
    if (lift >= kLeastLifts && change <= kLiftTolerance) return true;
  }
  return false;
}

// False where it diverges.
bool Wcsph::sweepStartPressure(const StepContext& context) {
  const double rows = std::sqrt(static_cast<double>(grid_.size()));
  const auto momentum = static_cast<float>(std::pow((rows - 1.0) / (rows + 1.0), 2));
  double first = 0.0;
  for (int sweep = 0; sweep < static_cast<int>(kStartSweeps * rows); ++sweep) {
    const double error = sweepStart(context, momentum);
    if (sweep == 0) first = error;
    if (error <= kStartTolerance * first) return true;
    if (!(error < kDiverged * first)) return false;
  }
  return true;
}

}  // namespace froude
