// Water in a closed tank that is shaken: is everything that walls give and take booked?
#include <cmath>

#include "run/summary.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

class Shaken final : public Measure {
 public:
  void read(const World& world, double t) override {
    if (t == 0.0) {
      area0_ = run::GaugeSet::fluidArea(world);
      count0_ = static_cast<double>(world.fluid()->size());
      return;
    }
    volume_ += std::abs(run::volumeError(world, area0_));
    ++count_;
    momentum_ = run::momentumError(world);
    lost_ =
        (count0_ - static_cast<double>(world.fluid()->size()) + static_cast<double>(world.ledger().leaks)) / count0_;
  }

  std::vector<Metric> results() const override {
    return {{"momentum", "1", momentum_, 1e-6, false},
            {"volume", "1", volume_ / count_, 0.01},
            {"lost", "1", lost_, 0.0, false}};
  }

 private:
  double area0_ = 0.0, count0_ = 0.0, volume_ = 0.0, count_ = 0.0, momentum_ = 0.0, lost_ = 0.0;
};

const Registered kCase{
    {.name = "sloshing",
     .measures =
         "momentum that is not accounted for at the end, mean |volume error|, share of particles that leaked or left",
     .scene = "sloshing",
     .every = 0.1,
     .full = {{0.025, 0.0125, 0.00625}, {}},
     .quick = {{0.025}, {{"duration", "1.0"}}},
     .measure = [](const scene::Scene&) { return std::make_unique<Shaken>(); }}};

}  // namespace
}  // namespace froude::validation
