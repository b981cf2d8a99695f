// Pictures of distance fields, read back by Cairo and by an XML parser's rules.
#include <cairo/cairo.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "export/color_scale.h"
#include "export/field_painter.h"
#include "export/frames.h"
#include "export_support.h"
#include "support/polygon_oracle.h"

namespace froude::exporting {
namespace {

using test::TemporaryFolder;

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
  std::uint32_t at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)] & 0xFFFFFFu; }
};

Picture read(const std::string& file) {
  Picture picture;
  cairo_surface_t* surface = cairo_image_surface_create_from_png(file.c_str());
  if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
    picture.width = cairo_image_surface_get_width(surface);
    picture.height = cairo_image_surface_get_height(surface);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < picture.height; ++y) {
      const auto* row = reinterpret_cast<const std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
      picture.pixels.insert(picture.pixels.end(), row, row + picture.width);
    }
  }
  cairo_surface_destroy(surface);
  return picture;
}

Polygon golden(const std::string& name) {
  std::ifstream stream(std::string(FROUDE_TEST_DATA) + "/geometry_polygons.json");
  const nlohmann::json loops = nlohmann::json::parse(stream)["polygons"][name]["loops"];
  std::vector<std::vector<Vec2>> rings;
  for (const auto& loop : loops) {
    rings.emplace_back();
    for (const auto& p : loop) rings.back().emplace_back(p[0].get<double>(), p[1].get<double>());
  }
  return Polygon::make(rings[0], {rings.begin() + 1, rings.end()});
}

// A box of 2 m × 1 m with a band of 0.25 m at a width of 1280: the map is 2.5625 m wide on 1224 pixels, from pixel 28
// on; its top is 112 pixels down.
struct BoxPicture {
  Polygon polygon = Polygon::box({{0.0, 0.0}, {2.0, 1.0}});
  FieldPicture what;
  double margin = 0.25 * 1.125, pixels = 1224.0 / (2.0 + 2.0 * margin);
  BoxPicture() {
    what.band = 0.25;
    what.layers = {FieldLayer::Distance};
  }
  std::pair<int, int> pixel(double x, double y) const {
    return {static_cast<int>(28.0 + (x + margin) * pixels), static_cast<int>(112.0 + (1.0 + margin - y) * pixels)};
  }
};

TEST(Diverging, is_blue_below_and_orange_above_zero_and_darkens) {
  int before = 2000;
  for (const double t : {1e-9, 0.1, 0.5, 0.8, 1.0, 7.0}) {
    const Color above = diverging(t), below = diverging(-t);
    EXPECT_GT(above.r, above.b + 40) << t;
    EXPECT_GT(below.b, below.r + 30) << t;
    const int light = above.r + above.g + above.b + below.r + below.g + below.b;
    EXPECT_LE(light, before);
    before = light;
  }
}

TEST(FieldPicture, has_the_sign_of_the_distance_in_its_colours) {
  const BoxPicture box;
  TemporaryFolder folder;
  drawField(folder.file("box.png"), box.polygon, "box", box.what);
  const Picture picture = read(folder.file("box.png"));
  ASSERT_EQ(picture.width, 1280);
  const std::vector<test::OracleEdge> edges = test::oracleEdges(box.polygon);
  int inside = 0, outside = 0;
  // Points away from contours, which stand at multiples of 0.05 m or more, and from labels.
  for (double x = -0.237; x < 2.24; x += 0.1)
    for (double y = -0.237; y < 1.24; y += 0.1) {
      const auto d = static_cast<double>(test::signedDistance(edges, {x, y}));
      if (std::abs(std::remainder(d, 0.05)) < 0.012) continue;
      const auto [i, j] = box.pixel(x, y);
      const std::uint32_t c = picture.at(i, j);
      const int red = static_cast<int>(c >> 16 & 255u), blue = static_cast<int>(c & 255u);
      if (std::abs(red - blue) < 20) continue;  // letters, and their white rims
      ++(d < 0.0 ? inside : outside);
      EXPECT_EQ(blue > red, d < 0.0) << x << ", " << y;
    }
  EXPECT_GT(inside, 60);
  EXPECT_GT(outside, 60);
}

TEST(FieldPicture, draws_an_offset_curve_where_it_is) {
  BoxPicture box;
  box.what.offsets = {0.13, -0.37};
  TemporaryFolder folder;
  EXPECT_TRUE(drawField(folder.file("box.png"), box.polygon, "box", box.what).empty());
  const Picture picture = read(folder.file("box.png"));
  const auto isMagenta = [&](double x, double y) {
    const auto [i, j] = box.pixel(x, y);
    for (int di = -1; di <= 1; ++di) {
      const std::uint32_t c = picture.at(i + di, j);
      if ((c >> 16 & 255u) > (c >> 8 & 255u) + 90u && (c & 255u) > (c >> 8 & 255u) + 60u) return true;
    }
    return false;
  };
  const double diagonal = 0.13 * std::sqrt(0.5);
  EXPECT_TRUE(isMagenta(2.13, 0.31));
  EXPECT_TRUE(isMagenta(2.0 + diagonal, 1.0 + diagonal));  // on the arc about a corner
  EXPECT_FALSE(isMagenta(2.13, 1.13));                     // the mitre's corner is not on it
  EXPECT_TRUE(isMagenta(0.37, 0.43));
  EXPECT_FALSE(isMagenta(0.30, 0.43));
  box.what.offsets = {-0.7};
  const std::vector<std::string> remarks = drawField(folder.file("box.png"), box.polygon, "box", box.what);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("70 cm deep"), std::string::npos) << remarks[0];
}

TEST(FieldPicture, has_its_width_and_shows_all_panels_for_shapes_of_any_aspect) {
  const std::vector<Polygon> shapes{golden("gear12"),
                                    golden("plate_1_1024"),
                                    golden("needle"),
                                    golden("holed_square"),
                                    golden("koch4"),
                                    Polygon::box({{0, 0}, {1000, 0.1}}),
                                    Polygon::box({{0, 0}, {1e-4, 1e-2}}),
                                    Polygon::box({{1e6, 1e6}, {1e6 + 1.0, 1e6 + 1.0}})};
  for (const Polygon& shape : shapes)
    for (const int width : {320, 1280}) {
      FieldPicture what;
      what.width = width;
      TemporaryFolder folder;
      drawField(folder.file("a.png"), shape, "a shape", what);
      const Picture picture = read(folder.file("a.png"));
      EXPECT_EQ(picture.width, width);
      EXPECT_GT(picture.height, width / 8);
      EXPECT_LT(picture.height, 2 * width + 500);
      EXPECT_GT(std::set<std::uint32_t>(picture.pixels.begin(), picture.pixels.end()).size(), 40u);
      EXPECT_EQ(folder.files(), std::vector<std::string>{"a.png"});
    }
}

TEST(FieldPicture, cells_that_would_be_too_many_are_remarked_on) {
  TemporaryFolder folder;
  FieldPicture what;
  what.width = 320;
  what.layers = {FieldLayer::Cells};
  what.cell = 0.1;
  EXPECT_TRUE(drawField(folder.file("a.png"), golden("star5"), "star", what).empty());
  what.cell = 1e-9;
  const std::vector<std::string> remarks = drawField(folder.file("a.png"), golden("star5"), "star", what);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("cells of 1e-09 m would be too many"), std::string::npos) << remarks[0];
}

TEST(FieldPicture, draws_the_same_bytes_again) {
  TemporaryFolder folder;
  drawField(folder.file("a.png"), golden("star5"), "star", {});
  drawField(folder.file("b.png"), golden("star5"), "star", {});
  EXPECT_EQ(folder.text("a.png"), folder.text("b.png"));
}

/// Names of elements that are open when the text ends; "wrong" if one is closed that is not the last one opened.
std::vector<std::string> openElements(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return {"wrong"};
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.starts_with('?') || tag.starts_with('!') || tag.ends_with('/')) continue;
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return {"wrong"};
      open.pop_back();
    } else {
      open.push_back(tag.substr(0, tag.find_first_of(" \n")));
    }
  }
  return open;
}

TEST(FieldPicture, an_svg_is_well_formed_and_says_what_it_shows) {
  TemporaryFolder folder;
  FieldPicture what;
  what.offsets = {0.1};
  drawField(folder.file("a.svg"), golden("gear12"), "cogs & <teeth>", what);
  const std::string svg = folder.text("a.svg");
  EXPECT_TRUE(svg.starts_with("<?xml"));
  EXPECT_EQ(openElements(svg), std::vector<std::string>{});
  EXPECT_NE(svg.find("<title>cogs &amp; &lt;teeth&gt;</title>"), std::string::npos);
  EXPECT_NE(svg.find("48 edges"), std::string::npos);
  EXPECT_NE(svg.find("width=\"1280px\""), std::string::npos);
  EXPECT_NE(svg.find("<image"), std::string::npos);
  EXPECT_NE(svg.find("glyph"), std::string::npos);  // letters
  EXPECT_NE(svg.find(" C "), std::string::npos);    // arcs
}

TEST(FieldPicture, a_folder_that_is_not_there_is_an_error_and_leaves_nothing) {
  TemporaryFolder folder;
  EXPECT_THROW(drawField(folder.file("nowhere/a.png"), golden("star5"), "star", {}), OutputError);
  EXPECT_THROW(drawField(folder.file("nowhere/a.svg"), golden("star5"), "star", {}), OutputError);
  EXPECT_TRUE(folder.files().empty());
}

}  // namespace
}  // namespace froude::exporting
