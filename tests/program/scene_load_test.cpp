// What a scene says arrives in the definitions: units, defaults, copies, expressions, seeded particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "program/scene_support.h"
#include "scene/document.h"
#include "scene/expression.h"
#include "scene/sha256.h"

namespace froude {
namespace {

using froude::testing::kFluid;
using froude::testing::kHead;
using froude::testing::loadText;
using froude::testing::refusal;
using froude::testing::SceneFile;

TEST(SceneLoad, left_out_keys_have_their_documented_defaults) {
  const scene::Scene s = loadText(kHead +
                                  "[[fluid.block]]\nshape = { box = [0, 0, 1, 0.5] }\n[[bullet.block]]\ncount = 3\n"
                                  "shape = { box = [1, 0, 2, 1] }\n[[body]]\nshape = { box = [1.5, 0, 1.6, 0.1] }\n");
  const WorldDef& w = s.world;
  EXPECT_EQ(s.title, "");
  EXPECT_EQ(w.seed, 1u);
  EXPECT_EQ(w.gravity, Vec2(0.0, -9.81));
  EXPECT_FALSE(w.gravityField);
  EXPECT_EQ(w.domain.closed, (std::array<bool, 4>{true, true, true, true}));
  EXPECT_EQ(w.domain.slip, Slip::Free);
  ASSERT_TRUE(w.fluid);
  EXPECT_EQ(w.fluid->model, "pbf");
  EXPECT_EQ(w.fluid->spacing, 0.01);  // a hundredth of the larger side of the largest block
  EXPECT_EQ(w.fluid->density, 1000.0);
  EXPECT_EQ(w.fluid->viscosity, 1e-6);
  EXPECT_DOUBLE_EQ(w.fluid->contactAngle, kPi / 2);
  EXPECT_EQ(w.fluid->sweeps, 0);
  EXPECT_EQ(w.fluid->courant, 0.0);
  EXPECT_EQ(w.fluid->viscositySolver, ViscositySolver::Auto);
  EXPECT_FALSE(w.timeStep);
  ASSERT_TRUE(w.bullet);
  EXPECT_EQ(w.bullet->radius, 0.002);
  EXPECT_EQ(w.bullet->restitution, 0.5);
  ASSERT_EQ(w.bodies.size(), 1u);
  EXPECT_EQ(w.bodies[0].name, "body0");
  EXPECT_EQ(w.bodies[0].motion, Motion::Fixed);
  EXPECT_EQ(w.bodies[0].friction, 0.3);
  EXPECT_EQ(w.bodies[0].restitution, 0.1);
  EXPECT_EQ(w.bodies[0].density, 1000.0);
  EXPECT_FALSE(w.bodies[0].slip);
  EXPECT_EQ(w.bodies[0].group, 1u);
  EXPECT_EQ(w.bodies[0].collidesWith, 0xFFFFFFFFu);
  EXPECT_EQ(s.output.every, 0.02);
  EXPECT_TRUE(s.output.h5 && s.output.png && !s.output.vdb);
  EXPECT_EQ(s.output.checkpoint, 60.0);
  EXPECT_EQ(s.output.image.width, 1280);
  EXPECT_EQ(s.output.image.view.max, Vec2(2.0, 1.0));
  EXPECT_FALSE(s.output.image.range);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(SceneLoad, a_scene_of_bullets_has_no_fluid_and_says_what_was_left_unused) {
  const scene::Scene s =
      loadText(kHead + "[fluid]\ndensity = 900.0\n[[bullet.block]]\ncount = 3\nshape = { box = [0, 0, 1, 1] }\n");
  EXPECT_FALSE(s.world.fluid);
  EXPECT_TRUE(s.world.bullet);
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_NE(s.notes[0].find("no fluid is modelled"), std::string::npos);
}

TEST(SceneLoad, angles_are_degrees_in_the_file_and_radians_in_the_definitions) {
  const scene::Scene s =
      loadText(kHead +
               "[fluid]\ncontact_angle = 60\n[[fluid.block]]\nshape = { box = [0, 0, 1, 1] }\n"
               "[[body]]\nshape = { box = [-0.1, -0.1, 0.1, 0.1] }\nposition = [1.5, 0.5]\nangle = 30\n"
               "[[emitter]]\nkind = \"bullet\"\nfrom = [1.9, 0.5]\nto = [1.8, 0.5]\nspeed = 1\nrate = 10\n"
               "spread = 45\n");
  EXPECT_DOUBLE_EQ(s.world.fluid->contactAngle, kPi / 3);
  EXPECT_DOUBLE_EQ(s.world.bodies[0].angle, kPi / 6);
  EXPECT_DOUBLE_EQ(s.world.emitters[0].spread, kPi / 4);
}

TEST(SceneLoad, walls_and_periodic_sides) {
  const auto closed = [](const std::string& lines) { return loadText(kHead + lines).world.domain.closed; };
  EXPECT_EQ(closed("walls = false\n"), (std::array<bool, 4>{false, false, false, false}));
  EXPECT_EQ(closed("walls = [\"bottom\", \"left\"]\n"), (std::array<bool, 4>{true, false, true, false}));
  EXPECT_EQ(closed("periodic = [\"x\"]\n"), (std::array<bool, 4>{false, false, true, true}));
  EXPECT_EQ(closed("walls = []\n"), (std::array<bool, 4>{false, false, false, false}));
  EXPECT_TRUE(loadText(kHead + "periodic = [\"y\"]\n").world.domain.periodicY);
  EXPECT_EQ(loadText(kHead + "wall_slip = \"free\"\n").world.domain.slip, Slip::Free);
  EXPECT_EQ(loadText(kHead + "wall_slip = \"no\"\n").world.domain.slip, Slip::NoSlip);
}

TEST(SceneLoad, gravity_is_constant_or_a_field) {
  const std::string head = "format = 1\nduration = 1\ngravity = GRAVITY\n[domain]\nbox = [0, 0, 1, 1]\n";
  const auto with = [&](const std::string& gravity) {
    std::string text = head;
    return loadText(text.replace(text.find("GRAVITY"), 7, gravity)).world;
  };
  EXPECT_EQ(with("[1, \"-9.81\"]").gravity, Vec2(1.0, -9.81));
  EXPECT_FALSE(with("[0, \"-2*pi\"]").gravityField);
  const WorldDef field = with("[\"-4*x + t\", \"-4*y^2\"]");
  ASSERT_TRUE(field.gravityField);
  EXPECT_EQ(field.gravityField(Vec2(0.5, 3.0), 0.25), Vec2(-1.75, -36.0));
}

TEST(SceneLoad, an_expression_gives_each_thread_its_own_value) {
  const scene::Expression e("sin(x) + t*y", "xyt");
  std::vector<std::thread> threads;
  std::vector<int> wrong(7, 0);
  for (int k = 0; k < 7; ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < 2000; ++i) {
        const double x = 0.01 * i + k, t = 0.5 * k;
        if (std::abs(e.evaluate(x, 2.0, t) - (std::sin(x) + 2.0 * t)) > 1e-15) ++wrong[static_cast<std::size_t>(k)];
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(7, 0));
}

TEST(SceneLoad, an_expression_knows_the_error_function) {
  // M. Abramowitz and I.A. Stegun, "Handbook of Mathematical Functions", 1964, Table 7.1.
  EXPECT_NEAR(scene::Expression("erf(x)", "x").evaluate(0.5, 0.0, 0.0), 0.5204998778, 1e-10);
  EXPECT_NEAR(scene::Expression("erf(-2*t)", "t").evaluate(0.0, 0.0, 0.5), -0.8427007929, 1e-10);
  EXPECT_TRUE(scene::Expression("1 + erf(0)", "t").isConstant());
}

TEST(SceneLoad, copies_go_first_index_fastest_and_turn_each_a_little_further) {
  const scene::Scene s = loadText(kHead +
                                  "[[body]]\nname = \"peg\"\nshape = { regular = { sides = 8, radius = 0.03 } }\n"
                                  "position = [0.2, 0.1]\nangle = 5\n"
                                  "repeat = { count = [4, 3], step = [[0.3, 0.01], [0.0, 0.25]], turn = 2.5 }\n");
  ASSERT_EQ(s.world.bodies.size(), 12u);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i) {
      const BodyDef& body = s.world.bodies[static_cast<std::size_t>(4 * j + i)];
      EXPECT_EQ(body.name, "peg." + std::to_string(4 * j + i));
      EXPECT_NEAR(body.position.x(), 0.2 + 0.3 * i, 1e-15);
      EXPECT_NEAR(body.position.y(), 0.1 + 0.01 * i + 0.25 * j, 1e-15);
      EXPECT_NEAR(body.angle, (5.0 + 2.5 * (4 * j + i)) * kPi / 180.0, 1e-15);
    }
}

TEST(SceneLoad, an_origin_at_the_centroid_moves_the_shape) {
  const std::string body =
      "[[body]]\nshape = { polygon = [[0, 0], [0.3, 0], [0, 0.3]] }\nposition = [1, 0.5]\norigin = ";
  EXPECT_NEAR(loadText(kHead + body + "\"own\"\n").world.bodies[0].shape->centroid().x(), 0.1, 1e-15);
  EXPECT_NEAR(loadText(kHead + body + "\"centroid\"\n").world.bodies[0].shape->centroid().norm(), 0.0, 1e-15);
}

TEST(SceneLoad, a_script_has_numbers_and_expressions_in_t) {
  const scene::Scene s =
      loadText(kHead +
               "[[body]]\nname = \"piston\"\nmotion = \"scripted\"\nshape = { box = [0, 0, 0.1, 1] }\n"
               "script = [{ until = 0.5, velocity = [0.2, \"sin(t)\"] }, { until = 2, spin = \"3*t\" }]\n");
  const auto& script = s.world.bodies[0].script;
  ASSERT_EQ(script.size(), 2u);
  EXPECT_EQ(script[0].until, 0.5);
  EXPECT_EQ(script[0].velocityX(0.1), 0.2);
  EXPECT_DOUBLE_EQ(script[0].velocityY(0.1), std::sin(0.1));
  EXPECT_EQ(script[0].spin(0.1), 0.0);
  EXPECT_EQ(script[1].velocityX(0.1), 0.0);
  EXPECT_EQ(script[1].spin(1.5), 4.5);
}

TEST(SceneLoad, fluid_stands_on_its_lattice_with_its_velocities) {
  const scene::Scene s = loadText(kHead +
                                  "[model]\nspacing = 0.1\n[[fluid.block]]\nshape = { box = [0.2, 0, 0.7, 0.4] }\n"
                                  "velocity = [\"x*y\", -1]\n");
  ASSERT_EQ(s.fluidParticles(), 20u);
  std::size_t k = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 5; ++i, ++k) {
      const Vec2 p = s.fluidBlocks[0].positions[k], v = s.fluidBlocks[0].velocities[k];
      EXPECT_NEAR(p.x(), 0.2 + (i + 0.5) * 0.1, 1e-15);
      EXPECT_NEAR(p.y(), (j + 0.5) * 0.1, 1e-15);
      EXPECT_EQ(v, Vec2(p.x() * p.y(), -1.0));
    }
  EXPECT_TRUE(s.notes.empty());
}

// Oracle: the distance of a point to a turned rectangle, written here from its own coordinates.
double distanceToRectangle(const Vec2& p, const Vec2& center, double angle, const Vec2& half) {
  const Vec2 d = p - center;
  const Vec2 local(std::cos(angle) * d.x() + std::sin(angle) * d.y(),
                   -std::sin(angle) * d.x() + std::cos(angle) * d.y());
  const Vec2 outside(std::max(std::abs(local.x()) - half.x(), 0.0), std::max(std::abs(local.y()) - half.y(), 0.0));
  return outside.norm() > 0.0 ? outside.norm()
                              : std::max(std::abs(local.x()) - half.x(), std::abs(local.y()) - half.y());
}

TEST(SceneLoad, fluid_is_cut_around_bodies_walls_and_earlier_blocks) {
  const scene::Scene s =
      loadText(kHead +
               "[model]\nspacing = 0.02\n[[fluid.block]]\nshape = { box = [0, 0, 1, 1] }\n"
               "[[fluid.block]]\nshape = { box = [0.51, -0.5, 2.5, 0.75] }\n"
               "[[body]]\nname = \"bar\"\nshape = { box = [-0.2, -0.05, 0.2, 0.05] }\nposition = [1.0, 0.4]\n"
               "angle = 30\n");
  const double dx = 0.02;
  std::vector<Vec2> all = s.fluidBlocks[0].positions;
  all.insert(all.end(), s.fluidBlocks[1].positions.begin(), s.fluidBlocks[1].positions.end());
  for (const Vec2& p : all) {
    EXPECT_GE(distanceToRectangle(p, {1.0, 0.4}, kPi / 6, {0.2, 0.05}), 0.5 * dx * (1 - 1e-5));
    EXPECT_TRUE(p.x() > 0.49 * dx && p.x() < 2.0 - 0.49 * dx && p.y() > 0.49 * dx && p.y() < 1.0 - 0.49 * dx);
  }
  double nearest = kInfinity;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, (all[i] - all[k]).norm());
  EXPECT_GE(nearest, 0.9 * dx);
  // What lies free is filled: count the lattice of the first block by the same oracle.
  std::size_t expected = 0;
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 50; ++i)
      expected += distanceToRectangle({(i + 0.5) * dx, (j + 0.5) * dx}, {1.0, 0.4}, kPi / 6, {0.2, 0.05}) >= 0.5 * dx;
  EXPECT_EQ(s.fluidBlocks[0].positions.size(), expected);
  EXPECT_EQ(s.fluidBlocks[0].cut, 2500 - expected);
  ASSERT_EQ(s.notes.size(), 2u);
  EXPECT_NE(s.notes[0].find("fluid.block.0: " + std::to_string(expected) + " particles placed, " +
                            std::to_string(2500 - expected) + " places cut"),
            std::string::npos)
      << s.notes[0];
}

TEST(SceneLoad, blocks_that_abut_and_a_body_flush_with_the_fluid_cut_nothing) {
  const scene::Scene s =
      loadText(kHead +
               "[model]\nspacing = 0.01\n[[fluid.block]]\nshape = { box = [0.1, 0.1, 0.8, 0.6] }\ncut = false\n"
               "[[fluid.block]]\nshape = { box = [0.8, 0.1, 1.9, 0.6] }\ncut = false\n"
               "[[body]]\nshape = { box = [0, 0, 2, 0.1] }\n[[body]]\nshape = { box = [0, 0.1, 0.1, 1] }\n"
               "[[body]]\nshape = { box = [0, -0.5, 0.1, 0.5] }\nposition = [2.4, 0.1]\nangle = 90\n");
  EXPECT_EQ(s.fluidParticles(), 180u * 50u);
}

TEST(SceneLoad, a_body_that_fluid_passes_through_cuts_nothing) {
  const scene::Scene s = loadText(kHead +
                                  "[model]\nspacing = 0.1\n[[fluid.block]]\nshape = { box = [0, 0, 1, 1] }\n"
                                  "[[body]]\nshape = { box = [0.2, 0.2, 0.8, 0.8] }\ncollides_with = 2\n");
  EXPECT_EQ(s.fluidParticles(), 100u);
}

TEST(SceneLoad, bullets_stand_at_random_inside_the_shape_and_outside_of_bodies) {
  const std::string text = kHead +
                           "[bullet]\nradius = 0.01\n[[bullet.block]]\ncount = 2000\nshape = { box = [0, 0, 1, 1] }\n"
                           "[[bullet.block]]\ncount = 2000\nshape = { box = [0, 0, 1, 1] }\nvelocity = [0, -5]\n"
                           "[[body]]\nshape = { box = [-0.2, -0.05, 0.2, 0.05] }\nposition = [0.5, 0.5]\nangle = 30\n";
  const scene::Scene s = loadText(text);
  ASSERT_EQ(s.bulletCount(), 4000u);
  for (const Vec2& p : s.bulletBlocks[0].positions) {
    EXPECT_GE(distanceToRectangle(p, {0.5, 0.5}, kPi / 6, {0.2, 0.05}), 0.01 * (1 - 1e-5));
    EXPECT_TRUE(p.x() >= 0.0099 && p.x() <= 1.0 && p.y() >= 0.0099 && p.y() <= 0.9901);
  }
  EXPECT_EQ(s.bulletBlocks[1].velocities[7], Vec2(0.0, -5.0));
  EXPECT_NE(s.bulletBlocks[0].positions[0], s.bulletBlocks[1].positions[0]);
  EXPECT_EQ(loadText(text).bulletBlocks[1].positions, s.bulletBlocks[1].positions);
  EXPECT_NE(loadText("seed = 2\n" + text).bulletBlocks[0].positions, s.bulletBlocks[0].positions);
}

TEST(SceneLoad, gauges_and_output_arrive) {
  const scene::Scene s =
      loadText(kHead + kFluid +
               "[[gauge]]\nname = \"p\"\ntype = \"pressure\"\nat = [0.5, 0.1]\nwindow = 0.2\nevery = 0.01\n"
               "[[gauge]]\nname = \"f\"\ntype = \"front\"\naxis = \"y\"\nquantile = 0.9\n"
               "[[gauge]]\nname = \"u\"\ntype = \"profile\"\nfrom = [0, 0]\nto = [1, 0.5]\ncount = 11\n"
               "[[gauge]]\nname = \"e\"\ntype = \"energy\"\nspecies = \"fluid\"\n"
               "[output]\nevery = 0.05\nframes = [\"png\"]\ncheckpoint = 5\n"
               "png = { width = 640, view = [0, 0, 1, 1], color = \"pressure\", range = [0, 100] }\n");
  ASSERT_EQ(s.gauges.size(), 4u);
  EXPECT_EQ(s.gauges[0].at, Vec2(0.5, 0.1));
  EXPECT_EQ(s.gauges[0].window, 0.2);
  EXPECT_EQ(s.gauges[0].every, 0.01);
  EXPECT_EQ(s.gauges[1].axis, 'y');
  EXPECT_EQ(s.gauges[1].quantile, 0.9);
  EXPECT_EQ(s.gauges[1].every, 0.05);  // that of the frames
  EXPECT_EQ(s.gauges[2].count, 11);
  EXPECT_EQ(s.gauges[2].to, Vec2(1.0, 0.5));
  EXPECT_EQ(s.gauges[3].species, Species::Fluid);
  EXPECT_TRUE(s.output.png && !s.output.h5);
  EXPECT_EQ(s.output.image.width, 640);
  EXPECT_EQ(s.output.image.color, "pressure");
  EXPECT_EQ(*s.output.image.range, (std::array<double, 2>{0.0, 100.0}));
}

TEST(SceneLoad, emitters_and_sinks_arrive) {
  const scene::Scene s =
      loadText(kHead +
               "[[emitter]]\nkind = \"fluid\"\nfrom = [0.4, 0.5]\nto = [0.2, 0.5]\nspeed = 2\nstop = 1\n"
               "lifetime = 5\nlimit = 100\npolicy = \"recycle-oldest\"\n"
               "[[sink]]\nshape = { box = [1, 0, 1.5, 0.5] }\n");
  ASSERT_EQ(s.world.emitters.size(), 1u);
  const EmitterDef& e = s.world.emitters[0];
  EXPECT_EQ(e.kind, EmitterDef::Kind::Fluid);
  EXPECT_EQ(e.stop, 1.0);
  EXPECT_EQ(e.lifetime, 5.0);
  EXPECT_EQ(e.limit, 100u);
  EXPECT_EQ(e.policy, GrowthPolicy::RecycleOldest);
  ASSERT_TRUE(s.world.fluid);
  EXPECT_DOUBLE_EQ(s.world.fluid->spacing, 0.01);  // a twentieth of the nozzle
  ASSERT_EQ(s.world.sinks.size(), 1u);
  EXPECT_DOUBLE_EQ(s.world.sinks[0].shape->area(), 0.25);
}

TEST(SceneLoad, repairs_of_polygons_are_said) {
  const scene::Scene s =
      loadText(kHead + "[[body]]\nname = \"gate\"\nshape = { polygon = [[0, 0], [0, 1], [1, 1], [1, 1], [1, 0]] }\n");
  ASSERT_FALSE(s.notes.empty());
  EXPECT_EQ(s.notes[0].rfind("body.gate.shape: ", 0), 0u) << s.notes[0];
  EXPECT_DOUBLE_EQ(s.world.bodies[0].shape->area(), 1.0);
}

TEST(SceneLoad, warnings_say_what_runs_but_is_probably_not_meant) {
  const auto warnings = [](const std::string& more) {
    std::string all;
    for (const scene::Warning& w : loadText(kHead + more).warnings) all += w.line().substr(w.place.file.size()) + "\n";
    return all;
  };
  const std::string fluid = "[model]\nspacing = 0.05\n[[fluid.block]]\nshape = { box = [0, 0, 1, 1] }\n";
  EXPECT_EQ(warnings(fluid), "");
  // √(2 · 9.81 · 0.975) = 4.37 m/s; two spacings are 0.1 m.
  EXPECT_EQ(warnings("[model]\nspacing = 0.05\ntime_step = 0.0228\n[[fluid.block]]\nshape = { box = [0, 0, 1, 1] }\n"),
            "");
  EXPECT_EQ(warnings("[model]\nspacing = 0.05\ntime_step = 0.0232\n[[fluid.block]]\nshape = { box = [0, 0, 1, 1] }\n")
                .rfind(":7:13: model.time_step: warning: ", 0),
            0u);
  EXPECT_EQ(warnings(fluid + "[[body]]\nname = \"a\"\nshape = { box = [1.2, 0, 1.24, 1] }\n")
                .rfind(":11:9: body.a.shape: ", 0),
            0u);
  EXPECT_EQ(warnings(fluid + "[[body]]\nname = \"a\"\nshape = { box = [1.2, 0, 1.26, 1] }\n"), "");
  EXPECT_NE(warnings(fluid + "[[body]]\nname = \"a\"\nshape = { box = [1.2, 0, 1.4, 0.98] }\n")
                .find("gap of 0.02 m to the domain's top"),
            std::string::npos);
  EXPECT_NE(warnings(fluid + "[[body]]\nname = \"a\"\nshape = { box = [1.2, 0, 1.4, 0.5] }\n[[body]]\nname = \"b\"\n"
                             "shape = { box = [1.43, 0, 1.6, 0.5] }\n")
                .find("gap of 0.03 m to body.b"),
            std::string::npos);
  EXPECT_EQ(warnings(fluid + "[[body]]\nname = \"a\"\nshape = { box = [1.2, 0, 1.4, 0.5] }\n[[body]]\nname = \"b\"\n"
                             "shape = { box = [1.4, 0, 1.6, 0.5] }\n"),
            "");
  EXPECT_NE(warnings(fluid + "[[body]]\nname = \"a\"\nshape = { box = [0.2, 0, 1, 1] }\n").find("are taken by bodies"),
            std::string::npos);
}

TEST(SceneLoad, the_nearest_word_is_found_by_edits_and_swaps) {
  EXPECT_EQ(scene::nearest("denisty", {"motion", "density", "friction"}), "density");
  EXPECT_EQ(scene::nearest("colour", {"range", "color", "view"}), "color");
  EXPECT_EQ(scene::nearest("x", {}), "");
}

TEST(SceneLoad, sha256_gives_the_known_answers) {
  EXPECT_EQ(scene::sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(scene::sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace froude
