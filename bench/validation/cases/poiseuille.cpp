// A channel flow that starts: do walls hold the fluid as viscosity asks for?
#include <algorithm>
#include <cmath>

#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

/// Largest error of the profile at any reading but the first, over the largest steady speed F L²/(8ν).
class Channel final : public Measure {
 public:
  explicit Channel(const scene::Scene& scene)
      : L_(scene.world.domain.box.max.y()),
        viscosity_(scene.world.fluid->viscosity),
        F_(scene.world.gravity.x()),
        strips_(static_cast<int>(std::lround(L_ / scene.world.fluid->spacing))) {}

  void read(const World& world) override {
    const double t = world.time();
    if (t == 0.0) return;
    const ParticlePool& pool = *world.fluid();
    const auto y = [&](std::size_t i) { return pool.y()[i]; };
    const auto off = [&](std::size_t i) { return pool.vx()[i] - poiseuilleStart(pool.y()[i], t, L_, viscosity_, F_); };
    for (const double mean : stripMeans(pool.size(), 0.0, L_, strips_, y, off)) {
      largest_ = std::max(largest_, std::abs(mean));
    }
  }

  std::vector<Metric> results() const override {
    return {{"profile", "1", largest_ / (F_ * L_ * L_ / (8.0 * viscosity_)), 0.02}};
  }

 private:
  double L_, viscosity_, F_;
  int strips_;
  double largest_ = 0.0;
};

const Registered kCase{{"poiseuille",
                        "largest error of the profile every 0.25 s (νt/L² = 0.025), over the largest steady speed",
                        "poiseuille",
                        0.25,
                        {{0.04, 0.02, 0.01}, {}},
                        {{0.04}, {{"duration", "0.5"}}},
                        [](const scene::Scene& scene) { return std::make_unique<Channel>(scene); }}};

}  // namespace
}  // namespace froude::validation
