// The column by which speed is compared: its course against the agreed one, and how well the water keeps its volume.
#include <cmath>
#include <filesystem>

#include "run/summary.h"
#include "validation/dam_curve.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kVolumeFrom = 3.0;  // s: what fell has come down

class Dam final : public Measure {
 public:
  void read(const World& world, double t) override {
    if (t == 0.0) area0_ = run::GaugeSet::fluidArea(world);
    if (t <= kDamCurveEnd + 0.1) curve_.read(world, t);
    if (t >= kVolumeFrom) {
      volume_ += std::abs(run::volumeError(world, area0_));
      ++count_;
    }
    if (t > 0.0) compression_ = world.ledger().densityErrorTime / t;
  }

  std::vector<Metric> results() const override {
    std::vector<Metric> metrics;
    if (std::filesystem::exists(damTruthFile())) {
      const DamDistance off = distance(curve_, readDamCurve(damTruthFile()));
      metrics.push_back({"toe", "m", off.toe, 0.02});
      metrics.push_back({"centre", "m", off.centre, 0.02});
    }
    if (count_ > 0.0) metrics.push_back({"volume", "1", volume_ / count_, 0.01});
    metrics.push_back({"compression", "1", compression_, {}});
    return metrics;
  }

 private:
  DamCurve curve_;
  double area0_ = 0.0, volume_ = 0.0, count_ = 0.0, compression_ = 0.0;
};

const Registered kCase{{.name = "dam",
                        .measures =
                            "toe and centre of mass up to 2 s against tests/data/dam_truth.csv, mean |volume error| "
                            "from 3 to 5 s, mean compression",
                        .scene = "dam_speed",
                        .every = 0.02,
                        .full = {{0.04, 0.02, 0.01}, {{"duration", "5.0"}}},
                        .quick = {{0.05}, {{"duration", "1.0"}}},
                        .measure = [](const scene::Scene&) { return std::make_unique<Dam>(); },
                        .flow = FlowKind::Splash,
                        .norm = {"toe", "centre"}}};

}  // namespace
}  // namespace froude::validation
