// Shapes from drawings: every kind of outline against its closed form, curves against their tolerance, and every way in
// which a drawing can be wrong.
#include <gtest/gtest.h>

#include <cmath>

#include <froude/base/random.h>

#include "program/scene_support.h"
#include "scene/svg_drawing.h"

namespace froude {
namespace {

using froude::testing::kHead;
using froude::testing::SceneFile;
using scene::DrawingError;
using scene::svgPolygonOf;

const std::string kOpen = "<svg xmlns=\"http://www.w3.org/2000/svg\">\n";

Polygon drawn(const std::string& body, double tolerance = 0.0, const std::string& id = "",
              std::vector<std::string>* notes = nullptr, double scale = 1.0) {
  return svgPolygonOf(kOpen + body + "</svg>", "a.svg", id, scale, tolerance, notes);
}

std::string refused(const std::string& body, const std::string& id = "", double scale = 1.0) {
  try {
    drawn(body, 0.0, id, nullptr, scale);
  } catch (const DrawingError& error) {
    return error.what();
  }
  return "accepted";
}

void expectBox(const Polygon& polygon, double left, double bottom, double right, double top, double error = 0.0) {
  EXPECT_NEAR(polygon.bounds().min.x(), left, error);
  EXPECT_NEAR(polygon.bounds().min.y(), bottom, error);
  EXPECT_NEAR(polygon.bounds().max.x(), right, error);
  EXPECT_NEAR(polygon.bounds().max.y(), top, error);
}

std::string path(const std::string& d, const std::string& more = "") {
  return "<path d=\"" + d + "\" " + more + "/>\n";
}

TEST(SvgDrawing, y_points_up_and_vertices_keep_their_coordinates_to_the_bit) {
  const Polygon triangle = drawn(path("M0.1 -0.3 L0.7 -0.3 L0.1 -0.9 Z"));
  ASSERT_EQ(triangle.edgeCount(), 3u);
  expectBox(triangle, 0.1, 0.3, 0.7, 0.9);
  EXPECT_TRUE(triangle.contains({0.2, 0.7}));
  EXPECT_FALSE(triangle.contains({0.6, 0.7}));
  expectBox(drawn(path("M1 2 H3 V5 H1 Z"), 0.0, "", nullptr, 0.25), 0.25, -1.25, 0.75, -0.5);
}

TEST(SvgDrawing, every_command_of_a_path_draws_what_it_should_absolute_and_relative) {
  // The same outline, 12 x 6 with a quarter circle of radius 2 taken off, in absolute and in relative commands.
  const double area = 72.0 - (4.0 - kPi);
  for (const char* d : {"M0 0 L12 0 V4 A2 2 0 0 1 10 6 H0 Z", "m0 0 l12 0 v4 a2 2 0 0 1 -2 2 h-10 z",
                        "M0,0 12,0 12,4A2,2,0,0,1,10,6L0 6z", "m0 0 12 0 0 4a2 2 0 01-2 2h-10"}) {
    SCOPED_TRACE(d);
    const Polygon polygon = drawn(path(d), 1e-6);
    expectBox(polygon, 0, -6, 12, 0, 1e-12);
    EXPECT_NEAR(polygon.area(), area, 1e-5);
  }
  // ∫ of quadratic and cubic arches: 2/3 and 3/5 … of the control polygon's boxes, by Green's theorem.
  EXPECT_NEAR(drawn(path("M0 0 Q3 6 6 0 Z"), 1e-6).area(), 2.0 / 3.0 * 6.0 * 3.0, 1e-5);
  EXPECT_NEAR(drawn(path("m0 0 q3 6 6 0 z"), 1e-6).area(), 12.0, 1e-5);
  EXPECT_NEAR(drawn(path("M0 0 C0 4 6 4 6 0 Z"), 1e-6).area(), 0.6 * 6.0 * 4.0, 1e-5);
  EXPECT_NEAR(drawn(path("m0 0 c0 4 6 4 6 0 z"), 1e-6).area(), 14.4, 1e-5);
  // T and S mirror the control point before them: the second arch hangs down as the first stands up.
  EXPECT_NEAR(drawn(path("M0 0 Q3 6 6 0 T12 0 V-9 H0 Z"), 1e-6).area(), 108.0, 1e-4);
  EXPECT_NEAR(drawn(path("M0 0 q3 6 6 0 t6 0 v-9 h-12 z"), 1e-6).area(), 108.0, 1e-4);
  EXPECT_NEAR(drawn(path("M0 0 C0 4 6 4 6 0 S12 -4 12 0 V-9 H0 Z"), 1e-6).area(), 108.0, 1e-4);
  EXPECT_NEAR(drawn(path("M0 0 c0 4 6 4 6 0 s6 -4 6 0 v-9 h-12 z"), 1e-6).area(), 108.0, 1e-4);
  // Arcs: the larger one, one with radii that are too small (a half circle), one that is turned by 90 degrees and goes
  // nearly round: clockwise on the page and with its gap below.
  EXPECT_NEAR(drawn(path("M1 0 A1 1 0 1 1 0 -1 Z"), 1e-6).area(), 0.75 * kPi + 0.5, 1e-5);
  EXPECT_NEAR(drawn(path("M0 0 A0.1 0.1 0 0 1 4 0 Z"), 1e-6).area(), 2.0 * kPi, 1e-5);
  expectBox(drawn(path("M0 0 A3 1 90 1 1 0.001 0 Z"), 1e-6), -0.9995, 0, 1.0005, 6, 1e-3);
  // A subpath goes on where the last one was closed.
  EXPECT_NEAR(drawn(path("M1 1 h4 v4 h-4 z h-1 v1 h1 z")).area(), 17.0, 1e-12);
}

TEST(SvgDrawing, basic_shapes_have_the_area_and_the_box_of_their_closed_forms) {
  expectBox(drawn("<rect x=\"0.1\" y=\"-0.7\" width=\"2\" height=\"0.5\"/>"), 0.1, 0.7 - 0.5, 2.1, 0.7, 1e-15);
  const Polygon rounded = drawn("<rect width=\"10\" height=\"6\" rx=\"2\" ry=\"1\"/>", 1e-6);
  EXPECT_NEAR(rounded.area(), 60.0 - (4.0 - kPi) * 2.0, 1e-5);
  expectBox(rounded, 0, -6, 10, 0, 1e-12);
  EXPECT_NEAR(drawn("<rect width=\"10\" height=\"6\" rx=\"2\"/>", 1e-6).area(), 60.0 - (4.0 - kPi) * 4.0, 1e-5);
  EXPECT_NEAR(drawn("<rect width=\"4\" height=\"2\" rx=\"9\" ry=\"9\"/>", 1e-6).area(), 2.0 * kPi, 1e-5);
  EXPECT_NEAR(drawn("<circle cx=\"3\" cy=\"4\" r=\"2\"/>", 1e-6).area(), 4.0 * kPi, 1e-5);
  EXPECT_NEAR((drawn("<circle cx=\"3\" cy=\"4\" r=\"2\"/>", 1e-6).centroid() - Vec2(3, -4)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(drawn("<ellipse cx=\"1\" rx=\"5\" ry=\"2\"/>", 1e-6).area(), 10.0 * kPi, 3e-5);
  EXPECT_EQ(drawn("<polygon points=\"0,0 4,0 4,3\"/>").area(), 6.0);
  EXPECT_EQ(drawn("<polyline points=\"0 0 4 0 4 3\"/>").area(), 6.0);
  EXPECT_NEAR(drawn("<rect width=\"1in\" height=\"25.4mm\"/>").area(), 96.0 * 96.0, 1e-6);
}

TEST(SvgDrawing, transforms_of_nested_groups_are_those_of_the_plane) {
  const std::string unit = "<rect id=\"u\" width=\"2\" height=\"1\"/>";
  expectBox(drawn("<g transform=\"translate(5 7)\"><g transform=\"scale(2 3)\">" + unit + "</g></g>"), 5, -10, 9, -7);
  expectBox(drawn("<g transform=\"translate(5 7) scale(2 3)\">" + unit + "</g>"), 5, -10, 9, -7);
  expectBox(drawn("<g transform=\"rotate(90)\">" + unit + "</g>"), -1, -2, 0, 0, 1e-15);
  expectBox(drawn("<g transform=\"rotate(90 2 0)\">" + unit + "</g>"), 1, 0, 2, 2, 1e-15);
  expectBox(drawn("<g transform=\"matrix(0 1 -1 0 0 0)\">" + unit + "</g>"), -1, -2, 0, 0);
  const Polygon skewed = drawn("<g transform=\"skewX(45)\">" + unit + "</g>");
  expectBox(skewed, 0, -1, 3, 0, 1e-15);
  EXPECT_NEAR(skewed.area(), 2.0, 1e-14);
  expectBox(drawn("<g transform=\"skewY(45)\">" + unit + "</g>"), 0, -3, 2, 0, 1e-15);
  // Chosen by its id an element stays where its groups have put it.
  expectBox(drawn("<g transform=\"translate(5 7)\"><g transform=\"scale(2 3)\">" + unit + "</g></g>", 0, "u"), 5, -10,
            9, -7);
  // A circle under a shear is an ellipse of the same area.
  EXPECT_NEAR(drawn("<g transform=\"skewX(60)\"><circle r=\"1\"/></g>", 1e-6).area(), kPi, 1e-5);
}

TEST(SvgDrawing, a_use_draws_its_element_again_where_it_says) {
  const std::string defs = "<defs><rect id=\"u\" width=\"2\" height=\"1\"/></defs>";
  expectBox(drawn(defs + "<use href=\"#u\" x=\"3\" y=\"1\" transform=\"scale(2)\"/>"), 6, -4, 10, -2);
  expectBox(
      drawn("<defs><rect id=\"u\" width=\"2\" height=\"1\"/></defs><g xmlns:xlink=\"http://www.w3.org/1999/xlink\">"
            "<use xlink:href=\"#u\"/></g>"),
      0, -1, 2, 0);
  EXPECT_NE(refused("<g id=\"a\"><use href=\"#a\"/></g>").find("in a ring"), std::string::npos);
  EXPECT_NE(refused("<use href=\"other.svg#a\"/>").find("same drawing"), std::string::npos);
  EXPECT_NE(refused("<symbol id=\"s\"/><use href=\"#s\"/>").find("uses the <symbol>"), std::string::npos);
}

TEST(SvgDrawing, uses_of_uses_do_not_multiply_without_bound) {
  std::string body = "<defs><rect id=\"u0\" width=\"2\" height=\"1\"/>";
  for (int i = 1; i < 40; ++i) {
    const std::string before = "<use href=\"#u" + std::to_string(i - 1) + "\"/>";
    body += "<g id=\"u" + std::to_string(i) + "\">" + before + before + "</g>";
  }
  EXPECT_NE(refused(body + "</defs><use href=\"#u39\"/>").find("more than 100000 elements"), std::string::npos);
}

TEST(SvgDrawing, fill_rules_are_kept_wherever_they_are_written) {
  const std::string nested = "M0 0 H6 V6 H0 Z M2 2 H4 V4 H2 Z";  // both clockwise
  EXPECT_EQ(drawn(path(nested)).area(), 36.0);
  EXPECT_EQ(drawn(path(nested, "fill-rule=\"evenodd\"")).area(), 32.0);
  EXPECT_EQ(drawn(path(nested, "style=\"fill:#abc; fill-rule : evenodd\"")).area(), 32.0);
  EXPECT_EQ(drawn("<g fill-rule=\"evenodd\">" + path(nested) + "</g>").area(), 32.0);
  EXPECT_EQ(drawn("<g fill-rule=\"evenodd\">" + path(nested, "style=\"fill-rule:nonzero\"") + "</g>").area(), 36.0);
  EXPECT_EQ(drawn(path(nested, "fill-rule=\"nonzero\" style=\"fill-rule:evenodd\"")).area(), 32.0);
  EXPECT_EQ(drawn(path("M0 0 H6 V6 H0 Z M2 2 V4 H4 V2 Z")).area(), 32.0) << "the other way round is a hole";
  EXPECT_EQ(drawn(path(nested, "fill-rule=\"evenodd\"")).ringStarts().size(), 3u);
}

TEST(SvgDrawing, overlapping_elements_are_united_and_crossing_points_are_said) {
  std::vector<std::string> notes;
  const Polygon cross = drawn(
      "<rect x=\"-3\" y=\"-1\" width=\"6\" height=\"2\"/><rect x=\"-1\" y=\"-3\" width=\"2\" "
      "height=\"6\"/>",
      0.0, "", &notes);
  EXPECT_EQ(cross.edgeCount(), 12u);
  EXPECT_NEAR(cross.area(), 20.0, 1e-7);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("4 of these points lie on a lattice of"), std::string::npos) << notes[0];
  // Beside each other, with a common side: one outline.
  notes.clear();
  const Polygon wall =
      drawn("<rect width=\"0.3\" height=\"0.7\"/><rect x=\"0.3\" width=\"0.1\" height=\"0.7\"/>", 0.0, "", &notes);
  EXPECT_EQ(wall.edgeCount(), 4u);
  expectBox(wall, 0.0, -0.7, 0.4, 0.0);
  EXPECT_TRUE(notes.empty());
}

TEST(SvgDrawing, what_crosses_itself_is_filled_by_its_rule) {
  // A pentagram of circumradius 1: the area of its points and of its middle, by closed form.
  std::string star = "M";
  for (int i = 0; i < 5; ++i)
    star += std::to_string(std::cos(0.8 * kPi * i)) + " " + std::to_string(std::sin(0.8 * kPi * i)) + " ";
  const double inner = 1.0 / std::pow((1.0 + std::sqrt(5.0)) / 2.0, 2);  // circumradius of the pentagon inside
  const double whole = 5.0 * inner * std::sin(0.2 * kPi);
  EXPECT_NEAR(drawn(path(star + "Z")).area(), whole, 1e-5);
  EXPECT_NE(refused(path(star + "Z", "fill-rule=\"evenodd\"")).find("5 separate outlines"), std::string::npos);
}

TEST(SvgDrawing, hidden_unfilled_and_described_elements_are_left_out_and_said) {
  std::vector<std::string> notes;
  const std::string square = "<rect id=\"r\" width=\"1\" height=\"1\"/>\n";
  const std::string body = square + "<rect x=\"5\" width=\"1\" height=\"1\" fill=\"none\"/>\n" +
                           "<g style=\"display:none\">" + square + "</g><g visibility=\"hidden\">" +
                           path("M7 7 h1 v1z") + "</g><text>words</text><line x2=\"3\"/><image/>" +
                           "<clipPath><circle r=\"9\"/></clipPath><linearGradient/><title>t</title>";
  EXPECT_EQ(drawn(body, 0.0, "", &notes).area(), 1.0);
  std::string all;
  for (const std::string& note : notes) all += note + "\n";
  for (const char* said :
       {"a.svg: fill=\"none\" encloses no area and was left out (line 3)", "display=\"none\" was left out (line 4)",
        "visibility=\"hidden\"", "<text> has no outline", "<line> has no outline", "<image> has no outline"})
    EXPECT_NE(all.find(said), std::string::npos) << said << "\n" << all;
  EXPECT_EQ(notes.size(), 6u) << all;
  // Asked for by its id, what is hidden is meant.
  EXPECT_EQ(drawn("<g display=\"none\"><rect id=\"h\" width=\"2\" height=\"2\"/></g>", 0.0, "h").area(), 4.0);
}

TEST(SvgDrawing, the_true_size_of_a_drawing_that_states_one_is_the_default) {
  const auto area = [](const std::string& root) {
    return svgPolygonOf("<svg " + root + "><rect width=\"10\" height=\"10\"/></svg>", "a.svg", "", 0.0, 0.0, nullptr)
        .area();
  };
  EXPECT_NEAR(area("width=\"200mm\" height=\"100mm\" viewBox=\"0 0 400 200\""), 0.005 * 0.005, 1e-12);
  EXPECT_EQ(area("width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\""), 0.01 * 0.01) << "1 mm a unit, exactly";
  EXPECT_NEAR(area("width=\"72pt\" viewBox=\"0 0 10 10\""), 0.0254 * 0.0254, 1e-12);
  EXPECT_NEAR(area("height=\"6pc\" viewBox=\"0 0 10 10\""), 0.0254 * 0.0254, 1e-12);
  EXPECT_NEAR(area("width=\"1in\" height=\"1in\""), std::pow(10 * 0.0254 / 96, 2), 1e-15);
  EXPECT_NEAR(area("width=\"20cm\" viewBox=\"0,0,100,50\""), 0.02 * 0.02, 1e-12);
  EXPECT_EQ(area("width=\"200\" height=\"100\" viewBox=\"0 0 400 200\""), 100.0);
  EXPECT_EQ(area(""), 100.0);
}

TEST(SvgDrawing, what_is_wrong_is_said_with_the_element_and_its_line) {
  struct Case {
    std::string body, start, contains;
  };
  const std::vector<Case> cases{
      {path("M0 0 L1 0 L1 1 X 3", "id=\"hull\""), "a.svg:2: path \"hull\": ", "behind the segment that ends at (1, 1)"},
      {"\n" + path("0 0 L1 0"), "a.svg:3: <path>: ", "stops being path data"},
      {path("M0 0 L1e999 0 L0 1 Z"), "a.svg:2: <path>: ", "right are M L H V C S Q T A Z"},
      {path("M0 0 L1 1 Z", "id=\"p\""), "a.svg:2: path \"p\": ", "has no area"},
      {path(""), "a.svg:2: <path>: ", "has no area"},
      {"<circle r=\"-1\"/>", "a.svg:2: <circle>: ", "r is \"-1\", right is a length that is not negative"},
      {"<circle cx=\"1\"/>", "a.svg:2: <circle>: ", "has no r"},
      {"<circle r=\"0\"/>", "a.svg:2: <circle>: ", "has no area"},
      {"<rect width=\"50%\" height=\"1\"/>", "a.svg:2: <rect>: ", "width is \"50%\", right is a length such as 12"},
      {"<rect width=\"2em\" height=\"1\"/>", "a.svg:2: <rect>: ", "right is a length"},
      {"<polygon points=\"0 0 1 0 1\"/>", "a.svg:2: <polygon>: ", "stops being a list of points"},
      {"<g id=\"flat\" transform=\"scale(1 0)\"><rect width=\"1\" height=\"1\"/></g>",
       "a.svg:2: g \"flat\": ", "has no inverse"},
      {"<rect width=\"1\" height=\"1\" transform=\"turn(3)\"/>", "a.svg:2: <rect>: ", "transform is \"turn(3)\""},
      {"<rect width=\"1\" height=\"1\" fill-rule=\"evenod\"/>", "a.svg:2: <rect>: ", "right is \"nonzero\" or"},
      {"<rect width=\"1e12\" height=\"1\"/>", "a.svg:2: <rect>: ", "beyond 1e9 m"},
      {"<svg>\n<rect id=\"in\" width=\"1\" height=\"1\"/></svg>", "a.svg:2: <svg>: ", "right is a group"},
      {"<svg><rect width=\"1\" height=\"1\"/></svg>", "a.svg:2: <svg>: ", "right is a group"},
      {"<text>words</text>", "a.svg: ", "nothing is drawn that encloses area; <text> has no outline"},
      {"<rect id=\"a\" width=\"1\" height=\"1\"/><circle cx=\"5\" r=\"1\"/>", "a.svg: ",
       "2 separate outlines; rect \"a\" (a.svg:2); <circle> (a.svg:2); a shape is one polygon, right is the id of one"},
      {path("M0 0 H4 V4 H0 Z M0 0 L2 1 L1 2 Z", "fill-rule=\"evenodd\" id=\"touch\""),
       "a.svg: path \"touch\" (a.svg:2): ", "touches"},
      {"<rect width=\"1\"", "a.svg:", "this is not XML"},
      {"<circle r=\"100000\"/>" + std::string(1, ' '), "", ""},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.body);
    const std::string got = refused(c.body);
    if (c.start.empty()) {
      EXPECT_EQ(got, "accepted");
      continue;
    }
    EXPECT_EQ(got.substr(0, c.start.size()), c.start) << got;
    EXPECT_NE(got.find(c.contains), std::string::npos) << got;
  }
}

TEST(SvgDrawing, an_id_that_is_not_there_names_those_that_are) {
  const std::string body = "<rect id=\"hull\" width=\"1\" height=\"1\"/><text id=\"label\"/>";
  EXPECT_EQ(refused(body, "hul"), "a.svg: no element has the id \"hul\", right is one of hull");
  EXPECT_NE(refused(body, "label").find("a.svg:2: text \"label\": a <text> has no outline of its own"),
            std::string::npos);
  EXPECT_NE(refused(body + body, "hull").find("the id is taken already, in line 2"), std::string::npos);
  EXPECT_NE(refused("<rect/>", "x").find("none has any"), std::string::npos);
}

TEST(SvgDrawing, entities_are_never_expanded_and_nothing_else_is_opened) {
  const auto what = [](const std::string& text) {
    try {
      svgPolygonOf(text, "a.svg", "", 1.0, 0.0, nullptr);
    } catch (const DrawingError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string rect = "<rect width=\"1\" height=\"1\"/></svg>";
  EXPECT_NE(what("<!DOCTYPE svg [<!ENTITY a \"b\">]><svg>" + rect).find("declares entities"), std::string::npos);
  EXPECT_NE(what("<!DOCTYPE svg [<!ENTITY a SYSTEM \"file:///etc/passwd\">]><svg>&a;" + rect).find("entities"),
            std::string::npos);
  std::string bomb = "<!DOCTYPE svg [<!ENTITY a0 \"lollollollollol\">";
  for (int i = 1; i < 30; ++i) {
    const std::string before = "&a" + std::to_string(i - 1) + ";";
    bomb += "<!ENTITY a" + std::to_string(i) + " \"" + before + before + before + before + "\">";
  }
  EXPECT_NE(what(bomb + "]><svg id=\"&a29;\">" + rect), "accepted");
  EXPECT_EQ(what("<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" "
                 "\"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd\"><svg>" +
                 rect),
            "accepted");
  EXPECT_NE(what("<html/>").find("its root is <html>"), std::string::npos);
  EXPECT_NE(what("").find("this is not XML"), std::string::npos);
}

TEST(SvgDrawing, a_tolerance_beyond_the_size_leaves_a_triangle_of_a_circle_and_nothing_of_a_slim_arch) {
  EXPECT_EQ(drawn("<circle r=\"1\"/>", 5.0).edgeCount(), 3u);
  try {
    drawn(path("M0 0 Q5 1 10 0 Z"), 5.0);
    ADD_FAILURE();
  } catch (const DrawingError& error) {
    EXPECT_NE(std::string(error.what()).find("has no area at a tolerance of 5 m"), std::string::npos) << error.what();
  }
}

TEST(SvgDrawing, many_things_left_out_are_counted_not_listed) {
  std::vector<std::string> notes;
  std::string body = "<rect width=\"1\" height=\"1\"/>";
  for (int i = 0; i < 20; ++i) body += "\n<text/>";
  drawn(body, 0.0, "", &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("(line 3, 4, 5, 6, 7, 8, 9, 10 and 12 more)"), std::string::npos) << notes[0];
}

TEST(SvgDrawing, more_vertices_than_a_hundred_thousand_are_refused_with_advice) {
  try {
    drawn("<circle id=\"c\" r=\"1\"/>", 1e-12);
    ADD_FAILURE();
  } catch (const DrawingError& error) {
    EXPECT_EQ(std::string(error.what()).find("a.svg:2: circle \"c\": the drawing has more than 100000 vertices"), 0u)
        << error.what();
  }
}

TEST(SvgDrawing, a_device_without_an_end_is_refused_when_the_limit_is_reached) {
  try {
    scene::svgPolygon("/dev/zero", "", 0.0, 0.0, nullptr);
    FAIL() << "was read to an end that it does not have";
  } catch (const DrawingError& error) {
    EXPECT_NE(std::string(error.what()).find("more than 16 MiB"), std::string::npos) << error.what();
  }
}

TEST(SvgDrawing, a_tangle_of_a_million_crossings_is_refused_at_once) {
  RandomStream random(3, 0);
  std::string tangle = "M";
  for (int i = 0; i < 20000; ++i)
    tangle += std::to_string(random.uniform()) + " " + std::to_string(random.uniform()) + " ";
  EXPECT_NE(refused(path(tangle + "Z", "id=\"knot\"")).find("path \"knot\": outlines cross more than 1000000 times"),
            std::string::npos);
}

std::string sceneWith(const std::string& shape) {
  return kHead + "[[body]]\nname = \"hull\"\nshape = { svg = { " + shape + " } }\n";
}

TEST(SvgDrawing, a_scene_finds_its_drawing_beside_it_and_writes_the_polygon_down) {
  const SceneFile file(sceneWith("file = \"parts/hull.svg\", id = \"h\", scale = 0.1"));
  const std::filesystem::path folder = std::filesystem::path(file.path()).parent_path();
  std::filesystem::create_directory(folder / "parts");
  std::ofstream(folder / "parts" / "hull.svg") << kOpen + "<rect id=\"h\" y=\"-5\" width=\"10\" height=\"5\"/></svg>";
  const scene::Scene s = scene::load(file.path());
  expectBox(*s.world.bodies.at(0).shape, 0.0, 0.0, 1.0, 0.5);
  EXPECT_EQ(s.resolved.find("svg"), std::string::npos) << s.resolved;
  EXPECT_TRUE(s.notes.empty());
  const scene::Scene again = testing::loadText(s.resolved);
  EXPECT_EQ(again.resolved, s.resolved);
}

TEST(SvgDrawing, a_scene_says_its_own_place_and_that_in_the_drawing) {
  const SceneFile file(sceneWith("file = \"hull.svg\""));
  const std::string drawing = (std::filesystem::path(file.path()).parent_path() / "hull.svg").string();
  const auto what = [&] {
    try {
      scene::load(file.path());
    } catch (const scene::SceneError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(what(), file.path() + ":7:17: body.hull.shape.svg: " + drawing +
                        ": there is no such file, right is the path of a drawing");
  std::ofstream(drawing) << kOpen + "\n<path id=\"keel\" d=\"M0 0 L1\"/></svg>";
  EXPECT_EQ(what().find(file.path() + ":7:17: body.hull.shape.svg: " + drawing + ":3: path \"keel\": "), 0u) << what();
  for (const auto& [shape, contains] : {std::pair("id = \"a\"", "shape.svg.file"), std::pair("file = \"\"", "is empty"),
                                        std::pair("file = \"a.svg\", scale = -1", "scale: is -1"),
                                        std::pair("file = \"a\", tolerance = 0.0", "above 0"),
                                        std::pair("file = \"a\", scales = 1", "the nearest is \"scale\"")}) {
    const std::string got = testing::refusal(sceneWith(shape));
    EXPECT_NE(got.find(contains), std::string::npos) << got;
  }
}

}  // namespace
}  // namespace froude
