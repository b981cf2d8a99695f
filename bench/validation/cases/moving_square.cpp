// A square that starts and moves through a closed box: the force of a viscous fluid on a body, from step to step.
#include <algorithm>
#include <cmath>

#include "validation/curve.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kFrom = 1.0, kTo = 8.0;  // [L/U]: before, the force is mostly that of the start
constexpr double kWindow = 0.1;           // [L/U]: the drag is the impulse of each window over its length

/// Drag coefficient −F/(½ρU²L) with U = 1 m/s, L = 1 m.
class Drag final : public Measure {
 public:
  Drag(const scene::Scene& scene, Curve pressure, Curve viscous)
      : scale_(-0.5 * scene.world.fluid->density), pressure_(std::move(pressure)), viscous_(std::move(viscous)) {}

  void read(const World& world, double t) override {
    // A step's force acted all along it.
    if (t > 0.0) drag_.add(last_, t, world.body(world.bodyIndex("square")).force.x() / scale_);
    last_ = t;
  }

  std::vector<Metric> results() const override {
    double square = 0.0, mean = 0.0, right = 0.0, noise = 0.0, count = 0.0;
    for (std::size_t k = 0; k < drag_.count(); ++k) {
      const double from = drag_.from(k), to = drag_.from(k + 1);
      if (from < kFrom * (1.0 - 1e-9) || to > std::min(kTo, last_) * (1.0 + 1e-9)) continue;
      const double end = std::min(to, pressure_.t.back());  // the table ends at 7.995
      const double reference = pressure_.mean(from, end) + viscous_.mean(from, end);
      square += std::pow(drag_.mean(k) - reference, 2);
      noise += drag_.variance(k);
      mean += drag_.mean(k);
      right += reference;
      count += 1.0;
    }
    return {{"drag", "1", std::sqrt(square * count) / right, 0.1},
            {"mean_drag", "1", mean / right - 1.0, {}},
            {"noise", "1", std::sqrt(noise * count) / right, {}}};
  }

 private:
  double scale_;  // [N/m]
  Curve pressure_, viscous_;
  WindowMeans drag_{kWindow};
  double last_ = 0.0;
};

const Registered kCase{{.name = "moving_square",
                        .measures = "drag coefficient at Re = 100, 1 < t < 8 L/U, in means over 0.1 L/U, against "
                                    "finite differences: rms and mean, "
                                    "over the mean of the reference; rms of the steps about those means",
                        .scene = "moving_square",
                        .every = 0.0,
                        .full = {{0.1, 0.05, 0.025}, {}},
                        .quick = {{0.1}, {{"duration", "1.5"}}},
                        .measure =
                            [](const scene::Scene& scene) {
                              const std::string file = dataPath("fluid_moving_square_re100_force.csv");
                              return std::make_unique<Drag>(scene, readCurve(file, 0, 1), readCurve(file, 0, 2));
                            },
                        .flow = FlowKind::Confined,
                        .norm = {"drag"}}};

}  // namespace
}  // namespace froude::validation
