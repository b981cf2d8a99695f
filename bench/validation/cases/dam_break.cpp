// Collapsing columns against experiments. Both have a gate that takes time to open, so one shift in time is free.
#include <algorithm>
#include <cmath>

#include "run/gauge_surface.h"
#include "validation/curve.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kLargestShift = 0.3;   // in T = t √(2g/a)
constexpr double kFrom = 0.84;          // T of the first datum that counts: before it the gate matters most
constexpr double kHeightColumns = 0.5;  // [dx] from the wall: where the column's height is read

/// Front Z = x/a over T = t √(2g/a), and height H = h/(2a) over τ = T/√2, of a column a × 2a at the left wall.
class Column final : public Measure {
 public:
  Column(const scene::Scene& scene, double a, Curve front, Curve height)
      : a_(a),
        rate_(std::sqrt(-2.0 * scene.world.gravity.y() / a)),
        front_(std::move(front)),
        height_(std::move(height)) {}

  void read(const World& world, double t) override {
    const run::FluidSurface surface(world);
    const double T = t * rate_;
    if (T < front_.t.back() + kLargestShift) toe_.add(T, surface.toe() / a_);
    if (!height_.t.empty())
      top_.add(T / std::sqrt(2.0), surface.height(kHeightColumns * world.definition().fluid->spacing) / (2.0 * a_));
  }

  std::vector<Metric> results() const override {
    const double to = std::min(front_.t.back(), toe_.t.back());
    const Distance front = bestShift(toe_, front_, kFrom, to, kLargestShift);
    std::vector<Metric> metrics{{"front", "1", front.rms, 0.05}, {"front_shift", "T", front.shift, {}, false}};
    if (!height_.t.empty())
      metrics.push_back({"height", "1", rmsDifference(top_, height_, front.shift / std::sqrt(2.0)), 0.05});
    return metrics;
  }

 private:
  double a_, rate_;
  Curve front_, height_;  // of the experiment
  Curve toe_, top_;
};

const Registered kMartinMoyce{
    {.name = "martin_moyce",
     .measures =
         "front and height of the column against Martin and Moyce (1952): rms of the front relative, of the height "
         "over the first height, after the one shift in time that fits the front best",
     .scene = "dam_break",
     .every = 0.002,
     .full = {{0.0028575, 0.00142875, 0.000714375}, {}},
     .quick = {{0.0028575}, {{"duration", "0.19"}}},
     .measure =
         [](const scene::Scene& scene) {
           return std::make_unique<Column>(scene, 0.05715,
                                           readCurve(dataPath("fluid_dambreak_martin_moyce_n2_2_front.csv"), 0, 1),
                                           readCurve(dataPath("fluid_dambreak_martin_moyce_n2_2_height.csv"), 0, 1));
         },
     .flow = FlowKind::Splash,
     .norm = {"front"}}};

const Registered kKoshizukaOka{
    {.name = "koshizuka_oka",
     .measures =
         "front of the column against the experiment of Koshizuka and Oka (1996): rms, relative, after the one shift "
         "in time that fits best",
     .scene = "koshizuka_oka",
     .every = 0.002,
     .full = {{0.0073, 0.00365, 0.001825}, {{"duration", "0.3"}}},
     .quick = {{0.0073}, {{"duration", "0.3"}}},
     .measure =
         [](const scene::Scene& scene) {
           return std::make_unique<Column>(
               scene, 0.146, readCurve(dataPath("fluid_dambreak_koshizuka_oka_1996.csv"), 1, 2, "exp"), Curve{});
         },
     .flow = FlowKind::Splash,
     .norm = {"front"}}};

}  // namespace
}  // namespace froude::validation
