// A cylinder that turns in a ring of fluid: curved no-slip walls, one of them moving.
#include <cmath>

#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kInner = 0.5, kOuter = 1.0;  // radii in scenes/drawings/ring.svg [m]

/// Circles of particles, one spacing apart, in place of the scene's squares, which leave a ring partly empty.
void fillWithCircles(World& world) {
  const double dx = world.definition().fluid->spacing;
  world.kill(Species::Fluid, world.definition().domain.box);
  std::vector<Vec2> positions;
  const int circles = static_cast<int>(std::lround((kOuter - kInner) / dx));
  const double apart = (kOuter - kInner) / circles;
  double owed = 0.0;  // particles that the circles so far should have had more
  for (int k = 0; k < circles; ++k) {
    const double r = kInner + (k + 0.5) * apart;
    owed += 2.0 * kPi * r * apart / (dx * dx);
    const double count = std::round(owed);
    owed -= count;
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const double angle = 2.0 * kPi * (i / count + 0.381966 * k);  // no two circles alike
      positions.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
  }
  world.addFluid(positions, std::vector<Vec2>(positions.size(), Vec2(0.0, 0.0)));
}

/// Mean error of the speed round the axis in rings of one spacing over the last fifth of the run, over the speed of the
/// inner wall: its rms over the rings.
class Ring final : public Measure {
 public:
  explicit Ring(const scene::Scene& scene)
      : from_(0.8 * scene.duration),
        omega_(scene.world.bodies.at(1).spin),
        rings_(static_cast<int>(std::lround((kOuter - kInner) / scene.world.fluid->spacing))) {}

  void read(const World& world, double t) override {
    if (t < from_) return;
    const ParticlePool& pool = *world.fluid();
    const auto radius = [&](std::size_t i) { return std::hypot(pool.x()[i], pool.y()[i]); };
    const auto off = [&](std::size_t i) {
      const double r = radius(i);
      return (pool.x()[i] * pool.vy()[i] - pool.y()[i] * pool.vx()[i]) / r - couetteRing(r, kInner, kOuter, omega_);
    };
    double sum = 0.0;
    const std::vector<double> means = stripMeans(pool.size(), kInner, kOuter, rings_, radius, off);
    for (const double mean : means) sum += mean * mean;
    error_ += std::sqrt(sum / static_cast<double>(means.size())) / (omega_ * kInner);
    ++count_;
  }

  std::vector<Metric> results() const override { return {{"profile", "1", error_ / count_, 0.02}}; }

 private:
  double from_, omega_;
  int rings_;
  double error_ = 0.0, count_ = 0.0;
};

const Registered kCase{{.name = "couette",
                        .measures =
                            "speed round the axis, steady, against a r + b/r: rms over the radius, over the speed "
                            "of the inner wall",
                        .scene = "couette",
                        .every = 0.1,
                        .full = {{0.05, 0.025, 0.0125}, {}},
                        .quick = {{0.05}, {{"duration", "1.0"}}},
                        .measure = [](const scene::Scene& scene) { return std::make_unique<Ring>(scene); },
                        .prepare = fillWithCircles,
                        .flow = FlowKind::Confined,
                        .norm = {"profile"}}};

}  // namespace
}  // namespace froude::validation
