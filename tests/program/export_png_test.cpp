// Pictures, read back by Cairo.
#include <cairo/cairo.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <memory>
#include <set>

#include "export/color_scale.h"
#include "export/frames.h"
#include "export/png_painter.h"
#include "export/png_particles.h"
#include "export_support.h"

namespace froude::exporting {
namespace {

using test::smallScene;
using test::TemporaryFolder;
using test::worldOf;

constexpr double kPixels = (1280.0 - 56.0) / 2.0;  // a metre of the small scene, between margins of 28

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
  std::uint32_t at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)] & 0xFFFFFFu; }
  /// At a place of the small scene's tank of 2 × 1 m [m], in a picture of 1280 pixels.
  std::uint32_t atPlace(double x, double y) const {
    return at(static_cast<int>(28.0 + x * kPixels), static_cast<int>(60.0 + (1.0 - y) * kPixels));
  }
};

Picture read(const std::string& file) {
  Picture picture;
  cairo_surface_t* surface = cairo_image_surface_create_from_png(file.c_str());
  if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
    picture.width = cairo_image_surface_get_width(surface);
    picture.height = cairo_image_surface_get_height(surface);
    cairo_surface_flush(surface);
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

std::uint32_t packed(Color c) {
  return static_cast<std::uint32_t>(c.r) << 16 | static_cast<std::uint32_t>(c.g) << 8 | c.b;
}

// Colours of matplotlib's viridis at places between the stops of ours.
TEST(ColorScale, viridis_is_viridis) {
  const std::array<std::pair<double, std::array<int, 3>>, 5> known = {
      {{0.0, {68, 1, 84}}, {0.25, {59, 82, 139}}, {0.5, {33, 145, 140}}, {0.75, {94, 201, 98}}, {1.0, {253, 231, 37}}}};
  for (const auto& [t, rgb] : known) {
    const Color c = viridis(t);
    EXPECT_NEAR(c.r, rgb[0], 4) << t;
    EXPECT_NEAR(c.g, rgb[1], 4) << t;
    EXPECT_NEAR(c.b, rgb[2], 4) << t;
  }
  EXPECT_EQ(packed(viridis(-3.0)), packed(viridis(0.0)));
  EXPECT_EQ(packed(viridis(7.0)), packed(viridis(1.0)));
  EXPECT_EQ(packed(viridis(std::nan(""))), packed(viridis(0.0)));
}

TEST(ColorScale, numbers_are_round) {
  EXPECT_DOUBLE_EQ(roundUp(6.26), 8.0);
  EXPECT_DOUBLE_EQ(roundUp(0.00101), 0.0015);
  EXPECT_DOUBLE_EQ(roundUp(9.1), 10.0);
  EXPECT_DOUBLE_EQ(roundUp(2.0), 2.0);
  EXPECT_DOUBLE_EQ(roundDown(0.54), 0.5);
  EXPECT_DOUBLE_EQ(roundDown(1999.0), 1000.0);
  const std::vector<double> ticks = niceTicks(0.0, 5.0, 5);
  ASSERT_EQ(ticks.size(), 6u);
  for (int k = 0; k < 6; ++k) EXPECT_DOUBLE_EQ(ticks[static_cast<std::size_t>(k)], k);
  const std::vector<double> density = niceTicks(900.0, 1100.0, 5);
  EXPECT_EQ(density, (std::vector<double>{900.0, 950.0, 1000.0, 1050.0, 1100.0}));
}

TEST(ColorScale, range_follows_from_the_scene) {
  scene::Scene scene = smallScene();
  scene.bulletBlocks.clear();
  scene.world.bullet.reset();
  ColorScale speed = colorScale(scene);
  EXPECT_DOUBLE_EQ(speed.high, 3.0);  // √(2 · 9.81 · 0.5) = 3.13
  EXPECT_EQ(speed.label, "speed (m/s)");
  scene.output.image.color = "pressure";
  EXPECT_DOUBLE_EQ(colorScale(scene).high, 5000.0);  // 4905
  EXPECT_EQ(colorScale(scene).label, "pressure (kN/m)");
  scene.output.image.color = "density";
  EXPECT_DOUBLE_EQ(colorScale(scene).low, 900.0);
  EXPECT_DOUBLE_EQ(colorScale(scene).high, 1100.0);
  scene.output.image.range = std::array<double, 2>{990.0, 1010.0};
  EXPECT_DOUBLE_EQ(colorScale(scene).low, 990.0);
  scene.output.image = {};
  scene.world.gravity = {0.0, 0.0};
  for (Vec2& v : scene.fluidBlocks[0].velocities) v = {0.0, 0.0};
  EXPECT_DOUBLE_EQ(colorScale(scene).high, 1.0);
}

TEST(ExportPng, has_the_width_of_the_scene_an_even_height_and_equal_scales) {
  for (const int width : {200, 641, 1280}) {
    for (const double tall : {0.1, 1.0, 30.0}) {
      scene::Scene scene = smallScene();
      scene.output.image.width = width;
      scene.output.image.view = {{0.0, 0.0}, {2.0, tall}};
      const World world = worldOf(scene);
      TemporaryFolder folder;
      drawPng(folder.file("picture.png"), world, scene);
      const Picture picture = read(folder.file("picture.png"));
      EXPECT_EQ(picture.width, width);
      EXPECT_EQ(picture.height % 2, 0);
      EXPECT_LE(picture.height, 2 * width + 100);
      EXPECT_EQ(folder.files(), std::vector<std::string>{"picture.png"});
    }
  }
}

/// Pixels of a colour within `slack` of each channel.
std::size_t count(const Picture& picture, Color c, int slack) {
  std::size_t n = 0;
  for (const std::uint32_t p : picture.pixels) {
    const int r = static_cast<int>(p >> 16 & 255u), g = static_cast<int>(p >> 8 & 255u), b = static_cast<int>(p & 255u);
    if (std::abs(r - c.r) <= slack && std::abs(g - c.g) <= slack && std::abs(b - c.b) <= slack) ++n;
  }
  return n;
}

// One speed for all the water: the area of its colour is the area of the water, in discs and in the dense surface.
TEST(ExportPng, shows_the_water_in_the_colour_of_its_speed) {
  for (const double spacing : {0.05, 0.005}) {
    scene::Scene scene = smallScene(spacing);
    scene.bulletBlocks.clear();
    scene.world.bodies.clear();
    scene.output.image.range = std::array<double, 2>{0.0, 2.0};
    for (Vec2& v : scene.fluidBlocks[0].velocities) v = {0.6, 0.8};
    const World world = worldOf(scene);
    TemporaryFolder folder;
    drawPng(folder.file("picture.png"), world, scene);
    const Picture picture = read(folder.file("picture.png"));
    const double water = 0.8 * 0.5 * kPixels * kPixels;
    const auto seen = static_cast<double>(count(picture, viridis(0.5), 2));
    EXPECT_GT(seen, spacing > 0.02 ? 0.6 * water : 0.97 * water) << spacing;
    EXPECT_LT(seen, (spacing > 0.02 ? 1.0 : 1.03) * water) << spacing;
    // Where it lies: the middle of the block is in, the middle of the tank is not.
    EXPECT_EQ(picture.at(28 + 490, 60 + 200), 0xFFFFFFu);
  }
}

TEST(ExportPng, shows_polygons_grey_with_their_holes_open) {
  scene::Scene scene = smallScene();
  scene.bulletBlocks.clear();
  scene.fluidBlocks.clear();
  scene.world.bodies[0].shape = std::make_shared<Polygon>(
      Polygon::make({{0, 0}, {0.8, 0}, {0.8, 0.8}, {0, 0.8}}, {{{0.2, 0.2}, {0.6, 0.2}, {0.6, 0.6}, {0.2, 0.6}}}));
  scene.world.bodies[0].position = {0.5, 0.1};
  const World world = worldOf(scene);
  TemporaryFolder folder;
  drawPng(folder.file("picture.png"), world, scene);
  const Picture picture = read(folder.file("picture.png"));
  const auto pixel = [&](double x, double y) { return picture.atPlace(x, y); };
  EXPECT_EQ(pixel(0.9, 0.5), 0xFFFFFFu);  // the hole
  EXPECT_EQ(pixel(0.6, 0.5), pixel(1.2, 0.5));
  EXPECT_NE(pixel(0.6, 0.5), 0xFFFFFFu);
  EXPECT_EQ(pixel(1.6, 0.5), 0xFFFFFFu);
}

TEST(ExportPng, tells_fixed_scripted_and_free_bodies_apart_and_shows_how_a_free_one_is_turned) {
  scene::Scene scene = smallScene();
  scene.bulletBlocks.clear();
  scene.fluidBlocks.clear();
  scene.world.fluid.reset();
  scene.world.bullet.reset();
  scene.world.bodies.clear();
  const auto shape = std::make_shared<Polygon>(Polygon::box({{-0.2, -0.2}, {0.2, 0.2}}));
  for (const Motion motion : {Motion::Fixed, Motion::Scripted, Motion::Free}) {
    BodyDef body;
    body.shape = shape;
    body.motion = motion;
    body.position = {0.4 + 0.6 * static_cast<double>(scene.world.bodies.size()), 0.5};
    scene.world.bodies.push_back(body);
  }
  scene.world.bodies[2].angle = 0.5 * kPi;
  scene.world.bodies[2].hinge = HingeDef{{1.6, 0.35}, std::nullopt};
  const World world = worldOf(scene);
  TemporaryFolder folder;
  drawPng(folder.file("picture.png"), world, scene);
  const Picture picture = read(folder.file("picture.png"));
  const auto pixel = [&](double x, double y) { return picture.atPlace(x, y); };
  EXPECT_NE(pixel(0.35, 0.55), pixel(0.95, 0.55));
  EXPECT_NE(pixel(0.35, 0.55), pixel(1.55, 0.55));
  EXPECT_NE(pixel(0.95, 0.55), pixel(1.55, 0.55));
  EXPECT_NE(pixel(1.6, 0.6), pixel(1.55, 0.6)) << "its x axis points up";
  EXPECT_EQ(pixel(1.7, 0.5), pixel(1.55, 0.55)) << "and no longer right";
  EXPECT_EQ(pixel(0.5, 0.5), pixel(0.35, 0.55)) << "fixed ones have no mark";
  EXPECT_EQ(pixel(1.6, 0.35), 0xFFFFFFu) << "the hinge is a ring";
  for (int x = 700; x < picture.width; ++x)
    for (int y = picture.height - 60; y < picture.height; ++y)
      ASSERT_EQ(picture.at(x, y), 0xFFFFFFu) << "without particles there is nothing to colour, and no bar";
}

TEST(ExportPng, has_letters_and_a_colour_bar) {
  scene::Scene scene = smallScene();
  scene.fluidBlocks.clear();
  scene.bulletBlocks.clear();
  scene.world.bodies.clear();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  drawPng(folder.file("picture.png"), world, scene);
  const Picture picture = read(folder.file("picture.png"));
  std::set<std::uint32_t> bar;
  std::size_t title = 0, clock = 0, length = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const bool dark = (picture.at(x, y) & 255u) < 128u;
      if (y < 50 && x < 400 && dark) ++title;
      if (y < 50 && x > 1000 && dark) ++clock;
      if (y > picture.height - 70 && x < 400 && dark) ++length;
      if (y > picture.height - 70 && x > 800) bar.insert(picture.at(x, y));
    }
  EXPECT_GT(title, 100u);
  EXPECT_GT(clock, 100u);
  EXPECT_GT(length, 100u);
  EXPECT_GT(bar.size(), 150u);
}

TEST(ExportPng, keeps_titles_of_any_length_on_the_picture) {
  scene::Scene scene = smallScene();
  scene.output.image.width = 320;
  scene.title.clear();
  for (int k = 0; k < 60; ++k) scene.title += "n² = 2 …";
  const World world = worldOf(scene);
  TemporaryFolder folder;
  drawPng(folder.file("picture.png"), world, scene);
  const Picture picture = read(folder.file("picture.png"));
  ASSERT_EQ(picture.width, 320);
  int gap = 0, widest = 0;  // between the title and the time
  for (int x = 0; x < picture.width; ++x) {
    bool ink = false;
    for (int y = 2; y < 28; ++y) ink = ink || picture.at(x, y) != 0xFFFFFFu;
    gap = ink ? 0 : gap + 1;
    if (x > 100) widest = std::max(widest, gap);
  }
  EXPECT_GE(widest, 10);
}

TEST(ExportPng, draws_the_same_bytes_again) {
  const scene::Scene scene = smallScene();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  drawPng(folder.file("a.png"), world, scene);
  drawPng(folder.file("b.png"), world, scene);
  EXPECT_EQ(folder.text("a.png"), folder.text("b.png"));
}

TEST(ExportPng, all_kinds_of_colour_and_particles_far_outside_are_drawn) {
  for (const char* color : {"speed", "pressure", "density"}) {
    scene::Scene scene = smallScene();
    scene.output.image.color = color;
    scene.output.image.view = {{0.7, 0.2}, {0.9, 0.3}};
    World world = worldOf(scene);
    ASSERT_TRUE(world.step(0.01).ok());
    TemporaryFolder folder;
    drawPng(folder.file("picture.png"), world, scene);
    const Picture picture = read(folder.file("picture.png"));
    EXPECT_GT(std::set<std::uint32_t>(picture.pixels.begin(), picture.pixels.end()).size(), 20u);
  }
}

TEST(ExportPng, frames_are_one_file_each) {
  scene::Scene scene = smallScene();
  scene.output.h5 = false;
  scene.output.image.width = 160;
  const World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  for (int k = 0; k < 3; ++k) writer.write(world, k);
  writer.closeSegment();
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"frame_00000.png", "frame_00001.png", "frame_00002.png"}));
}

TEST(ExportPng, a_folder_that_is_not_there_is_an_error_that_names_the_file) {
  const scene::Scene scene = smallScene();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  try {
    drawPng(folder.file("nowhere/picture.png"), world, scene);
    FAIL() << "no error";
  } catch (const OutputError& e) {
    EXPECT_NE(std::string(e.what()).find("nowhere/picture.png"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("No such file"), std::string::npos);
  }
}

// Ink is the area of the discs, whatever their size and place on the pixels.
TEST(PaintDiscs, discs_have_their_area) {
  for (const double radius : {4.0, 7.3, 20.0}) {
    std::vector<std::uint8_t> data(100 * 100 * 4, 0xFF);
    const Canvas canvas{data.data(), 400, 0, 0, 100, 100};
    paintDiscs(canvas, {{50.3f, 49.6f, std::nanf("")}}, radius, Look::Apart);
    double ink = 0.0;
    for (std::size_t k = 0; k < data.size(); k += 4) ink += (255.0 - data[k]) / 255.0;
    const double core = kPi * (radius - 1.0) * (radius - 1.0), rim = kPi * radius * radius - core;
    const double dark = 1.0 - 70.0 / 255.0, darker = 1.0 - 0.72 * 70.0 / 255.0;
    EXPECT_NEAR(ink, core * dark + rim * darker, 0.02 * ink) << radius;
  }
}

// Together, a lattice that is stretched by a tenth is one surface in one colour, whatever its place on the pixels.
TEST(PaintDiscs, together_are_a_surface_without_gaps) {
  for (const double spacing : {0.7, 1.3, 2.9, 4.0, 6.1}) {
    std::vector<std::uint8_t> data(100 * 100 * 4, 0xFF);
    const Canvas canvas{data.data(), 400, 0, 0, 100, 100};
    std::vector<Disc> discs;
    for (double y = 20.0; y < 80.0; y += spacing)
      for (double x = 20.0; x < 80.0; x += 1.1 * spacing)
        discs.push_back({static_cast<float>(x), static_cast<float>(y), 0.5f});
    paintDiscs(canvas, discs, 0.5 * spacing, Look::Together);
    const Color c = viridis(0.5);
    for (std::size_t y = 25; y < 70; ++y)
      for (std::size_t x = 25; x < 70; ++x) {
        ASSERT_NEAR(data[y * 400 + x * 4], c.b, 12) << spacing << " at " << x << ", " << y;
        ASSERT_NEAR(data[y * 400 + x * 4 + 1], c.g, 12) << spacing << " at " << x << ", " << y;
      }
  }
}

TEST(PaintDiscs, stay_on_the_canvas) {
  std::vector<std::uint8_t> data(40 * 40 * 4, 0xFF);
  const Canvas canvas{data.data(), 160, 10, 10, 30, 30};
  for (const double radius : {0.5, 1.0, 6.0})
    for (const Look look : {Look::Apart, Look::Together})
      paintDiscs(canvas, {{10.0f, 10.0f, 0.5f}, {30.0f, 29.0f, 0.5f}, {-5.0f, 20.0f, 0.5f}, {20.0f, 46.0f, 0.5f}},
                 radius, look);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      if (x < 10 || y < 10 || x >= 30 || y >= 30) {
        EXPECT_EQ(data[static_cast<std::size_t>((y * 40 + x) * 4)], 0xFF);
      }
}

}  // namespace
}  // namespace froude::exporting
