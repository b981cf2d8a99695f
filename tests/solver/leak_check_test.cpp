// The certificate of resolved paths, on paths made by hand: the library itself makes none that leaks.
#include <froude/solver/coupling/leak_check.h>

#include <gtest/gtest.h>

#include <froude/base/random.h>

#include "support/encounter.h"
#include "support/polygon_generator.h"
#include "support/worlds.h"

namespace froude {
namespace {

constexpr double kDt = 0.01;
const Polygon kPlate = Polygon::box({{-0.5, -0.5e-4}, {0.5, 0.5e-4}});
const DiscContact kPoint{0.0, 0.0, 0.0, {}, true};

// The world of one body about the origin, with the sub-step begun.
struct Stage {
  explicit Stage(const BodyDef& body, bool periodic = false, const Box& box = {{-2.0, -2.0}, {2.0, 2.0}})
      : def(make(body, periodic, box)), bodies(def.bodies), obstacles(def.domain, bodies, 0.1) {
    bodies.beginStep(0.0, kDt);
    obstacles.beginStep(bodies, kDt, 0.5);
  }
  static WorldDef make(const BodyDef& body, bool periodic, const Box& box) {
    WorldDef def;
    def.domain.box = box;
    def.domain.periodicX = periodic;
    def.bodies.push_back(body);
    return def;
  }
  PathLeak straight(const Vec2& from, const Vec2& to, const DiscContact& disc = kPoint) const {
    const PathResult path{};
    return checkPath(obstacles, from, to, disc, path);
  }

  WorldDef def;
  BodySet bodies;
  Obstacles obstacles;
};

BodyDef turning(const Polygon& shape, double spin, const Vec2& velocity = {0.0, 0.0}) {
  BodyDef def = testing::body("body", shape, {0.0, 0.0});
  def.motion = Motion::Scripted;
  def.spin = spin;
  def.velocity = velocity;
  return def;
}

TEST(LeakCheck, a_path_through_a_plate_of_a_tenth_of_a_millimetre_leaks) {
  for (const Motion motion : {Motion::Fixed, Motion::Scripted}) {
    BodyDef plate = testing::body("plate", kPlate, {0.0, 0.0});
    plate.motion = motion;
    const Stage stage(plate);
    const PathLeak through = stage.straight({0.1, 0.02}, {0.1, -0.02});
    EXPECT_TRUE(through.leaked);
    EXPECT_FALSE(through.inside);
    EXPECT_EQ(through.body, 0);
    EXPECT_EQ(through.at, Vec2(0.1, 0.02));
    EXPECT_TRUE(stage.straight({0.1, 1.7}, {0.1, -1.7}).leaked) << "farther than the reach";
    const PathLeak into = stage.straight({0.1, 0.02}, {0.1, 0.0});
    EXPECT_TRUE(into.leaked);
    EXPECT_TRUE(into.inside);
    EXPECT_FALSE(stage.straight({0.1, 0.02}, {0.3, 1e-4}).leaked);
    EXPECT_FALSE(stage.straight({0.1, 0.5e-4}, {0.2, 0.5e-4}).leaked) << "along it";
    EXPECT_FALSE(stage.straight({0.1, 0.5e-4}, {0.2, 0.02}).leaked) << "off it";
    EXPECT_TRUE(stage.straight({0.1, 0.5e-4}, {0.2, -0.02}).leaked) << "from it through it";
  }
}

TEST(LeakCheck, what_starts_inside_and_stays_there_leaks) {
  const Stage stage(testing::body("box", Polygon::box({{-0.5, -0.5}, {0.5, 0.5}}), {0.0, 0.0}));
  EXPECT_TRUE(stage.straight({0.1, 0.1}, {0.1, 0.1}).inside);
  EXPECT_FALSE(stage.straight({0.1, 0.1}, {0.8, 0.1}).leaked) << "out";
}

TEST(LeakCheck, what_may_pass_a_body_does_not_leak) {
  for (const Motion motion : {Motion::Fixed, Motion::Scripted}) {
    BodyDef body = testing::body("plate", kPlate, {0.0, 0.0});
    body.motion = motion;
    body.group = 2;
    const Stage stage(body);
    DiscContact passes = kPoint;
    passes.filter = {1, 1};
    EXPECT_FALSE(stage.straight({0.1, 0.02}, {0.1, -0.02}, passes).leaked);
    EXPECT_FALSE(stage.straight({0.1, 0.02}, {0.1, 0.0}, passes).leaked);
    EXPECT_TRUE(stage.straight({0.1, 0.02}, {0.1, -0.02}).leaked);
  }
}

TEST(LeakCheck, a_turning_plate_that_sweeps_over_a_resting_point_leaks) {
  const Vec2 rest(0.3, 0.1);
  const PathLeak over = Stage(turning(kPlate, 60.0)).straight(rest, rest);
  EXPECT_TRUE(over.leaked);
  EXPECT_FALSE(over.inside) << "it is behind the plate";
  EXPECT_FALSE(Stage(turning(kPlate, -60.0)).straight(rest, rest).leaked);
  EXPECT_FALSE(Stage(turning(kPlate, 20.0)).straight(rest, rest).leaked) << "not so far yet";
  // What goes round with it does not leak, and what stays in front of it neither.
  const Transform end = Transform::of({0.0, 0.0}, 0.6);
  EXPECT_TRUE(Stage(turning(kPlate, 60.0)).straight({0.3, 0.001}, end.toWorld({0.3, 0.001})).leaked)
      << "the chord of its arc is no way round";
  const Transform littleTurn = Transform::of({0.0, 0.0}, 0.01);
  EXPECT_FALSE(Stage(turning(kPlate, 1.0)).straight({0.3, 0.001}, littleTurn.toWorld({0.3, 0.001})).leaked);
}

TEST(LeakCheck, a_point_that_a_turning_body_carries_is_seen_in_its_frame) {
  const Stage stage(turning(kPlate, 60.0));
  const double skin = 1e-12;
  const Vec2 from(0.3, 0.5e-4 + skin);
  PathResult path;
  path.contacts = kMaxBounces + 1;
  for (PathResult::Impulse& i : path.impulses) i = {0, from, {0, 0}, {0, 0}, 0.0, {0.0, 1.0}, 0.0};
  const Vec2 carried = stage.obstacles.carriedFrom(0, from, 0.0);
  EXPECT_FALSE(checkPath(stage.obstacles, from, carried, kPoint, path).leaked) << "on its arc";
  EXPECT_TRUE(checkPath(stage.obstacles, from, stage.obstacles.carriedFrom(0, {0.3, -1e-3}, 0.0), kPoint, path).leaked);
}

TEST(LeakCheck, each_piece_of_a_bounced_path_is_checked) {
  const Stage stage(testing::body("box", Polygon::box({{-0.5, -0.5}, {0.5, 0.5}}), {0.0, 0.0}));
  DiscContact disc = kPoint;
  disc.radius = 0.01;
  PathResult path;
  path.contacts = 1;
  path.impulses[0] = {0, {0.0, 0.5}, {0, 0}, {0, 0}, 0.5, {0.0, 1.0}, 0.0};
  EXPECT_FALSE(checkPath(stage.obstacles, {-0.1, 0.6}, {0.1, 0.6}, disc, path).leaked);
  EXPECT_TRUE(checkPath(stage.obstacles, {-0.1, 0.6}, {0.1, -0.6}, disc, path).leaked) << "the second";
  EXPECT_TRUE(checkPath(stage.obstacles, {-0.6, -0.6}, {0.1, 0.6}, disc, path).leaked) << "the first";
  EXPECT_EQ(checkPath(stage.obstacles, {-0.1, 0.6}, {0.1, -0.6}, disc, path).at, Vec2(0.0, 0.51));
}

TEST(LeakCheck, a_closed_side_leaks_and_an_open_one_does_not) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {1.0, 1.0}};
  def.domain.closed = {true, true, true, false};
  const BodySet bodies(def.bodies);
  const Obstacles obstacles(def.domain, bodies, 0.05);
  const PathResult path{};
  const auto check = [&](const Vec2& from, const Vec2& to) { return checkPath(obstacles, from, to, kPoint, path); };
  EXPECT_TRUE(check({0.5, 0.1}, {0.5, -0.01}).leaked);
  EXPECT_TRUE(check({0.5, 0.1}, {0.5, -0.01}).inside);
  EXPECT_TRUE(check({0.5, 0.1}, {0.5, -7.0}).leaked);
  EXPECT_EQ(check({0.5, 0.1}, {0.5, -7.0}).body, -1);
  EXPECT_FALSE(check({0.5, 0.9}, {0.5, 7.0}).leaked);
  EXPECT_FALSE(check({0.01, 0.99}, {-0.5, 20.0}).leaked) << "gone before it passes the wall's line";
  EXPECT_FALSE(check({0.5, 0.1}, {0.5, 0.0}).leaked) << "onto the wall";
}

TEST(LeakCheck, the_copy_of_a_body_across_a_periodic_side_counts) {
  for (const Motion motion : {Motion::Fixed, Motion::Scripted}) {
    BodyDef body = testing::body("plate", Polygon::box({{-0.02, -0.5}, {0.02, 0.5}}), {1.0, 0.0});
    body.motion = motion;
    const Stage stage(body, true, {{0.0, -2.0}, {1.0, 2.0}});
    EXPECT_TRUE(stage.straight({0.05, 0.0}, {0.01, 0.0}).inside);
    EXPECT_TRUE(stage.straight({0.05, 0.0}, {-0.05, 0.0}).leaked) << "through the copy and the body";
    EXPECT_FALSE(stage.straight({0.05, 0.7}, {-0.05, 0.7}).leaked) << "past it";
  }
}

// Spin and speed of every size; straight paths that know nothing of the body, so many leak.
TEST(LeakCheck, agrees_with_the_count_over_all_edges_on_random_pieces) {
  RandomStream random(81, 0);
  long leaked = 0, checked = 0;
  for (int k = 0; k < 400; ++k) {
    const Polygon shape = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    const double spin = k % 4 == 0 ? 0.0 : random.uniform(-0.5, 0.5) / kDt;
    const BodyDef body = turning(shape, spin, Vec2(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0)));
    const Stage stage(body);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(shape);
    const RigidMotion motion{Transform::of(body.position, body.angle), body.velocity, body.spin};
    for (int piece = 0; piece < 250; ++piece) {
      const Vec2 from(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      const double travel = std::pow(10.0, random.uniform(-3.0, 0.0));
      const Vec2 to = from + travel * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      if (test::whereIs(edges, motion.start.toLocal(from)) >= 0) continue;
      test::ResolvedPath path;
      path.corners = {{0.0, from}, {kDt, to}};
      const bool expected = test::countLeaks(edges, motion, kDt, path) > 0;
      ASSERT_EQ(stage.straight(from, to).leaked, expected) << "body " << k << ", piece " << piece;
      leaked += expected ? 1 : 0;
      ++checked;
    }
  }
  EXPECT_GT(checked, 80000);
  EXPECT_GT(leaked, 5000);
  EXPECT_LT(leaked, checked / 2);
}

}  // namespace
}  // namespace froude
