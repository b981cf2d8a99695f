// A dam that breaks against a wall with pressure sensors: when the water comes, how hard it presses, and how quietly.
#include <algorithm>
#include <cmath>

#include "validation/curve.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kHeight = 0.3;                         // of the column [m]
constexpr double kFilter = 0.1;                         // width of the median filter, in t* = t √(g/H)
constexpr double kArrived = 0.5;                        // [ρ g H]: half way up the rise of sensor 1 is near 1
constexpr double kPlateauFrom = 3.5, kPlateauTo = 5.5;  // t*: between the impact and the wave that falls back

struct Sensor {
  std::string name;
  Vec2 at;      // [m]
  Curve data;   // of the experiment, empty if there is none
  double peak;  // of the experiment, median of a hundred runs [ρ g H]
  Curve signal{};
};

/// Pressures over ρ g H, over t*.
class Wall final : public Measure {
 public:
  Wall(const scene::Scene& scene, std::vector<Sensor> sensors)
      : rate_(std::sqrt(-scene.world.gravity.y() / kHeight)),
        scale_(-scene.world.fluid->density * scene.world.gravity.y() * kHeight),
        sensors_(std::move(sensors)) {}

  void read(const World& world, double t) override {
    for (Sensor& sensor : sensors_) {
      const double pressure = world.pressureAt(sensor.at);
      sensor.signal.add(t * rate_, std::isfinite(pressure) ? pressure / scale_ : 0.0);  // dry: none
    }
  }

  std::vector<Metric> results() const override {
    std::vector<Metric> metrics;
    for (const Sensor& sensor : sensors_) {
      const Curve quiet = medianFiltered(sensor.signal, kFilter);
      if (&sensor == &sensors_.front())
        metrics.push_back({"arrival", "1", quiet.reaches(kArrived) / sensor.data.reaches(kArrived) - 1.0, 0.03});
      if (quiet.t.back() < kPlateauTo) continue;
      if (!sensor.data.t.empty()) {
        const double right = sensor.data.mean(kPlateauFrom, kPlateauTo);
        metrics.push_back({"plateau_" + sensor.name, "1", quiet.mean(kPlateauFrom, kPlateauTo) / right - 1.0, 0.1});
      }
      metrics.push_back(
          {"peak_" + sensor.name, "1", *std::max_element(quiet.z.begin(), quiet.z.end()) / sensor.peak - 1.0, {}});
      double noise = 0.0;
      for (std::size_t i = 0; i < quiet.z.size(); ++i) noise += std::pow(sensor.signal.z[i] - quiet.z[i], 2);
      metrics.push_back({"noise_" + sensor.name, "ρgH", std::sqrt(noise / static_cast<double>(quiet.z.size())), {}});
    }
    return metrics;
  }

 private:
  double rate_, scale_;
  std::vector<Sensor> sensors_;
};

std::unique_ptr<Measure> measure(const scene::Scene& scene) {
  const std::string series = dataPath("fluid_dambreak_lobovsky_H300_pressure.csv"),
                    peaks = dataPath("fluid_dambreak_lobovsky_H300_peaks.csv");
  std::vector<Sensor> sensors;
  for (const scene::GaugeDef& gauge : scene.gauges) {
    if (gauge.type != "pressure") continue;
    const std::string number = gauge.name.substr(1);  // p1 … p4
    sensors.push_back({gauge.name, gauge.at, number == "2" ? Curve{} : readCurve(series, 1, 2, number),
                       readCurve(peaks, 0, 5, number).z.at(0)});
  }
  return std::make_unique<Wall>(scene, std::move(sensors));
}

const Registered kCase{
    {.name = "dam_pressure",
     .measures =
         "pressures on the far wall after a median filter 0.1 √(H/g) wide, against Lobovský et al. (2014): arrival at "
         "the lowest sensor, mean from 3.5 to 5.5 √(H/g), peak; rms of what the filter took",
     .scene = "dam_pressure",
     .every = 0.0,
     .full = {{0.01, 0.005, 0.0025}, {{"duration", "1.0"}}},
     .quick = {{0.015}, {{"duration", "1.0"}}},
     .measure = measure}};

}  // namespace
}  // namespace froude::validation
