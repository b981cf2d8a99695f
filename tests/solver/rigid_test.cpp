// Free bodies against closed forms of textbook mechanics: flight, slopes, rolling, pendulums, stacks, sleep.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>

#include <froude/base/archive.h>
#include <froude/solver/world.h>

#include "support/rigid_worlds.h"

namespace froude::testing {
namespace {

// Reference values: shared/reference/rigid_analytic.json, closed forms of textbook mechanics, g = 9.81 m/s².

TEST(Rigid, free_flight_is_exact) {
  WorldDef def = plain();
  def.bodies.push_back(freeBody("b", box(0.3, 0.2), {0.0, 100.0}));
  def.bodies[0].velocity = {2.0, 5.0};
  def.bodies[0].spin = 7.3;
  World world(def);
  run(world, 1.0, 0.01);
  EXPECT_NEAR(world.body(0).transform.position.x(), 2.0, 1e-12);
  EXPECT_NEAR(world.body(0).transform.position.y(), 100.0 + 0.095, 1e-11);
  EXPECT_NEAR(world.body(0).angle, 7.3, 1e-12);
}

TEST(Rigid, a_body_turns_about_its_centre_of_mass_wherever_its_origin_is) {
  WorldDef def = plain();
  def.gravity = {0.0, 0.0};
  def.bodies.push_back(freeBody("b", Polygon::box({{1.0, 2.0}, {1.5, 2.2}}), {3.0, 50.0}));
  def.bodies[0].spin = 2.0;
  World world(def);
  const Vec2 centroid(1.25, 2.1);
  const Vec2 before = world.body(0).transform.toWorld(centroid);
  run(world, 2.0, 0.01);
  EXPECT_LT((world.body(0).transform.toWorld(centroid) - before).norm(), 1e-11);
  EXPECT_NEAR(world.body(0).angle, 4.0, 1e-12);
}

struct SlopeCase {
  double degrees, friction, distance;  // after 1 s
};

TEST(Rigid, a_block_on_a_slope_slides_as_coulomb_says) {
  for (const SlopeCase& c :
       {SlopeCase{10, 0.1, 0.36869610860380525}, SlopeCase{20, 0.3, 0.2948511115259409}, SlopeCase{25, 0.5, 0.0},
        SlopeCase{30, 0.5, 0.32857269721866383}, SlopeCase{45, 0.5, 1.7341793808600074}}) {
    WorldDef def = slope(c.degrees);
    def.bodies.push_back(freeBody("block", box(1.0, 0.5), {0.0, 0.25}));
    def.bodies[0].friction = c.friction;
    World world(def);
    run(world, 1.0, 0.005);
    // Of first order in the sub-step: half of one at the end's speed.
    EXPECT_NEAR(world.body(0).transform.position.x(), c.distance, 0.004 + 0.01 * c.distance) << c.degrees << " degrees";
    EXPECT_NEAR(world.body(0).angle, 0.0, 1e-6);
  }
}

TEST(Rigid, half_a_degree_decides_whether_a_block_slides) {
  const double critical = std::atan(0.5) * 180.0 / kPi;
  for (const double more : {-0.5, 0.5}) {
    WorldDef def = slope(critical + more);
    def.bodies.push_back(freeBody("block", box(1.0, 0.25), {0.0, 0.125}));
    def.bodies[0].friction = 0.5;
    World world(def);
    run(world, 3.0, 0.01);
    const double a = kG * (std::sin((critical + more) * kPi / 180.0) - 0.5 * std::cos((critical + more) * kPi / 180.0));
    EXPECT_NEAR(world.body(0).transform.position.x(), more < 0.0 ? 0.0 : 0.5 * a * 9.0, more < 0.0 ? 1e-3 : 0.01);
  }
}

TEST(Rigid, a_ball_bounces_to_the_heights_of_its_restitution) {
  WorldDef def = plain();
  def.bodies.push_back(freeBody("ball", box(0.1, 0.1), {0.0, 1.05}));
  def.bodies[0].restitution = 0.8;
  World world(def);
  std::vector<double> apex;
  double before = 0.0;
  while (world.time() < 2.7) {
    world.step(0.001);
    const double v = world.body(0).velocity.y();
    if (before > 0.0 && v <= 0.0) apex.push_back(world.body(0).transform.position.y() - 0.05);
    before = v;
  }
  const std::vector<double> exact{0.64, 0.4096, 0.262144, 0.16777216};
  ASSERT_GE(apex.size(), exact.size());
  for (std::size_t k = 0; k < exact.size(); ++k)
    EXPECT_NEAR(apex[k], exact[k], 0.005 * (k + 1.0) * exact[k]) << "bounce " << k;
}

// A polygon of so many sides that it rolls as a disc: its front corner bears it, which brakes it by π/n of its weight.
BodyDef disc(double radius, double friction) {
  BodyDef def = freeBody("disc", Polygon::regular(2880, radius), {0.0, radius});
  def.friction = friction;
  return def;
}

struct RollCase {
  double degrees, friction, acceleration, turning;  // turning: angular acceleration times the radius
};

TEST(Rigid, a_disc_rolls_or_slides_down_a_slope) {
  for (const RollCase& c : {RollCase{20, 0.5, 2.2368117373498735, 2.2368117373498735}, RollCase{30, 0.5, 3.27, 3.27},
                            RollCase{45, 0.2, 5.549374018752024, 2.774687009376013}}) {
    WorldDef def = slope(c.degrees);
    def.bodies.push_back(disc(0.5, c.friction));
    World world(def);
    run(world, 1.0, 0.005);
    EXPECT_NEAR(world.body(0).velocity.x(), c.acceleration, 0.01 * c.acceleration) << c.degrees << " degrees";
    EXPECT_NEAR(-0.5 * world.body(0).spin, c.turning, 0.01 * c.turning) << c.degrees << " degrees";
  }
}

TEST(Rigid, a_sliding_disc_comes_to_roll) {
  WorldDef def = plain();
  def.bodies.push_back(disc(0.5, 0.2));
  def.bodies[0].velocity = {3.0, 0.0};
  World world(def);
  run(world, 0.509683995922528, 0.005);
  EXPECT_NEAR(world.body(0).transform.position.x(), 1.27420998980632, 0.01);
  run(world, 0.6, 0.005);
  EXPECT_NEAR(world.body(0).velocity.x(), 2.0, 0.01);
  EXPECT_NEAR(world.body(0).spin, -4.0, 0.03);
}

TEST(Rigid, a_sliding_box_stops_where_friction_stops_it) {
  WorldDef def = plain();
  def.bodies.push_back(freeBody("box", box(2.0, 0.5), {0.0, 0.25}));
  def.bodies[0].friction = 0.35;
  def.bodies[0].velocity = {4.0, 0.0};
  World world(def);
  run(world, 1.5, 0.005);
  EXPECT_NEAR(world.body(0).transform.position.x(), 2.329983981360128, 0.015);
  EXPECT_NEAR(world.body(0).velocity.x(), 0.0, 1e-6);
}

/// Full period of a body that hangs on `pivot`, released from `degrees` away from its lowest position, mean of
/// `swings`.
double period(const Polygon& shape, const Vec2& pivot, double degrees, int swings, double dt) {
  WorldDef def = plain();
  const Vec2 arm = shape.centroid() - pivot;
  const double hanging = -0.5 * kPi - std::atan2(arm.y(), arm.x());
  BodyDef b = freeBody("pendulum", shape, {0.0, 0.0});
  b.angle = hanging + degrees * kPi / 180.0;
  b.position = Vec2(0.0, 100.0) - Rotation::of(b.angle).apply(pivot);
  b.hinge = HingeDef{{0.0, 100.0}, std::nullopt};
  def.bodies.push_back(b);
  World world(def);
  int crossings = 0;
  double first = 0.0, last = 0.0;
  double before = world.body(0).angle - hanging;
  while (crossings < 2 * swings + 1) {
    world.step(dt);
    const double now = world.body(0).angle - hanging;
    if ((before > 0.0) != (now > 0.0)) {
      last = world.time() - dt * now / (now - before);
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  EXPECT_LT((world.body(0).transform.toWorld(pivot) - Vec2(0.0, 100.0)).norm(), 1e-9) << "the hinge holds";
  return (last - first) / swings;
}

TEST(Rigid, pendulums_of_polygons_swing_with_the_exact_period) {
  struct Case {
    Polygon shape;
    Vec2 pivot;
    double exact;  // at 90 degrees
  };
  const std::vector<Case> cases{
      {box(1.0, 1.0), {-0.5, 0.5}, 2.2991355645034135},
      {box(2.0, 0.1), {-1.0, 0.0}, 2.735002659567767},
      {Polygon::make({{0, 0}, {2, 0}, {2, 0.5}, {0.5, 0.5}, {0.5, 2}, {0, 2}}), {0.0, 0.0}, 3.052883154303817},
      {Polygon::regular(6, 1.0), {1.0, 0.0}, 2.818295426005172},
  };
  for (const Case& c : cases) {
    EXPECT_NEAR(period(c.shape, c.pivot, 90.0, 10, 0.005), c.exact, 2e-4 * c.exact);
  }
}

TEST(Rigid, a_pendulum_keeps_its_swing_for_a_hundred_periods) {
  const double early = period(box(2.0, 0.1), {-1.0, 0.0}, 90.0, 1, 0.01);
  const double late = period(box(2.0, 0.1), {-1.0, 0.0}, 90.0, 100, 0.01);
  EXPECT_NEAR(late, early, 1e-3 * early) << "the period of a large swing tells its size";
}

WorldDef stack(int boxes, double size, double lastDensity) {
  WorldDef def = plain();
  const auto shape = std::make_shared<const Polygon>(box(size, size));
  for (int k = 0; k < boxes; ++k) {
    BodyDef b = freeBody("b" + std::to_string(k), Polygon(*shape), {0.0, size * (k + 0.5)});
    b.shape = shape;
    if (k == boxes - 1) b.density = lastDensity;
    def.bodies.push_back(b);
  }
  return def;
}

TEST(Rigid, twenty_boxes_stand_for_a_minute_without_creep) {
  for (const double size : {0.1, 1.0}) {
    World world(stack(20, size, 1000.0));
    run(world, 60.0, 0.01);
    for (std::size_t k = 0; k < 20; ++k) {
      const Transform& at = world.body(k).transform;
      EXPECT_NEAR(at.position.x(), 0.0, 0.01 * size) << "box " << k;
      EXPECT_NEAR(at.position.y(), size * (static_cast<double>(k) + 0.5), 0.01 * size) << "box " << k;
    }
    EXPECT_TRUE(world.body(0).asleep);
  }
}

TEST(Rigid, each_box_of_a_stack_bears_what_is_above_it) {
  World world(stack(10, 1.0, 1000.0));
  run(world, 5.0, 0.01);
  // Ground's force on the lowest box is the weight of all ten; net forces vanish.
  double ground = 0.0;
  for (std::size_t k = 0; k < 10; ++k) ground += world.body(k).force.y();
  EXPECT_NEAR(ground, 10.0 * 1000.0 * kG, 0.01 * 10.0 * 1000.0 * kG);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_NEAR(world.body(k).force.y(), 1000.0 * kG, 10.0 * kG) << "box " << k;
}

TEST(Rigid, a_heavy_box_stays_up_on_light_ones) {
  World world(stack(10, 0.5, 10000.0));
  run(world, 20.0, 0.01);
  EXPECT_NEAR(world.body(9).transform.position.y(), 4.75, 0.05);
  EXPECT_NEAR(world.body(9).transform.position.x(), 0.0, 0.01);
}

// A slab that stands on its end in its own coordinates, 6 m away from its origin.
TEST(Rigid, the_torque_on_a_fixed_body_is_about_its_centre_of_mass_wherever_its_origin_is) {
  const double off = 1.2, weight = 1000.0 * 0.5 * 0.5 * kG;
  WorldDef def = plain();
  BodyDef slab = body("slab", Polygon::box({{4.0, -7.0}, {4.4, -3.0}}), {20.0, 50.0});
  slab.angle = 0.5 * kPi;  // its centre of mass comes to (25, 54.2)
  def.bodies.push_back(slab);
  def.bodies.push_back(freeBody("box", box(0.5, 0.5), {25.0 + off, 54.65}));
  World world(def);
  run(world, 0.45, 0.01);
  for (const bool asleep : {false, true}) {
    ASSERT_EQ(world.body(1).asleep, asleep);
    EXPECT_NEAR(world.body(0).force.y(), -weight, 0.01 * weight) << asleep;
    EXPECT_NEAR(world.body(0).torque, -off * weight, 0.01 * off * weight) << asleep;
    EXPECT_NEAR(world.body(1).torque, 0.0, 0.01 * off * weight) << asleep;
    run(world, 3.0, 0.01);
  }
}

// Two descriptions of one motion: the torque is of the body, and not of the point that its script moves.
TEST(Rigid, the_torque_on_a_scripted_body_does_not_depend_on_its_origin) {
  const double spin = 4.0, dt = 1.0 / 240.0;
  const Vec2 away(5.0, 3.0);
  std::array<double, 2> torque{};
  for (const bool isAway : {false, true}) {
    const Vec2 arm = isAway ? away : Vec2(0.0, 0.0);  // from the origin to the centre of mass
    WorldDef def = plain();
    BodyDef lever = body("lever", Polygon::box({arm - Vec2(2.0, 0.2), arm + Vec2(2.0, 0.2)}), Vec2(20.0, 50.0) - arm);
    lever.motion = Motion::Scripted;
    lever.spin = spin;
    lever.velocity = cross(spin, Vec2(-arm));
    def.bodies.push_back(lever);
    def.bodies.push_back(freeBody("box", box(0.5, 0.5), {21.2, 50.45}));
    World world(def);
    world.step(dt);
    torque[isAway ? 1 : 0] = world.body(0).torque;
  }
  EXPECT_LT(torque[0], -1000.0) << "the lever strikes the box";
  EXPECT_NEAR(torque[1], torque[0], 1e-9 * std::abs(torque[0]));
}

TEST(Rigid, a_sleeper_wakes_when_it_is_hit) {
  WorldDef def = stack(3, 0.5, 1000.0);
  World world(def);
  run(world, 3.0, 0.01);
  ASSERT_TRUE(world.body(2).asleep);
  BodyDef hammer = freeBody("hammer", box(0.3, 0.3), {-2.0, 1.25});
  hammer.velocity = {6.0, 2.5};
  const BodyId id = world.createBody(hammer);
  run(world, 4.0, 0.01);
  EXPECT_FALSE(world.body(2).asleep);
  EXPECT_GT(world.body(2).transform.position.x(), 0.05);
  EXPECT_TRUE(world.isAlive(id));
}

TEST(Rigid, fast_bodies_do_not_pass_thin_walls) {
  for (const double speed : {20.0, 300.0, 2000.0}) {
    WorldDef def = plain();
    def.gravity = {0.0, 0.0};
    def.bodies.push_back(body("plate", box(0.002, 20.0), {10.0, 50.0}));
    BodyDef b = freeBody("shot", box(0.05, 0.05), {0.0, 50.0});
    b.velocity = {speed, 0.0};
    b.spin = 3.0;
    b.restitution = 0.5;
    def.bodies.push_back(b);
    World world(def);
    double slowest = speed;
    for (int k = 0; k < 60; ++k) {
      world.step(0.01);
      slowest = std::min(slowest, world.body(1).velocity.x());
      EXPECT_LT(world.body(1).transform.position.x(), 10.0) << speed << " m/s, step " << k;
    }
    EXPECT_LT(slowest, 0.0) << "it comes back";
  }
}

TEST(Rigid, a_box_slides_over_the_seams_of_a_concave_floor) {
  WorldDef def = plain();
  // A flat run on a shape that has to be cut into several convex pieces, which meet below the run.
  def.bodies.push_back(body(
      "floor",
      Polygon::make(
          {{0, 0}, {2, 0}, {2, 0.5}, {3, 0.5}, {3, 0}, {5, 0}, {5, 0.5}, {6, 0.5}, {6, 0}, {8, 0}, {8, 1}, {0, 1}}),
      {0.0, 1.0}));
  BodyDef b = freeBody("box", box(0.4, 0.4), {0.5, 2.2});
  b.friction = 0.0;
  b.velocity = {3.0, 0.0};
  def.bodies.push_back(b);
  World world(def);
  for (int k = 0; k < 230; ++k) {
    world.step(0.01);
    ASSERT_NEAR(world.body(1).velocity.x(), 3.0, 1e-9) << "at x = " << world.body(1).transform.position.x();
    ASSERT_NEAR(world.body(1).transform.position.y(), 2.2, 1e-3);
  }
}

TEST(Rigid, a_motor_turns_as_fast_as_its_torque_allows) {
  WorldDef def = plain();
  def.gravity = {0.0, 0.0};
  BodyDef b = freeBody("wheel", Polygon::regular(12, 0.5), {0.0, 50.0});
  b.hinge = HingeDef{{0.0, 50.0}, MotorDef{4.0, 100.0}};
  def.bodies.push_back(b);
  World world(def);
  const double inertia = 1000.0 * def.bodies[0].shape->secondMoment();
  run(world, 1.0, 0.01);
  EXPECT_NEAR(world.body(0).spin, 100.0 / inertia, 1e-9 * 100.0 / inertia) << "torque over inertia";
  run(world, 20.0, 0.01);
  EXPECT_NEAR(world.body(0).spin, 4.0, 1e-9);
  const double kinetic = 0.5 * inertia * 16.0;
  EXPECT_NEAR(world.ledger().work, kinetic, 1e-9 * kinetic) << "all of its work is in the wheel";
}

TEST(Rigid, a_brake_that_holds_does_no_work) {
  WorldDef def = plain();
  BodyDef b = freeBody("flap", box(1.0, 0.1), {0.5, 50.0});
  b.hinge = HingeDef{{0.0, 50.0}, MotorDef{0.0, 2.0 * 1000.0 * 0.1 * kG * 0.5}};
  def.bodies.push_back(b);
  World world(def);
  run(world, 10.0, 0.01);
  EXPECT_NEAR(world.body(0).angle, 0.0, 1e-9);
  EXPECT_NEAR(world.ledger().work, 0.0, 1e-9) << "its weight would turn it by a little in each step, and does not";
}

TEST(Rigid, overlapping_bodies_are_parted_gently) {
  WorldDef def = plain();
  def.gravity = {0.0, 0.0};
  for (int k = 0; k < 2; ++k) def.bodies.push_back(freeBody("b", box(1.0, 1.0), {0.6 * k, 50.0}));
  World world(def);
  double fastest = 0.0;
  for (int k = 0; k < 100; ++k) {
    world.step(0.01);
    fastest = std::max(fastest, world.body(0).velocity.norm());
  }
  EXPECT_LT(fastest, 1e-9) << "parting leaves no velocity";
  EXPECT_GT(world.body(1).transform.position.x() - world.body(0).transform.position.x(), 0.999);
}

TEST(Rigid, bodies_of_groups_that_do_not_meet_pass_each_other) {
  WorldDef def = plain();
  for (int k = 0; k < 2; ++k) {
    def.bodies.push_back(freeBody("b", box(1.0, 1.0), {0.3 * k, 0.5}));
    def.bodies.back().group = 1u << k;
    def.bodies.back().collidesWith = 1u << k;
  }
  World world(def);
  run(world, 1.0, 0.01);
  EXPECT_NEAR(world.body(1).transform.position.x() - world.body(0).transform.position.x(), 0.3, 1e-9);
}

// Falling and tumbling polygons of many sides, concave ones too.
WorldDef heap() {
  WorldDef def = plain();
  def.domain.box = {{0.0, 0.0}, {3.0, 10.0}};
  for (int k = 0; k < 120; ++k) {
    Polygon shape = k % 4 == 3 ? Polygon::make({{0, 0}, {0.3, 0}, {0.3, 0.1}, {0.1, 0.1}, {0.1, 0.3}, {0, 0.3}})
                               : Polygon::regular(3 + k % 4, 0.14);
    BodyDef b = freeBody("b" + std::to_string(k), std::move(shape), {0.3 + 0.33 * (k % 8), 0.3 + 0.35 * (k / 8)});
    b.angle = 0.7 * k;
    b.spin = k % 5 - 2.0;
    b.restitution = 0.3;
    def.bodies.push_back(b);
  }
  BodyDef paddle = body("paddle", box(1.5, 0.1), {1.5, 0.8});
  paddle.motion = Motion::Scripted;
  paddle.spin = 1.0;
  def.bodies.push_back(paddle);
  return def;
}

TEST(Rigid, momentum_of_a_heap_closes_to_rounding) {
  World world(heap());
  run(world, 2.0, 0.01);
  const Ledger& l = world.ledger();
  const Totals t = world.totals();
  const Vec2 error = t.momentum - l.momentum0 - l.impulse;
  EXPECT_LT(error.norm(), 1e-10 * t.mass) << error.transpose();
  EXPECT_LT(l.energyDrift, 0.01) << "no energy from nowhere";
}

TEST(Rigid, the_same_bits_on_any_number_of_threads_and_from_a_saved_state) {
  std::string first;
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena(threads).execute([&] {
      World world(heap());
      for (int k = 0; k < 60; ++k) world.step(0.01);
      MemorySnapshot state;
      state.save([&](Archive& a) { world.archive(a); });
      for (int k = 0; k < 60; ++k) world.step(0.01);
      const std::string hash = world.stateHash();
      if (first.empty()) first = hash;
      EXPECT_EQ(hash, first) << threads << " threads";
      World other(heap());
      state.load([&](Archive& a) { other.archive(a); });
      for (int k = 0; k < 60; ++k) other.step(0.01);
      EXPECT_EQ(other.stateHash(), first) << "resumed on " << threads << " threads";
    });
  }
}

TEST(Rigid, refuses_what_cannot_be_free) {
  auto refusal = [](auto&& change) {
    WorldDef def = plain();
    def.bodies.push_back(freeBody("thing", box(1.0, 1.0), {0.0, 5.0}));
    change(def.bodies[0]);
    try {
      World world(def);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(refusal([](BodyDef& b) { b.density = -1.0; }).find("density above 0"), std::string::npos);
  EXPECT_NE(refusal([](BodyDef& b) { b.motion = Motion::Fixed, b.hinge = HingeDef{}; }).find("make it free"),
            std::string::npos);
  EXPECT_NE(refusal([](BodyDef& b) {
              b.hinge = HingeDef{{0, 0}, MotorDef{1.0, -2.0}};
            }).find("torque"),
            std::string::npos);
  EXPECT_NE(refusal([](BodyDef& b) { b.script.push_back({1.0, {}, {}, {}}); }).find("script"), std::string::npos);
}

}  // namespace
}  // namespace froude::testing
