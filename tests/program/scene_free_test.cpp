// Free bodies and their hinges as a scene gives them, and what is said of those that stand badly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "program/scene_support.h"
#include "scene/estimate.h"

namespace froude {
namespace {

using froude::testing::kFluid;
using froude::testing::kHead;
using froude::testing::loadText;

std::string box(const std::string& name, double x, double y, const std::string& more = "motion = \"free\"\n") {
  return "[[body]]\nname = \"" + name + "\"\nshape = { box = [-0.1, -0.1, 0.1, 0.1] }\nposition = [" +
         std::to_string(x) + ", " + std::to_string(y) + "]\n" + more;
}

std::vector<std::string> warningsOf(const std::string& text) {
  std::vector<std::string> lines;
  for (const scene::Warning& w : loadText(text).warnings) lines.push_back(w.key + ": " + w.text);
  return lines;
}

TEST(SceneFree, a_free_body_arrives_with_its_density_velocity_and_spin) {
  const scene::Scene s = loadText(kHead + box("a", 0.5, 0.5) + "density = 500\nvelocity = [1, 2]\nspin = -3\n");
  const BodyDef& b = s.world.bodies.at(0);
  EXPECT_EQ(b.motion, Motion::Free);
  EXPECT_EQ(b.density, 500.0);
  EXPECT_EQ(b.velocity, Vec2(1.0, 2.0));
  EXPECT_EQ(b.spin, -3.0);
  EXPECT_FALSE(b.hinge);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(SceneFree, a_hinge_arrives_with_its_motor) {
  const scene::Scene s =
      loadText(kHead + box("a", 0.5, 0.5) + "hinge = { at = [0.45, 0.55], motor = { speed = -2.0, torque = 0 } }\n" +
               box("b", 1.5, 0.5) + "hinge = { at = [1.5, 0.5] }\n");
  ASSERT_TRUE(s.world.bodies.at(0).hinge && s.world.bodies.at(0).hinge->motor);
  EXPECT_EQ(s.world.bodies[0].hinge->at, Vec2(0.45, 0.55));
  EXPECT_EQ(s.world.bodies[0].hinge->motor->speed, -2.0);
  EXPECT_EQ(s.world.bodies[0].hinge->motor->torque, 0.0);
  ASSERT_TRUE(s.world.bodies.at(1).hinge);
  EXPECT_FALSE(s.world.bodies[1].hinge->motor);
}

// The hinge rests on the same material point of each copy.
TEST(SceneFree, copies_take_their_hinges_along) {
  const scene::Scene s =
      loadText(kHead + box("a", 0.3, 0.3) +
               "hinge = { at = [0.4, 0.35] }\nrepeat = { count = [3], step = [[0.5, 0.1]], turn = 90.0 }\n");
  ASSERT_EQ(s.world.bodies.size(), 3u);
  for (const BodyDef& b : s.world.bodies) {
    const Vec2 local = Transform::of(b.position, b.angle).toLocal(b.hinge->at);
    EXPECT_NEAR((local - Vec2(0.1, 0.05)).norm(), 0.0, 1e-12) << b.name;
  }
  EXPECT_NEAR((s.world.bodies[1].hinge->at - Vec2(0.75, 0.5)).norm(), 0.0, 1e-12);
}

TEST(SceneFree, a_hinged_body_that_spins_turns_about_its_hinge_unless_a_velocity_is_given) {
  const std::string turning = kHead + box("a", 0.5, 0.5) + "spin = 2.0\nhinge = { at = [0.4, 0.5] }\n";
  EXPECT_NEAR((loadText(turning).world.bodies[0].velocity - Vec2(0.0, 0.2)).norm(), 0.0, 1e-12);
  EXPECT_EQ(loadText(turning + "velocity = [0.3, 0.1]\n").world.bodies[0].velocity, Vec2(0.3, 0.1));
}

TEST(SceneFree, a_world_of_bodies_alone_is_a_scene) {
  const scene::Scene s = loadText(kHead + box("a", 0.5, 0.5));
  EXPECT_FALSE(s.world.fluid || s.world.bullet);
  EXPECT_EQ(s.fluidParticles() + s.bulletCount(), 0u);
  EXPECT_GE(scene::estimate(s).bytes, scene::estimate(loadText(kHead)).bytes + 1000.0);
  EXPECT_GE(scene::estimate(s).substeps, 1.0);
}

TEST(SceneFree, bodies_that_overlap_at_the_start_are_named_with_the_depth) {
  const std::vector<std::string> w = warningsOf(kHead + box("a", 0.5, 0.5) + box("b", 0.67, 0.55));
  ASSERT_EQ(w.size(), 1u);
  EXPECT_EQ(w[0].rfind("body.a.position: overlaps body.b at the start, by about 0.03 m", 0), 0u) << w[0];
}

TEST(SceneFree, the_free_one_of_two_that_overlap_is_the_one_to_move) {
  const std::vector<std::string> w = warningsOf(kHead + box("wall", 0.5, 0.5, "") + box("b", 0.65, 0.5));
  ASSERT_EQ(w.size(), 1u);
  EXPECT_EQ(w[0].rfind("body.b.position: overlaps body.wall", 0), 0u) << w[0];
}

TEST(SceneFree, every_way_of_overlapping_is_found) {
  const std::string bars =
      "[[body]]\nname = \"lie\"\nmotion = \"free\"\nposition = [1, 0.5]\nshape = { box = [-0.4, -0.05, 0.4, 0.05] }\n"
      "[[body]]\nname = \"stand\"\nmotion = \"free\"\nposition = [1, 0.5]\nshape = { box = [-0.05, -0.4, 0.05, 0.4] "
      "}\n";
  const std::string ring =
      "shape = { polygon = [[0, 0], [1, 0], [1, 0.8], [0, 0.8]], holes = [[[0.1, 0.1], [0.9, 0.1], [0.9, 0.7], "
      "[0.1, 0.7]]] }\nposition = [0.1, 0.1]\nmotion = \"free\"\n";
  EXPECT_EQ(warningsOf(kHead + bars).size(), 1u) << "a cross, no vertex of one in the other";
  EXPECT_EQ(warningsOf(kHead + box("a", 0.5, 0.5) + box("b", 0.5, 0.5)).size(), 1u) << "one upon the other";
  EXPECT_EQ(warningsOf(kHead + box("a", 0.5, 0.5) + box("b", 0.6, 0.5)).size(), 1u) << "along a common side";
  EXPECT_EQ(warningsOf(kHead + "[[body]]\n" + ring + "[[body]]\n" + ring).size(), 1u) << "two rings, one place";
  EXPECT_EQ(warningsOf(kHead + box("large", 0.5, 0.5) +
                       "[[body]]\nname = \"small\"\nshape = { box = [0.48, 0.48, 0.52, 0.52] }\n")
                .size(),
            1u)
      << "one wholly within the other";
}

TEST(SceneFree, bodies_that_touch_or_are_filtered_or_never_move_are_no_overlap) {
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.5, 0.1) + box("b", 0.5, 0.3) + box("c", 0.7, 0.1)).empty());
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.5, 0.5, "") + box("b", 0.6, 0.5, "")).empty());
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.5, 0.5) + "collides_with = 2\n" + box("b", 0.6, 0.5)).empty());
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.5, 0.5) +
                         "[[body]]\nname = \"ring\"\nshape = { polygon = [[0, 0], [1, 0], [1, 1], [0, 1]], holes = "
                         "[[[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]]] }\n")
                  .empty())
      << "in the hole of another";
}

TEST(SceneFree, of_many_overlaps_five_are_said_and_the_others_counted) {
  const std::vector<std::string> w =
      warningsOf(kHead + box("a", 0.2, 0.5) + "repeat = { count = [10], step = [[0.15, 0.0]] }\n");
  ASSERT_EQ(w.size(), 6u);
  EXPECT_EQ(w.back(), "body: 4 more pairs of bodies overlap at the start");
}

TEST(SceneFree, what_reaches_out_of_the_domain_is_said) {
  std::vector<std::string> w = warningsOf(kHead + box("a", 0.05, 0.5));
  ASSERT_EQ(w.size(), 1u);
  EXPECT_EQ(w[0].rfind("body.a.position: reaches 0.05 m beyond the domain's left wall", 0), 0u) << w[0];
  w = warningsOf(kHead + "walls = [\"bottom\"]\n" + box("a", 0.5, 0.95));
  ASSERT_EQ(w.size(), 1u);
  EXPECT_EQ(w[0].rfind("body.a.position: reaches 0.05 m beyond the domain's top side, which is open", 0), 0u) << w[0];
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.1, 0.5)).empty());
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.05, 0.5, "")).empty());
}

TEST(SceneFree, a_free_body_between_periodic_sides_is_said_once) {
  const std::string periodic = kHead + "periodic = [\"x\"]\n";
  const std::vector<std::string> w = warningsOf(periodic + box("a", 0.5, 0.5) + box("b", 1.5, 0.5));
  ASSERT_EQ(w.size(), 1u);
  EXPECT_EQ(w[0].rfind("body.a.motion: free bodies are not carried across a periodic side", 0), 0u) << w[0];
  EXPECT_TRUE(warningsOf(periodic + box("a", 0.5, 0.5) + "hinge = { at = [0.5, 0.5] }\n").empty());
  EXPECT_TRUE(warningsOf(periodic + box("a", 0.5, 0.5, "")).empty());
}

TEST(SceneFree, a_hinge_far_from_its_body_is_said) {
  const std::vector<std::string> w = warningsOf(kHead + box("a", 0.5, 0.5) + "hinge = { at = [0.0, 0.0] }\n");
  ASSERT_EQ(w.size(), 1u);
  EXPECT_EQ(w[0].rfind("body.a.hinge.at: is 0.566 m away from the body, which is 0.283 m large", 0), 0u) << w[0];
  EXPECT_TRUE(warningsOf(kHead + box("a", 0.5, 0.5) + "hinge = { at = [0.5, 0.8] }\n").empty()) << "a pendulum";
}

TEST(SceneFree, a_narrow_gap_beside_a_free_body_is_not_said_for_it_changes) {
  const std::string fixed = box("a", 1.15, 0.5, "") + box("b", 1.39, 0.5, "");
  EXPECT_EQ(warningsOf(kHead + kFluid + fixed).size(), 1u);
  EXPECT_TRUE(warningsOf(kHead + kFluid + box("a", 1.15, 0.5, "") + box("b", 1.39, 0.5)).empty());
}

// Forty thousand bodies side by side: a judge that asked every pair would not come back.
TEST(SceneFree, thousands_of_bodies_are_judged_by_their_boxes) {
  const std::string many = "format = 1\nduration = 1.0\n[domain]\nbox = [0, 0, 50, 50]\n" + box("a", 0.2, 0.2) +
                           "repeat = { count = [200, 200], step = [[0.21, 0.0], [0.0, 0.21]] }\n" +
                           box("last", 42.05, 0.15);
  EXPECT_EQ(warningsOf(many).size(), 1u);
}

}  // namespace
}  // namespace froude
