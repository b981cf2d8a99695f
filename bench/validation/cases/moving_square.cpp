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
    const double value = world.body(world.bodyIndex("square")).force.x() / scale_;
    if (t > 0.0) {
      // A step's force acted all along it: the windows get its shares.
      for (double from = last_; from < t;) {
        const auto k = static_cast<std::size_t>(from / kWindow * (1.0 + 1e-12));
        const double to = std::max(std::min(t, kWindow * static_cast<double>(k + 1)), std::nextafter(from, t));
        if (windows_.size() <= k) windows_.resize(k + 1);
        windows_[k].impulse += value * (to - from);
        windows_[k].square += value * value * (to - from);
        windows_[k].length += to - from;
        from = to;
      }
    }
    last_ = t;
  }

  std::vector<Metric> results() const override {
    double square = 0.0, mean = 0.0, reference = 0.0, noise = 0.0, count = 0.0;
    for (std::size_t k = 0; k < windows_.size(); ++k) {
      const double from = kWindow * static_cast<double>(k), to = from + kWindow;
      const Window& w = windows_[k];
      if (from < kFrom * (1.0 - 1e-9) || to > std::min(kTo, last_) * (1.0 + 1e-9)) continue;
      const double right =
          pressure_.mean(from, std::min(to, pressure_.t.back())) + viscous_.mean(from, std::min(to, viscous_.t.back()));
      const double drag = w.impulse / w.length;
      square += (drag - right) * (drag - right);
      noise += std::max(0.0, w.square / w.length - drag * drag);
      mean += drag;
      reference += right;
      count += 1.0;
    }
    return {{"drag", "1", std::sqrt(square * count) / reference, 0.1},
            {"mean_drag", "1", mean / reference - 1.0, {}},
            {"noise", "1", std::sqrt(noise * count) / reference, {}}};
  }

 private:
  struct Window {
    double impulse = 0.0, square = 0.0, length = 0.0;
  };
  double scale_;
  Curve pressure_, viscous_;
  std::vector<Window> windows_;
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
                        .measure = [](const scene::Scene& scene) {
                          const std::string file = dataPath("fluid_moving_square_re100_force.csv");
                          return std::make_unique<Drag>(scene, readCurve(file, 0, 1), readCurve(file, 0, 2));
                        }}};

}  // namespace
}  // namespace froude::validation
