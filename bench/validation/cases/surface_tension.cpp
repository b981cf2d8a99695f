// Drops under surface tension: the pressure inside one at rest, the period of one that swings, the angle at a floor.
#include <cmath>

#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

const FluidDef& fluidOf(const World& world) { return *world.definition().fluid; }

/// Radius of the disc with the fluid's area [m].
double radius(const World& world) { return std::sqrt(world.totals().mass / fluidOf(world).density / kPi); }

/// Means over the second half of the run.
class AtRest final : public Measure {
 public:
  explicit AtRest(const scene::Scene& scene) : from_(0.5 * scene.duration) {}

  void read(const World& world, double t) override {
    if (t < from_) return;
    const ParticlePool& pool = *world.fluid();
    const Moments m = moments(pool);
    const double r = radius(world);
    double pressure = 0.0, largest = 0.0;
    int count = 0;
    constexpr int kPlaces = 12;  // each way, over the inner square of half the diameter
    for (int k = 0; k < kPlaces * kPlaces; ++k) {
      const Vec2 at((k % kPlaces + 0.5) / kPlaces - 0.5, (k / kPlaces + 0.5) / kPlaces - 0.5);
      pressure += world.pressureAt(m.centre + r * at);
      ++count;
    }
    for (std::size_t i = 0; i < pool.size(); ++i) largest = std::max(largest, std::hypot(pool.vx()[i], pool.vy()[i]));
    pressure_ += pressure / count / (fluidOf(world).surfaceTension / r) - 1.0;
    // Of the speed of capillary waves as long as the radius.
    const double scale = std::sqrt(fluidOf(world).surfaceTension / (fluidOf(world).density * r));
    rms_ += std::sqrt(2.0 * m.kinetic) / scale;
    largest_ = std::max(largest_, largest / scale);
    ++count_;
  }
  std::vector<Metric> results() const override {
    return {{"pressure", "1", pressure_ / count_, 0.05},
            {"speed_rms", "1", rms_ / count_, {}},
            {"speed_largest", "1", largest_, {}}};
  }

 private:
  double from_, pressure_ = 0.0, rms_ = 0.0, largest_ = 0.0, count_ = 0.0;
};

/// From the first to the last time that the drop is round.
class Oscillating final : public Measure {
 public:
  void read(const World& world, double t) override {
    const Moments m = moments(*world.fluid());
    const double lying = (m.xx - m.yy) / (m.xx + m.yy);
    if (t == 0.0) {
      const double r = radius(world);
      exact_ = 2.0 * kPi / std::sqrt(6.0 * fluidOf(world).surfaceTension / (fluidOf(world).density * r * r * r));
    } else if (t > 0.25 * exact_ && last_ * lying < 0.0) {  // at its start it is round
      const double at = lastTime_ + (t - lastTime_) * last_ / (last_ - lying);
      if (turns_ == 0) first_ = at;
      end_ = at;
      ++turns_;
    }
    largest_ = t < 0.5 * exact_ ? std::max(largest_, lying) : largest_;
    lateLargest_ = t > 1.5 * exact_ ? std::max(lateLargest_, std::abs(lying)) : 0.0;
    last_ = lying;
    lastTime_ = t;
  }
  std::vector<Metric> results() const override {
    std::vector<Metric> metrics;
    if (turns_ > 1) metrics.push_back({"period", "1", 2.0 * (end_ - first_) / (turns_ - 1) / exact_ - 1.0, 0.05});
    metrics.push_back({"amplitude", "1", lateLargest_ / largest_ - 1.0, {}, false});
    return metrics;
  }

 private:
  double exact_ = 0.0, last_ = 0.0, lastTime_ = 0.0, first_ = 0.0, end_ = 0.0, largest_ = 0.0, lateLargest_ = 0.0;
  int turns_ = 0;
};

/// The angle of the circle's cap with the area and the centroid that the fluid has, mean over the second half.
class Cap final : public Measure {
 public:
  explicit Cap(const scene::Scene& scene) : from_(0.5 * scene.duration) {}

  void read(const World& world, double t) override {
    if (t < from_) return;
    const double height = moments(*world.fluid()).centre.y() / (std::sqrt(kPi) * radius(world));
    double low = 0.01, high = kPi - 0.01;
    for (int k = 0; k < 50; ++k) {
      const double angle = 0.5 * (low + high);
      (centroid(angle) < height ? low : high) = angle;
    }
    sum_ += (low - fluidOf(world).contactAngle) * 180.0 / kPi;
    ++count_;
  }
  std::vector<Metric> results() const override { return {{"angle", "deg", sum_ / count_, 5.0}}; }

 private:
  /// Of a cap above its base, over the square root of its area.
  static double centroid(double angle) {
    const double s = std::sin(angle), area = angle - s * std::cos(angle);
    return (2.0 / 3.0 * s * s * s / area - std::cos(angle)) / std::sqrt(area);
  }
  double from_, sum_ = 0.0, count_ = 0.0;
};

const Registered kAtRest{
    {.name = "surface_tension",
     .measures = "means over the second half: pressure inside the drop over σ/R; rms and largest speed over √(σ/(ρR))",
     .scene = "surface_tension",
     .every = 0.02,
     .full = {{0.05, 0.025, 0.0125}, {}},
     .quick = {{0.05}, {}},
     .measure = [](const scene::Scene& scene) { return std::make_unique<AtRest>(scene); },
     .flow = FlowKind::Surface,
     .norm = {"pressure"}}};

const Registered kOscillating{{.name = "oscillating_drop",
                               .measures = "mean period of the second mode over that of ω² = 6σ/(ρR³); amplitude lost "
                                           "from the first half period to after "
                                           "one and a half",
                               .scene = "oscillating_drop",
                               .every = 0.01,
                               .full = {{0.05, 0.025, 0.0125}, {}},
                               .quick = {{0.05}, {}},
                               .measure = [](const scene::Scene&) { return std::make_unique<Oscillating>(); },
                               .flow = FlowKind::Surface,
                               .norm = {"period"}}};

const Registered kWetting{
    {.name = "contact_angle",
     .measures = "angle of the circle's cap with the drop's area and centroid, against 60 degrees",
     .scene = "contact_angle",
     .every = 0.05,
     .full = {{0.05, 0.025, 0.0125}, {}},
     .quick = {{0.05}, {}},
     .measure = [](const scene::Scene& scene) { return std::make_unique<Cap>(scene); }}};

const Registered kBeading{{.name = "contact_angle_120",
                           .measures = "the same drop, against 120 degrees",
                           .scene = "contact_angle",
                           .every = 0.05,
                           .full = {{0.05, 0.025, 0.0125}, {{"fluid.contact_angle", "120.0"}}},
                           .quick = {{0.05}, {{"fluid.contact_angle", "120.0"}}},
                           .measure = [](const scene::Scene& scene) { return std::make_unique<Cap>(scene); }}};

}  // namespace
}  // namespace froude::validation
