// A square that turns and stretches under tension: does a method keep it whole?
#include <algorithm>
#include <cmath>

#include "run/gauges.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kCenter = -0.1473427;  // p(0)/(ρ ω² L²) at the start: Poisson's equation in the square, by series

class Patch final : public Measure {
 public:
  void read(const World& world, double t) override {
    const Totals totals = world.totals(Species::Fluid);
    if (t == 0.0) {
      start_ = totals;
      area0_ = run::GaugeSet::fluidArea(world);
      return;
    }
    const FluidDef& fluid = *world.definition().fluid;
    const double dx = fluid.spacing;
    if (!read_) center_ = world.pressureAt({0.0, 0.0}) / (kCenter * fluid.density) - 1.0;
    read_ = true;
    angular_ = totals.angular / start_.angular - 1.0;
    kinetic_ = totals.kinetic / start_.kinetic - 1.0;
    area_ = run::GaugeSet::fluidArea(world) / area0_ - 1.0;
    const Clumping clumps = clumping(*world.fluid(), 0.5 * dx, 2.0 * dx);
    nearest_ = std::max(0.0, 1.0 - clumps.leastDistance / dx);
    close_ = clumps.closeShare;
    torn_ = static_cast<double>(clumps.components) - 1.0;
  }

  std::vector<Metric> results() const override {
    return {{"center_pressure", "1", center_, 0.05},  {"angular_momentum", "1", angular_, 0.02},
            {"kinetic_energy", "1", kinetic_, {}},    {"area", "1", area_, 0.02},
            {"nearest_pair", "dx", nearest_, {}},     {"clumped", "1", close_, {}},
            {"torn_off", "pieces", torn_, 0.0, false}};
  }

 private:
  bool read_ = false;
  Totals start_;
  double area0_ = 0.0, center_ = 0.0, angular_ = 0.0, kinetic_ = 0.0, area_ = 0.0, nearest_ = 0.0, close_ = 0.0,
         torn_ = 0.0;
};

const Registered kCase{
    {.name = "rotating_patch",
     .measures = "pressure in the middle after t ω = 0.01 over that of the start; at t ω = 2: angular momentum, "
                 "kinetic energy and area over those at the start; by how much the nearest "
                 "pair is below one spacing, the share of particles with another nearer than half of one, pieces that "
                 "are more than two spacings off",
     .scene = "rotating_patch",
     .every = 0.01,
     .full = {{0.04, 0.02, 0.01}, {}},
     .quick = {{0.04}, {{"duration", "0.5"}}},
     .measure = [](const scene::Scene&) { return std::make_unique<Patch>(); },
     .flow = FlowKind::Surface,
     .norm = {"area"}}};

}  // namespace
}  // namespace froude::validation
