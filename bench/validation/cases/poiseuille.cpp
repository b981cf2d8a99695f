// Channel flows that start from rest: do walls hold the fluid as viscosity asks for?
#include <algorithm>
#include <cmath>

#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

/// Velocity along x at height y [m] and time t [s].
using Profile = std::function<double(double y, double t)>;

/// Largest error of the profile between y = 0 and L at any reading but the first, over `scale` [m/s].
class Channel final : public Measure {
 public:
  Channel(const scene::Scene& scene, double L, double scale, Profile exact)
      : L_(L),
        scale_(scale),
        exact_(std::move(exact)),
        strips_(static_cast<int>(std::lround(L / scene.world.fluid->spacing))) {}

  void read(const World& world, double t) override {
    if (t == 0.0) return;
    const ParticlePool& pool = *world.fluid();
    const auto y = [&](std::size_t i) { return pool.y()[i]; };
    const auto off = [&](std::size_t i) { return pool.vx()[i] - exact_(pool.y()[i], t); };
    for (const double mean : stripMeans(pool.size(), 0.0, L_, strips_, y, off))
      largest_ = std::max(largest_, std::abs(mean));
  }

  std::vector<Metric> results() const override { return {{"profile", "1", largest_ / scale_, 0.02}}; }

 private:
  double L_, scale_;
  Profile exact_;
  int strips_;
  double largest_ = 0.0;
};

std::unique_ptr<Measure> measurePoiseuille(const scene::Scene& scene) {
  const double L = scene.world.domain.box.max.y(), viscosity = scene.world.fluid->viscosity,
               F = scene.world.gravity.x();
  return std::make_unique<Channel>(scene, L, F * L * L / (8.0 * viscosity),
                                   [=](double y, double t) { return poiseuilleStart(y, t, L, viscosity, F); });
}

std::unique_ptr<Measure> measureCouette(const scene::Scene& scene) {
  const BodyDef& belt = scene.world.bodies.at(0);
  const double L = belt.shape->bounds().min.y(), viscosity = scene.world.fluid->viscosity, V = belt.surfaceVelocity;
  return std::make_unique<Channel>(scene, L, V,
                                   [=](double y, double t) { return couetteStart(y, t, L, viscosity, V); });
}

const Registered kPoiseuille{
    {.name = "poiseuille",
     .measures = "largest error of the profile every 0.25 s (νt/L² = 0.025), over the largest steady speed",
     .scene = "poiseuille",
     .every = 0.25,
     .full = {{0.04, 0.02, 0.01}, {}},
     .quick = {{0.04}, {{"duration", "0.5"}}},
     .measure = measurePoiseuille,
     .flow = FlowKind::Confined,
     .norm = {"profile"}}};

const Registered kCouette{
    {.name = "couette_start",
     .measures = "largest error of the profile every 0.25 s (νt/L² = 0.025), over the speed of the belt",
     .scene = "couette_start",
     .every = 0.25,
     .full = {{0.04, 0.02, 0.01}, {}},
     .quick = {{0.04}, {{"duration", "0.5"}}},
     .measure = measureCouette,
     .flow = FlowKind::Confined,
     .norm = {"profile"}}};

}  // namespace
}  // namespace froude::validation
