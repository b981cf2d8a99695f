// [[soft]]: what a scene says of bodies that deform, what is refused with its place, what is doubtful.
#include <gtest/gtest.h>

#include <algorithm>

#include "program/scene_support.h"
#include "scene/material_point.h"

namespace froude {
namespace {

using froude::testing::kHead;
using froude::testing::loadText;
using froude::testing::refusal;

// Five lines; the next is 10.
const std::string kJelly =
    kHead + "[[soft]]\nname = \"jelly\"\nshape = { box = [0.5, 0.2, 1.0, 0.7] }\nspacing = 0.1\nyoung = 1.0e6\n";

TEST(SceneSoft, a_box_becomes_a_mesh_with_the_keys_of_the_file) {
  const scene::Scene s = loadText(kJelly +
                                  "model = \"stvk\"\nposition = [0.1, 0.05]\nangle = 10.0\nvelocity = [1, 2]\n"
                                  "spin = 3.0\ndensity = 500.0\npoisson = 0.3\ndamping = 4.0\nfriction = 0.7\n"
                                  "strain_limit = 0.5\npressure = 20.0\ngroup = 4\ncollides_with = 6\n");
  ASSERT_EQ(s.world.soft.size(), 1u);
  const SoftDef& def = s.world.soft[0];
  EXPECT_EQ(def.name, "jelly");
  EXPECT_EQ(def.model, SoftModel::StVenantKirchhoff);
  EXPECT_EQ(def.position, Vec2(0.1, 0.05));
  EXPECT_NEAR(def.angle, kPi / 18.0, 1e-15);
  EXPECT_EQ(def.velocity, Vec2(1, 2));
  EXPECT_EQ(def.spin, 3.0);
  EXPECT_EQ(def.spacing, 0.1);
  EXPECT_EQ(def.density, 500.0);
  EXPECT_EQ(def.young, 1.0e6);
  EXPECT_EQ(def.poisson, 0.3);
  EXPECT_EQ(def.damping, 4.0);
  EXPECT_EQ(def.friction, 0.7);
  EXPECT_EQ(def.strainLimit, 0.5);
  EXPECT_EQ(def.pressure, 20.0);
  EXPECT_EQ(def.group, 4u);
  EXPECT_EQ(def.collidesWith, 6u);
  EXPECT_TRUE(def.pinned.empty());
  double area = 0.0;
  for (const auto& t : def.mesh->triangles)
    area +=
        0.5 * cross(def.mesh->points[t[1]] - def.mesh->points[t[0]], def.mesh->points[t[2]] - def.mesh->points[t[0]]);
  EXPECT_NEAR(area, 0.25, 1e-12);
  EXPECT_EQ(s.softPoints(), def.mesh->points.size());
}

TEST(SceneSoft, a_rope_is_cut_into_links_of_about_the_spacing_and_keeps_its_corners) {
  const scene::Scene s = loadText(kHead +
                                  "[[soft]]\nname = \"rope\"\npath = [[0.2, 0.5], [1.2, 0.5], [1.2, 0.9]]\n"
                                  "thickness = 0.02\nspacing = 0.1\npin = { box = [0.1, 0.4, 0.25, 0.6] }\n");
  const SoftDef& def = s.world.soft.at(0);
  EXPECT_EQ(def.model, SoftModel::Rope);
  EXPECT_EQ(def.thickness, 0.02);
  ASSERT_EQ(def.mesh->points.size(), 15u);
  ASSERT_EQ(def.mesh->outline.size(), 14u);
  EXPECT_TRUE(def.mesh->triangles.empty());
  for (std::uint32_t i = 0; i < 14; ++i) EXPECT_EQ(def.mesh->outline[i], (std::array<std::uint32_t, 2>{i, i + 1}));
  EXPECT_EQ(def.mesh->points[10], Vec2(1.2, 0.5));
  EXPECT_NEAR((def.mesh->points[4] - Vec2(0.6, 0.5)).norm(), 0.0, 1e-15);
  EXPECT_EQ(def.pinned, std::vector<std::uint32_t>{0});
}

TEST(SceneSoft, pins_hold_the_points_in_one_shape_or_in_several_the_boundary_included) {
  const scene::Scene one = loadText(kJelly + "pin = { box = [0.4, 0.2, 0.5, 0.7] }\n");
  const SoftDef& def = one.world.soft[0];
  EXPECT_GE(def.pinned.size(), 5u);
  for (const std::uint32_t i : def.pinned) EXPECT_EQ(def.mesh->points[i].x(), 0.5);
  const auto onSide =
      std::count_if(def.mesh->points.begin(), def.mesh->points.end(), [](const Vec2& p) { return p.x() == 0.5; });
  EXPECT_EQ(static_cast<std::size_t>(onSide), def.pinned.size());
  const scene::Scene two =
      loadText(kJelly + "pin = [{ box = [0.4, 0.2, 0.5, 0.7] }, { box = [1.0, 0.2, 1.1, 0.7] }]\n");
  EXPECT_EQ(two.world.soft[0].pinned.size(), 2 * def.pinned.size());
}

TEST(SceneSoft, copies_share_one_mesh_also_after_the_resolved_scene_is_read_again) {
  const scene::Scene first =
      loadText(kHead +
               "[[soft]]\nname = \"disc\"\nshape = { regular = { sides = 64, radius = 0.1 } }\nposition = [0.3, 0.5]\n"
               "spacing = 0.04\nyoung = 1.0e6\npin = { box = [-0.2, -0.2, 0.2, -0.05] }\n"
               "repeat = { count = [3, 2], step = [[0.3, 0.0], [0.0, 0.25]], turn = 5.0 }\n");
  ASSERT_EQ(first.world.soft.size(), 6u);
  EXPECT_EQ(first.world.soft[4].name, "disc.4");
  EXPECT_NEAR((first.world.soft[4].position - Vec2(0.6, 0.75)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(first.world.soft[4].angle, 20.0 * kPi / 180.0, 1e-15);
  EXPECT_EQ(first.notes.size(), 1u) << "the outline is coarsened, said once";
  const scene::Scene again = loadText(first.resolved);
  ASSERT_EQ(again.world.soft.size(), 6u);
  EXPECT_TRUE(again.notes.empty());
  for (std::size_t i = 0; i < 6; ++i) {
    const SoftDef &a = first.world.soft[i], &b = again.world.soft[i];
    SCOPED_TRACE(a.name);
    EXPECT_EQ(a.mesh, first.world.soft[0].mesh);
    EXPECT_EQ(b.mesh, again.world.soft[0].mesh);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.mesh->points, b.mesh->points);
    EXPECT_EQ(a.mesh->triangles, b.mesh->triangles);
    EXPECT_EQ(a.pinned, b.pinned);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.angle, b.angle);
  }
  EXPECT_EQ(first.resolved.substr(first.resolved.find('\n')), again.resolved.substr(again.resolved.find('\n')));
}

TEST(SceneSoft, an_exact_outline_keeps_every_vertex) {
  const std::string disc =
      kHead +
      "[[soft]]\nshape = { regular = { sides = 96, radius = 0.2 } }\nposition = [1.0, 0.5]\nspacing = 0.05\n"
      "young = 1.0e6\n";
  EXPECT_LT(loadText(disc).world.soft[0].mesh->outline.size(), 50u);
  const scene::Scene exact = loadText(disc + "outline = \"exact\"\n");
  EXPECT_EQ(exact.world.soft[0].mesh->outline.size(), 96u);
  EXPECT_TRUE(exact.notes.empty());
}

TEST(SceneSoft, drawings_are_filled_too) {
  const froude::testing::SceneFile file(
      kHead + "[[soft]]\nname = \"ring\"\nshape = { svg = { file = \"" + std::string(FROUDE_SOURCE_DIR) +
      "/tests/data/soft_ring.svg\", scale = 0.01 } }\nposition = [0.5, 0.8]\nspacing = 0.02\nyoung = 1.0e6\n");
  const scene::Scene s = scene::load(file.path());
  const TriangleMesh& mesh = *s.world.soft.at(0).mesh;
  double area = 0.0;
  for (const auto& t : mesh.triangles)
    area += 0.5 * cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
  // A ring of radii 0.3 and 0.15.
  EXPECT_NEAR(area, kPi * (0.09 - 0.0225), 0.01 * kPi * (0.09 - 0.0225));
}

TEST(SceneSoft, fluid_is_not_seeded_into_soft_bodies_or_ropes) {
  const scene::Scene s =
      loadText(kHead +
               "[model]\nspacing = 0.02\n[fluid]\ndensity = 1000.0\n[[fluid.block]]\nshape = { box = "
               "[0.0, 0.0, 2.0, 0.8] }\n[[soft]]\nname = \"jelly\"\nshape = { box = [0.5, 0.2, 1.0, "
               "0.7] }\nspacing = 0.05\nyoung = 1.0e6\n[[soft]]\nname = \"rope\"\npath = [[1.2, 0.2], "
               "[1.8, 0.6]]\nthickness = 0.04\nspacing = 0.05\n");
  EXPECT_GT(s.fluidBlocks[0].cut, 600u);
  const Box grown = Box{{0.5, 0.2}, {1.0, 0.7}}.grown(0.0099);
  for (const Vec2& p : s.fluidBlocks[0].positions) {
    EXPECT_FALSE(grown.contains(p));
    const Vec2 along = Vec2(0.6, 0.4).normalized(), from = p - Vec2(1.2, 0.2);
    const double t = from.dot(along);
    if (t > 0.0 && t < Vec2(0.6, 0.4).norm()) {
      EXPECT_GE(std::abs(cross(along, from)), 0.0299);
    }
  }
}

struct Refusal {
  std::string text, begins, holds;
};

TEST(SceneSoft, refusals_name_place_key_and_what_is_right) {
  const std::string rope = kHead + "[[soft]]\nname = \"r\"\n";  // the next line is 7
  for (const Refusal& r : std::vector<Refusal>{
           {kHead + "[[soft]]\nname = \"jelly\"\n", "5:1: soft.jelly.shape: is missing", "box"},
           {kJelly + "poisson = 0.5\n", "10:11: soft.jelly.poisson: is 0.5", "below 0.5"},
           {kJelly + "poisson = -0.1\n", "10:11: soft.jelly.poisson: is -0.1", "from 0"},
           {kJelly + "young = 0\n", "10:9: TOML", ""},
           {kJelly + "density = 0\n", "10:11: soft.jelly.density: is 0", "above 0"},
           {kJelly + "damping = -1\n", "10:11: soft.jelly.damping: is -1", "from 0"},
           {kJelly + "model = \"neohooke\"\n", "10:9: soft.jelly.model: is \"neohooke\"", "\"neo-hookean\""},
           {kJelly + "colour = 1\n", "10:1: soft.jelly.colour: unknown key", "nearest"},
           {kJelly + "path = [[0, 0], [1, 1]]\n", "7:1: soft.jelly.shape: a rope has none", "path"},
           {kJelly + "thickness = 0.1\n", "10:1: soft.jelly.thickness: belongs to ropes", "\"rope\""},
           {kJelly + "model = \"rope\"\n", "7:1: soft.jelly.shape: a rope has none", ""},
           {kJelly + "pin = { box = [0, 0, 0.3, 0.1] }\n", "10:7: soft.jelly.pin: holds no point of the body",
            "own coordinates"},
           {kJelly + "pin = []\n", "10:7: soft.jelly.pin: is an empty list", ""},
           {kJelly + "pin = [{ box = [0.4, 0, 0.6, 1] }, { box = [0.4, 0, 0.55, 1] }]\n",
            "10:36: soft.jelly.pin: holds only points that an earlier one holds", ""},
           {kJelly + "pin = { bax = [0, 0, 0.3, 0.1] }\n", "10:9: soft.jelly.pin.bax: unknown key", "\"box\""},
           {kJelly + "repeat = { count = [2], step = [[0.1, 0.0], [1, 1]] }\n", "10:32: soft.jelly.repeat.step", ""},
           {kJelly + "[[soft]]\nname = \"jelly\"\nshape = { box = [0, 0, 0.1, 0.1] }\nyoung = 1.0e7\n",
            "11:8: soft.jelly.name: \"jelly\" is taken", "own"},
           {kJelly + "position = [3, 0]\n", "10:12: soft.jelly.position: jelly lies wholly outside the domain", ""},
           {kJelly + "position = [1.2, 0]\n", "7:9: soft.jelly.position: reaches 0.2 m beyond the domain's right side",
            "within the domain"},
           {kJelly + "[[body]]\nname = \"peg\"\nshape = { box = [0.9, 0.3, 1.5, 0.6] }\n",
            "7:9: soft.jelly.position: overlaps body.peg by 0.1 m", "pins"},
           {kHead + "[[soft]]\nshape = { box = [0, 0, 1, 1] }\nspacing = 1e-7\n",
            "7:11: soft.0.spacing: makes 1.15e+14 points", "right is a larger one"},
           {kHead + "[[soft]]\nshape = { polygon = [[0, 0], [1, 0], [1, 0.05]] }\nspacing = 0.05\n",
            "6:9: soft.0.shape: a triangle near", "2.86 degrees"},
           {rope + "path = [[0, 0]]\n", "7:8: soft.r.path: right are at least two points", ""},
           {rope + "path = [[0, 0], [0, 0]]\nthickness = 0.1\n", "7:17: soft.r.path: holds the same point twice", ""},
           {rope + "path = [[0, 0.5], [1, 0.5]]\n", "5:1: soft.r.thickness: is missing", "above 0"},
           {rope + "path = [[0, 0.5], [1, 0.5]]\nthickness = 0.1\npressure = 1\n",
            "9:1: soft.r.pressure: a rope has none", ""},
           {"format = 1\nduration = 1.0\n[domain]\nbox = [0.0, 0.0, 2.0, 1.0]\nperiodic = [\"x\"]\n[[soft]]\nshape = { "
            "box = [0.5, 0.2, 1.0, 0.7] }\nspacing = 0.1\nyoung = 1e6\n",
            "7:9: soft.soft0.position: soft bodies among periodic sides", "walls"},
       }) {
    const std::string what = refusal(r.text);
    EXPECT_EQ(what.substr(0, r.begins.size()), r.begins) << what;
    EXPECT_NE(what.find(r.holds), std::string::npos) << what;
  }
}

TEST(SceneSoft, gauges_name_their_body_and_a_point_of_it) {
  const std::string gauge = kJelly + "[[gauge]]\nname = \"g\"\n";  // the next line is 12
  const scene::Scene s = loadText(gauge +
                                  "type = \"tip\"\nsoft = \"jelly\"\nat = [1.0, 0.45]\n[[gauge]]\nname = \"a\"\n"
                                  "type = \"area\"\nsoft = \"jelly\"\n[[gauge]]\nname = \"e\"\ntype = \"energy\"\n"
                                  "species = \"soft\"\n");
  EXPECT_EQ(s.gauges.at(0).soft, "jelly");
  EXPECT_EQ(s.gauges[0].at, Vec2(1.0, 0.45));
  EXPECT_EQ(s.gauges.at(2).species, Species::Soft);
  for (const Refusal& r : std::vector<Refusal>{
           {gauge + "type = \"tip\"\nsoft = \"jely\"\nat = [1.0, 0.45]\n",
            "13:8: gauge.g.soft: \"jely\" names no soft body", "\"jelly\""},
           {gauge + "type = \"tip\"\nsoft = \"jelly\"\nat = [1.5, 0.45]\n",
            "14:6: gauge.g.at: [1.5, 0.45] is 0.5 m outside of \"jelly\"", "[1, 0.45]"},
           {gauge + "type = \"tip\"\nsoft = \"jelly\"\n", "10:1: gauge.g.at: is missing", ""},
           {gauge + "type = \"area\"\nsoft = \"jelly\"\nat = [1, 1]\n",
            "14:1: gauge.g.at: a gauge of type area takes only soft", ""},
           {kHead + "[[gauge]]\nname = \"g\"\ntype = \"area\"\nsoft = \"b\"\n",
            "8:8: gauge.g.soft: ", "the scene has none"},
           {kHead + "[[gauge]]\nname = \"g\"\ntype = \"mass\"\nspecies = \"soft\"\n",
            "8:11: gauge.g.species: ", "no such particles"},
       }) {
    const std::string what = refusal(r.text);
    EXPECT_EQ(what.substr(0, r.begins.size()), r.begins) << what;
    EXPECT_NE(what.find(r.holds), std::string::npos) << what;
  }
}

/// The lines of all warnings.
std::string warnings(const std::string& text) {
  std::string lines;
  for (const scene::Warning& warning : loadText(text).warnings) lines += warning.key + ": " + warning.text + "\n";
  return lines;
}

TEST(SceneSoft, what_runs_but_is_probably_not_meant_is_said) {
  EXPECT_EQ(warnings(kJelly), "");
  EXPECT_NE(warnings(kHead + "[[soft]]\nshape = { box = [0.2, 0.2, 1.2, 0.3] }\nspacing = 0.05\nyoung = 1e6\n")
                .find("soft.soft0.spacing: puts about 1.8 triangles across the body"),
            std::string::npos);
  const std::string bullets = "[[bullet.block]]\nshape = { box = [0.0, 0.0, 0.3, 0.3] }\ncount = 3\n";
  EXPECT_NE(
      warnings(kJelly + bullets).find("soft.jelly.collides_with: soft bodies and bullets pass through each other"),
      std::string::npos);
  EXPECT_EQ(warnings(kJelly + "collides_with = 2\n" + bullets), "");
  EXPECT_NE(warnings(kJelly + "poisson = 0.499\n").find("soft.jelly.poisson: is above 0.49"), std::string::npos);
  EXPECT_NE(warnings(kHead + "[[soft]]\nname = \"slack\"\nshape = { box = [0.5, 0.2, 1.0, 0.7] }\nspacing = 0.1\n"
                             "young = 1.0e3\n")
                .find("soft.slack.young: lets the body sag by a strain of about 4.9"),
            std::string::npos);
  EXPECT_NE(warnings(kJelly + "pin = { box = [0, 0, 2, 1] }\n").find("soft.jelly.pin: holds every point"),
            std::string::npos);
  const std::string pair = "repeat = { count = [2], step = [[0.3, 0.1]] }\n";
  EXPECT_NE(warnings(kJelly + pair).find("soft.jelly.0.position: overlaps soft.jelly.1 at the start, by about 0.2 m"),
            std::string::npos);
  EXPECT_EQ(warnings(kJelly + pair + "collides_with = 2\n"), "") << "filters let them pass";
}

TEST(SceneSoft, a_material_point_moves_with_its_triangle) {
  const scene::Scene s = loadText(kJelly);
  const TriangleMesh& mesh = *s.world.soft[0].mesh;
  for (const Vec2& place : {Vec2(0.5, 0.2), Vec2(0.77, 0.41), Vec2(0.93, 0.7), Vec2(1.0, 0.33)}) {
    const scene::MaterialPoint point(mesh, place);
    EXPECT_LT(point.distance, 1e-15);
    const auto sheared = [](const Vec2& p) { return Vec2(2.0 * p.x() + 0.3 * p.y() + 1.0, p.y() - 0.1 * p.x()); };
    const Vec2 moved = point.at([&](std::uint32_t i) { return sheared(mesh.points[i]); });
    EXPECT_NEAR((moved - sheared(place)).norm(), 0.0, 1e-14);
  }
  const scene::MaterialPoint outside(mesh, Vec2(1.5, 0.45));
  EXPECT_NEAR(outside.distance, 0.5, 1e-15);
  EXPECT_NEAR((outside.nearest - Vec2(1.0, 0.45)).norm(), 0.0, 1e-15);
}

}  // namespace
}  // namespace froude
