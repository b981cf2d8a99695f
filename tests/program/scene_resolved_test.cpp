// The resolved scene alone gives the same run: the same definitions and the same particles, bit for bit.
#include <gtest/gtest.h>

#include <cstring>

#include "program/scene_support.h"

namespace froude {
namespace {

using froude::testing::kHead;
using froude::testing::loadText;

/// Everything of a polygon, a body … as bits.
template <typename T>
std::string bits(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string bits(const Vec2& v) { return bits(v.x()) + bits(v.y()); }
std::string bits(const std::vector<Vec2>& all) {
  std::string out;
  for (const Vec2& v : all) out += bits(v);
  return out;
}
std::string bits(const Polygon& polygon) {
  std::string out;
  for (const Vec2& v : polygon.vertices()) out += bits(v);
  for (const std::uint32_t start : polygon.ringStarts()) out += bits(start);
  return out;
}

void expectSameBodies(const WorldDef& a, const WorldDef& b) {
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const BodyDef &p = a.bodies[i], &q = b.bodies[i];
    SCOPED_TRACE(p.name);
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(bits(*p.shape), bits(*q.shape));
    EXPECT_EQ(bits(p.position) + bits(p.angle) + bits(p.velocity) + bits(p.spin) + bits(p.density),
              bits(q.position) + bits(q.angle) + bits(q.velocity) + bits(q.spin) + bits(q.density));
    EXPECT_EQ(bits(p.friction) + bits(p.restitution) + bits(p.surfaceVelocity),
              bits(q.friction) + bits(q.restitution) + bits(q.surfaceVelocity));
    EXPECT_EQ(p.motion, q.motion);
    EXPECT_EQ(p.slip, q.slip);
    EXPECT_EQ(p.group, q.group);
    EXPECT_EQ(p.collidesWith, q.collidesWith);
    ASSERT_EQ(p.hinge.has_value(), q.hinge.has_value());
    if (p.hinge) {
      EXPECT_EQ(bits(p.hinge->at), bits(q.hinge->at));
      ASSERT_EQ(p.hinge->motor.has_value(), q.hinge->motor.has_value());
      if (p.hinge->motor) {
        EXPECT_EQ(bits(p.hinge->motor->speed) + bits(p.hinge->motor->torque),
                  bits(q.hinge->motor->speed) + bits(q.hinge->motor->torque));
      }
    }
    ASSERT_EQ(p.script.size(), q.script.size());
    for (std::size_t k = 0; k < p.script.size(); ++k)
      for (const double t : {0.0, 0.3, 1.7}) {
        EXPECT_EQ(bits(p.script[k].until), bits(q.script[k].until));
        EXPECT_EQ(bits(p.script[k].velocityX(t)), bits(q.script[k].velocityX(t)));
        EXPECT_EQ(bits(p.script[k].velocityY(t)), bits(q.script[k].velocityY(t)));
        EXPECT_EQ(bits(p.script[k].spin(t)), bits(q.script[k].spin(t)));
      }
  }
}

void expectSameSpecies(const WorldDef& a, const WorldDef& b) {
  ASSERT_EQ(a.fluid.has_value(), b.fluid.has_value());
  if (a.fluid) {
    EXPECT_EQ(a.fluid->model, b.fluid->model);
    EXPECT_EQ(a.fluid->viscositySolver, b.fluid->viscositySolver);
    EXPECT_EQ(bits(a.fluid->spacing) + bits(a.fluid->density) + bits(a.fluid->viscosity) + bits(a.fluid->contactAngle) +
                  bits(a.fluid->courant) + bits(a.fluid->sweeps),
              bits(b.fluid->spacing) + bits(b.fluid->density) + bits(b.fluid->viscosity) + bits(b.fluid->contactAngle) +
                  bits(b.fluid->courant) + bits(b.fluid->sweeps));
  }
  ASSERT_EQ(a.bullet.has_value(), b.bullet.has_value());
  if (a.bullet) {
    EXPECT_EQ(
        bits(a.bullet->radius) + bits(a.bullet->density) + bits(a.bullet->friction) + bits(a.bullet->restitution),
        bits(b.bullet->radius) + bits(b.bullet->density) + bits(b.bullet->friction) + bits(b.bullet->restitution));
    EXPECT_EQ(a.bullet->group, b.bullet->group);
  }
  ASSERT_EQ(a.emitters.size(), b.emitters.size());
  for (std::size_t i = 0; i < a.emitters.size(); ++i) {
    const EmitterDef &p = a.emitters[i], &q = b.emitters[i];
    EXPECT_EQ(bits(p.from) + bits(p.to) + bits(p.speed) + bits(p.rate) + bits(p.spread) + bits(p.start) + bits(p.stop) +
                  bits(p.lifetime) + bits(p.limit) + bits(p.policy) + bits(p.kind),
              bits(q.from) + bits(q.to) + bits(q.speed) + bits(q.rate) + bits(q.spread) + bits(q.start) + bits(q.stop) +
                  bits(q.lifetime) + bits(q.limit) + bits(q.policy) + bits(q.kind));
  }
}

void expectSame(const scene::Scene& a, const scene::Scene& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(bits(a.duration), bits(b.duration));
  EXPECT_EQ(a.world.seed, b.world.seed);
  EXPECT_EQ(bits(a.world.gravity), bits(b.world.gravity));
  ASSERT_EQ(!a.world.gravityField, !b.world.gravityField);
  if (a.world.gravityField) {
    EXPECT_EQ(bits(a.world.gravityField({0.3, 0.7}, 0.1)), bits(b.world.gravityField({0.3, 0.7}, 0.1)));
  }
  EXPECT_EQ(bits(a.world.domain.box.min) + bits(a.world.domain.box.max),
            bits(b.world.domain.box.min) + bits(b.world.domain.box.max));
  EXPECT_EQ(a.world.domain.closed, b.world.domain.closed);
  EXPECT_EQ(a.world.domain.periodicX, b.world.domain.periodicX);
  EXPECT_EQ(a.world.domain.slip, b.world.domain.slip);
  EXPECT_EQ(a.world.timeStep, b.world.timeStep);
  expectSameSpecies(a.world, b.world);
  expectSameBodies(a.world, b.world);
  ASSERT_EQ(a.world.sinks.size(), b.world.sinks.size());
  for (std::size_t i = 0; i < a.world.sinks.size(); ++i)
    EXPECT_EQ(bits(*a.world.sinks[i].shape), bits(*b.world.sinks[i].shape));
  ASSERT_EQ(a.fluidBlocks.size(), b.fluidBlocks.size());
  for (std::size_t i = 0; i < a.fluidBlocks.size(); ++i) {
    EXPECT_EQ(bits(a.fluidBlocks[i].positions), bits(b.fluidBlocks[i].positions));
    EXPECT_EQ(bits(a.fluidBlocks[i].velocities), bits(b.fluidBlocks[i].velocities));
  }
  ASSERT_EQ(a.bulletBlocks.size(), b.bulletBlocks.size());
  for (std::size_t i = 0; i < a.bulletBlocks.size(); ++i)
    EXPECT_EQ(bits(a.bulletBlocks[i].positions), bits(b.bulletBlocks[i].positions));
  ASSERT_EQ(a.gauges.size(), b.gauges.size());
  for (std::size_t i = 0; i < a.gauges.size(); ++i) {
    EXPECT_EQ(a.gauges[i].name + a.gauges[i].type + a.gauges[i].body,
              b.gauges[i].name + b.gauges[i].type + b.gauges[i].body);
    EXPECT_EQ(bits(a.gauges[i].every) + bits(a.gauges[i].at) + bits(a.gauges[i].x) + bits(a.gauges[i].quantile),
              bits(b.gauges[i].every) + bits(b.gauges[i].at) + bits(b.gauges[i].x) + bits(b.gauges[i].quantile));
    EXPECT_EQ(a.gauges[i].species, b.gauges[i].species);
  }
  EXPECT_EQ(bits(a.output.every) + bits(a.output.checkpoint), bits(b.output.every) + bits(b.output.checkpoint));
  EXPECT_EQ(a.output.h5, b.output.h5);
  EXPECT_EQ(a.output.image.range, b.output.image.range);
  EXPECT_EQ(bits(a.output.image.view.min), bits(b.output.image.view.min));
}

const std::string kEverything = R"toml(format = 1
title = "a \"title\" with \\ and ümlaut"
seed = 77
duration = 1.3
gravity = [0.1, "-9.81*(1 + 0.1*sin(t))"]
[domain]
box = [-0.3, 0.0, 2.0, 1.1]
walls = ["left", "bottom"]
wall_slip = "free"
[model]
spacing = 0.0173
time_step = 1e-3
courant = 0.3
sweeps = 7
viscosity_solver = "implicit"
[fluid]
density = 998.2
contact_angle = 61.7
[[fluid.block]]
shape = { polygon = [[0, 0], [0.7, 0.1], [0.71, 0.55], [0.3, 0.9]], holes = [[[0.3, 0.3], [0.4, 0.3], [0.37, 0.41]]] }
velocity = ["sin(2*pi*x)", 0.25]
[[fluid.block]]
shape = { box = [0.55, 0.0, 1.2, 0.6] }
[bullet]
radius = 0.0031
group = 4
[[bullet.block]]
shape = { regular = { sides = 7, radius = 0.9 } }
count = 137
velocity = [0.0, -5.0]
[[emitter]]
kind = "bullet"
from = [0.4, 0.95]
to = [0.2, 0.95]
speed = 2.0
rate = 33.3
spread = 12.3
lifetime = 0.7
policy = "grow"
[[sink]]
shape = { box = [1.8, 0.0, 2.0, 0.2] }
[[body]]
name = "peg"
shape = { regular = { sides = 5, radius = 0.0371 } }
position = [0.9, 0.07]
angle = 3.3
slip = "free"
repeat = { count = [5, 3], step = [[0.11, 0.003], [0.0, 0.17]], turn = 5.729577951308232 }
[[body]]
name = "wedge"
origin = "centroid"
shape = { polygon = [[0, 0], [0.1, 0.5], [0.2, 0]] }
position = [1.6, 0.5]
angle = 17.1
motion = "scripted"
surface_velocity = 0.3
script = [{ until = 0.7, velocity = ["0.1*sin(t)", 0.0], spin = 0.33 }, { until = 1.1, spin = "t^2" }]
[[gauge]]
name = "f"
type = "force"
body = "peg.7"
every = 0.01
[[gauge]]
name = "c"
type = "count"
species = "bullet"
[output]
every = 0.033
frames = ["h5"]
png = { range = [0.1, 0.7] }
)toml";

TEST(SceneResolved, alone_it_gives_the_same_definitions_and_particles_bit_for_bit) {
  const scene::Scene given = loadText(kEverything);
  EXPECT_GT(given.fluidParticles(), 500u);
  expectSame(given, loadText(given.resolved));
}

TEST(SceneResolved, what_was_set_on_the_command_line_is_part_of_it) {
  const scene::Scene given =
      loadText(kEverything, {{"model.spacing", "0.021"}, {"body.wedge.angle", "33.3"}, {"seed", "78"}});
  const scene::Scene again = loadText(given.resolved);
  EXPECT_EQ(again.world.fluid->spacing, 0.021);
  expectSame(given, again);
}

TEST(SceneResolved, resolving_it_again_changes_nothing) {
  const std::string once = loadText(kEverything).resolved;
  EXPECT_EQ(loadText(once).resolved, once);
}

TEST(SceneResolved, copies_are_written_out_and_defaults_are_explicit) {
  const std::string resolved = loadText(kEverything).resolved;
  for (const char* text : {"name = \"peg.14\"", "fluid = \"pbf\"", "checkpoint = 60.0", "friction = 0.3",
                           "motion = \"fixed\"", "\"sin(2*pi*x)\"", "width = 1280", "viscosity = 1e-06"})
    EXPECT_NE(resolved.find(text), std::string::npos) << text;
  for (const char* text : {"repeat", "regular", "box = [1.8", "centroid"})
    EXPECT_EQ(resolved.find(text), std::string::npos) << text;
}

TEST(SceneResolved, its_world_has_the_same_state_after_some_steps) {
  const scene::Scene given = loadText(kEverything), again = loadText(given.resolved);
  World a = scene::makeWorld(given), b = scene::makeWorld(again);
  EXPECT_EQ(a.fluid()->size(), given.fluidParticles());
  EXPECT_EQ(a.bullets()->size(), given.bulletCount());
  EXPECT_EQ(a.stateHash(), b.stateHash());
  const std::string start = a.stateHash();
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(a.substep().ok());
    EXPECT_TRUE(b.substep().ok());
  }
  EXPECT_EQ(a.stateHash(), b.stateHash());
  EXPECT_NE(a.stateHash(), start);
}

const std::string kFree = kHead + R"toml([[body]]
name = "box"
shape = { box = [-0.051, -0.05, 0.05, 0.05] }
position = [0.3, 0.3]
angle = 7.7
motion = "free"
density = 333.3
velocity = [0.1, -0.2]
spin = 1.7
repeat = { count = [3, 2], step = [[0.21, 0.003], [0.0, 0.21]], turn = 11.3 }
[[body]]
name = "wheel"
shape = { polygon = [[0, 0], [0.1, 0.01], [0.02, 0.1]] }
position = [1.3, 0.2]
angle = -13.1
motion = "free"
spin = 3.3
hinge = { at = [1.33, 0.21], motor = { speed = 2.1, torque = 50.7 } }
repeat = { count = [2, 3], step = [[0.31, 0.0], [0.0, 0.23]], turn = 17.7 }
[[body]]
name = "door"
shape = { box = [0, 0, 0.02, 0.2] }
position = [0.1, 0.05]
motion = "free"
hinge = { at = [0.11, 0.25] }
)toml";

TEST(SceneResolved, free_bodies_hinges_and_motors_are_in_it) {
  const scene::Scene given = loadText(kFree);
  ASSERT_EQ(given.world.bodies.size(), 13u);
  ASSERT_TRUE(given.world.bodies[9].hinge && given.world.bodies[9].hinge->motor);
  const scene::Scene again = loadText(given.resolved);
  expectSame(given, again);
  EXPECT_EQ(again.resolved, given.resolved);
  for (const char* text : {"motion = \"free\"", "density = 333.3", "torque = 50.7", "hinge"})
    EXPECT_NE(given.resolved.find(text), std::string::npos) << text;
  EXPECT_EQ(given.resolved.find("-0.0,"), std::string::npos);
}

TEST(SceneResolved, copies_share_one_shape_again) {
  const scene::Scene again = loadText(loadText(kEverything).resolved);
  EXPECT_EQ(again.world.bodies.at(0).shape, again.world.bodies.at(14).shape);
  EXPECT_NE(again.world.bodies.at(0).shape, again.world.bodies.at(15).shape);
}

TEST(SceneResolved, scenes_of_the_house_survive_it) {
  for (const char* name : {"dam_break", "still_tank", "sieve"}) {
    SCOPED_TRACE(name);
    const scene::Scene given = scene::load(std::string(FROUDE_SOURCE_DIR) + "/scenes/" + name + ".toml");
    expectSame(given, loadText(given.resolved));
  }
}

}  // namespace
}  // namespace froude
