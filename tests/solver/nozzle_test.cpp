// A jet of fluid that comes out of a nozzle.
#include <gtest/gtest.h>

#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

// Upwards against gravity, so that what is ahead slows down and presses on what comes after it.
WorldDef fountain(const std::string& method, double speed) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {1.0, 2.5}};
  def.fluid = FluidDef{};
  def.fluid->model = method;
  def.fluid->spacing = 0.02;
  EmitterDef nozzle;
  nozzle.name = "nozzle";
  nozzle.kind = EmitterDef::Kind::Fluid;
  nozzle.from = {0.44, 0.1};
  nozzle.to = {0.56, 0.1};
  nozzle.speed = speed;
  nozzle.limit = 100000;
  def.emitters.push_back(nozzle);
  return def;
}

class FluidNozzle : public FluidMethod {};
INSTANTIATE_TEST_SUITE_P(Each, FluidNozzle, kFluidMethods, methodName);

TEST_P(FluidNozzle, a_jet_against_gravity_comes_out_at_its_speed_and_rises_about_as_high_as_that_carries_it) {
  const double speed = 6.0;
  World world(fountain(GetParam(), speed));
  double top = 0.0;
  for (int k = 0; k < 61; ++k) {
    const StepReport report = world.step(0.01);
    ASSERT_TRUE(report.ok()) << name(report.trouble) << " at " << world.time();
    const ParticlePool& pool = *world.fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) {
      top = std::max(top, pool.y()[i]);
      if (pool.y()[i] < 0.12) {
        EXPECT_NEAR(pool.vy()[i], speed, 1e-9);
      }
    }
  }
  // A slender jet falls freely but for what it takes to widen it. Six particles across give way as a lattice does, by
  // jerks: measured, they rise 10 % too high on what the nozzle pushes from behind.
  const double height = speed * speed / (2.0 * 9.81);
  EXPECT_NEAR(top - 0.1, height, 0.12 * height);
  // Mass comes at density · speed · width, and the books close although the nozzle holds against the jet.
  EXPECT_NEAR(world.ledger().massEmitted, 1000.0 * speed * 0.12 * world.time(), 1000.0 * 0.12 * 0.02 * 1.5);
  const Totals totals = world.totals();
  const Vec2 open = totals.momentum - world.ledger().momentum0 - world.ledger().impulse;
  EXPECT_LT(open.norm(), 1e-6 * totals.mass * speed);
  EXPECT_LT(world.ledger().energyDrift, 0.02);
}

TEST_P(FluidNozzle, a_drowned_nozzle_refuses_what_has_no_room_and_counts_it) {
  WorldDef def = fountain(GetParam(), 1.0);
  World world(def);
  std::vector<Vec2> water;
  for (double y = 0.01; y < 0.4; y += 0.02) {
    for (double x = 0.01; x < 1.0; x += 0.02) water.emplace_back(x, y);
  }
  world.addFluid(water, std::vector<Vec2>(water.size(), Vec2(0.0, 0.0)));
  for (int k = 0; k < 30; ++k) {
    const StepReport report = world.step(0.01);
    ASSERT_TRUE(report.ok()) << name(report.trouble) << " at " << world.time();
  }
  EXPECT_GT(world.ledger().refused, 0u);
  EXPECT_EQ(world.fluid()->size(), water.size() + world.ledger().emitted);
  EXPECT_LT(world.ledger().maxSpeed, 2.0);
}

// Ahead it falls faster and faster and pulls, where a method knows tension, on what the nozzle still holds.
TEST_P(FluidNozzle, a_wide_jet_that_falls_comes_out_at_its_speed) {
  WorldDef def = fountain(GetParam(), 0.5);
  def.emitters[0].from = {0.8, 2.3};
  def.emitters[0].to = {0.2, 2.3};
  World world(def);
  for (int k = 0; k < 40; ++k) {
    const StepReport report = world.step(0.01);
    ASSERT_TRUE(report.ok()) << name(report.trouble) << " at " << world.time();
    const ParticlePool& pool = *std::as_const(world).fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) {
      if (pool.y()[i] < 2.28) continue;
      EXPECT_NEAR(pool.vy()[i], -0.5, 1e-9);
      EXPECT_NEAR(pool.vx()[i], 0.0, 1e-9);
    }
  }
  EXPECT_GT(world.fluid()->size(), 250u);
  EXPECT_LT(momentumError(world), 1e-6);
}

TEST(Nozzle, recycling_keeps_the_limit_in_every_sub_step) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {1.0, 1.0}};
  def.bullet = BulletDef{};
  EmitterDef gun;
  gun.kind = EmitterDef::Kind::Bullet;
  gun.from = {0.4, 0.5};
  gun.to = {0.6, 0.5};
  gun.speed = 1.0;
  gun.rate = 1e5;
  gun.limit = 100;
  gun.policy = GrowthPolicy::RecycleOldest;
  def.emitters.push_back(gun);
  World world(def);
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(world.substep(0.01).ok());
    EXPECT_LE(world.bullets()->size(), 100u);
  }
}

TEST_P(FluidNozzle, a_saved_jet_goes_on_with_the_same_bits) {
  World straight(fountain(GetParam(), 3.0)), stopped(fountain(GetParam(), 3.0)), resumed(fountain(GetParam(), 3.0));
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(straight.step(0.01).ok());
  for (int k = 0; k < 9; ++k) ASSERT_TRUE(stopped.step(0.01).ok());
  MemorySnapshot snapshot;
  snapshot.save([&](Archive& a) { stopped.archive(a); });
  snapshot.load([&](Archive& a) { resumed.archive(a); });
  for (int k = 9; k < 20; ++k) ASSERT_TRUE(resumed.step(0.01).ok());
  EXPECT_EQ(straight.stateHash(), resumed.stateHash());
}

}  // namespace
}  // namespace froude::testing
