// Frames written and read back with OpenVDB.
#include <froude/base/random.h>
#include <froude/fields/openvdb/frame_file.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "program/export_support.h"

namespace froude::vdb {
namespace {

Points somePoints(std::size_t count, const Vec2& origin) {
  RandomStream random(11, count);
  Points points;
  points.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    points.position[i] = origin + Vec2(random.uniform(-1.0, 3.0), random.uniform(-2.0, 1.0));
    points.velocity[i] = {random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)};
    points.pressure[i] = static_cast<float>(random.uniform(0.0, 1e4));
    points.density[i] = 1000.0f;
    points.radius[i] = 0.01f;
    points.species[i] = i % 10 == 0 ? 1 : 0;
    points.id[i] = static_cast<std::int32_t>(7 * i + 1);
  }
  return points;
}

TEST(FrameFile, gives_back_every_point_once_and_to_single_precision_wherever_it_lies) {
  for (const Vec2& origin : {Vec2(0.0, 0.0), Vec2(1e6, -1e6)}) {
    const test::TemporaryFolder folder;
    FrameContents contents;
    contents.label = {1.25, 7, "m"};
    contents.points = somePoints(5000, origin);
    writeFrame(folder.file("a.vdb"), contents);
    const FrameRead found = readFrame(folder.file("a.vdb"));
    EXPECT_EQ(found.label.time, 1.25);
    EXPECT_EQ(found.label.frame, 7);
    EXPECT_EQ(found.label.unit, "m");
    ASSERT_EQ(found.points.size(), contents.points.size());
    // A float relative to a voxel's centre, at most half a voxel away: half a last bit of one half; then doubles.
    const double tolerance =
        found.pointVoxel * std::ldexp(1.0, -25) + 4.0 * origin.norm() * std::ldexp(1.0, -52) + 1e-15;
    EXPECT_LT(found.pointVoxel, 0.5);
    std::set<std::int32_t> seen;
    for (std::size_t k = 0; k < found.points.size(); ++k) {
      const std::int32_t id = found.points.id[k];
      ASSERT_TRUE(seen.insert(id).second);
      const auto i = static_cast<std::size_t>((id - 1) / 7);
      ASSERT_LE((found.points.position[k] - contents.points.position[i]).lpNorm<Eigen::Infinity>(), tolerance);
      ASSERT_LE((found.points.velocity[k] - contents.points.velocity[i]).norm(), 5.0 * std::ldexp(1.0, -23));
      ASSERT_EQ(found.points.pressure[k], contents.points.pressure[i]);
      ASSERT_EQ(found.points.density[k], contents.points.density[i]);
      ASSERT_EQ(found.points.radius[k], contents.points.radius[i]);
      ASSERT_EQ(found.points.species[k], contents.points.species[i]);
    }
  }
}

TEST(FrameFile, of_no_point_one_point_and_points_on_a_line) {
  const test::TemporaryFolder folder;
  for (const std::size_t count : {0u, 1u, 40u}) {
    FrameContents contents;
    contents.points = somePoints(count, {0.0, 0.0});
    for (Vec2& p : contents.points.position) p.y() = 0.5;
    writeFrame(folder.file("a.vdb"), contents);
    const FrameRead found = readFrame(folder.file("a.vdb"));
    EXPECT_EQ(found.points.size(), count);
    EXPECT_TRUE(found.levelSets.empty());
    for (const Vec2& p : found.points.position) EXPECT_NEAR(p.y(), 0.5, 1e-7);
  }
}

TEST(FrameFile, fog_holds_the_area_of_the_fluid) {
  const test::TemporaryFolder folder;
  FrameContents contents;
  contents.points = somePoints(1000, {0.0, 0.0});
  contents.fogVoxel = 0.1;
  contents.particleArea = 0.004;
  writeFrame(folder.file("a.vdb"), contents);
  EXPECT_NEAR(readFrame(folder.file("a.vdb")).fogArea, 900 * 0.004, 1e-4);  // every tenth is a bullet
}

TEST(FrameFile, level_sets_come_back_as_they_were) {
  const test::TemporaryFolder folder;
  const LevelSet set(Polygon::regular(5, 0.4), 0.02);
  FrameContents contents;
  contents.levelSets["obstacles"] = &set;
  writeFrame(folder.file("a.vdb"), contents);
  const FrameRead found = readFrame(folder.file("a.vdb"));
  const LevelSet& back = found.levelSets.at("obstacles");
  EXPECT_EQ(back.activeVoxels(), set.activeVoxels());
  for (int k = 0; k < 50; ++k) {
    const Vec2 p(0.01 * k, 0.3);
    EXPECT_EQ(back.distance(p), set.distance(p));
  }
}

TEST(FrameFile, what_cannot_be_read_or_written_is_an_error_that_names_the_file) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.file("no.vdb")) << "something else";
  for (const char* name : {"no.vdb", "absent.vdb"}) {
    try {
      readFrame(folder.file(name));
      ADD_FAILURE() << name;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    }
  }
  EXPECT_THROW(writeFrame(folder.file("no/folder.vdb"), FrameContents{}), Error);
}

}  // namespace
}  // namespace froude::vdb
