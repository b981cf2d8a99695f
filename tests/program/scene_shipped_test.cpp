// The scenes of the house: sound, without a warning, and exactly what they claim to be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "scene/scene.h"

namespace froude {
namespace {

scene::Scene shipped(const std::string& name) {
  return scene::load(std::string(FROUDE_SOURCE_DIR) + "/scenes/" + name + ".toml");
}

TEST(ShippedScenes, none_has_a_warning_or_cuts_anything_and_each_says_what_to_see) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(FROUDE_SOURCE_DIR) + "/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    const scene::Scene s = scene::load(entry.path().string());
    for (const scene::Warning& warning : s.warnings) ADD_FAILURE() << warning.line();
    for (const std::string& note : s.notes) ADD_FAILURE() << note;
    std::ifstream stream(entry.path());
    std::string first;
    std::getline(stream, first);
    EXPECT_EQ(first.rfind("# What to see: ", 0), 0u) << first;
  }
  EXPECT_GE(count, 4);
}

TEST(ShippedScenes, the_dam_break_is_the_column_of_Martin_and_Moyce) {
  const scene::Scene s = shipped("dam_break");
  EXPECT_EQ(s.fluidParticles(), 40u * 80u);
  Box box;
  for (const Vec2& p : s.fluidBlocks[0].positions) box.include(p);
  const double a = 2.25 * 0.0254, dx = s.world.fluid->spacing;
  EXPECT_NEAR(box.max.x() - box.min.x() + dx, a, 1e-12);
  EXPECT_NEAR(box.max.y() - box.min.y() + dx, 2 * a, 1e-12);
  EXPECT_GT(s.world.domain.box.max.x(), 4.11 * a + 4 * dx);  // the front's last datum
  EXPECT_GT(s.duration, 7.4 * std::sqrt(a / 9.81));          // the height's last datum
  ASSERT_GE(s.gauges.size(), 3u);
  EXPECT_EQ(s.gauges[0].type, "toe");
  EXPECT_EQ(s.gauges[2].type, "height");
  EXPECT_DOUBLE_EQ(s.gauges[2].x, 0.5 * dx);
}

TEST(ShippedScenes, the_still_tank_stands_on_its_floor) {
  const scene::Scene s = shipped("still_tank");
  EXPECT_EQ(s.fluidParticles(), 100u * 50u);
  EXPECT_EQ(s.world.bodies.at(0).name, "floor");
  EXPECT_EQ(s.world.bodies.at(0).shape->bounds().max.y(), 0.0);
}

TEST(ShippedScenes, the_speed_scenes_are_those_that_other_programs_were_measured_on) {
  for (const char* name : {"dam_speed", "sieve"}) {
    const scene::Scene s = shipped(name);
    EXPECT_EQ(s.fluidParticles(), 99856u);
    EXPECT_DOUBLE_EQ(s.world.fluid->spacing, 1.0 / 316.0);
    EXPECT_EQ(s.world.domain.box.max, Vec2(3.0, 2.0));
    EXPECT_EQ(s.duration, 2.0);
    const std::vector<Vec2>& points = s.fluidBlocks[0].positions;
    for (const std::size_t k :
         {std::size_t{0}, std::size_t{315}, std::size_t{316}, std::size_t{50000}, points.size() - 1}) {
      EXPECT_NEAR(points[k].x(), (static_cast<double>(k % 316) + 0.5) / 316.0, 1e-13);
      EXPECT_NEAR(points[k].y(), (static_cast<double>(k / 316) + 0.5) / 316.0, 1e-13);
    }
  }
  EXPECT_EQ(shipped("dam_speed").world.bodies.size(), 0u);
  const scene::Scene sieve = shipped("sieve");
  ASSERT_EQ(sieve.world.bodies.size(), 200u);
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 20; ++i) {
      const BodyDef& peg = sieve.world.bodies[static_cast<std::size_t>(20 * j + i)];
      const Vec2 center(1.15 + 0.09 * i, 0.08 + 0.09 * j);
      ASSERT_EQ(peg.shape->vertices().size(), 8u);
      for (int k = 0; k < 8; ++k) {
        const double at = 0.1 * (20 * j + i) + kPi * k / 4;
        const Vec2 vertex =
            Transform::of(peg.position, peg.angle).toWorld(peg.shape->vertices()[static_cast<std::size_t>(k)]);
        EXPECT_NEAR((vertex - center - 0.03 * Vec2(std::cos(at), std::sin(at))).norm(), 0.0, 1e-13);
      }
    }
}

TEST(ShippedScenes, the_harbour_stands_as_it_was_drawn) {
  const scene::Scene s = shipped("harbour");
  ASSERT_EQ(s.world.bodies.size(), 6u);
  const Polygon& land = *s.world.bodies[0].shape;
  EXPECT_EQ(land.ringStarts().size(), 3u) << "the lock chamber is a hole";
  EXPECT_EQ(land.bounds().min, Vec2(0.0, 0.0));
  EXPECT_EQ(land.bounds().max.x(), 4.0);
  EXPECT_FALSE(land.contains({2.0, 0.2})) << "within the chamber";
  // The buoy is a ring of radii 16 and 8, one centimetre a unit, 0.1 mm of tolerance.
  const Polygon& buoy = *s.world.bodies[1].shape;
  EXPECT_NEAR(buoy.area(), kPi * (0.16 * 0.16 - 0.08 * 0.08), 2e-4 * 2 * kPi * 0.24);
  EXPECT_NEAR(buoy.centroid().norm(), 0.0, 1e-6);
  EXPECT_EQ(s.world.bodies[2].shape, s.world.bodies[5].shape) << "gulls share a shape";
}

std::size_t bodiesThat(const scene::Scene& s, Motion motion) {
  return static_cast<std::size_t>(std::count_if(s.world.bodies.begin(), s.world.bodies.end(),
                                                [=](const BodyDef& b) { return b.motion == motion; }));
}

TEST(ShippedScenes, those_of_free_bodies_hold_what_they_say) {
  EXPECT_EQ(bodiesThat(shipped("pyramid"), Motion::Free), 210u);
  const scene::Scene tumbler = shipped("tumbler");
  EXPECT_EQ(bodiesThat(tumbler, Motion::Free), 2000u);
  EXPECT_EQ(bodiesThat(tumbler, Motion::Scripted), 1u);
  for (const std::size_t sides : {4u, 5u, 6u, 8u})
    EXPECT_EQ(std::count_if(tumbler.world.bodies.begin() + 1, tumbler.world.bodies.end(),
                            [=](const BodyDef& b) { return b.shape->vertices().size() == sides; }),
              500);
  const scene::Scene floating = shipped("float");
  const BodyDef& hull = floating.world.bodies.at(3);
  EXPECT_GT(hull.density, floating.world.fluid->density);
  EXPECT_LT(hull.density * hull.shape->area(), 0.6 * floating.world.fluid->density * (0.38 + 0.52) / 2 * 0.2);
  for (const char* name : {"water_wheel", "gate"}) EXPECT_TRUE(shipped(name).world.bodies.at(0).hinge) << name;
}

TEST(ShippedScenes, the_gears_turn_as_their_teeth_say) {
  const scene::Scene s = shipped("gears");
  const auto teeth = [](const Polygon& gear, double tip) {  // two vertices each at the tip circle
    return std::count_if(gear.vertices().begin(), gear.vertices().end(),
                         [=](const Vec2& v) { return std::abs(v.norm() - tip) < 1e-4; }) /
           2;
  };
  EXPECT_EQ(teeth(*s.world.bodies.at(0).shape, 0.445), 16);
  EXPECT_EQ(teeth(*s.world.bodies.at(1).shape, 0.645), 24);
  World world = scene::makeWorld(s);
  while (world.time() < 2.0) ASSERT_TRUE(world.substep().ok());
  const double small = world.body(0).angle, large = world.body(1).angle;
  EXPECT_GT(small, 2.0) << "rad; the motor turns it by 2 rad/s once it is up to speed";
  EXPECT_LT(small, 4.0);
  EXPECT_NEAR(small, -1.5 * large, 0.012 / 0.4) << "12 mm of backlash at the pitch circle of 0.4 m";
}

TEST(ShippedScenes, the_stacks_stand) {
  const scene::Scene s = shipped("stacks");
  World world = scene::makeWorld(s);
  while (world.time() < 2.0) ASSERT_TRUE(world.substep().ok());
  for (std::size_t b = 0; b < world.bodyCount(); ++b) {
    SCOPED_TRACE(s.world.bodies[b].name);
    EXPECT_NEAR((world.body(b).transform.position - s.world.bodies[b].position).norm(), 0.0, 5e-3);
    EXPECT_NEAR(world.body(b).angle, 0.0, 5e-3);
  }
}

TEST(ShippedScenes, ten_and_forty_thousand_particles_are_one_key_away) {
  const std::string file = std::string(FROUDE_SOURCE_DIR) + "/scenes/dam_speed.toml";
  EXPECT_EQ(scene::load(file, {{"model.spacing", "0.01"}}).fluidParticles(), 10000u);
  EXPECT_EQ(scene::load(file, {{"model.spacing", "0.005"}}).fluidParticles(), 40000u);
}

}  // namespace
}  // namespace froude
