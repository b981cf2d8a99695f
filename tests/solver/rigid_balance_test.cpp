// Blocks that stand, rock, tip over or fall from an edge, at the limits that books give.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <froude/solver/world.h>

#include "support/rigid_worlds.h"

namespace froude::testing {
namespace {

TEST(RigidBalance, a_block_tips_over_from_the_angular_speed_of_the_books_on) {
  const double least = 0.6528668508453134;  // of a block of 0.5 × 2 m about its lower corner
  for (const double share : {0.95, 1.05}) {
    WorldDef def = plain();
    BodyDef b = freeBody("block", box(0.5, 2.0), {0.0, 1.0});
    b.friction = 10.0;
    b.spin = -share * least;
    b.velocity = cross(b.spin, Vec2(-0.25, 1.0));
    def.bodies.push_back(b);
    World world(def);
    run(world, 4.0, 0.005);
    const bool lies = std::abs(world.body(0).angle) > 1.0;
    EXPECT_EQ(lies, share > 1.0) << world.body(0).angle;
  }
}

// Housner (1963): the block turns about one lower corner, lands flat, and goes on about the other one.
TEST(RigidBalance, a_rocking_block_lands_in_time_and_loses_what_the_landing_takes) {
  struct Case {
    double b, h, share, quarter, ratio;  // quarter of the lossless period [s]; angular speed after over before
  };
  for (const Case& c : {Case{0.25, 1.0, 0.5, 1.9752128603152932 / 4.0, 0.9117647058823529},
                        Case{0.25, 1.0, 0.8, 3.4345583932668693 / 4.0, 0.9117647058823529},
                        Case{0.5, 1.0, 0.5, 2.0665206088711696 / 4.0, 0.7},
                        Case{0.1, 0.5, 0.8, 2.4150584821530874 / 4.0, 0.9423076923076923}}) {
    WorldDef def = plain();
    const double tilt = c.share * std::atan(c.b / c.h);
    BodyDef block = freeBody("block", box(2.0 * c.b, 2.0 * c.h), Rotation::of(tilt).apply({c.b, c.h}));
    block.angle = tilt;
    block.friction = 10.0;
    def.bodies.push_back(block);
    World world(def);
    double before = 0.0, landed = 0.0;
    while (landed == 0.0 && world.time() < 2.0) {
      before = world.body(0).spin;
      const double angle = world.body(0).angle;
      world.step(0.0005);
      const double now = world.body(0).angle;
      if (now <= 1e-9) landed = world.time() - 0.0005 * now / (now - angle);
    }
    EXPECT_NEAR(landed, c.quarter, 0.01 * c.quarter) << c.b << " x " << c.h << " at " << c.share;
    for (int k = 0; k < 4; ++k) world.step(0.0005);
    EXPECT_NEAR(world.body(0).spin / before, c.ratio, 0.02) << c.b << " x " << c.h << " at " << c.share;
  }
}

// A block of 2b × 2h falls from its balance on one corner onto its side. It is started a little beyond the balance with
// the speed that it would pass there with. The corner must not slip, and at cos = 1/3 (tall blocks) it bears no weight.
TEST(RigidBalance, a_block_that_falls_over_arrives_with_the_energy_of_its_fall) {
  struct Case {
    double b, h, atFlat;  // [rad/s]
  };
  for (const Case& c :
       {Case{0.25, 1.0, 3.2883573328429634}, Case{0.5, 0.5, 2.468836278557186}, Case{1.0, 0.25, 0.6528668508453134}}) {
    const double r = std::hypot(c.b, c.h), beyond = 0.02;
    WorldDef def = plain();
    BodyDef block = freeBody("block", box(2.0 * c.b, 2.0 * c.h), r * Vec2(std::sin(beyond), std::cos(beyond)));
    block.angle = 0.5 * kPi - std::atan2(c.h, -c.b) - beyond;
    block.friction = 1e6;
    block.spin = -std::sqrt(2.0 * kG * r * (1.0 - std::cos(beyond)) / (4.0 / 3.0 * r * r));
    block.velocity = cross(block.spin, block.position);
    def.bodies.push_back(block);
    World world(def);
    double fastest = 0.0;
    while (world.body(0).angle > -0.5 * kPi + 1e-3 && world.time() < 10.0) {
      world.step(0.0005);
      fastest = std::max(fastest, -world.body(0).spin);
    }
    EXPECT_NEAR(fastest, c.atFlat, 0.01 * c.atFlat) << c.b << " x " << c.h;
  }
}

TEST(RigidBalance, half_a_degree_decides_whether_a_block_topples) {
  for (const double height : {2.0, 5.0}) {
    const double critical = std::atan(1.0 / height) * 180.0 / kPi;
    for (const double more : {-0.5, 0.5}) {
      WorldDef def = slope(critical + more);
      def.bodies.push_back(freeBody("block", box(1.0, height), {0.0, 0.5 * height}));
      def.bodies[0].friction = 1.0;
      World world(def);
      run(world, 5.0, 0.01);
      if (more < 0.0) {
        EXPECT_NEAR(world.body(0).angle, 0.0, 1e-3) << height << " m high";
      } else {
        EXPECT_LT(world.body(0).angle, -1.0) << height << " m high";
      }
    }
  }
}

// N equal blocks reach ½ Σ 1/i beyond the edge of a table, each at the point of falling. In a step of 1/100 s the
// weight of eight is not handed down to the last digit: they are given 5 % where fewer need 3 %.
TEST(RigidBalance, a_stack_reaches_as_far_over_the_edge_as_the_harmonic_series) {
  for (const auto& [blocks, margin] : {std::pair{1, 0.03}, {2, 0.03}, {4, 0.03}, {8, 0.05}}) {
    for (const bool stands : {true, false}) {
      WorldDef def = plain();
      def.bodies.push_back(body("table", box(10.0, 1.0), {-5.0, 50.0}));
      double reach = 0.0;
      for (int k = 0; k < blocks; ++k) {  // from the table up
        reach += (stands ? 1.0 - margin : 1.0 + margin) * 0.5 / (blocks - k);
        def.bodies.push_back(freeBody("b" + std::to_string(k), box(1.0, 0.25), {reach - 0.5, 50.625 + 0.25 * k}));
      }
      World world(def);
      run(world, 5.0, 0.01);
      const BodyState& top = world.body(static_cast<std::size_t>(blocks));
      const double drop = 50.625 + 0.25 * (blocks - 1) - top.transform.position.y();
      if (stands) {
        EXPECT_NEAR(drop, 0.0, 0.01) << blocks << " blocks";
      } else {
        EXPECT_GT(drop, 1.0) << blocks << " blocks";
      }
    }
  }
}

}  // namespace
}  // namespace froude::testing
