// What every fluid method must do at rest: tanks, plates, corners, needles.
#include <gtest/gtest.h>

#include <froude/fields/distance_field.h>
#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

constexpr double kG = 9.81;

class FluidAtRest : public FluidMethod {};
INSTANTIATE_TEST_SUITE_P(Each, FluidAtRest, kFluidMethods, methodName);

TEST_P(FluidAtRest, a_tank_comes_to_rest_under_hydrostatic_pressure_and_its_floor_carries_the_weight) {
  if (wcsph()) GTEST_SKIP() << "does not hold yet: its mean speed is 1.3 % of the wave's, not 1 (docs/models/wcsph.md)";
  WorldDef def = fluidWorld({{0.0, -0.2}, {0.8, 0.8}}, 0.02);
  def.bodies.push_back(body("floor", Polygon::box({{-1.0, -1.0}, {2.0, 0.0}}), {0.0, 0.0}));
  World world(def);
  fill(world, {{0.0, 0.0}, {0.8, 0.5}}, 0.02);
  runTo(world, 4.0);
  EXPECT_LT(meanSpeed(world), 0.01 * std::sqrt(kG * 0.5));
  // Of any particle at any time: dfsph presses some in the bottom corners while the lattice gives way.
  EXPECT_LT(world.ledger().maxDensityError, pbf() ? 0.03 : 0.06);
  double force = 0.0, seconds = 0.0;
  while (seconds < 0.5) {
    const StepReport report = world.substep();
    force += world.body(0).force.y() * report.dt;
    seconds += report.dt;
  }
  const double weight = 1000.0 * kG * 0.8 * 0.5;
  EXPECT_NEAR(-force / seconds, weight, 0.02 * weight);  // the side walls carry a share of about 0.3 dx of width each
  for (const double depth : {0.1, 0.25, 0.4}) {
    EXPECT_NEAR(world.pressureAt({0.4, 0.5 - depth}), 1000.0 * kG * depth, 0.04 * 1000.0 * kG * 0.5) << depth;
  }
}

TEST_P(FluidAtRest, a_tank_of_forty_rows_is_calm_after_three_seconds_and_half_as_deep_has_half_the_pressure) {
  const double dx = 0.0125, depth = 40 * dx;
  World world(fluidWorld({{0.0, 0.0}, {0.3, 0.8}}, dx));
  fill(world, {{0.0, 0.0}, {0.3, depth}}, dx);
  runTo(world, 3.0);
  EXPECT_LT(meanSpeed(world), 0.01 * std::sqrt(kG * depth));
  // Of three places and half a second; single ones are up to 3 % off by the arrangement of the particles there.
  double pressure = 0.0, seconds = 0.0;
  while (seconds < 0.5) {
    const double dt = world.substep().dt;
    for (const double x : {0.08, 0.15, 0.22}) pressure += dt * world.pressureAt({x, 0.5 * depth}) / 3.0;
    seconds += dt;
  }
  EXPECT_NEAR(pressure / seconds, 1000.0 * kG * 0.5 * depth, 0.02 * 1000.0 * kG * depth);
}

TEST_P(FluidAtRest, two_sides_of_a_thin_plate_have_their_own_levels_and_pressures) {
  if (apic()) GTEST_SKIP() << "does not hold yet: the shallow side's pressure is 7 % too high (docs/models/apic.md)";
  if (wcsph()) GTEST_SKIP() << "does not hold yet: the pressure is 2.53 % too low, not 2.5 (docs/models/wcsph.md)";
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.2, 1.4}}, 0.02);
  def.bodies.push_back(body("plate", Polygon::box({{-0.00005, -0.1}, {0.00005, 1.5}}), {0.6, 0.0}));
  World world(def);
  fill(world, {{0.0, 0.0}, {0.6, 1.0}}, 0.02);
  fill(world, {{0.6, 0.0}, {1.2, 0.5}}, 0.02);
  runTo(world, 2.5);
  std::size_t left = 0, right = 0;
  for (const double x : world.fluid()->x()) ++(x < 0.6 ? left : right);
  EXPECT_EQ(left, 30u * 50u);
  EXPECT_EQ(right, 30u * 25u);
  EXPECT_EQ(world.ledger().leaks, 0u);
  // Each side has its own hydrostatic pressure, 2 % of the deeper side's at the floor: a mean over half a second and
  // three places. Single places are up to 3 % off, for as long as the particles around them keep their arrangement.
  const std::vector<double> lefts{0.15, 0.3, 0.56}, rights{0.64, 0.9, 1.05};
  double deep = 0.0, shallow = 0.0;
  const double start = world.time();
  while (world.time() < start + 0.5) {
    const double dt = world.substep().dt;
    for (const double x : lefts) deep += dt * world.pressureAt({x, 0.2}) / 3.0;
    for (const double x : rights) shallow += dt * world.pressureAt({x, 0.1}) / 3.0;
  }
  const double seconds = world.time() - start, tolerance = 0.02 * 1000.0 * kG * 1.0;
  EXPECT_NEAR(deep / seconds, 1000.0 * kG * 0.8, tolerance);
  EXPECT_NEAR(shallow / seconds, 1000.0 * kG * 0.4, tolerance);
}

// A body on the floor of a tank 1.2 m wide; particles wherever they are at least half a spacing from it.
World tankAround(const WorldDef& base, const Polygon& solid, double depth) {
  WorldDef def = base;
  const double dx = def.fluid->spacing;
  def.bodies.push_back(body("solid", solid, {0.0, 0.0}));
  World world(def);
  const DistanceField field(solid, dx);
  std::vector<Vec2> points;
  for (const Vec2& p : latticePoints({{0.0, 0.0}, {1.2, depth}}, dx)) {
    if (field.sample(p).distance > 0.5 * dx) points.push_back(p);
  }
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  return world;
}

// Corners as the fluid has them: 45 degrees under a ramp, 90 in front of a step, 270 round its edge, and a needle 2 mm
// thick. Neither method is still there, above all where a solid thinner than the support ends; pbf is left out at the
// needle, where it throws particles faster than water falls (docs/models/pbf.md).
TEST_P(FluidAtRest, around_corners_and_needles_it_simmers_but_does_not_boil) {
  if (wcsph())
    GTEST_SKIP() << "does not hold yet: single particles reach 41 % of the wave's speed (docs/models/wcsph.md)";
  const double depth = 0.4, wave = std::sqrt(kG * depth);
  const WorldDef def = fluidWorld({{0.0, 0.0}, {1.2, 0.8}}, 0.025);
  const std::vector<std::pair<const char*, std::vector<Vec2>>> solids{
      {"45", {{0.8, -0.1}, {1.3, -0.1}, {1.3, 0.5}}},
      {"90 and 270", {{0.7, -0.1}, {1.3, -0.1}, {1.3, 0.2}, {0.7, 0.2}}},
      {"needle", {{0.599, -0.1}, {0.601, -0.1}, {0.6, 0.25}}}};
  for (const auto& [name, corners] : solids) {
    if (pbf() && name == solids.back().first) continue;
    World world = tankAround(def, Polygon::make(corners), depth);
    const std::size_t count = world.fluid()->size();
    runTo(world, 2.0);
    double fastest = 0.0, mean = 0.0, steps = 0.0;
    while (world.time() < 3.0) {
      ASSERT_TRUE(world.substep().ok());
      fastest = std::max(fastest, world.totals().maxSpeed);
      mean += meanSpeed(world);
      steps += 1.0;
    }
    EXPECT_LT(fastest, (pbf() ? 0.5 : 0.35) * wave) << name;
    EXPECT_LT(mean / steps, (pbf() ? 0.06 : 0.02) * wave) << name;
    EXPECT_EQ(world.fluid()->size(), count) << name;
    EXPECT_EQ(world.ledger().leaks, 0u) << name;
  }
}

// A floor that rises as a piston carries all of the fluid at its own speed, whose pressure stays that of its weight.
TEST_P(FluidAtRest, on_a_rising_floor_a_fluid_rests_as_on_a_still_one) {
  const double speed = 0.2;
  WorldDef def = fluidWorld({{0.0, 0.0}, {0.6, 1.0}}, 0.02);
  BodyDef floor = body("floor", Polygon::box({{-0.5, -0.5}, {1.1, 0.0}}), {0.0, 0.1});
  floor.motion = Motion::Scripted;
  floor.velocity = {0.0, speed};
  def.bodies.push_back(floor);
  World world(def);
  const std::vector<Vec2> points = latticePoints({{0.0, 0.1}, {0.6, 0.4}}, 0.02);
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, speed)));
  runTo(world, 1.0);
  double force = 0.0, momentum = 0.0, seconds = 0.0;
  while (seconds < 1.0) {
    const double dt = world.substep().dt;
    force += dt * world.body(0).force.y();
    momentum += dt * world.totals().momentum.y();
    seconds += dt;
  }
  const double mass = world.totals().mass;
  EXPECT_NEAR(momentum / seconds, mass * speed, 0.05 * mass * speed);
  EXPECT_NEAR(-force / seconds, mass * kG, 0.03 * mass * kG);
  EXPECT_LT(momentumError(world), 1e-6);
  EXPECT_EQ(world.ledger().leaks + world.ledger().crushed, 0u);
}

}  // namespace
}  // namespace froude::testing
