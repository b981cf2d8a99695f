// Frames of a run as .vdb files: what is in them, what a resumed run drops, and what a full disk leaves.
#include <froude/fields/distance_field.h>
#include <froude/fields/openvdb/frame_file.h>
#include <gtest/gtest.h>

#include <cmath>

#include "export/frames.h"
#include "export/vdb_frames.h"
#include "program/export_support.h"

namespace froude::exporting {
namespace {

using test::FullDisk;
using test::smallScene;
using test::TemporaryFolder;
using test::worldOf;

/// The small tank with a bar that turns above the water.
scene::Scene vdbScene() {
  scene::Scene scene = smallScene();
  scene.output.png = scene.output.h5 = false;
  scene.output.vdb = true;
  BodyDef bar;
  bar.name = "bar";
  bar.shape = std::make_shared<Polygon>(Polygon::box({{-0.2, -0.075}, {0.2, 0.075}}));
  bar.position = {1.4, 0.6};
  bar.motion = Motion::Scripted;
  bar.spin = 3.0;
  scene.world.bodies.push_back(bar);
  return scene;
}

TEST(ExportVdb, holds_every_particle_and_the_time) {
  const scene::Scene scene = vdbScene();
  World world = worldOf(scene);
  ASSERT_TRUE(world.step(0.02).ok());
  const TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 3);
  EXPECT_EQ(folder.files(), std::vector<std::string>{"frame_00003.vdb"});
  const vdb::FrameRead found = vdb::readFrame(folder.file("frame_00003.vdb"));
  EXPECT_EQ(found.label.time, world.time());
  EXPECT_EQ(found.label.frame, 3);
  const ParticlePool &fluid = *world.fluid(), &bullets = *world.bullets();
  ASSERT_EQ(found.points.size(), fluid.size() + bullets.size());
  const double tolerance = found.pointVoxel * std::ldexp(1.0, -25) + 1e-15;
  std::size_t matched = 0;
  double pressures = 0.0;
  for (std::size_t k = 0; k < found.points.size(); ++k) {
    const bool water = found.points.species[k] == 0;
    const ParticlePool& pool = water ? fluid : bullets;
    for (std::size_t i = 0; i < pool.size(); ++i) {
      if (static_cast<std::int32_t>(pool.birth()[i]) != found.points.id[k]) continue;
      ASSERT_NEAR(found.points.position[k].x(), pool.x()[i], tolerance);
      ASSERT_NEAR(found.points.position[k].y(), pool.y()[i], tolerance);
      ASSERT_EQ(found.points.velocity[k].x(), static_cast<double>(static_cast<float>(pool.vx()[i])));
      ASSERT_EQ(found.points.radius[k], water ? 0.025f : static_cast<float>(scene.world.bullet->radius));
      ++matched;
    }
    pressures += static_cast<double>(found.points.pressure[k]);
  }
  EXPECT_EQ(matched, found.points.size());
  EXPECT_GT(pressures, 0.0);
  const double area = static_cast<double>(fluid.size()) * 0.05 * 0.05;
  EXPECT_NEAR(found.fogArea, area, 1e-5 * area);
}

TEST(ExportVdb, level_sets_are_the_polygons_where_they_are) {
  scene::Scene scene = vdbScene();
  scene.world.fluid->spacing = 0.02;  // the voxel
  scene.fluidBlocks.clear();
  World world = worldOf(scene);
  ASSERT_TRUE(world.step(0.3).ok());
  const TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 0);
  const vdb::FrameRead found = vdb::readFrame(folder.file("frame_00000.vdb"));
  ASSERT_EQ(found.levelSets.size(), 2u);
  for (const auto& [name, body] : {std::pair("obstacles", std::size_t{0}), std::pair("bodies", std::size_t{1})}) {
    const vdb::LevelSet& set = found.levelSets.at(name);
    EXPECT_NEAR(set.voxelSize(), 0.02, 1e-12);
    const DistanceField field(*world.bodyDefinition(body).shape, 0.2);
    const Transform& pose = world.body(body).transform;
    int compared = 0;
    for (double y = 0.005; y < 1.0; y += 0.01)
      for (double x = 0.005; x < 2.0; x += 0.01) {
        const double d = field.sampleExact(pose.toLocal({x, y})).distance;
        // Two voxels inside the band of three, so that all nodes around the point are in it: then √2/2 voxels is the
        // bound.
        if (std::abs(d) > 0.02) continue;
        ASSERT_NEAR(set.distance({x, y}), d, 0.02 * (0.5 * std::sqrt(2.0) + 1e-4)) << name;
        ++compared;
      }
    EXPECT_GT(compared, 100) << name;
  }
  EXPECT_GT(world.body(1).angle, 0.5);
}

TEST(ExportVdb, a_scene_without_bodies_has_points_alone) {
  scene::Scene scene = vdbScene();
  scene.world.bodies.clear();
  const World world = worldOf(scene);
  const TemporaryFolder folder;
  FrameWriter(folder.path(), scene, world, 0).write(world, 0);
  EXPECT_TRUE(vdb::readFrame(folder.file("frame_00000.vdb")).levelSets.empty());
}

TEST(ExportVdb, resuming_drops_later_frames) {
  const scene::Scene scene = vdbScene();
  const World world = worldOf(scene);
  const TemporaryFolder folder;
  FrameWriter first(folder.path(), scene, world, 0);
  for (int k = 0; k < 4; ++k) first.write(world, k);
  const FrameWriter second(folder.path(), scene, world, 2);
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"frame_00000.vdb", "frame_00001.vdb"}));
}

TEST(ExportVdb, writing_alters_nothing) {
  const scene::Scene scene = vdbScene();
  const World world = worldOf(scene);
  const std::string before = world.stateHash();
  const TemporaryFolder folder;
  FrameWriter(folder.path(), scene, world, 0).write(world, 0);
  EXPECT_EQ(world.stateHash(), before);
}

TEST(ExportVdb, a_full_disk_is_an_error_that_names_the_file_and_leaves_nothing_half_written) {
  const scene::Scene scene = vdbScene();
  const World world = worldOf(scene);
  for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{3000}}) {
    const TemporaryFolder folder;
    FrameWriter writer(folder.path(), scene, world, 0);
    {
      const FullDisk full(bytes);
      try {
        writer.write(world, 0);
        ADD_FAILURE() << "no error at " << bytes;
      } catch (const OutputError& e) {
        EXPECT_NE(std::string(e.what()).find("frame_00000.vdb"), std::string::npos) << e.what();
      }
    }
    EXPECT_TRUE(folder.files().empty());
    writer.write(world, 0);  // there is room again
    EXPECT_GT(vdb::readFrame(folder.file("frame_00000.vdb")).points.size(), 0u);
  }
}

}  // namespace
}  // namespace froude::exporting
