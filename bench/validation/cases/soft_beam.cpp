// Elastic beams: Timoshenko's cantilever, the flag of Turek and Hron at rest and swinging, free vibration.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "validation/curve.h"
#include "validation/soft_point.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kReadFrom = 0.9;  // of the run: means at rest are taken from here on

/// Where the tip comes to rest.
class TipAtRest final : public Measure {
 public:
  TipAtRest(const scene::Scene& scene, const Vec2& tip, const Vec2& exact, double target, double from = kReadFrom)
      : from_(from * scene.duration), tip_(scene, 0, tip), exact_(exact), target_(target) {}

  void read(const World& world, double t) override {
    if (t < from_) return;
    sum_ += tip_.displacement(world);
    count_ += 1.0;
  }

  std::vector<Metric> results() const override {
    const Vec2 mean = sum_ / count_;
    std::vector<Metric> all{{"uy", "1", mean.y() / exact_.y() - 1.0, target_}};
    if (exact_.x() != 0.0) all.push_back({"ux", "1", mean.x() / exact_.x() - 1.0, target_});
    return all;
  }

 private:
  double from_;
  SoftPoint tip_;
  Vec2 exact_, sum_{0, 0};
  double count_ = 0.0, target_;
};

/// Minima of a curve, each at the vertex of a parabola through three readings.
Curve minima(const Curve& curve) {
  Curve found;
  for (std::size_t k = 1; k + 1 < curve.z.size(); ++k) {
    const double a = curve.z[k - 1], b = curve.z[k], c = curve.z[k + 1];
    if (!(b < a && b <= c)) continue;
    const double step = 0.5 * (curve.t[k + 1] - curve.t[k - 1]), bend = a - 2.0 * b + c;
    const double shift = 0.5 * (a - c) / bend;
    found.add(curve.t[k] + shift * step, b - 0.125 * (a - c) * (a - c) / bend);
  }
  return found;
}

/// Mean time between minima; NaN with fewer than two.
double periodOf(const Curve& lows) {
  if (lows.t.size() < 2) return std::nan("");
  return (lows.t.back() - lows.t.front()) / static_cast<double>(lows.t.size() - 1);
}

/// The flag swings from rest: period and depth of its minima, and the whole curve.
class Swing final : public Measure {
 public:
  explicit Swing(const scene::Scene& scene) : tip_(scene, 0, {0.6, 0.2}) {}

  void read(const World& world, double t) override { uy_.add(t, tip_.displacement(world).y()); }

  std::vector<Metric> results() const override {
    const Curve reference = readCurve(dataPath("soft_turek_hron_csm3_series.csv"), 0, 2);
    const Curve lows = minima(uy_), exact = minima(reference);
    const auto mean = [](const Curve& c) {
      return std::accumulate(c.z.begin(), c.z.end(), 0.0) / static_cast<double>(c.z.size());
    };
    double square = 0.0, count = 0.0;
    for (std::size_t k = 0; k < reference.t.size() && reference.t[k] <= std::min(2.0, uy_.t.back()); ++k) {
      square += std::pow(uy_.at(reference.t[k]) - reference.z[k], 2);
      count += 1.0;
    }
    return {{"period", "1", periodOf(lows) / periodOf(exact) - 1.0, 0.05},
            {"amplitude", "1", mean(lows) / mean(exact) - 1.0, 0.05},
            {"rms_2s", "m", std::sqrt(square / count), {}}};
  }

 private:
  SoftPoint tip_;
  Curve uy_;
};

/// A beam that swings about its sag: the period, and whether energy grows.
class Vibration final : public Measure {
 public:
  Vibration(const scene::Scene& scene, double period) : tip_(scene, 0, {1.0, 0.0}), period_(period) {}

  void read(const World& world, double t) override {
    uy_.add(t, tip_.displacement(world).y());
    const Totals totals = world.totals();
    const double energy = totals.kinetic + totals.potential + totals.strain;
    if (t == 0.0) first_ = energy;
    most_ = std::max(most_, energy);
    last_ = energy;
    swing_ = std::max(swing_, totals.kinetic);
  }

  std::vector<Metric> results() const override {
    return {{"period", "1", periodOf(minima(uy_)) / period_ - 1.0, 0.02},
            {"energy_gain", "1", (most_ - first_) / swing_, 0.01, false},
            {"energy_loss", "1", (first_ - last_) / swing_, {}, false}};
  }

 private:
  SoftPoint tip_;
  Curve uy_;
  double period_, first_ = 0.0, most_ = -1e300, last_ = 0.0, swing_ = 0.0;
};

// A strip of L = 1 m, h = 0.1 m, ν = 0.3 that is clamped: 0.13741 m per m/s² of gravity at E = 1e6, ρ = 1000, by
// quadratic finite elements; Timoshenko's beam gives 0.13806, Euler's 0.13650.
const Registered kCantilever{
    {.name = "cantilever",
     .measures =
         "sag of the tip under the own weight, against plane elasticity by fine quadratic elements (Timoshenko's "
         "beam is 0.5 % softer)",
     .scene = "cantilever",
     .every = 0.02,
     .full = {{0.1 / 3, 0.1 / 6, 0.1 / 12}, {}},
     .quick = {{0.1 / 3}, {{"duration", "3.0"}}},
     .measure =
         [](const scene::Scene& s) {
           return std::make_unique<TipAtRest>(s, Vec2(1.0, 0.0), Vec2(0.0, -0.013741), 0.02);
         },
     .softModels = {"neo-hookean", "stvk"},
     .flow = FlowKind::Soft,
     .norm = {"uy"}}};

const Registered kCsm1{{.name = "csm1",
                        .measures = "where the flag comes to rest, E = 1.4e6: Turek & Hron 2006, table of CSM1",
                        .scene = "flag",
                        .every = 0.01,
                        .full = {{0.02 / 3, 0.02 / 6, 0.02 / 12}, {{"soft.0.damping", "14.0"}, {"duration", "3.0"}}},
                        .quick = {{0.02 / 2}, {{"soft.0.damping", "14.0"}, {"duration", "0.2"}}},
                        .measure =
                            [](const scene::Scene& s) {
                              return std::make_unique<TipAtRest>(s, Vec2(0.6, 0.2), Vec2(-0.007187, -0.0661), 0.03);
                            },
                        .softModels = {"stvk"},
                        .flow = FlowKind::Soft,
                        .norm = {"ux", "uy"}}};

const Registered kCsm2{
    {.name = "csm2",
     .measures = "the same, E = 5.6e6: CSM2",
     .scene = "flag",
     .every = 0.01,
     .full = {{0.02 / 3, 0.02 / 6, 0.02 / 12},
              {{"soft.0.damping", "28.0"}, {"soft.0.young", "5.6e6"}, {"duration", "1.5"}}},
     .quick = {{0.02 / 2}, {{"soft.0.damping", "28.0"}, {"soft.0.young", "5.6e6"}, {"duration", "0.1"}}},
     .measure =
         [](const scene::Scene& s) {
           return std::make_unique<TipAtRest>(s, Vec2(0.6, 0.2), Vec2(-0.000469, -0.01697), 0.03);
         },
     .softModels = {"stvk"},
     .flow = FlowKind::Soft,
     .norm = {"ux", "uy"}}};

const Registered kCsm3{
    {.name = "csm3",
     .measures =
         "the flag swings without loss: mean period and depth of its minima over 5 s, rms over 2 s; FeatFlow's curve",
     .scene = "flag",
     .every = 0.005,
     .full = {{0.02 / 3, 0.02 / 6, 0.02 / 12}, {}},
     .quick = {{0.02 / 2}, {{"duration", "1.0"}}},
     .measure = [](const scene::Scene& s) { return std::make_unique<Swing>(s); },
     .softModels = {"stvk"},
     .flow = FlowKind::Soft,
     .norm = {"period", "amplitude"}}};

// Euler-Bernoulli: (1.8751041/L)² √(E'I/(ρh)), E' = E/(1 − ν²).
const Registered kVibration{
    {.name = "free_vibration",
     .measures = "the beam swings about its sag: period against Euler and Bernoulli, energy over 100 periods",
     .scene = "cantilever",
     .every = 0.02,
     .full = {{0.1 / 3}, {{"soft.0.damping", "0.0"}, {"duration", "187.0"}}},
     .quick = {{0.1 / 3}, {{"soft.0.damping", "0.0"}, {"duration", "4.0"}}},
     .measure = [](const scene::Scene& s) { return std::make_unique<Vibration>(s, 1.867413247); },
     .softModels = {"neo-hookean", "stvk"},
     .flow = FlowKind::Soft,
     .norm = {"period"}}};

// Thin plate, plane strain: (ρ g d + ρ_s g t) L⁴/(384 D), D = E t³/(12 (1 − ν²)).
const Registered kPlate{
    {.name = "plate",
     .measures =
         "sag of a clamped plate under 2 m of water, mean of the last 40 %, against the thin plate; Fourey et al. "
         "2017 (other codes: +6 to −13 %)",
     .scene = "plate",
     .every = 0.002,
     .full = {{0.1, 0.05, 0.025}, {}},
     .quick = {{0.1}, {{"duration", "0.02"}}},
     .measure = [](const scene::Scene& s) {
       return std::make_unique<TipAtRest>(s, Vec2(0.5, 0.125), Vec2(0.0, -6.86044e-5), 0.1, 0.6);
     }}};

}  // namespace
}  // namespace froude::validation
