// Shapes and points as they are named on a command line.
#include <gtest/gtest.h>

#include "program/scene_support.h"
#include "scene/point_table.h"
#include "scene/shape_argument.h"

namespace froude {
namespace {

using froude::testing::SceneFile;

/// "LINE:COLUMN: key: …" of the refusal, without the file; "accepted" if there is none.
std::string shapeRefusal(const std::string& text, const std::string& name, const std::string& id = {}) {
  const SceneFile file(text, name);
  try {
    scene::readShapeArgument(file.path() + id, {});
  } catch (const scene::SceneError& error) {
    const std::string what = error.what();
    if (what.rfind(file.path(), 0) != 0) return "the message does not begin with the file: " + what;
    return what.substr(file.path().size() + 1);
  }
  return "accepted";
}

void expectRefusal(const std::string& said, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(said.find(part), std::string::npos) << part << " in: " << said;
}

TEST(ShapeArgument, a_file_with_one_shape_is_that_shape) {
  const SceneFile file("# a box\nshape = { box = [0, 0, 2, 0.5] }\n", "box.toml");
  const scene::ShapeArgument shape = scene::readShapeArgument(file.path(), {});
  EXPECT_DOUBLE_EQ(shape.polygon.area(), 1.0);
  EXPECT_EQ(shape.name, "box.toml");
  EXPECT_TRUE(shape.notes.empty());
}

TEST(ShapeArgument, refusals_name_line_and_column) {
  expectRefusal(shapeRefusal("shape = { bix = [0, 0, 1, 1] }\n", "a.toml"),
                {"1:", "unknown key", "nearest is \"box\""});
  expectRefusal(shapeRefusal("\nshape = { polygon = [[0, 0], [1, 1], [1, 0], [0, 1]] }\n", "a.toml"),
                {"2:21: shape.polygon"});
  expectRefusal(shapeRefusal("shap = { box = [0, 0, 1, 1] }\n", "a.toml"), {"1:1: shap", "nearest is \"shape\""});
  expectRefusal(shapeRefusal("shape = {\n", "a.toml"), {"not a TOML document"});
  expectRefusal(shapeRefusal("0,0\n1,0\n1,x\n", "a.csv"), {"3:3: y", "\"x\" is not a number"});
  expectRefusal(shapeRefusal("0,0\n1,0\n", "a.csv"), {"polygon"});
  expectRefusal(shapeRefusal("0,0\n1,0\n0,2e9\n", "a.csv"), {"3:3: y", "1e+09"});
  expectRefusal(shapeRefusal("shape", "a.txt"), {"FILE.toml", "FILE.csv", "FILE.svg#ID"});
  expectRefusal(shapeRefusal("0,0\n1,0\n0,1\n", "a.csv", "#b"), {"no names in it"});
  expectRefusal(shapeRefusal("shape = { box = [0, 0, 1, 1] }\n", "a.toml", "#gate"), {"one shape and no bodies"});
  expectRefusal(shapeRefusal("shape = { box = [0, 0, 1, 1] }\n", "a.toml", "#"), {"nothing stands behind the #"});
}

const std::string kBodies =
    froude::testing::kHead +
    "[[body]]\nname = \"gate\"\nshape = { box = [0, 0, 0.1, 0.5] }\nposition = [1.0, 0.2]\nangle = 30\n"
    "[[body]]\nname = \"peg\"\norigin = \"centroid\"\nposition = [0.2, 0.2]\n"
    "shape = { polygon = [[1, 1], [1.1, 1], [1.1, 1.1], [1, 1.1], [1, 1]] }\n"
    "repeat = { count = [3], step = [[0.2, 0.0]] }\n";

TEST(ShapeArgument, a_body_of_a_scene_is_told_in_its_own_frame) {
  const SceneFile file(kBodies, "scene.toml");
  const scene::ShapeArgument gate = scene::readShapeArgument(file.path() + "#gate", {});
  EXPECT_EQ(gate.polygon.bounds().max, Vec2(0.1, 0.5));
  EXPECT_EQ(gate.name, "scene.toml#gate");
  EXPECT_TRUE(gate.notes.empty());
  const scene::ShapeArgument peg = scene::readShapeArgument(file.path() + "#peg.2", {});
  EXPECT_NEAR(peg.polygon.centroid().norm(), 0.0, 1e-15);
  ASSERT_EQ(peg.notes.size(), 1u);
  EXPECT_NE(peg.notes[0].find("repeats"), std::string::npos);
}

TEST(ShapeArgument, a_scene_without_a_name_lists_its_bodies) {
  expectRefusal(shapeRefusal(kBodies, "scene.toml"), {"1:1: shape", "this is a scene", "gate, peg"});
  expectRefusal(shapeRefusal(kBodies, "scene.toml", "#gaet"), {"no body is called \"gaet\"", "nearest is \"gate\""});
}

TEST(ShapeArgument, a_table_may_close_its_ring) {
  const SceneFile file("\xEF\xBB\xBFx,y\r\n0,0\r\n\r\n# corner\r\n1, 0\r\n+1,1e0\r\n0,0\r\n", "v.csv");
  const scene::ShapeArgument shape = scene::readShapeArgument(file.path(), {});
  EXPECT_DOUBLE_EQ(shape.polygon.area(), 0.5);
  EXPECT_EQ(shape.notes.size(), 1u);
}

TEST(PointTable, reads_what_spreadsheets_write) {
  const SceneFile file("\"x\",\"y\"\n-0.5,\t1e-3\n\n  3 , 4", "p.csv");
  const std::vector<Vec2> points = scene::readPoints(file.path(), 1e9);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0], Vec2(-0.5, 1e-3));
  EXPECT_EQ(points[1], Vec2(3.0, 4.0));
  const SceneFile empty("", "p.csv");
  EXPECT_TRUE(scene::readPoints(empty.path(), 1e9).empty());
}

TEST(PointTable, refuses_rows_with_their_place) {
  const auto refusal = [](const std::string& text) -> std::string {
    const SceneFile file(text, "p.csv");
    try {
      scene::readPoints(file.path(), 1e9);
    } catch (const scene::SceneError& error) {
      return std::string(error.what()).substr(file.path().size() + 1);
    }
    return "accepted";
  };
  expectRefusal(refusal("x,y\n1,2\n3;4\n"), {"3:1: row", "has 1 cell", "x,y"});
  expectRefusal(refusal("1,2,3\n"), {"1:5: row", "has 3 cells"});
  expectRefusal(refusal("1,\n"), {"1:3: y", "\"\" is not a number"});
  expectRefusal(refusal("1,nan\n"), {"1:3: y", "is nan"});
  expectRefusal(refusal("1,1e999\n"), {"1:3: y", "beyond all doubles"});
  expectRefusal(refusal("1,2\nx,y\n"), {"2:1: x", "\"x\" is not a number"});
  expectRefusal(refusal("y,x\n1,2\n"), {"1:1: header", "right is x,y"});
}

}  // namespace
}  // namespace froude
