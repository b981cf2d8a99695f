// Soft bodies against polygons, each other and themselves.
#include <gtest/gtest.h>

#include <froude/solver/world.h>

#include "support/soft_meshes.h"

namespace froude {
namespace {

using testing::lattice;
using testing::softWorld;

SoftDef block(const Vec2& at, double side, int cells) {
  SoftDef def;
  def.mesh = lattice(side, side, cells, cells);
  def.spacing = side / cells;
  def.position = at;
  def.young = 5.0e4;
  def.poisson = 0.3;
  def.damping = 2.0;
  return def;
}

double momentumGap(const World& world) {
  const Ledger& l = world.ledger();
  const Totals t = world.totals();
  return (t.momentum - l.momentum0 - l.impulse).norm() / t.mass;
}

TEST(SoftContact, one_block_comes_to_rest_on_another) {
  WorldDef def = softWorld({block({0.5, 0.201}, 0.3, 6), block({0.51, 0.512}, 0.3, 6)}, Vec2(0.0, -9.81));
  for (SoftDef& soft : def.soft) soft.damping = 20.0, soft.friction = 0.6;
  BodyDef floor;
  floor.name = "floor";
  floor.shape = std::make_shared<Polygon>(Polygon::box({{-0.9, 0.0}, {2.9, 0.2}}));
  floor.friction = 0.6;
  def.bodies.push_back(floor);
  World world(def);
  ASSERT_TRUE(world.step(3.5).ok());
  EXPECT_LT(momentumGap(world), 1e-9);
  EXPECT_LT(world.softState(1).momentum.norm() / world.softState(1).mass, 0.05);
  const double lower = world.softState(0).center.y(), upper = world.softState(1).center.y();
  EXPECT_NEAR(lower, 0.335, 0.02);
  EXPECT_NEAR(upper - lower, 0.28, 0.03);
}

TEST(SoftContact, two_blocks_that_meet_keep_their_momentum_and_bounce) {
  SoftDef left = block({0.2, 0.8}, 0.3, 6), right = block({0.7, 0.9}, 0.3, 6);
  left.velocity = {2.0, 0.0};
  left.damping = right.damping = 0.0;
  World world(softWorld({left, right}, Vec2(0.0, 0.0)));
  const Totals before = world.totals();
  ASSERT_TRUE(world.step(0.3).ok());
  const Totals after = world.totals();
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-9 * before.momentum.norm());
  EXPECT_NEAR(after.angular, before.angular, 2e-3 * std::abs(before.angular));
  EXPECT_GT(world.softState(1).momentum.x(), 0.6 * before.momentum.x());
  EXPECT_LE(after.kinetic + after.strain, before.kinetic * 1.001);
}

TEST(SoftContact, a_spike_does_not_slip_between_two_points) {
  WorldDef def = softWorld({block({0.5, 0.62}, 0.4, 4)}, Vec2(0.0, -9.81));
  BodyDef spike;
  spike.name = "spike";
  spike.shape = std::make_shared<Polygon>(Polygon::make({{0.748, 0.0}, {0.752, 0.0}, {0.75, 0.6}}));
  def.bodies.push_back(spike);
  World world(def);
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(world.step(1.0 / 120.0).ok());
    // Its top is not under the skin: no bottom edge has come far below it.
    const SoftDef& soft = world.softDefinition(0);
    for (const auto& edge : soft.mesh->outline) {
      const Vec2 a(world.soft()->x()[edge[0]], world.soft()->y()[edge[0]]);
      const Vec2 b(world.soft()->x()[edge[1]], world.soft()->y()[edge[1]]);
      if (edge[1] > 4 || (a.x() - 0.75) * (b.x() - 0.75) > 0.0) continue;
      const double y = a.y() + (0.75 - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
      EXPECT_GT(y, 0.6 - 0.01) << world.time();
    }
  }
}

TEST(SoftContact, a_free_box_that_falls_on_a_block_rests_there_and_momentum_closes) {
  for (const double density : {50.0, 1000.0, 5000.0}) {
    SoftDef soft = block({0.5, 0.0}, 0.4, 8);
    soft.young = 2.0e5;
    soft.damping = 20.0;
    WorldDef def = softWorld({soft}, Vec2(0.0, -9.81));
    BodyDef box;
    box.name = "box";
    box.shape = std::make_shared<Polygon>(Polygon::box({{-0.1, -0.1}, {0.1, 0.1}}));
    box.position = {0.7, 0.6};
    box.motion = Motion::Free;
    box.density = density;
    box.friction = 0.5;
    def.bodies.push_back(box);
    World world(def);
    ASSERT_TRUE(world.step(6.0).ok()) << density;
    EXPECT_LT(momentumGap(world), 1e-9) << density;
    EXPECT_NEAR(world.body(std::size_t{0}).transform.position.y(), 0.49, 0.05) << density;
    EXPECT_LT(world.body(std::size_t{0}).velocity.norm(), 0.05) << density;
    EXPECT_LT(world.ledger().energyDrift, 0.02) << density;
  }
}

// Coulomb: a block on a slope of 20 degrees stays where friction is 0.6, and slides at g (sin − 0.1 cos) where it is
// 0.1.
TEST(SoftContact, friction_holds_or_lets_slide_as_coulomb_says) {
  for (const double friction : {0.6, 0.1}) {
    SoftDef soft = block({0.6, 0.0}, 0.2, 4);
    soft.friction = friction;
    soft.young = 2.0e5;
    const double slope = 20.0 * kPi / 180.0;
    WorldDef def = softWorld({soft}, 9.81 * Vec2(std::sin(slope), -std::cos(slope)));
    BodyDef floor;
    floor.name = "floor";
    floor.shape = std::make_shared<Polygon>(Polygon::box({{-0.9, 0.0}, {2.9, 0.5}}));
    floor.friction = friction;
    def.bodies.push_back(floor);
    def.soft[0].position.y() = 0.5;
    World world(def);
    const double before = world.softState(0).center.x();
    ASSERT_TRUE(world.step(0.6).ok());
    const double way = world.softState(0).center.x() - before;
    const double exact = 0.5 * 0.36 * 9.81 * (std::sin(slope) - 0.1 * std::cos(slope));
    if (friction > 0.5) {
      EXPECT_LT(way, 0.02);
    } else {
      EXPECT_NEAR(way, exact, 0.1 * exact);
    }
  }
}

}  // namespace
}  // namespace froude
