// A fluid that a lid drives round in a closed box: no-slip walls and the flow that they make inside, once it is steady.
#include <algorithm>
#include <cmath>

#include "validation/curve.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kReadFrom = 0.8;  // of the run: means are taken from here on

/// One component of the velocity along one centre line of the unit square: time means over cells of one spacing of the
/// difference from the reference at the particles' own places, so that neither their pattern nor the steep profile
/// under the lid is taken for an error.
class Line {
 public:
  Line(Curve exact, int cells) : exact_(std::move(exact)), sums_(static_cast<std::size_t>(cells)), counts_(sums_) {}

  void add(double s, double value) {
    const auto k = static_cast<std::size_t>(
        std::clamp(std::floor(s * static_cast<double>(sums_.size())), 0.0, static_cast<double>(sums_.size() - 1)));
    sums_[k] += value - exact_.smoothAt(s);
    counts_[k] += 1.0;
  }
  double rms() const {
    double sum = 0.0, cells = 0.0;
    visit([&](double mean) { sum += mean * mean, cells += 1.0; });
    return std::sqrt(sum / cells);
  }
  double largest() const {
    double most = 0.0;
    visit([&](double mean) { most = std::max(most, std::abs(mean)); });
    return most;
  }

 private:
  template <typename Visit>
  void visit(Visit&& visit) const {
    for (std::size_t k = 0; k < sums_.size(); ++k)
      if (counts_[k] > 0.0) visit(sums_[k] / counts_[k]);
  }
  Curve exact_;
  std::vector<double> sums_, counts_;
};

class Cavity final : public Measure {
 public:
  Cavity(const scene::Scene& scene, Curve u, Curve v)
      : from_(kReadFrom * scene.duration),
        half_(scene.world.fluid->spacing),
        lid_(scene.world.bodies.at(0).surfaceVelocity),
        u_(std::move(u), static_cast<int>(std::lround(1.0 / half_))),
        v_(std::move(v), static_cast<int>(std::lround(1.0 / half_))) {}

  void read(const World& world, double t) override {
    if (t < from_) return;
    const ParticlePool& pool = *world.fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) {
      const double x = pool.x()[i], y = pool.y()[i];
      if (std::abs(x - 0.5) < half_) u_.add(y, pool.vx()[i] / lid_);
      if (std::abs(y - 0.5) < half_) v_.add(x, pool.vy()[i] / lid_);
    }
  }

  std::vector<Metric> results() const override {
    return {{"u_rms", "1", u_.rms(), 0.02},
            {"v_rms", "1", v_.rms(), 0.02},
            {"u_largest", "1", u_.largest(), {}},
            {"v_largest", "1", v_.largest(), {}}};
  }

 private:
  double from_, half_, lid_;  // half_: half the width of the strips that stand for the lines [m]
  Line u_, v_;
};

/// Columns of the table: s, u and v at Re 100, at 400, at 1000.
std::unique_ptr<Measure> measure(const scene::Scene& scene, std::size_t column) {
  const std::string file = dataPath("fluid_cavity_reference_fd.csv");
  return std::make_unique<Cavity>(scene, readCurve(file, 0, column), readCurve(file, 0, column + 1));
}

const Registered k100{
    {.name = "cavity",
     .measures =
         "Re = 100, last fifth of 20 L/U: speeds on the two centre lines against finite differences, over the speed of "
         "the lid",
     .scene = "cavity",
     .every = 0.02,
     .full = {{0.04, 0.02, 0.01}, {}},
     .quick = {{0.04}, {{"duration", "1.0"}}},
     .measure = [](const scene::Scene& scene) { return measure(scene, 1); },
     .flow = FlowKind::Confined,
     .norm = {"u_rms", "v_rms"}}};

const Registered k400{{.name = "cavity_400",
                       .measures = "the same at Re = 400, 40 L/U",
                       .scene = "cavity",
                       .every = 0.02,
                       .full = {{0.04, 0.02, 0.01}, {{"fluid.viscosity", "0.0025"}, {"duration", "40.0"}}},
                       .quick = {{0.04}, {{"fluid.viscosity", "0.0025"}, {"duration", "1.0"}}},
                       .measure = [](const scene::Scene& scene) { return measure(scene, 3); },
                       .flow = FlowKind::Confined,
                       .norm = {"u_rms", "v_rms"}}};

}  // namespace
}  // namespace froude::validation
