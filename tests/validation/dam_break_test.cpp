// The front of a collapsing column against the experiment of Martin and Moyce (1952), n² = 2.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "run/gauges.h"
#include "scene/scene.h"
#include "validation/curve.h"

namespace froude {
namespace {

using validation::Curve;

// The gauge `toe` of the shipped scene, as Z = x/a over T = t √(2g/a).
Curve simulated(const std::string& spacing) {
  const double a = 0.05715, g = 9.81;
  const scene::Scene scene = scene::load(std::string(FROUDE_SOURCE_DIR) + "/scenes/dam_break.toml",
                                         {{"model.spacing", spacing}, {"duration", "0.19"}});
  World world = scene::makeWorld(scene);
  run::GaugeSet gauges(scene.gauges, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  while (world.time() < scene.duration) {
    EXPECT_TRUE(world.substep().ok());
    gauges.afterStep(world, rows);
  }
  std::size_t column = 0;
  while (gauges.columns()[column].name != "toe") ++column;
  Curve curve;
  for (const std::string& row : rows) {
    std::stringstream cells(row);
    std::string cell;
    std::getline(cells, cell, ',');
    const double t = std::stod(cell);
    for (std::size_t k = 0; k <= column; ++k) std::getline(cells, cell, ',');
    if (cell.empty()) continue;
    curve.add(t * std::sqrt(2.0 * g / a), std::stod(cell) / a);
  }
  return curve;
}

TEST(DamBreak, the_front_follows_martin_and_moyce) {
  const Curve reference =
      validation::readCurve(std::string(FROUDE_TEST_DATA) + "/fluid_dambreak_martin_moyce_n2_2_front.csv", 0, 1);
  ASSERT_GE(reference.t.size(), 12u);
  for (const char* spacing : {"0.0028575", "0.00142875"}) {  // a/20, a/40
    // For T ≥ 0.84, after the one time shift that fits best: the gate of the experiment takes time to open.
    const validation::Distance off = validation::bestShift(simulated(spacing), reference, 0.84, 4.0, 0.3);
    RecordProperty(std::string("rms_") + spacing, std::to_string(off.rms));
    EXPECT_LT(off.rms, 0.04) << "spacing " << spacing << ", ΔT = " << off.shift;  // asked for: 8 %
    EXPECT_GT(off.shift, 0.0);
  }
}

}  // namespace
}  // namespace froude
