// Water at rest over steps and corners: pressure, forces, and how still it is.
#include <cmath>

#include "run/summary.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kLevel = 0.5;  // of the water in the scene [m]

/// Means over the second half of the run.
class Rest final : public Measure {
 public:
  explicit Rest(const scene::Scene& scene) : from_(0.5 * scene.duration), gravity_(-scene.world.gravity.y()) {
    for (const scene::GaugeDef& gauge : scene.gauges)
      if (gauge.type == "pressure") probes_.push_back({gauge.name, gauge.at, 0.0});
  }

  void read(const World& world) override {
    if (world.time() == 0.0) area0_ = run::GaugeSet::fluidArea(world);
    if (world.time() < from_) return;
    ++count_;
    const ParticlePool& pool = *world.fluid();
    double speed = 0.0;
    for (std::size_t i = 0; i < pool.size(); ++i) speed += std::hypot(pool.vx()[i], pool.vy()[i]);
    speed_ += speed / static_cast<double>(pool.size()) / std::sqrt(gravity_ * kLevel);
    const double density = world.definition().fluid->density;
    for (Probe& probe : probes_) {
      const double right = density * gravity_ * (kLevel - probe.at.y());
      probe.sum += world.pressureAt(probe.at) / right - 1.0;
    }
    Vec2 force(0.0, 0.0);
    for (std::size_t i = 0; i < world.bodyCount(); ++i) force += world.body(i).force;
    force_ += -force.y() / (world.totals(Species::Fluid).mass * gravity_) - 1.0;
    volume_ = run::volumeError(world, area0_);
  }

  std::vector<Metric> results() const override {
    std::vector<Metric> metrics;
    const double n = count_;
    for (const Probe& probe : probes_) metrics.push_back({"pressure_" + probe.name, "1", probe.sum / n, 0.01});
    metrics.push_back({"mean_speed", "1", speed_ / n, 0.005});
    metrics.push_back({"force", "1", force_ / n, 0.01});
    metrics.push_back({"volume", "1", volume_, 0.01});
    return metrics;
  }

 private:
  struct Probe {
    std::string name;
    Vec2 at;
    double sum;
  };
  double from_, gravity_;
  std::vector<Probe> probes_;
  double count_ = 0.0, speed_ = 0.0, force_ = 0.0, area0_ = 0.0, volume_ = 0.0;
};

const Registered kCase{{"hydrostatic",
                        "means over the second half: pressure at the scene's three gauges over ρ g (H - y), speed over "
                        "√(gH), the forces on "
                        "all bodies over the weight; the volume at the end",
                        "hydrostatic",
                        0.02,
                        {{0.025, 0.0125, 0.00625}, {}},
                        {{0.025}, {{"duration", "2.0"}}},
                        [](const scene::Scene& scene) { return std::make_unique<Rest>(scene); }}};

}  // namespace
}  // namespace froude::validation
