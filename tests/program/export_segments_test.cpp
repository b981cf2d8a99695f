// Frames in HDF5 and XDMF, read back.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <regex>

#include "export/frames.h"
#include "export/segments.h"
#include "export_support.h"

namespace froude::exporting {
namespace {

using test::FullDisk;
using test::readDataset;
using test::readNumber;
using test::rootNames;
using test::smallScene;
using test::TemporaryFolder;
using test::worldOf;

scene::Scene h5Scene() {
  scene::Scene scene = smallScene();
  scene.output.png = false;
  return scene;
}

TEST(ExportSegments, hold_every_particle_as_it_is) {
  const scene::Scene scene = h5Scene();
  World world = worldOf(scene);
  ASSERT_TRUE(world.step(0.02).ok());
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 0);
  EXPECT_FALSE(folder.has("frames/0000.h5"));
  writer.closeSegment();

  const std::string file = folder.file("frames/0000.h5");
  const ParticlePool &fluid = *world.fluid(), &bullets = *world.bullets();
  const std::size_t n = fluid.size() + bullets.size();
  const test::Dataset position = readDataset(file, "frame_00000/position"),
                      velocity = readDataset(file, "frame_00000/velocity"),
                      pressure = readDataset(file, "frame_00000/pressure"),
                      density = readDataset(file, "frame_00000/density"),
                      species = readDataset(file, "frame_00000/species"), id = readDataset(file, "frame_00000/id"),
                      bodies = readDataset(file, "frame_00000/bodies");
  ASSERT_EQ(position.shape, (std::vector<hsize_t>{n, 2}));
  ASSERT_EQ(velocity.shape, (std::vector<hsize_t>{n, 2}));
  ASSERT_EQ(pressure.shape, (std::vector<hsize_t>{n}));
  ASSERT_EQ(density.shape, (std::vector<hsize_t>{n}));
  ASSERT_EQ(species.shape, (std::vector<hsize_t>{n}));
  ASSERT_EQ(id.shape, (std::vector<hsize_t>{n}));
  EXPECT_EQ(position.elementSize, 4u);
  const auto p = fluid.column(*fluid.findColumn<float>("pressure"));
  const auto d = fluid.column(*fluid.findColumn<float>("density"));
  double pressures = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const bool water = k < fluid.size();
    const ParticlePool& pool = water ? fluid : bullets;
    const std::size_t i = water ? k : k - fluid.size();
    ASSERT_EQ(position.values[2 * k], static_cast<double>(static_cast<float>(pool.x()[i])));
    ASSERT_EQ(position.values[2 * k + 1], static_cast<double>(static_cast<float>(pool.y()[i])));
    ASSERT_EQ(velocity.values[2 * k], static_cast<double>(static_cast<float>(pool.vx()[i])));
    ASSERT_EQ(velocity.values[2 * k + 1], static_cast<double>(static_cast<float>(pool.vy()[i])));
    ASSERT_EQ(species.values[k], water ? 0.0 : 1.0);
    ASSERT_EQ(id.values[k], static_cast<double>(pool.birth()[i]));
    ASSERT_NEAR(pressure.values[k], water ? 1000.0 * static_cast<double>(p[i]) : 0.0,
                1e-3 * std::abs(pressure.values[k]));
    ASSERT_NEAR(density.values[k], 1000.0 * (water ? static_cast<double>(d[i]) : 1.0), 1e-3);
    pressures += pressure.values[k];
  }
  EXPECT_GT(pressures, 0.0);
  EXPECT_EQ(bodies.values, (std::vector<double>{1.2, 0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(readNumber(file, "frame_00000", "time"), world.time());
  EXPECT_EQ(readNumber(file, "frame_00000", "index"), 0.0);
}

// Poses of free bodies are those of their origins, also where the centre of mass is elsewhere; there are no particles.
TEST(ExportSegments, a_world_of_free_bodies_alone_has_their_poses_in_each_frame) {
  scene::Scene scene = h5Scene();
  scene.fluidBlocks.clear();
  scene.bulletBlocks.clear();
  scene.world.fluid.reset();
  scene.world.bullet.reset();
  scene.world.bodies[0].motion = Motion::Free;
  scene.world.bodies[0].position = {1.0, 0.6};
  scene.world.bodies[0].velocity = {0.5, 0.0};
  World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 0);
  world.step(0.1);
  writer.write(world, 1);
  writer.closeSegment();
  const std::string file = folder.file("frames/0000.h5");
  EXPECT_EQ(readDataset(file, "frame_00000/position").shape, (std::vector<hsize_t>{0, 2}));
  const test::Dataset first = readDataset(file, "frame_00000/bodies"), second = readDataset(file, "frame_00001/bodies");
  ASSERT_EQ(first.shape, (std::vector<hsize_t>{1, 6}));
  EXPECT_NEAR(first.values[0], 1.0, 1e-15);
  EXPECT_NEAR(first.values[1], 0.6, 1e-15);
  EXPECT_EQ(first.values[3], 0.5);
  EXPECT_NEAR(second.values[0], 1.05, 1e-6);
  EXPECT_NEAR(second.values[1], 0.6 - 0.5 * 9.81 * 0.01, 3e-3) << "a sub-step's error of free fall";
  EXPECT_NE(folder.text("frames.xdmf").find("</Xdmf>"), std::string::npos);
}

TEST(ExportSegments, positions_far_from_the_origin_are_doubles) {
  scene::Scene scene = h5Scene();
  EXPECT_EQ(positionBytes(scene.world), 4);
  scene.world.bodies.clear();
  scene.world.domain.box = {{1e6, 1e6}, {1e6 + 2.0, 1e6 + 1.0}};
  for (auto* blocks : {&scene.fluidBlocks, &scene.bulletBlocks})
    for (Vec2& p : blocks->front().positions) p += Vec2(1e6, 1e6);
  EXPECT_EQ(positionBytes(scene.world), 8);
  const World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 0);
  writer.closeSegment();
  const test::Dataset position = readDataset(folder.file("frames/0000.h5"), "frame_00000/position");
  for (std::size_t k = 0; k < world.fluid()->size(); ++k) ASSERT_EQ(position.values[2 * k], world.fluid()->x()[k]);
  EXPECT_NE(folder.text("frames.xdmf").find("Precision=\"8\""), std::string::npos);
}

TEST(ExportSegments, one_for_each_closing_and_an_index_over_all) {
  const scene::Scene scene = h5Scene();
  World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  std::vector<double> times;
  for (int k = 0; k < 5; ++k) {
    writer.write(world, k);
    times.push_back(world.time());
    if (k == 1 || k == 3) writer.closeSegment();
    world.step(0.01);
  }
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"frames.h5", "frames.xdmf", "frames/0000.h5", "frames/0001.h5"}));
  EXPECT_EQ(rootNames(folder.file("frames.h5")).size(), 4u);
  writer.closeSegment();
  writer.closeSegment();  // nothing new: nothing happens
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"frames.h5", "frames.xdmf", "frames/0000.h5", "frames/0001.h5",
                                                      "frames/0002.h5"}));
  // Through the external links.
  for (int k = 0; k < 5; ++k) {
    const std::string name = "frame_0000" + std::to_string(k);
    EXPECT_EQ(readNumber(folder.file("frames.h5"), name, "time"), times[static_cast<std::size_t>(k)]);
    EXPECT_EQ(readDataset(folder.file("frames.h5"), name + "/density").shape[0],
              world.fluid()->size() + world.bullets()->size());
  }
}

TEST(ExportSegments, what_was_never_closed_leaves_nothing) {
  const scene::Scene scene = h5Scene();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  {
    FrameWriter writer(folder.path(), scene, world, 0);
    writer.write(world, 0);
  }
  EXPECT_TRUE(folder.files().empty());
}

TEST(ExportSegments, resuming_drops_later_frames) {
  scene::Scene scene = h5Scene();
  scene.output.png = true;
  scene.output.image.width = 160;
  World world = worldOf(scene);
  TemporaryFolder folder;
  {
    FrameWriter writer(folder.path(), scene, world, 0);
    for (int k = 0; k < 7; ++k) {
      writer.write(world, k);
      if (k % 3 == 2) writer.closeSegment();  // 0 1 2 | 3 4 5 | 6 is lost
      world.step(0.01);
    }
  }
  std::ofstream(folder.file("frames/0002.h5.part")) << "half a segment";
  for (const int next : {4, 3}) {  // in the middle of a segment, and at its beginning
    FrameWriter writer(folder.path(), scene, world, next);
    std::vector<std::string> expected = {"frames.h5", "frames.xdmf", "frames/0000.h5"};
    if (next == 4) expected.push_back("frames/0001.h5");
    for (int k = 0; k < next; ++k) expected.push_back("frame_0000" + std::to_string(k) + ".png");
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(folder.files(), expected);
    EXPECT_EQ(rootNames(folder.file("frames.h5")).size(), static_cast<std::size_t>(next));
    EXPECT_NEAR(readNumber(folder.file("frames.h5"), "frame_0000" + std::to_string(next - 1), "time"),
                0.01 * (next - 1), 1e-12);
  }
  FrameWriter writer(folder.path(), scene, world, 3);
  writer.write(world, 3);
  writer.closeSegment();
  EXPECT_TRUE(folder.has("frames/0001.h5"));
  EXPECT_EQ(readNumber(folder.file("frames.h5"), "frame_00003", "time"), world.time());
}

TEST(ExportSegments, writing_alters_nothing) {
  scene::Scene scene = smallScene();
  World plain = worldOf(scene), written = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, written, 0);
  for (int k = 0; k < 4; ++k) {
    plain.substep();
    written.substep();
    const std::string before = written.stateHash();
    writer.write(written, k);
    writer.closeSegment();
    ASSERT_EQ(written.stateHash(), before);
  }
  EXPECT_EQ(plain.stateHash(), written.stateHash());
}

// Tags open and close in order, attributes are quoted, and every item names a dataset of the size it claims.
TEST(ExportXdmf, is_well_formed_and_points_at_what_is_there) {
  const scene::Scene scene = h5Scene();
  World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  for (int k = 0; k < 3; ++k) {
    writer.write(world, k);
    if (k == 0) writer.closeSegment();
    world.step(0.01);
  }
  writer.closeSegment();
  const std::string text = folder.text("frames.xdmf");
  std::vector<std::string> open;
  const std::regex tag(R"re(<(/?)([A-Za-z]+)((?:\s+[A-Za-z]+="[^"<>&]*")*)\s*(/?)>)re");
  std::size_t brackets = 0, tags = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), tag), end; it != end; ++it, ++tags) {
    if ((*it)[1].length() > 0) {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), (*it)[2].str());
      open.pop_back();
    } else if ((*it)[4].length() == 0) {
      open.push_back((*it)[2].str());
    }
  }
  for (const char c : text) brackets += c == '<' ? 1 : 0;
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(brackets, tags + 1);  // all but the declaration

  const std::regex item(R"re(<DataItem Dimensions="([0-9]+)( 2)?"[^>]*>([^:<]+):/([^<]+)</DataItem>)re");
  int items = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), item), end; it != end; ++it, ++items) {
    const test::Dataset set = readDataset(folder.file((*it)[3].str()), (*it)[4].str());
    ASSERT_FALSE(set.shape.empty()) << (*it)[0];
    EXPECT_EQ(set.shape[0], std::stoull((*it)[1].str()));
    EXPECT_EQ(set.shape.size() == 2, (*it)[2].length() > 0);
  }
  EXPECT_EQ(items, 3 * 7);  // six columns, and the numbers of the points
}

TEST(ExportXdmf, leaves_out_frames_without_particles) {
  scene::Scene scene = h5Scene();
  scene.fluidBlocks.clear();
  scene.bulletBlocks.clear();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  writer.write(world, 0);
  writer.closeSegment();
  EXPECT_EQ(folder.text("frames.xdmf").find("Polyvertex"), std::string::npos);
  EXPECT_EQ(readDataset(folder.file("frames.h5"), "frame_00000/position").shape, (std::vector<hsize_t>{0, 2}));
}

TEST(ExportSegments, a_full_disk_is_an_error_that_names_the_file_and_leaves_nothing_half_written) {
  const scene::Scene scene = h5Scene();
  const World world = worldOf(scene);
  for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{3000}}) {
    TemporaryFolder folder;
    FrameWriter writer(folder.path(), scene, world, 0);
    writer.write(world, 0);
    {
      const FullDisk full(bytes);
      try {
        writer.closeSegment();
        FAIL() << "no error";
      } catch (const OutputError& e) {
        EXPECT_NE(std::string(e.what()).find("frames/0000.h5"), std::string::npos) << e.what();
      }
    }
    EXPECT_TRUE(folder.files().empty());
    writer.closeSegment();  // there is room again
    EXPECT_EQ(rootNames(folder.file("frames.h5")).size(), 1u);
  }
}

TEST(ExportSegments, a_folder_that_cannot_be_made_is_an_error) {
  const scene::Scene scene = h5Scene();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  std::ofstream(folder.file("frames")) << "in the way";
  EXPECT_THROW(FrameWriter(folder.path(), scene, world, 0), OutputError);
}

TEST(ExportSegments, a_broken_segment_is_an_error_when_resuming) {
  const scene::Scene scene = h5Scene();
  const World world = worldOf(scene);
  TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("frames"));
  std::ofstream(folder.file("frames/0000.h5")) << "not HDF5";
  EXPECT_THROW(FrameWriter(folder.path(), scene, world, 1), OutputError);
}

// Bytes on disk are what a user budgets for: 29 a particle and a few kB a frame.
TEST(ExportSegments, take_29_bytes_a_particle) {
  scene::Scene scene = smallScene(0.01);
  scene.output.png = false;
  const World world = worldOf(scene);
  TemporaryFolder folder;
  FrameWriter writer(folder.path(), scene, world, 0);
  for (int k = 0; k < 10; ++k) writer.write(world, k);
  writer.closeSegment();
  const auto particles = static_cast<double>(world.fluid()->size() + world.bullets()->size());
  const auto bytes = static_cast<double>(std::filesystem::file_size(folder.file("frames/0000.h5")));
  EXPECT_LT(bytes, 10.0 * (29.0 * particles + 10000.0));
  EXPECT_GE(bytes, 10.0 * 29.0 * particles);
}

}  // namespace
}  // namespace froude::exporting
