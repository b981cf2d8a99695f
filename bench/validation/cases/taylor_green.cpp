// Vortices that fade by viscosity alone: how much does a method mix and damp by itself?
#include <cmath>

#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

using Vortices = Vec2 (*)(const Vec2& x, double t, double viscosity);

class Decay final : public Measure {
 public:
  Decay(const scene::Scene& scene, Vortices exact) : viscosity_(scene.world.fluid->viscosity), exact_(exact) {}

  void read(const World& world, double t) override {
    time_ = t;
    kinetic_ = world.totals(Species::Fluid).kinetic;
    if (time_ == 0.0) kinetic0_ = kinetic_;
    error_ = velocityError(*world.fluid(), [&](const Vec2& x) { return exact_(x, time_, viscosity_); });
  }

  std::vector<Metric> results() const override {
    const double rate = 16.0 * kPi * kPi * viscosity_;  // of the energy [1/s]
    return {{"velocity", "1", error_, 0.05},
            {"decay_rate", "1", -std::log(kinetic_ / kinetic0_) / (rate * time_) - 1.0, 0.05}};
  }

 private:
  double viscosity_;
  Vortices exact_;
  double time_ = 0.0, kinetic0_ = 0.0, kinetic_ = 0.0, error_ = 0.0;
};

constexpr double kReadEvery = 10.0;  // s: the first and the last reading are enough

const Registered kPeriodic{
    {.name = "taylor_green",
     .measures =
         "when a tenth of the energy should be left: difference of the particles' velocities from the exact ones "
         "(rms, relative); rate of the energy's decay",
     .scene = "taylor_green",
     .every = kReadEvery,
     .full = {{0.04, 0.02, 0.01}, {}},
     .quick = {{0.04}, {{"duration", "0.3"}}},
     .measure = [](const scene::Scene& scene) { return std::make_unique<Decay>(scene, taylorGreen); },
     .flow = FlowKind::Confined,
     .norm = {"velocity"}}};

// 1000 ln 10/(16 π²) s.
const Registered kPeriodic1000{
    {.name = "taylor_green_1000",
     .measures = "the same at Re = 1000, where the flow is unstable",
     .scene = "taylor_green",
     .every = kReadEvery,
     .full = {{0.04, 0.02, 0.01}, {{"fluid.viscosity", "0.001"}, {"duration", "14.58129"}}},
     .quick = {{0.04}, {{"fluid.viscosity", "0.001"}, {"duration", "0.3"}}},
     .measure = [](const scene::Scene& scene) { return std::make_unique<Decay>(scene, taylorGreen); },
     .flow = FlowKind::Confined,
     .norm = {"velocity"}}};

const Registered kBox{
    {.name = "taylor_green_box",
     .measures = "the same of one vortex between smooth walls",
     .scene = "taylor_green_box",
     .every = kReadEvery,
     .full = {{0.02, 0.01, 0.005}, {}},
     .quick = {{0.02}, {{"duration", "0.3"}}},
     .measure = [](const scene::Scene& scene) { return std::make_unique<Decay>(scene, taylorGreenBox); },
     .flow = FlowKind::Confined,
     .norm = {"velocity"}}};

}  // namespace
}  // namespace froude::validation
