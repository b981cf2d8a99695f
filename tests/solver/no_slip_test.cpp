// Walls to which the fluid sticks, against exact flows between plates.
#include <gtest/gtest.h>

#include "support/channel.h"
#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

class NoSlip : public FluidMethod {};
INSTANTIATE_TEST_SUITE_P(Each, NoSlip, kViscousMethods, methodName);

TEST_P(NoSlip, a_flow_driven_between_plates_takes_the_parabola) {
  const double force = 0.08, largest = force / (8.0 * kChannelViscosity);  // 0.1 m/s: Re = 1
  WorldDef def = channel(GetParam());
  def.gravity = {force, 0.0};
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 1.0}}, kChannelSpacing);
  for (const double time : {0.5, 2.0, 8.0}) {  // t ν/L² = 0.05, 0.2, 0.8
    ASSERT_TRUE(world.step(time - world.time()).ok());
    EXPECT_LT(largestError(world, [&](double y) { return poiseuille(y, time, force); }), 0.04 * largest) << time;
  }
  EXPECT_EQ(world.fluid()->size(), 400u);
  EXPECT_EQ(world.ledger().leaks, 0u);
}

TEST_P(NoSlip, a_belt_drags_the_fluid_along_and_feels_the_shear) {
  const double speed = 0.1;
  WorldDef def = channel(GetParam());
  def.domain.box.max.y() = 1.4;
  BodyDef belt;
  belt.name = "belt";
  belt.shape = std::make_shared<const Polygon>(Polygon::box({{-1.0, 0.0}, {2.0, 0.3}}));
  belt.position = {0.0, 1.0};
  // Counter-clockwise along the edge is along +x on the lower side.
  belt.surfaceVelocity = speed;
  def.bodies.push_back(belt);
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 1.0}}, kChannelSpacing);
  for (const double time : {0.5, 2.0, 8.0}) {
    ASSERT_TRUE(world.step(time - world.time()).ok());
    EXPECT_LT(largestError(world, [&](double y) { return couette(y, time, speed); }), 0.04 * speed) << time;
  }
  const double shear = def.fluid->density * kChannelViscosity * speed;  // [N/m] of a channel 1 m long
  EXPECT_NEAR(world.body(0).force.x(), -shear, 0.05 * shear);
}

TEST_P(NoSlip, a_free_wall_beside_it_lets_the_fluid_slide) {
  WorldDef def = channel(GetParam());
  def.domain.slip = Slip::Free;
  def.gravity = {0.08, 0.0};
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 1.0}}, kChannelSpacing);
  const StepReport report = world.step(1.0);
  ASSERT_TRUE(report.ok()) << name(report.trouble) << " " << report.troubleValue << " at " << world.time();
  EXPECT_LT(largestError(world, [](double) { return 0.08; }), 1e-3 * 0.08);
}

}  // namespace
}  // namespace froude::testing
