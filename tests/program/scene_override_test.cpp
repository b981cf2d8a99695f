// --set PATH=VALUE: what it changes, and what it refuses.
#include <gtest/gtest.h>

#include "program/scene_support.h"

namespace froude {
namespace {

using froude::testing::kFluid;
using froude::testing::kHead;
using froude::testing::loadText;
using froude::testing::refusal;

const std::string kScene = kHead + kFluid +
                           "[[body]]\nname = \"gate\"\nshape = { box = [1.5, 0, 1.6, 0.2] }\n"
                           "[[body]]\nname = \"peg\"\nshape = { box = [0, 0, 0.02, 0.2] }\nposition = [1.8, 0.5]\n"
                           "repeat = { count = [2], step = [[0.05, 0.1]] }\n";

TEST(SceneOverride, a_dotted_path_changes_what_the_file_says) {
  EXPECT_EQ(loadText(kScene, {{"model.spacing", "0.05"}}).world.fluid->spacing, 0.05);
  EXPECT_EQ(loadText(kScene, {{"duration", "3"}}).duration, 3.0);
  EXPECT_EQ(loadText(kScene, {{"gravity", "[0, \"-9.81*t\"]"}}).world.gravityField(Vec2(0, 0), 2.0).y(), -19.62);
  EXPECT_EQ(loadText(kScene, {{"gravity.1", "-1.5"}, {"gravity", "[1, 2]"}}).world.gravity, Vec2(1, 2));
}

TEST(SceneOverride, a_key_or_table_that_the_file_leaves_out_is_made) {
  EXPECT_EQ(loadText(kScene, {{"model.time_step", "1e-3"}}).world.timeStep, 1e-3);
  EXPECT_EQ(loadText(kScene, {{"output.png.width", "320"}}).output.image.width, 320);
  EXPECT_FALSE(loadText(kScene, {{"output.frames", "[]"}}).output.png);
}

TEST(SceneOverride, tables_of_an_array_are_named_by_index_or_by_name) {
  EXPECT_NEAR(loadText(kScene, {{"body.gate.angle", "9"}}).world.bodies[0].angle, kPi / 20, 1e-15);
  EXPECT_NEAR(loadText(kScene, {{"body.0.angle", "9"}}).world.bodies[0].angle, kPi / 20, 1e-15);
  EXPECT_EQ(loadText(kScene, {{"fluid.block.0.velocity", "[1, 0]"}}).fluidBlocks[0].velocities[3], Vec2(1, 0));
  EXPECT_EQ(loadText(kScene, {{"body.peg.repeat.count", "[3]"}}).world.bodies.size(), 4u);
}

TEST(SceneOverride, a_name_may_hold_dots) {
  const std::string resolved = loadText(kScene).resolved;
  EXPECT_EQ(loadText(resolved, {{"body.peg.1.friction", "0.9"}}).world.bodies[2].friction, 0.9);
}

TEST(SceneOverride, a_bare_word_is_a_string_and_a_quoted_one_too) {
  EXPECT_EQ(loadText(kScene, {{"output.png.color", "pressure"}}).output.image.color, "pressure");
  EXPECT_EQ(loadText(kScene, {{"output.png.color", "\"pressure\""}}).output.image.color, "pressure");
  EXPECT_EQ(loadText(kScene, {{"title", "C:\\x y"}}).title, "C:\\x y");
}

TEST(SceneOverride, later_ones_win_and_all_are_checked_like_the_file) {
  EXPECT_EQ(loadText(kScene, {{"model.fluid", "dfsph"}}).world.fluid->model, "dfsph");
  EXPECT_EQ(loadText(kScene, {{"seed", "4"}, {"seed", "5"}}).world.seed, 5u);
  EXPECT_EQ(refusal(kScene, {{"model.spacing", "-1"}}).rfind("0:0: model.spacing: is -1", 0), 0u);
  EXPECT_EQ(refusal(kScene, {{"model.fluid", "mpm"}}).rfind("0:0: model.fluid: is \"mpm\"", 0), 0u);
  EXPECT_EQ(refusal(kScene, {{"duration", "long"}}).rfind("0:0: duration: is a string", 0), 0u);
}

TEST(SceneOverride, a_path_that_names_nothing_is_refused_with_the_nearest) {
  const auto of = [](const std::string& path, const std::string& value) { return refusal(kScene, {{path, value}}); };
  EXPECT_NE(of("body.gate.angel", "3").find("body.gate.angel: unknown key, the nearest is \"angle\""),
            std::string::npos);
  EXPECT_NE(of("modle.spacing", "3").find("modle: unknown key, the nearest is \"model\""), std::string::npos);
  EXPECT_NE(of("body.gat.angle", "3")
                .find("\"gat\" names no element, right is an index from 0 to 1 or a name, the nearest is \"gate\""),
            std::string::npos);
  EXPECT_NE(of("body.7.angle", "3").find("names no element"), std::string::npos);
  EXPECT_NE(of("fluid.block.velocity", "[0, 1]").find("names no element"), std::string::npos);
  EXPECT_NE(of("duration.x", "3").find("a number, which has no keys"), std::string::npos);
  EXPECT_NE(of("", "3").find("--set: not a path"), std::string::npos);
  EXPECT_NE(of("a..b", "3").find("--set: not a path"), std::string::npos);
  EXPECT_NE(of(".a", "3").find("--set: not a path"), std::string::npos);
  EXPECT_NE(of("seed.", "3").find("--set: not a path"), std::string::npos);
}

TEST(SceneOverride, a_value_cannot_smuggle_in_more) {
  for (const std::string value : {"", "3\nduration = 9", "[1, 2", "\"open", "{ a = 1", "\xFF"}) {
    SCOPED_TRACE(value);
    EXPECT_NE(refusal(kScene, {{"seed", value}}).find("is no TOML value"), std::string::npos);
  }
}

}  // namespace
}  // namespace froude
