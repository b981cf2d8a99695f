// Soft bodies in what a run writes: gauges, pictures, HDF5 frames with XDMF.
#include <gtest/gtest.h>

#include "export/frames.h"
#include "export/soft_surface.h"
#include "export_support.h"
#include "program/scene_support.h"
#include "run/gauges.h"

namespace froude {
namespace {

using test::readDataset;
using test::TemporaryFolder;

/// A square of jelly, and a rope, without gravity, so that nothing moves but what the test moves.
scene::Scene jellyAndRope(const std::string& more = "") {
  return froude::testing::loadText(
      "format = 1\nduration = 1.0\ngravity = [0.0, 0.0]\n[domain]\nbox = [0.0, 0.0, 4.0, 3.0]\n"
      "[[soft]]\nname = \"jelly\"\nshape = { box = [0.0, 0.0, 0.5, 0.5] }\nposition = [1.0, 1.0]\nspacing = 0.1\n"
      "young = 1.0e6\npoisson = 0.3\n"
      "[[soft]]\nname = \"rope\"\npath = [[2.0, 1.0], [3.0, 1.0]]\nthickness = 0.02\nspacing = 0.1\n"
      "young = 1.0e6\n" +
      more);
}

/// Moves all points by an affine map about (1, 1).
void deform(World& world, double stretch, double turn) {
  ParticlePool& pool = *world.soft();
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const Vec2 p(stretch * (pool.x()[i] - 1.0), pool.y()[i] - 1.0);
    pool.x()[i] = 1.0 + std::cos(turn) * p.x() - std::sin(turn) * p.y();
    pool.y()[i] = 1.0 + std::sin(turn) * p.x() + std::cos(turn) * p.y();
  }
}

std::vector<double> row(const std::string& line) {
  std::vector<double> values;
  std::stringstream cells(line);
  for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
  return values;
}

TEST(SoftOutput, gauges_read_the_tip_the_area_and_the_strain_energy) {
  const scene::Scene scene = jellyAndRope(
      "[[gauge]]\nname = \"tip\"\ntype = \"tip\"\nsoft = \"jelly\"\nat = [0.5, 0.25]\n"
      "[[gauge]]\nname = \"end\"\ntype = \"tip\"\nsoft = \"rope\"\nat = [3.0, 1.0]\n"
      "[[gauge]]\nname = \"area\"\ntype = \"area\"\nsoft = \"jelly\"\n"
      "[[gauge]]\nname = \"energy\"\ntype = \"energy\"\nspecies = \"soft\"\n"
      "[[gauge]]\nname = \"mass\"\ntype = \"mass\"\nspecies = \"soft\"\n");
  World world = scene::makeWorld(scene);
  deform(world, 1.1, 0.0);
  run::GaugeSet gauges(scene.gauges, world);
  EXPECT_EQ(gauges.header(),
            "t,tip.x,tip.y,end.x,end.y,area,energy.kinetic,energy.potential,energy.strain,energy.total,mass");
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  ASSERT_EQ(rows.size(), 1u);
  const std::vector<double> v = row(rows[0]);
  EXPECT_NEAR(v[1], 0.05, 1e-14);
  EXPECT_NEAR(v[2], 0.0, 1e-14);
  EXPECT_NEAR(v[3], 0.2, 1e-14);
  EXPECT_NEAR(v[5], 0.275, 1e-14);
  EXPECT_EQ(v[6], 0.0);
  EXPECT_GT(v[8], 0.0);
  EXPECT_EQ(v[9], v[6] + v[7] + v[8]);
  EXPECT_NEAR(v[10], 1000.0 * (0.25 + 0.02), 1e-9);
}

TEST(SoftOutput, the_surface_tells_the_strain_and_not_the_turning) {
  const scene::Scene scene = jellyAndRope();
  World world = scene::makeWorld(scene);
  deform(world, 1.0, 0.4);
  for (const float strain : exporting::softSurface(world).strain) EXPECT_NEAR(strain, 0.0F, 1e-6F);
  deform(world, 1.2, 0.0);
  const exporting::SoftSurface surface = exporting::softSurface(world);
  ASSERT_EQ(surface.triangles.size(), scene.world.soft[0].mesh->triangles.size());
  ASSERT_EQ(surface.links.size(), 10u);
  for (const float strain : surface.strain) EXPECT_NEAR(strain, 0.2F, 1e-6F);
  const double along = std::hypot(1.2 * std::cos(0.4), std::sin(0.4));
  for (const float strain : surface.linkStrain) EXPECT_NEAR(strain, along - 1.0, 1e-6);
}

TEST(SoftOutput, frames_hold_points_triangles_and_links) {
  const scene::Scene scene = jellyAndRope("[output]\nframes = [\"h5\"]\n");
  World world = scene::makeWorld(scene);
  deform(world, 1.2, 0.0);
  TemporaryFolder folder;
  exporting::FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 0);
  writer.closeSegment();
  const std::string file = folder.file("frames/0000.h5");
  const std::size_t n = world.soft()->size(), t = scene.world.soft[0].mesh->triangles.size();
  const test::Dataset position = readDataset(file, "frame_00000/position"),
                      species = readDataset(file, "frame_00000/species"),
                      density = readDataset(file, "frame_00000/density"),
                      triangles = readDataset(file, "frame_00000/triangles"),
                      strain = readDataset(file, "frame_00000/strain"), links = readDataset(file, "frame_00000/links");
  ASSERT_EQ(position.shape, (std::vector<hsize_t>{n, 2}));
  ASSERT_EQ(triangles.shape, (std::vector<hsize_t>{t, 3}));
  ASSERT_EQ(strain.shape, (std::vector<hsize_t>{t}));
  ASSERT_EQ(links.shape, (std::vector<hsize_t>{10, 2}));
  double area = 0.0;
  const auto at = [&](double k) {
    const auto i = 2 * static_cast<std::size_t>(k);
    return Vec2(position.values[i], position.values[i + 1]);
  };
  for (std::size_t k = 0; k < t; ++k) {
    const Vec2 a = at(triangles.values[3 * k]);
    area += 0.5 * cross(Vec2(at(triangles.values[3 * k + 1]) - a), Vec2(at(triangles.values[3 * k + 2]) - a));
    EXPECT_NEAR(strain.values[k], 0.2, 1e-6);
  }
  EXPECT_NEAR(area, 0.3, 1e-6);
  EXPECT_NEAR((at(links.values.back()) - Vec2(3.4, 1.0)).norm(), 0.0, 1e-6);
  for (std::size_t k = 0; k < n; ++k) {
    EXPECT_EQ(species.values[k], 2.0);
    EXPECT_EQ(density.values[k], 1000.0);
  }
  const std::string xdmf = folder.text("frames.xdmf");
  for (const char* part : {"Polyvertex", "TopologyType=\"Triangle\"", "TopologyType=\"Polyline\"",
                           "frames/0000.h5:/frame_00000/triangles", "Center=\"Cell\""})
    EXPECT_NE(xdmf.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace froude
