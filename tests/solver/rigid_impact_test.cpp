// What two bodies do to each other, or one to the floor, in the moment in which they meet.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <froude/solver/world.h>

#include "support/rigid_worlds.h"

namespace froude::testing {
namespace {

TEST(RigidImpact, a_cradle_hands_the_blow_on) {
  for (const int moving : {1, 2}) {
    WorldDef def = plain();
    def.gravity = {0.0, 0.0};
    for (int k = 0; k < 5; ++k) {
      BodyDef b = freeBody("b" + std::to_string(k), box(0.2, 0.2), {0.2 * k + (k < moving ? -0.05 : 0.0), 50.0});
      b.restitution = 1.0;
      b.friction = 0.0;
      if (k < moving) b.velocity = {1.0, 0.0};
      def.bodies.push_back(b);
    }
    World world(def);
    run(world, 0.3, 0.002);
    for (int k = 0; k < 5; ++k) {
      EXPECT_NEAR(world.body(static_cast<std::size_t>(k)).velocity.x(), k >= 5 - moving ? 1.0 : 0.0, 1e-6) << k;
    }
  }
}

TEST(RigidImpact, unequal_masses_part_as_momentum_and_energy_say) {
  for (const auto& [m1, m2, v1, v2] : {std::array{2.0, 1.0, 1.0 / 3.0, 4.0 / 3.0}, std::array{1.0, 3.0, -0.5, 0.5}}) {
    WorldDef def = plain();
    def.gravity = {0.0, 0.0};
    for (int k = 0; k < 2; ++k) {
      BodyDef b = freeBody("b" + std::to_string(k), box(1.0, 1.0), {1.5 * k, 50.0});
      b.restitution = 1.0;
      b.density = k == 0 ? m1 : m2;
      if (k == 0) b.velocity = {1.0, 0.0};
      def.bodies.push_back(b);
    }
    World world(def);
    run(world, 1.0, 0.002);
    EXPECT_NEAR(world.body(0).velocity.x(), v1, 1e-6);
    EXPECT_NEAR(world.body(1).velocity.x(), v2, 1e-6);
  }
}

// Golden impacts without friction: j = −(1 + e) vₙ/(1/mA + 1/mB + (rA × n)²/IA + (rB × n)²/IB) at the point of contact
// (Routh 1905), of shared/reference/rigid_analytic.json.

/// A body of a golden impact: its shape and pose at the moment of the impact, its motion before it.
struct Partner {
  Polygon shape;
  double mass;  // [kg/m]
  double angle;
  Vec2 at, velocity;
  double spin;
};

struct Impact {
  double restitution;
  Vec2 velocityA;
  double spinA;
  Vec2 velocityB;
  double spinB;
};

// Meets them in full flight, a little before the impact, and judges them a little after it. A blow is given when the
// bodies are within 0.2 % of their thickness, here up to 0.4 ms early: what they have still to turn until they touch
// makes the lever of the blow wrong by as much, and the spin of the light body B with it.
void expectImpact(const Partner& partnerA, const Partner& partnerB, const Impact& after) {
  SCOPED_TRACE("restitution " + std::to_string(after.restitution));
  const double before = 0.002, early = 4e-4;
  WorldDef def = plain();
  def.gravity = {0.0, 0.0};
  const Vec2 up(0.0, 50.0);
  Vec2 momentum(0.0, 0.0);
  for (const Partner* p : {&partnerA, &partnerB}) {
    BodyDef b = freeBody("b", p->shape, up + p->at - before * p->velocity);
    b.density = p->mass / p->shape.area();
    b.velocity = p->velocity, b.spin = p->spin, b.angle = p->angle - before * p->spin;
    b.friction = 0.0, b.restitution = after.restitution;
    def.bodies.push_back(b);
    momentum += p->mass * p->velocity;
  }
  World world(def);
  run(world, 0.004, 0.0001);
  const BodyState &a = world.body(0), &b = world.body(1);
  EXPECT_NEAR(a.velocity.x(), after.velocityA.x(), 2e-3);
  EXPECT_NEAR(a.velocity.y(), after.velocityA.y(), 2e-3);
  EXPECT_NEAR(a.spin, after.spinA, 4e-3);
  EXPECT_NEAR(b.velocity.x(), after.velocityB.x(), 4e-3);
  EXPECT_NEAR(b.velocity.y(), after.velocityB.y(), 4e-3);
  const double lever = early * std::abs(partnerA.spin - partnerB.spin) * partnerB.shape.bounds().max.norm();
  const double blow = partnerB.mass * (after.velocityB - partnerB.velocity).norm();
  const double inertia = partnerB.mass * partnerB.shape.secondMoment() / partnerB.shape.area();
  EXPECT_NEAR(b.spin, after.spinB, 4e-3 + blow * lever / inertia);
  EXPECT_LT((world.totals().momentum - momentum).norm(), 1e-12) << "momentum is kept to rounding";
}

TEST(RigidImpact, a_corner_meets_the_middle_of_a_face) {
  const Partner a{box(1.0, 1.0), 1.0, 0.0, {0.0, 0.0}, {0.0, 0.0}, 0.0};
  const Partner b{box(1.0, 1.0), 1.0, 0.25 * kPi, {0.5 + std::sqrt(0.5), 0.0}, {-2.0, 0.0}, 0.0};
  for (const Impact& after :
       {Impact{1.0, {-2.0, 0.0}, 0.0, {0.0, 0.0}, 0.0}, Impact{0.5, {-1.5, 0.0}, 0.0, {-0.5, 0.0}, 0.0},
        Impact{0.0, {-1.0, 0.0}, 0.0, {-1.0, 0.0}, 0.0}}) {
    expectImpact(a, b, after);
  }
}

TEST(RigidImpact, a_corner_meets_a_face_off_centre) {
  const Partner a{box(2.0, 2.0), 4.0, 0.0, {0.0, 0.0}, {0.5, 0.0}, 0.3};
  const Partner b{box(1.0, 1.0), 1.0, 0.25 * kPi, {1.0 + std::sqrt(0.5), 0.4}, {-2.0, 0.5}, -1.0};
  for (const Impact& after :
       {Impact{1.0, {-0.40839694656488545, 0.0}, 0.8450381679389314, {1.6335877862595418, 0.5}, -1.0},
        Impact{0.5, {-0.18129770992366412, 0.0}, 0.7087786259541985, {0.7252251908396947, 0.5}, -1.0},
        Impact{0.0, {0.04580152671755727, 0.0}, 0.5725190839694656, {-0.1832061068702291, 0.5}, -1.0}}) {
    expectImpact(a, b, after);
  }
}

// What falls on the rod's end is a disc of radius 1/4 in the reference: to the impact it is mass, moment of inertia and
// the place of its lowest point, and this rhombus has the same three, with a corner where the disc touches.
TEST(RigidImpact, a_rod_is_hit_near_its_end) {
  const double half = std::sqrt(0.125);
  const Partner rod{box(2.0, 0.1), 1.0, 0.0, {0.0, 0.0}, {0.0, 0.0}, 0.0};
  const Partner b{
      Polygon::make({{half, 0.0}, {0.0, 0.25}, {-half, 0.0}, {0.0, -0.25}}), 0.5, 0.0, {0.8, 0.3}, {0.0, -3.0}, 0.0};
  ASSERT_NEAR(b.shape.secondMoment() / b.shape.area(), 0.015625 / 0.5, 1e-15);
  for (const Impact& after :
       {Impact{1.0, {0.0, -1.2207001522070013}, -2.922374429223744, {0.0, -0.5585996955859973}, 0.0},
        Impact{0.5, {0.0, -0.9155251141552511}, -2.191780821917808, {0.0, -1.1689497716894979}, 0.0},
        Impact{0.0, {0.0, -0.6103500761035007}, -1.461187214611872, {0.0, -1.7792998477929987}, 0.0}}) {
    expectImpact(rod, b, after);
  }
}

TEST(RigidImpact, a_disc_hits_the_floor_with_friction) {
  struct Case {
    double vx, vy, w, mu, e, vxAfter, vyAfter, wAfter;
  };
  for (const Case& c : {Case{3.0, -4.0, 0.0, 0.05, 1.0, 2.6, 4.0, -0.8}, Case{3.0, -4.0, 0.0, 0.5, 1.0, 2.0, 4.0, -2.0},
                        Case{1.0, -2.0, 5.0, 0.3, 0.6, 0.04, 1.2, 3.08}}) {
    WorldDef def = plain();
    def.gravity = {0.0, 0.0};
    BodyDef d = freeBody("disc", Polygon::regular(720, 1.0), {0.0, 1.01});
    d.velocity = {c.vx, c.vy}, d.spin = c.w, d.friction = c.mu, d.restitution = c.e;
    def.bodies.push_back(d);
    World world(def);
    run(world, 0.05, 0.0005);
    EXPECT_NEAR(world.body(0).velocity.x(), c.vxAfter, 0.03);
    EXPECT_NEAR(world.body(0).velocity.y(), c.vyAfter, 0.03);
    EXPECT_NEAR(world.body(0).spin, c.wAfter, 0.06);
  }
}

}  // namespace
}  // namespace froude::testing
