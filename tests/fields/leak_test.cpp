#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include <froude/base/parallel.h>
#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/sweep.h>
#include <froude/fields/world_field.h>

#include "support/encounter.h"
#include "support/polygon_generator.h"

namespace froude {
namespace {

struct Target {
  std::unique_ptr<DistanceField> field;
  std::vector<test::OracleEdge> edges;
};

std::vector<Target> makeTargets(int count) {
  std::vector<Target> targets;
  RandomStream random(31, 0);
  for (int k = 0; k < count; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    targets.push_back({std::make_unique<DistanceField>(polygon, 0.03), test::oracleEdges(polygon)});
  }
  return targets;
}

struct Encounter {
  RigidMotion motion;
  double dt;
  Vec2 from;
  Vec2 velocity;
  double radius;
  test::Bounce bounce;
};

/// A bullet of up to 1,000 m/s aimed at a polygon that moves and turns; starts anywhere round it, also inside its
/// pockets.
Encounter makeEncounter(const Target& target, RandomStream& random) {
  Encounter e;
  e.dt = std::pow(10.0, random.uniform(-4.0, -2.0));
  e.motion.start =
      Transform::of({random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)}, random.uniform(0.0, 2.0 * kPi));
  const double drift = std::pow(10.0, random.uniform(-1.0, 2.0));
  e.motion.velocity = drift * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  const double turn = random.below(8) == 0 ? random.uniform(-7.0, 7.0) : random.uniform(-0.5, 0.5);
  e.motion.spin = random.below(4) == 0 ? 0.0 : turn / e.dt;
  const double speed = std::pow(10.0, random.uniform(0.0, 3.0));
  const double angle = random.uniform(0.0, 2.0 * kPi);
  const Vec2 direction(std::cos(angle), std::sin(angle));
  const double hitTime = random.uniform(0.0, 1.0) * e.dt;
  const Transform pose = e.motion.at(hitTime);
  const test::OracleEdge& edge = target.edges[random.below(static_cast<std::uint32_t>(target.edges.size()))];
  const Vec2 aim = pose.toWorld(edge.a + random.uniform(-0.1, 1.1) * (edge.b - edge.a));
  e.velocity = speed * direction;
  e.from = aim - hitTime * e.velocity;
  e.radius = random.below(2) == 0 ? 0.0 : 0.03 * std::pow(10.0, random.uniform(-3.0, 0.0));
  e.bounce.restitution = 0.5 * random.below(3);
  e.bounce.friction = 0.5 * random.below(3);
  return e;
}

struct Tally {
  long encounters = 0;
  long hit = 0;
  long rested = 0;
  long leaks = 0;
};

void meet(const Target& target, const Encounter& e, Tally* tally) {
  const double start = target.field->sampleExact(e.motion.start.toLocal(e.from)).distance;
  if (start <= e.radius + 1e-9) return;
  const auto sweep = [&](double elapsed, const Vec2& from, const Vec2& to) {
    const RigidMotion rest{e.motion.at(elapsed), e.motion.velocity, e.motion.spin};
    return sweepDisc(*target.field, rest, e.dt - elapsed, from, to, e.radius);
  };
  const auto surface = [&](const Vec2& point, double time) { return e.motion.velocityAt(point, time); };
  const test::ResolvedPath path = test::resolve(e.from, e.velocity, e.dt, e.bounce, sweep, surface);
  ++tally->encounters;
  tally->hit += path.contacts > 0;
  tally->rested += path.restsFrom >= 0.0;
  tally->leaks += test::countLeaks(target.edges, e.motion, e.dt, path);
}

TEST(LongLeaks, none_in_random_swept_encounters_with_thin_concave_and_spinning_polygons) {
  constexpr long kBlock = 10000;  // encounters, from a stream of their own: a block can be run again alone
  const std::size_t blocks = std::getenv("FROUDE_LONG") != nullptr ? 10000 : 100;
  const std::vector<Target> targets = makeTargets(64);
  std::vector<Tally> tallies(blocks);
  parallelFor(blocks, 1, [&](std::size_t block, std::size_t) {
    RandomStream random(32, block);
    while (tallies[block].encounters < kBlock) {
      const Target& target = targets[random.below(64)];
      meet(target, makeEncounter(target, random), &tallies[block]);
    }
  });
  Tally all;
  for (std::size_t block = 0; block < blocks; ++block) {
    const Tally& tally = tallies[block];
    EXPECT_EQ(tally.leaks, 0) << "in block " << block;
    all.encounters += tally.encounters;
    all.hit += tally.hit;
    all.rested += tally.rested;
  }
  EXPECT_EQ(all.encounters, static_cast<long>(blocks) * kBlock);
  EXPECT_GT(all.hit, all.encounters / 4) << "encounters that never touch prove nothing";
  EXPECT_GT(all.rested, 0);
  RecordProperty("encounters", static_cast<int>(all.encounters));
  RecordProperty("hit", static_cast<int>(all.hit));
  RecordProperty("rested", static_cast<int>(all.rested));
}

// The bullet follows an edge of a turning polygon a nanometre off for 200 chords; then it meets another edge.
TEST(Leaks, a_long_graze_does_not_make_the_contact_after_it_coarse) {
  const std::vector<Target> targets = makeTargets(64);
  RandomStream random(32, 7613);
  Tally tally;
  for (int k = 0; k < 2635;) {
    const Target& target = targets[random.below(64)];
    const Encounter e = makeEncounter(target, random);
    if (target.field->sampleExact(e.motion.start.toLocal(e.from)).distance > e.radius + 1e-9) ++k;
  }
  const Target& target = targets[random.below(64)];
  const Encounter e = makeEncounter(target, random);
  ASSERT_EQ(target.edges.size(), 96u);
  meet(target, e, &tally);
  EXPECT_EQ(tally.leaks, 0);
  const RigidMotion rest{e.motion.at(1.3390258638308644e-4), e.motion.velocity, e.motion.spin};
  const Vec2 from(-1.614153387923235, -2.4371965472969692);
  const Vec2 to(-1.361019097924707, -2.4357546856737087);
  const double left = 1.926450775534614e-4 - 1.3390258638308644e-4;
  const SweepHit hit = sweepDisc(*target.field, rest, 1.001 * left, from, Vec2(from + 1.001 * (to - from)), 0.0);
  ASSERT_TRUE(hit.hit);
  const Transform pose = rest.at(hit.time * 1.001 * left);
  EXPECT_LT(target.field->sampleExact(pose.toLocal(hit.center)).distance, 1e-9) << "held off";
}

TEST(Leaks, the_counter_sees_a_path_that_goes_through) {
  const Polygon plate = Polygon::box({{-0.5, -0.5e-4}, {0.5, 0.5e-4}});
  const std::vector<test::OracleEdge> edges = test::oracleEdges(plate);
  test::ResolvedPath through;
  through.corners = {{0.0, {0.0, 5.0}}, {0.01, {0.1, -5.0}}};
  EXPECT_EQ(test::countLeaks(edges, RigidMotion{Transform(), {0, 0}, 0.0}, 0.01, through), 1);
  EXPECT_EQ(test::countLeaks(edges, RigidMotion{Transform(), {0, 0}, 30.0}, 0.01, through), 1);
  // A resting point that a turning plate sweeps over.
  test::ResolvedPath resting;
  resting.corners = {{0.0, {0.3, 0.1}}, {0.01, {0.3, 0.1}}};
  EXPECT_EQ(test::countLeaks(edges, RigidMotion{Transform(), {0, 0}, 60.0}, 0.01, resting), 1);
  EXPECT_EQ(test::countLeaks(edges, RigidMotion{Transform(), {0, 0}, -60.0}, 0.01, resting), 0);
  test::ResolvedPath in;
  in.corners = {{0.0, {0.0, 1.0}}, {0.01, {0.0, 0.0}}};
  EXPECT_GE(test::countLeaks(edges, RigidMotion{Transform(), {0, 0}, 0.0}, 0.01, in), 1);
}

TEST(Leaks, none_among_many_fixed_polygons_and_the_walls_of_a_domain) {
  RandomStream random(33, 0);
  const DomainWalls walls{{{-2.0, -2.0}, {2.0, 2.0}}, {true, true, true, false}};
  std::vector<Polygon> polygons;
  std::vector<PlacedPolygon> placed;
  for (int k = 0; k < 16; ++k)
    polygons.push_back(test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random));
  for (int k = 0; k < 16; ++k) {
    const Vec2 at(-1.5 + k % 4, -1.5 + k / 4);
    placed.push_back({&polygons[static_cast<std::size_t>(k)], Transform::of(at, random.uniform(0.0, 6.3)), k});
  }
  const WorldField world(placed, walls, 0.03);
  std::vector<test::OracleEdge> edges;
  for (const FieldEdge& e : world.edges()) edges.push_back({e.a, e.b});
  long hits = 0;
  for (int k = 0; k < 60000; ++k) {
    const Vec2 from(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    const double radius = k % 2 == 0 ? 0.0 : random.uniform(0.0, 0.03);
    if (world.sampleExact(from).distance <= radius) continue;
    const double angle = random.uniform(0.0, 2.0 * kPi);
    const double speed = std::pow(10.0, random.uniform(0.0, 3.0));
    const auto sweep = [&](double, const Vec2& p, const Vec2& q) { return world.sweepDisc(p, q, radius); };
    const auto surface = [](const Vec2&, double) { return Vec2(0.0, 0.0); };
    const test::Bounce bounce{0.5 * random.below(3), 0.5 * random.below(3)};
    const test::ResolvedPath path =
        test::resolve(from, speed * Vec2(std::cos(angle), std::sin(angle)), 0.01, bounce, sweep, surface);
    hits += path.contacts;
    for (std::size_t i = 0; i + 1 < path.corners.size(); ++i) {
      const Vec2 p = path.corners[i].position;
      Vec2 q = path.corners[i + 1].position;
      // Above the open top there is no wall any more.
      if (p.y() > 2.0) break;
      if (q.y() > 2.0) q = p + (2.0 - p.y()) / (q.y() - p.y()) * (q - p);
      ASSERT_FALSE(test::crosses(edges, p, q)) << k;
    }
  }
  EXPECT_GT(hits, 30000);
}

}  // namespace
}  // namespace froude
