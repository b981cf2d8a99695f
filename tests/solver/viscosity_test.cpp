// The solve for viscosity against the explicit term, exact flows, and the books.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "support/channel.h"
#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

constexpr double kExplicitStep = 0.125 * kChannelSpacing * kChannelSpacing / kChannelViscosity;  // s

class Viscosity : public FluidMethod {
 protected:
  static WorldDef viscousWorld(const Box& domain, double dx, double viscosity) {
    WorldDef def = fluidWorld(domain, dx);
    def.fluid->viscosity = viscosity;
    def.domain.slip = Slip::NoSlip;
    return def;
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, Viscosity, kViscousMethods, methodName);

TEST_P(Viscosity, the_solve_and_the_explicit_term_differ_to_first_order_in_the_sub_step) {
  if (apic()) GTEST_SKIP() << "it has no explicit term";
  const double wave = 2.0 * kPi, duration = 8.0 * kExplicitStep;
  auto speeds = [&](ViscositySolver solver, double dt) {
    WorldDef def = channel(GetParam());
    def.domain.periodicY = true;
    def.domain.closed = {false, false, false, false};
    def.fluid->viscositySolver = solver;
    def.timeStep = dt;
    World world(def);
    const std::vector<Vec2> points = latticePoints(def.domain.box, kChannelSpacing);
    std::vector<Vec2> velocities;
    for (const Vec2& p : points) velocities.emplace_back(0.01 * std::sin(wave * p.y()), 0.0);
    world.addFluid(points, velocities);
    EXPECT_TRUE(world.step(duration).ok());
    double sum = 0.0;  // amplitude of the wave
    const ParticlePool& pool = *world.fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) sum += pool.vx()[i] * std::sin(wave * pool.y()[i]);
    return 2.0 * sum / static_cast<double>(pool.size());
  };
  double apart[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = kExplicitStep / (k + 1);
    apart[k] = speeds(ViscositySolver::Implicit, dt) - speeds(ViscositySolver::Explicit, dt);
  }
  // Backward and forward Euler of exp(−λt): (1 + λdt)⁻ⁿ − (1 − λdt)ⁿ = λ²·t·dt·exp(−λt), to first order.
  const double rate = kChannelViscosity * wave * wave;
  const double first = 0.01 * rate * rate * duration * kExplicitStep * std::exp(-rate * duration);
  EXPECT_NEAR(apart[0], first, 0.15 * first);
  EXPECT_NEAR(apart[1], 0.5 * apart[0], 0.1 * apart[0]);
}

TEST_P(Viscosity, ten_times_the_explicit_step_follows_the_start_of_a_flow_between_plates) {
  const double force = 0.08, largest = force / (8.0 * kChannelViscosity);
  WorldDef def = channel(GetParam());
  def.gravity = {force, 0.0};
  def.timeStep = 10.0 * kExplicitStep;
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 1.0}}, kChannelSpacing);
  for (const double time : {0.5, 2.0, 5.0}) {  // t ν/L² = 0.05, 0.2, 0.5
    ASSERT_TRUE(world.step(time - world.time()).ok());
    EXPECT_LT(largestError(world, [&](double y) { return poiseuille(y, time, force); }), 0.04 * largest) << time;
  }
  EXPECT_LT(momentumError(world) * world.ledger().maxSpeed, 1e-6 * largest);
}

TEST_P(Viscosity, ten_times_the_explicit_step_follows_a_belt_that_starts) {
  const double speed = 0.1;
  WorldDef def = channel(GetParam(), 1.4);
  def.bodies.push_back(body("belt", Polygon::box({{-1.0, 0.0}, {2.0, 0.3}}), {0.0, 1.0}));
  def.bodies[0].surfaceVelocity = speed;
  def.timeStep = 10.0 * kExplicitStep;
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 1.0}}, kChannelSpacing);
  for (const double time : {0.5, 2.0, 5.0}) {
    ASSERT_TRUE(world.step(time - world.time()).ok());
    EXPECT_LT(largestError(world, [&](double y) { return couette(y, time, speed); }), 0.04 * speed) << time;
  }
  const double shear = def.fluid->density * kChannelViscosity * speed;  // [N/m] of a channel 1 m long
  EXPECT_NEAR(world.body(0).force.x(), -shear, 0.05 * shear);
  EXPECT_LT(momentumError(world) * world.ledger().maxSpeed, 1e-6 * speed);
}

TEST_P(Viscosity, a_block_of_honey_falls_apart_in_long_steps_and_never_gains_energy) {
  const double dx = 0.01;
  WorldDef def = viscousWorld({{0.0, 0.0}, {1.0, 0.6}}, dx, 1.0);
  World world(def);
  fill(world, {{0.3, 0.0}, {0.7, 0.4}}, dx);
  double before = world.totals().kinetic + world.totals().potential;
  const double start = before;
  for (int k = 0; k < 200; ++k) {
    ASSERT_TRUE(world.substep().ok());
    const Totals totals = world.totals();
    EXPECT_LE(totals.kinetic + totals.potential, before + 1e-6 * start) << "at " << world.time();
    before = totals.kinetic + totals.potential;
  }
  EXPECT_GT(world.time() / 200.0, 20.0 * 0.125 * dx * dx / def.fluid->viscosity);  // mean step, of an explicit one
  EXPECT_LT(before, start);
  EXPECT_LT(momentumError(world), 1e-6);
}

// A jet into a viscous pool with a turning paddle and a raft, all of which hold the fluid.
WorldDef busyPool(WorldDef def) {
  def.fluid->viscositySolver = ViscositySolver::Implicit;
  BodyDef paddle = body("paddle", Polygon::box({{-0.15, -0.02}, {0.15, 0.02}}), {1.1, 0.3});
  paddle.motion = Motion::Scripted;
  paddle.spin = 1.0;
  def.bodies.push_back(paddle);
  BodyDef raft = body("raft", Polygon::box({{-0.1, -0.1}, {0.1, 0.1}}), {0.5, 0.4});
  raft.motion = Motion::Free;
  raft.density = 300.0;
  def.bodies.push_back(raft);
  def.emitters.push_back(nozzle({1.5, 0.8}, {1.3, 0.8}, 1.0, 10000));
  return def;
}

void fillPool(World& world) {
  std::vector<Vec2> water;
  for (const Vec2& p : latticePoints({{0.0, 0.0}, {1.6, 0.6}}, 0.02)) {
    if ((p - Vec2(1.1, 0.3)).norm() > 0.18 && (p - Vec2(0.5, 0.4)).cwiseAbs().maxCoeff() > 0.1) water.push_back(p);
  }
  world.addFluid(water, std::vector<Vec2>(water.size(), Vec2(0.0, 0.0)));
}

TEST_P(Viscosity, what_walls_bodies_and_nozzles_get_is_what_the_fluid_loses) {
  World world(busyPool(viscousWorld({{0.0, 0.0}, {1.6, 1.2}}, 0.02, 0.2)));
  fillPool(world);
  for (int k = 0; k < 100; ++k) {
    const StepReport report = world.substep();
    ASSERT_TRUE(report.ok()) << name(report.trouble) << " at " << world.time();
    const ParticlePool& pool = *world.fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) {
      if (pool.y()[i] > 0.77) {
        EXPECT_NEAR(pool.vy()[i], -1.0, 1e-9) << "a nozzle carries it";
      }
    }
  }
  EXPECT_GT(world.ledger().emitted, 20u);
  EXPECT_LT(momentumError(world), 1e-6);
}

TEST_P(Viscosity, the_solve_has_the_same_bits_on_1_2_and_3_threads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      World world(busyPool(viscousWorld({{0.0, 0.0}, {1.6, 1.2}}, 0.02, 0.2)));
      fillPool(world);
      for (int k = 0; k < 30; ++k) ASSERT_TRUE(world.substep().ok());
      hashes.push_back(world.stateHash());
    });
  }
  ASSERT_EQ(hashes.size(), 3u);
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

// A raft a tenth as dense as the honey: were its drag taken at its old velocity, it would be thrown to and fro.
TEST_P(Viscosity, a_light_body_in_honey_rises_slowly_and_is_not_thrown_about) {
  if (wcsph()) GTEST_SKIP() << "does not hold yet: it is thrown about at up to 3.7 m/s (docs/models/wcsph.md)";
  WorldDef def = viscousWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02, 1.0);
  BodyDef box = body("box", Polygon::box({{-0.1, -0.1}, {0.1, 0.1}}), {0.5, 0.3});
  box.motion = Motion::Free;
  box.density = 100.0;
  def.bodies.push_back(box);
  World world(def);
  std::vector<Vec2> honey;
  for (const Vec2& p : latticePoints({{0.0, 0.0}, {1.0, 0.6}}, 0.02)) {
    if ((p - Vec2(0.5, 0.3)).cwiseAbs().maxCoeff() > 0.1) honey.push_back(p);
  }
  world.addFluid(honey, std::vector<Vec2>(honey.size(), Vec2(0.0, 0.0)));
  const double energy = world.totals().kinetic + world.totals().potential;
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(world.step(0.005).ok());
    EXPECT_LT(world.body(0).velocity.norm(), 0.1) << "at " << world.time();
  }
  EXPECT_GT(world.body(0).transform.position.y(), 0.3);
  // apic lifts some as it evens particles out around the box (docs/models/apic.md).
  if (!apic()) {
    EXPECT_LT(world.totals().kinetic + world.totals().potential, energy);
  }
}

// All iterations do not solve it. The books close to what single precision leaves of differences times ν·dt/dx² = 1e5.
TEST_P(Viscosity, a_literal_step_far_beyond_all_bounds_is_stable) {
  if (wcsph()) GTEST_SKIP() << "cannot hold: it would take more acoustic steps than a sub-step may have";
  WorldDef def = viscousWorld({{0.0, 0.0}, {2.0, 0.5}}, 0.01, 1e4);
  def.domain.slip = Slip::Free;
  def.timeStep = 1e-3;
  World world(def);
  const std::vector<Vec2> points = latticePoints({{0.0, 0.0}, {2.0, 0.4}}, 0.01);
  std::vector<Vec2> velocities;
  for (const Vec2& p : points) velocities.emplace_back(0.1 * std::sin(kPi * p.x()), 0.05 * std::sin(40.0 * p.x()));
  world.addFluid(points, velocities);
  const double kinetic = world.totals().kinetic;
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world.substep().ok());
  EXPECT_LT(world.totals().kinetic, kinetic);
  EXPECT_LT(momentumError(world), 1e-3);
}

}  // namespace
}  // namespace froude::testing
