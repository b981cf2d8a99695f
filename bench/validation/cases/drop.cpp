// Drops whose motion is affine, free all round: does a method keep shape, energy and period?
#include <cmath>

#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

/// The disc that is drawn out. Axes are taken over those at the start, as squares of particles are no disc.
class Stretched final : public Measure {
 public:
  void read(const World& world, double t) override {
    constexpr double kRate = -100.0;  // of the scene: it is drawn out along y [1/s]
    const Moments m = moments(*world.fluid());
    if (t == 0.0) start_ = m;
    const Drop exact = dropAt(t, kRate, 0.0, 1e-6);
    axisX_ = m.axisX() / start_.axisX() / exact.a - 1.0;
    axisY_ = m.axisY() / start_.axisY() * exact.a - 1.0;
    energy_ = m.kinetic / start_.kinetic * kinetic(dropAt(0.0, kRate, 0.0, 1.0)) / kinetic(exact) - 1.0;
  }
  std::vector<Metric> results() const override {
    return {{"axis_x", "1", axisX_, 0.02}, {"axis_y", "1", axisY_, 0.02}, {"energy", "1", energy_, {}}};
  }

 private:
  Moments start_;
  double axisX_ = 0.0, axisY_ = 0.0, energy_ = 0.0;
};

/// The drop that swings. Its energy is counted from that of the round drop at rest.
class Swinging final : public Measure {
 public:
  void read(const World& world, double t) override {
    const Moments m = moments(*world.fluid());
    const double lying = m.xx - m.yy;
    const double energy = m.kinetic + 0.5 * kB * kB * (m.xx + m.yy + m.centre.squaredNorm());
    if (t == 0.0) {
      start_ = m;
      energy0_ = energy;
    }
    const double axis = m.axisX() / start_.axisX() - dropAt(t, kA, kB, 1e-3).a;
    squares_ += axis * axis;
    ++count_;
    // The motion starts round and towards lying; later ones are found between two readings.
    if (t > 0.0 && last_ < 0.0 && lying >= 0.0) {
      end_ = lastTime_ + (t - lastTime_) * last_ / (last_ - lying);
      ++periods_;
    }
    last_ = lying;
    lastTime_ = t;
    loss_ = (energy0_ - energy) / start_.kinetic;
  }

  std::vector<Metric> results() const override {
    const double exact = dropPeriod(kA, kB, 1e-3);
    std::vector<Metric> metrics;
    if (periods_ > 0) metrics.push_back({"period", "1", end_ / periods_ / exact - 1.0, 0.02});
    metrics.push_back({"energy_loss_a_period", "1", loss_ / (lastTime_ / exact), {}});
    metrics.push_back({"axis_rms", "1", std::sqrt(squares_ / count_), {}});
    return metrics;
  }

 private:
  static constexpr double kA = 1.0, kB = 1.0;  // of the scene [1/s]
  Moments start_;
  double energy0_ = 0.0, loss_ = 0.0, squares_ = 0.0, count_ = 0.0;
  double last_ = 0.0, lastTime_ = 0.0, end_ = 0.0;
  int periods_ = 0;
};

const Registered kDrop{{.name = "drop",
                        .measures =
                            "semi-axes from second moments at 7.6 ms over the exact ones, kinetic energy over the "
                            "exact one",
                        .scene = "drop",
                        .every = 1.0,
                        .full = {{0.05, 0.025, 0.0125}, {}},
                        .quick = {{0.1}, {}},
                        .measure = [](const scene::Scene&) { return std::make_unique<Stretched>(); },
                        .flow = FlowKind::Surface,
                        .norm = {"axis_x", "axis_y"}}};

const Registered kCentral{{.name = "central_drop",
                           .measures =
                               "mean of up to four periods over the exact one; energy of the oscillation lost in a "
                               "period; rms error of the semi-axis along x over the radius",
                           .scene = "central_drop",
                           .every = 0.02,
                           .full = {{0.1, 0.05, 0.025}, {}},
                           .quick = {{0.1}, {{"duration", "5.0"}}},
                           .measure = [](const scene::Scene&) { return std::make_unique<Swinging>(); },
                           .flow = FlowKind::Surface,
                           .norm = {"period"}}};

}  // namespace
}  // namespace froude::validation
