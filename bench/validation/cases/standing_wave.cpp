// A small standing wave: its period, and how much faster it fades than its viscosity asks for.
#include <algorithm>
#include <cmath>

#include "validation/exact.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr int kPeriods = 10;

/// The first mode's amplitude of the surface, η = a cos kx, k = 2π/L. Where a fluid keeps its density, that is (2/L) ∫
/// η cos kx dx = (2/L) ∫∫ cos kx over the fluid: a sum over all particles, in which no one of them counts for much.
class Wave final : public Measure {
 public:
  explicit Wave(const scene::Scene& scene)
      : L_(scene.world.domain.box.max.x() - scene.world.domain.box.min.x()), viscosity_(scene.world.fluid->viscosity) {
    double top = 0.0;
    for (const Vec2& x : scene.fluidBlocks.at(0).positions) top = std::max(top, x.y());
    depth_ = top + 0.5 * scene.world.fluid->spacing;
    period_ = standingWavePeriod(L_, depth_, -scene.world.gravity.y());
  }

  void read(const World& world, double t) override {
    const ParticlePool& pool = *world.fluid();
    const double k = 2.0 * kPi / L_;
    double sum = 0.0;
    for (std::size_t i = 0; i < pool.size(); ++i) sum += std::cos(k * pool.x()[i]);
    const double a = 2.0 / L_ * sum * world.fluidMass() / world.definition().fluid->density;
    // It starts with a = 0. What crosses zero again within a quarter of a period is noise.
    if (t > 0.0 && a * a_ <= 0.0 && a != a_ && t > crossed_ + 0.25 * period_) cross(t_ + (t - t_) * a_ / (a_ - a));
    if (std::abs(a) > peak_) peak_ = std::abs(a), peakTime_ = t;
    t_ = t;
    a_ = a;
  }

  std::vector<Metric> results() const override {
    // The first crossing is that after half a period: the start is no crossing that was seen.
    const auto n = std::min<std::size_t>(crossings_.size(), 2 * kPeriods);
    const double period = n > 1 ? 2.0 * (crossings_[n - 1] - crossings_[0]) / static_cast<double>(n - 1) : std::nan("");
    const double k = 2.0 * kPi / L_;
    return {{"period", "1", period / period_ - 1.0, 0.02},
            {"extra_viscosity", "m²/s", -slope() / (4.0 * k * k) - viscosity_, {}}};
  }

 private:
  void cross(double t) {
    crossings_.push_back(t);
    crossed_ = t;
    if (peaks_.size() < 2 * kPeriods) peaks_.push_back({peakTime_, std::log(peak_ * peak_)});
    peak_ = 0.0;
  }
  /// Of ln E over time, E the square of the amplitude at its extremes, by least squares [1/s].
  double slope() const {
    double n = 0.0, st = 0.0, se = 0.0, stt = 0.0, ste = 0.0;
    for (const auto& [t, e] : peaks_) n += 1.0, st += t, se += e, stt += t * t, ste += t * e;
    return (n * ste - st * se) / (n * stt - st * st);
  }

  double L_, viscosity_, depth_ = 0.0, period_ = 0.0;
  double t_ = 0.0, a_ = 0.0, crossed_ = 0.0, peak_ = 0.0, peakTime_ = 0.0;
  std::vector<double> crossings_;                 // [s]
  std::vector<std::pair<double, double>> peaks_;  // time, ln a²
};

const Registered kCase{{.name = "standing_wave",
                        .measures =
                            "ten periods of the first mode: mean period against √(g k tanh kD); viscosity by which its "
                            "energy fades, less the given one",
                        .scene = "standing_wave",
                        .every = 0.0,
                        .full = {{0.02, 0.01, 0.005}, {}},
                        .quick = {{0.02}, {{"duration", "1.8"}}},
                        .measure = [](const scene::Scene& scene) { return std::make_unique<Wave>(scene); },
                        .flow = FlowKind::Surface,
                        .norm = {"period"}}};

}  // namespace
}  // namespace froude::validation
