// Water at rest over steps and corners: pressure, forces, and how still it is.
#include <cmath>

#include "run/summary.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

// Of the scene: the water is 0.425 m² where its level is at 0.5 m, and 1 m wide there.
constexpr double kLevel = 0.5, kArea = 0.425, kWidth = 1.0;

/// Means over the second half of the run.
class Rest final : public Measure {
 public:
  explicit Rest(const scene::Scene& scene) : from_(0.5 * scene.duration), gravity_(-scene.world.gravity.y()) {
    for (const scene::GaugeDef& gauge : scene.gauges)
      if (gauge.type == "pressure") probes_.push_back({gauge.name, gauge.at, 0.0});
  }

  void read(const World& world, double t) override {
    const double density = world.definition().fluid->density, mass = world.totals(Species::Fluid).mass;
    if (t == 0.0) {
      area0_ = run::GaugeSet::fluidArea(world);
      // Places on the ramp are cut, which lowers the level by a hair.
      level_ = kLevel + (mass / density - kArea) / kWidth;
    }
    volume_ = run::volumeError(world, area0_);
    if (t < from_) return;
    ++count_;
    const ParticlePool& pool = *world.fluid();
    double speed = 0.0;
    for (std::size_t i = 0; i < pool.size(); ++i) speed += std::hypot(pool.vx()[i], pool.vy()[i]);
    speed_ += speed / static_cast<double>(pool.size()) / std::sqrt(gravity_ * level_);
    for (Probe& probe : probes_)
      probe.sum += world.pressureAt(probe.at) / (density * gravity_ * (level_ - probe.at.y())) - 1.0;
    double force = 0.0;
    for (std::size_t i = 0; i < world.bodyCount(); ++i) force -= world.body(i).force.y();
    force_ += force / (mass * gravity_) - 1.0;
  }

  std::vector<Metric> results() const override {
    std::vector<Metric> metrics;
    for (const Probe& probe : probes_) metrics.push_back({"pressure_" + probe.name, "1", probe.sum / count_, 0.01});
    metrics.push_back({"mean_speed", "1", speed_ / count_, 0.005});
    metrics.push_back({"force", "1", force_ / count_, 0.01});
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
  double level_ = 0.0, area0_ = 0.0, count_ = 0.0, speed_ = 0.0, force_ = 0.0, volume_ = 0.0;
};

const Registered kCase{
    {.name = "hydrostatic",
     .measures =
         "means over the second half: pressure at the scene's three gauges over ρ g (H - y), speed over √(gH), the "
         "forces on all bodies over the weight; at the end the volume",
     .scene = "hydrostatic",
     .every = 0.02,
     .full = {{0.025, 0.0125, 0.00625}, {}},
     .quick = {{0.025}, {{"duration", "1.0"}}},
     .measure = [](const scene::Scene& scene) { return std::make_unique<Rest>(scene); },
     .flow = FlowKind::AtRest,
     .norm = {"pressure_deep", "pressure_over_step", "pressure_under_lip"}}};

}  // namespace
}  // namespace froude::validation
