// What every fluid method must do in motion: flight, collision, rotation, seams, paddles, sinks.
#include <gtest/gtest.h>

#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

constexpr double kG = 9.81;

class FluidInMotion : public FluidMethod {};
INSTANTIATE_TEST_SUITE_P(Each, FluidInMotion, kFluidMethods, methodName);

TEST_P(FluidInMotion, a_drop_in_free_fall_keeps_its_shape_and_obeys_gravity) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 3.0}}, 0.02);
  World world(def);
  fill(world, {{0.4, 2.5}, {0.6, 2.7}}, 0.02);
  runTo(world, 0.4);
  const double t = world.time();
  const Totals totals = world.totals();
  // In apic velocities pass through floats each step.
  EXPECT_NEAR(totals.momentum.y() / totals.mass, -kG * t, apic() ? 1e-5 : 1e-6);
  double low = 9.0, high = 0.0;
  for (const double y : world.fluid()->y()) {
    low = std::min(low, y);
    high = std::max(high, y);
  }
  EXPECT_NEAR(high - low, 0.18, 0.01);
}

TEST_P(FluidInMotion, particles_far_from_all_others_fly_parabolas) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {4.0, 4.0}}, 0.02);
  World world(def);
  const std::vector<Vec2> start{{0.5, 3.0}, {2.0, 3.5}, {3.0, 2.5}}, speed{{1.0, 2.0}, {0.0, 0.0}, {-2.0, 1.0}};
  const std::vector<ParticleHandle> handles = world.addFluid(start, speed);
  std::vector<Vec2> at = start, v = speed;
  double longest = 0.0;
  while (world.time() < 0.4) {
    const double dt = world.substep().dt;
    longest = std::max(longest, dt);
    for (std::size_t k = 0; k < at.size(); ++k) {
      v[k].y() -= dt * kG;
      at[k] += dt * v[k];
    }
  }
  const ParticlePool& pool = *std::as_const(world).fluid();
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::size_t i = pool.indexOf(handles[k]).value();
    // In wcsph it falls in acoustic steps, whose ways are summed up on the lattice of positions.
    // In apic velocities pass through floats, and ways see the empty space around in the 5th digit.
    EXPECT_NEAR(pool.x()[i], at[k].x(), wcsph() ? 1e-6 : apic() ? 1e-4 : 1e-12);
    EXPECT_NEAR(pool.y()[i], at[k].y(), wcsph() ? 0.5 * kG * world.time() * longest : apic() ? 1e-4 : 1e-12);
    EXPECT_NEAR(pool.vy()[i], v[k].y(), apic() ? 1e-5 : 1e-11);
    // The steps of such a flight are a hundredth of it.
    const double t = world.time();
    EXPECT_NEAR(pool.y()[i], start[k].y() + speed[k].y() * t - 0.5 * kG * t * t, 0.02);
  }
}

TEST_P(FluidInMotion, an_over_dense_start_relaxes_without_an_explosion) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {2.0, 2.0}}, 0.02);
  def.gravity = {0.0, 0.0};
  World world(def);
  fill(world, {{0.8, 0.8}, {1.2, 1.2}}, 0.018);  // 23 % too many
  runTo(world, 0.5);
  const Totals totals = world.totals();
  EXPECT_LT(world.ledger().maxKinetic, 1e-3 * totals.mass * kG * 0.4) << "of what it would gain by its own height";
  EXPECT_LT(world.ledger().maxSpeed, 0.05);
  EXPECT_LT(totals.maxSpeed, 0.05);
}

TEST_P(FluidInMotion, a_start_with_half_too_many_particles_is_refused) {
  if (wcsph()) GTEST_SKIP() << "cannot hold: densities are integrated from rest, whatever the start";
  World world(fluidWorld({{0.0, 0.0}, {2.0, 2.0}}, 0.02));
  fill(world, {{0.8, 0.8}, {1.2, 1.2}}, 0.016);
  const StepReport report = world.substep();
  EXPECT_EQ(report.trouble, Trouble::Compression);
  EXPECT_GT(report.troubleValue, apic() ? 0.3 : 0.5);  // of all of it, surfaces too
  EXPECT_EQ(world.time(), 0.0);
}

TEST_P(FluidInMotion, a_start_with_gaps_falls_together_under_gravity_and_loses_none) {
  if (wcsph()) GTEST_SKIP() << "cannot hold: densities are integrated from rest, so that it keeps its gaps for long";
  World world(fluidWorld({{0.0, 0.0}, {0.6, 1.0}}, 0.02));
  fill(world, {{0.0, 0.0}, {0.6, 0.48}}, 0.024);  // 0.69 of a full block
  const std::size_t count = world.fluid()->size();
  runTo(world, 2.0);
  EXPECT_EQ(world.fluid()->size(), count);
  EXPECT_LT(world.ledger().maxDensityError, 0.1);
  EXPECT_LT(meanSpeed(world), 0.05 * std::sqrt(kG * 0.33));
  double height = 0.0;
  for (const double y : world.fluid()->y()) height += y / static_cast<double>(count);
  const double full = 0.5 * static_cast<double>(count) * 0.02 * 0.02 / 0.6;
  EXPECT_NEAR(height, full, 0.05 * full) << "half the depth of as many particles without gaps";
}

TEST_P(FluidInMotion, steps_a_hundredth_of_its_own_do_not_heat_a_fluid) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.025);
  def.timeStep = 1e-5;
  World world(def);
  fill(world, {{0.0, 0.0}, {0.5, 0.5}}, 0.025);
  runTo(world, 0.012);
  EXPECT_LT(world.ledger().energyDrift, 0.01);
  EXPECT_LT(meanSpeed(world), kG * 0.012) << "of free fall";
}

// Lighter than a particle, it is thrown about by any of them; following paths around a million turns would take hours.
TEST_P(FluidInMotion, a_needle_lighter_than_a_particle_may_spin_out_of_bounds_but_not_for_ever) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  BodyDef needle = body("needle", Polygon::make({{0.0, 0.0}, {0.3, 0.001}, {0.0, 0.002}}), {0.3, 0.3});
  needle.angle = 0.5;
  needle.motion = Motion::Free;
  needle.density = 500.0;
  def.bodies.push_back(needle);
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 0.28}}, 0.02);
  StepReport report;
  while (report.ok() && world.time() < 0.1) report = world.substep();
  EXPECT_TRUE(report.ok() || world.time() > 0.0);
  EXPECT_TRUE(world.totals().momentum.allFinite());

  def.bodies[0].spin = 1e12;
  def.timeStep = 1e-3;
  World spun(def);
  fill(spun, {{0.0, 0.0}, {1.0, 0.28}}, 0.02);
  report = spun.substep();
  EXPECT_EQ(report.trouble, Trouble::Turn);
  EXPECT_GT(report.troubleValue, 1e3);
  EXPECT_EQ(report.limit, StepLimit::Literal);
}

TEST_P(FluidInMotion, single_particles_and_no_particles_are_no_trouble) {
  const double highest = wcsph() ? 0.15 : 0.05;  // a little elastic, it bounces
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  World empty(def);
  EXPECT_TRUE(empty.substep().ok());
  World world(def);
  world.addFluid(std::vector<Vec2>{{0.5, 0.5}, {0.51, 0.5}, {0.2, 0.3}}, std::vector<Vec2>(3, Vec2(0.1, 0.0)));
  runTo(world, 0.5);
  for (const double y : world.fluid()->y()) {
    EXPECT_GE(y, 0.0);
    EXPECT_LT(y, highest);
  }
}

TEST_P(FluidInMotion, what_a_blob_loses_at_a_wall_is_the_walls_and_in_the_books) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  def.gravity = {0.0, 0.0};
  World world(def);
  const std::vector<Vec2> points = latticePoints({{0.4, 0.4}, {0.7, 0.6}}, 0.02);
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(1.0, 0.3)));
  const Totals before = world.totals();
  runTo(world, wcsph() ? 0.2 : 0.25);  // the kernel of wcsph reaches 0.06 m: to the wall, which is 0.06 m off then
  EXPECT_NEAR(world.totals().momentum.x(), before.momentum.x(), (wcsph() ? 1e-7 : 1e-9) * before.mass)
      << "nothing pushes in free flight";
  runTo(world, 1.0);
  EXPECT_LT(world.totals().momentum.x(), 0.5 * before.momentum.x()) << "it has met the wall";
  EXPECT_EQ(world.totals().mass, before.mass);
  EXPECT_LT(momentumError(world), 1e-6);
  EXPECT_LT(world.ledger().energyDrift, 0.01);
}

// A square that turns without gravity is held together by negative pressure, or tears. Forces in tension are not by
// pairs in dfsph: what they would do to the momentum is given back.
TEST_P(FluidInMotion, a_square_that_turns_keeps_its_place_and_gains_no_energy) {
  const double side = 1.0, spin = 2.0, dx = 0.04;
  WorldDef def = fluidWorld({{-2.0, -2.0}, {2.0, 2.0}}, dx);
  def.gravity = {0.0, 0.0};
  World world(def);
  const std::vector<Vec2> points = latticePoints({{-0.5 * side, -0.5 * side}, {0.5 * side, 0.5 * side}}, dx);
  std::vector<Vec2> velocities;
  for (const Vec2& p : points) velocities.push_back(spin * leftNormal(p));
  world.addFluid(points, velocities);
  const Totals before = world.totals();
  float lowest = 0.0f;
  while (world.time() < 1.0 / spin) {
    ASSERT_TRUE(world.substep().ok());
    const ParticlePool& pool = *std::as_const(world).fluid();
    const auto pressure = pool.column(*pool.findColumn<float>("pressure"));
    lowest = std::min(lowest, *std::min_element(pressure.begin(), pressure.end()));
    // In apic pressure takes the rest density where faces weigh what particles are.
    EXPECT_LT(world.totals().momentum.norm(), (apic() ? 1e-4 : 1e-6) * before.mass * spin * side);
  }
  if (!pbf()) {
    EXPECT_LT(lowest, -0.05f * static_cast<float>(spin * spin * side * side)) << "there was tension";
  }
  const Totals after = world.totals();
  EXPECT_EQ(after.count, before.count);
  EXPECT_LT(after.kinetic, 1.01 * before.kinetic);
  EXPECT_GT(after.kinetic, 0.8 * before.kinetic);
  EXPECT_NEAR(after.angular, before.angular, 0.05 * before.angular);
}

TEST_P(FluidInMotion, a_periodic_channel_is_the_same_wherever_its_seam_is) {
  std::vector<double> energies;
  // Whole cells of apic: its grid stands.
  for (const double shift : {0.0, apic() ? 0.32 : 0.31}) {
    WorldDef def = fluidWorld({{0.0, 0.0}, {0.8, 0.6}}, 0.02);
    def.domain.periodicX = true;
    def.timeStep = 0.002;  // the same number of sweeps and the same steps: rounding alone may differ
    def.fluid->sweeps = 10;
    World world(def);
    std::vector<Vec2> points, velocities;
    for (const Vec2& p : latticePoints({{0.0, 0.0}, {0.8, 0.3}}, 0.02)) {
      const double x = p.x() + shift;
      points.push_back({x - 0.8 * std::floor(x / 0.8), p.y()});
      velocities.push_back({0.3 * std::sin(2.0 * kPi * p.x() / 0.8), 0.0});
    }
    world.addFluid(points, velocities);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(world.substep().ok());
    EXPECT_EQ(world.ledger().retired, 0u);
    energies.push_back(world.totals().kinetic);
  }
  // The means of dfsph are over cells, and those lie elsewhere.
  EXPECT_NEAR(energies[0], energies[1], (pbf() ? 1e-4 : 1e-3) * energies[0]);
}

TEST_P(FluidInMotion, far_from_the_origin_nothing_is_lost) {
  std::vector<double> energies;
  for (const double offset : {0.0, 1.0e6}) {
    WorldDef def = fluidWorld({{offset, offset}, {offset + 1.0, offset + 1.0}}, 0.0625);
    World world(def);
    fill(world, {{offset, offset}, {offset + 0.5, offset + 0.75}}, 0.0625);
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(world.substep().ok());
    energies.push_back(world.totals().kinetic);
  }
  EXPECT_NEAR(energies[1], energies[0], 1e-3 * energies[0]);
}

TEST_P(FluidInMotion, a_paddle_that_turns_under_water_stirs_it_and_loses_none) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.025);
  BodyDef paddle = body("paddle", Polygon::box({{-0.2, -0.01}, {0.2, 0.01}}), {0.5, 0.25});
  paddle.motion = Motion::Scripted;
  paddle.spin = 3.0;
  def.bodies.push_back(paddle);
  World world(def);
  std::vector<Vec2> points;
  for (const Vec2& p : latticePoints({{0.0, 0.0}, {1.0, 0.5}}, 0.025)) {
    if (std::abs(p.y() - 0.25) > 0.02 || std::abs(p.x() - 0.5) > 0.21) points.push_back(p);
  }
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  runTo(world, 2.0);
  EXPECT_EQ(world.fluid()->size(), points.size());
  EXPECT_EQ(world.ledger().leaks, 0u);
  EXPECT_GT(world.totals().kinetic, 0.001 * world.totals().mass * 0.6 * 0.6) << "of its tips' speed";
  EXPECT_LT(world.totals().maxSpeed, 4.0 * 0.6);
  EXPECT_LT(momentumError(world), 1e-6);
  EXPECT_LT(world.ledger().energyDrift, 0.02) << "no more than the paddle's work";
}

TEST_P(FluidInMotion, a_sink_takes_fluid_away_and_the_books_close) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {0.8, 0.6}}, 0.025);
  def.sinks.push_back({std::make_shared<const Polygon>(Polygon::box({{0.7, 0.0}, {0.8, 0.1}}))});
  World world(def);
  fill(world, {{0.0, 0.0}, {0.7, 0.3}}, 0.025);
  const std::size_t start = world.fluid()->size();
  runTo(world, 0.6);
  const Ledger& ledger = world.ledger();
  EXPECT_GT(ledger.sunk, start / 5);
  EXPECT_EQ(world.fluid()->size() + ledger.sunk, start);
  EXPECT_LT(momentumError(world), 1e-6);
  EXPECT_EQ(ledger.leaks, 0u);
}

}  // namespace
}  // namespace froude::testing
