// Frames for the page, unpacked by a reader that was written from the description in frame_coder.h alone.
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <random>

#include "export/frames.h"
#include "export/page_frames.h"
#include "export/run_page.h"
#include "export_support.h"

namespace froude::exporting {
namespace {

using test::FullDisk;
using test::TemporaryFolder;
using Particles = CoarseFrame::Particles;

/// Reads records one after the other; keeps what the next one is coded against.
class Reader {
 public:
  struct Species {
    std::vector<std::uint32_t> id;
    std::vector<int> x, y, stepX, stepY, speed, value;
  };
  Species species[3];
  std::vector<std::uint32_t> bodies, corners, ends;
  std::vector<int> strain;
  double time = 0.0;
  int index = 0;

  void read(const std::string& record) {
    const auto number = [&](std::size_t at) {
      std::uint32_t v = 0;
      std::memcpy(&v, record.data() + at, 4);
      return v;
    };
    ASSERT_EQ(record.substr(0, 4), "FRPG");
    index = static_cast<int>(number(4));
    std::memcpy(&time, record.data() + 8, 8);
    if (number(16) == 1) *this = Reader(index, time);
    ASSERT_EQ(record.size(), 32 + number(24));
    raw_.resize(number(20));
    uLongf size = raw_.size();
    ASSERT_EQ(uncompress(raw_.data(), &size, reinterpret_cast<const Bytef*>(record.data()) + 32, number(24)), Z_OK);
    ASSERT_EQ(size, raw_.size());
    at_ = 0;
    for (Species& s : species) readSpecies(s);
    readBodies();
    readSurface();
    ASSERT_EQ(at_, raw_.size());
  }

  Reader() = default;

 private:
  Reader(int i, double t) : time(t), index(i) {}
  std::vector<unsigned char> raw_;
  std::size_t at_ = 0;

  std::uint32_t u32() {
    std::uint32_t v = 0;
    for (int k = 0; k < 4; ++k) v |= static_cast<std::uint32_t>(raw_.at(at_++)) << (8 * k);
    return v;
  }
  std::uint32_t varint() {
    std::uint32_t v = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint32_t byte = raw_.at(at_++);
      v |= (byte & 127u) << shift;
      if (byte < 128u) return v;
    }
  }
  std::int64_t signedVarint() {
    const std::int64_t v = varint();
    return v % 2 == 0 ? v / 2 : -(v + 1) / 2;
  }
  std::vector<int> plane(std::size_t n) {
    std::vector<int> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(raw_.at(at_++));
    return out;
  }
  static void keep(std::vector<int>& values, const std::vector<bool>& gone, std::size_t n) {
    std::vector<int> out;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!gone[i]) out.push_back(values[i]);
    out.resize(n, 0);
    values = out;
  }
  void coordinate(std::vector<int>& values, std::vector<int>& steps, std::uint32_t flags, std::size_t fresh) {
    const std::size_t n = values.size();
    const std::vector<int> low = plane(n), high = plane(n);
    int beside = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const int coded = low[i] + 256 * high[i];
      int residual = coded % 2 == 0 ? coded / 2 : -(coded + 1) / 2;
      if ((flags & 2u) != 0) residual += beside;
      beside = residual;
      const int now = ((values[i] + residual + ((flags & 1u) != 0 ? steps[i] : 0)) % 65536 + 65536 * 8) % 65536;
      steps[i] = i + fresh < n ? now - values[i] : 0;
      values[i] = now;
    }
  }
  void bytes(std::vector<int>& values) {
    const std::vector<int> differences = plane(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = (values[i] + differences[i]) % 256;
  }
  void readSpecies(Species& s) {
    const std::size_t n = u32(), lost = u32(), fresh = u32();
    const std::uint32_t flags = u32();
    std::vector<bool> gone(s.id.size(), false);
    for (std::size_t g = 0, place = 0; g < lost; ++g) gone.at(place += varint()) = true;
    std::vector<std::uint32_t> id;
    for (std::size_t i = 0; i < s.id.size(); ++i)
      if (!gone[i]) id.push_back(s.id[i]);
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < fresh; ++i) id.push_back(last += varint());
    s.id = id;
    ASSERT_EQ(id.size(), n);
    for (auto* values : {&s.x, &s.y, &s.stepX, &s.stepY, &s.speed}) keep(*values, gone, n);
    if ((flags & 4u) != 0) keep(s.value, gone, n);
    coordinate(s.x, s.stepX, flags, fresh);
    coordinate(s.y, s.stepY, flags, fresh);
    bytes(s.speed);
    bytes(s.value);
  }
  void readBodies() {
    const std::size_t n = u32();
    bodies.resize(n, 0u);
    for (int shift = 0; shift < 32; shift += 8)
      for (std::uint32_t& b : bodies) b ^= static_cast<std::uint32_t>(raw_.at(at_++)) << shift;
  }
  void readSurface() {
    const std::size_t triangles = u32(), links = u32();
    if (u32() == 0) {
      strain.assign(triangles + links, 0);
      for (auto [list, count] : {std::pair{&corners, 3 * triangles}, std::pair{&ends, 2 * links}}) {
        list->clear();
        std::int64_t last = 0;
        for (std::size_t i = 0; i < count; ++i) list->push_back(static_cast<std::uint32_t>(last += signedVarint()));
      }
    }
    bytes(strain);
  }
};

/// A cloud that is born, moves at random and dies at random.
class Cloud {
 public:
  CoarseFrame frame(int index, bool soft) {
    for (int k = 0; k < 200; ++k) ids_.push_back(next_++);
    std::erase_if(ids_, [&](std::uint32_t) { return random_() % 10 == 0; });
    CoarseFrame frame;
    frame.index = index;
    frame.time = 0.02 * index;
    for (int s = 0; s < 2; ++s) {
      Particles& p = frame.species[s];
      for (const std::uint32_t id : ids_) {
        p.id.push_back(id);
        p.x.push_back(static_cast<std::uint16_t>(random_()));
        p.y.push_back(static_cast<std::uint16_t>(id * 7 + 30 * static_cast<std::uint32_t>(index) + random_() % 4));
        p.speed.push_back(static_cast<std::uint8_t>(random_()));
        if (s == 0) p.value.push_back(static_cast<std::uint8_t>(random_()));
      }
    }
    for (int k = 0; k < 9; ++k) frame.bodies.push_back(0.1f * static_cast<float>(k * index) - 0.3f);
    if (!soft) return frame;
    frame.corners = {0, 1, 2, 2, 1, static_cast<std::uint32_t>(3 + index / 4)};
    frame.ends = {7, 4};
    for (int k = 0; k < 3; ++k) frame.strain.push_back(static_cast<std::uint8_t>(random_()));
    return frame;
  }

 private:
  std::mt19937 random_{7};
  std::uint32_t next_ = 0;
  std::vector<std::uint32_t> ids_;
};

void expectSame(const Reader& read, const CoarseFrame& frame) {
  EXPECT_EQ(read.index, frame.index);
  EXPECT_EQ(read.time, frame.time);
  for (int s = 0; s < 3; ++s) {
    const Particles& p = frame.species[s];
    EXPECT_EQ(read.species[s].id, p.id);
    EXPECT_TRUE(std::equal(p.x.begin(), p.x.end(), read.species[s].x.begin(), read.species[s].x.end()));
    EXPECT_TRUE(std::equal(p.y.begin(), p.y.end(), read.species[s].y.begin(), read.species[s].y.end()));
    EXPECT_TRUE(std::equal(p.speed.begin(), p.speed.end(), read.species[s].speed.begin(), read.species[s].speed.end()));
    EXPECT_TRUE(std::equal(p.value.begin(), p.value.end(), read.species[s].value.begin(), read.species[s].value.end()));
  }
  ASSERT_EQ(read.bodies.size(), frame.bodies.size());
  EXPECT_EQ(std::memcmp(read.bodies.data(), frame.bodies.data(), 4 * frame.bodies.size()), 0);
  EXPECT_EQ(read.corners, frame.corners);
  EXPECT_EQ(read.ends, frame.ends);
  EXPECT_TRUE(std::equal(frame.strain.begin(), frame.strain.end(), read.strain.begin(), read.strain.end()));
}

TEST(PageFrames, come_back_as_they_were_whoever_is_born_and_dies) {
  Cloud cloud;
  FrameCoder coder;
  Reader reader;
  int keys = 0;
  for (int k = 0; k < 50; ++k) {
    const CoarseFrame frame = cloud.frame(k, k > 5);
    const std::string record = coder.encode(frame);
    FrameRecord header;
    ASSERT_TRUE(readRecord(record.data(), header));
    keys += header.key ? 1 : 0;
    EXPECT_EQ(header.particles, frame.particles());
    ASSERT_NO_FATAL_FAILURE(reader.read(record));
    expectSame(reader, frame);
  }
  EXPECT_EQ(keys, 3);
}

TEST(PageFrames, an_older_number_among_the_new_ones_begins_anew) {
  FrameCoder coder;
  Reader reader;
  CoarseFrame frame;
  frame.species[0] = {{3, 5, 9}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1, 1, 1}};
  reader.read(coder.encode(frame));
  frame.species[0] = {{9, 4, 12}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1, 1, 1}};
  reader.read(coder.encode(frame));
  EXPECT_EQ(reader.species[0].id, (std::vector<std::uint32_t>{4, 9, 12}));
  EXPECT_EQ(reader.species[0].x, (std::vector<int>{2, 1, 3}));
}

// Steady flight is told by its first two frames.
TEST(PageFrames, a_predictable_motion_takes_hardly_any_bytes) {
  FrameCoder coder;
  CoarseFrame frame;
  Particles& p = frame.species[1];
  for (std::uint32_t id = 0; id < 10000; ++id) {
    p.id.push_back(id);
    p.x.push_back(static_cast<std::uint16_t>(id * 2654435761u >> 16));
    p.y.push_back(static_cast<std::uint16_t>(id * 40503u));
    p.speed.push_back(100);
  }
  std::size_t bytes = 0;
  for (int k = 0; k < 6; ++k) {
    bytes = coder.encode(frame).size();
    for (std::uint32_t id = 0; id < 10000; ++id) p.x[id] = static_cast<std::uint16_t>(p.x[id] + id % 50);
  }
  EXPECT_LT(bytes, 400u);
}

TEST(PageFrames, a_resumed_run_drops_what_is_later_and_what_is_half_written) {
  TemporaryFolder folder;
  Cloud cloud;
  std::vector<CoarseFrame> taken;
  {
    PageFrames frames(folder.path(), 0);
    for (int k = 0; k < 6; ++k) {
      taken.push_back(cloud.frame(k, false));
      EXPECT_TRUE(frames.append(taken.back()));
    }
  }
  const std::string file = folder.file(PageFrames::kName);
  const auto whole = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, whole - 5);
  {
    PageFrames frames(folder.path(), 100);
    ASSERT_EQ(frames.entries().size(), 5u);
  }
  PageFrames frames(folder.path(), 3);
  ASSERT_EQ(frames.entries().size(), 3u);
  frames.append(taken[3]);
  ASSERT_EQ(frames.entries().size(), 4u);
  EXPECT_TRUE(frames.entries()[3].record.key);
  const std::string bytes = folder.text(PageFrames::kName);
  EXPECT_EQ(bytes.size(), frames.bytes());
  Reader reader;
  for (const PageFrames::Entry& e : frames.entries()) reader.read(bytes.substr(e.begin - 32, 32 + e.record.packed));
  expectSame(reader, taken[3]);
}

TEST(PageFrames, a_full_disk_leaves_whole_frames) {
  TemporaryFolder folder;
  Cloud cloud;
  PageFrames frames(folder.path(), 0);
  frames.append(cloud.frame(0, false));
  const std::uint64_t sound = frames.bytes();
  {
    const FullDisk full(sound + 100);
    EXPECT_THROW(frames.append(cloud.frame(1, false)), OutputError);
  }
  EXPECT_EQ(folder.text(PageFrames::kName).size(), sound);
}

TEST(RunPage, carries_the_summary_the_gauges_and_every_frame) {
  const scene::Scene scene = test::smallScene();
  World world = test::worldOf(scene);
  TemporaryFolder folder;
  std::ofstream(folder.file("gauges.csv")) << "time,a\n0,1\n";
  RunPage page(folder.path(), scene, 0);
  for (int k = 0; k < 3; ++k) {
    page.take(world, k);
    ASSERT_TRUE(world.step(0.01).ok());
  }
  page.write(world, "{\"status\": \"done\", \"reason\": \"</script><b>\"}");
  const std::string text = folder.text("index.html");
  EXPECT_NE(text.find("<title>A small tank</title>"), std::string::npos);
  EXPECT_NE(text.find("\"status\":\"done\""), std::string::npos);
  EXPECT_NE(text.find("\"gauges\":\"time,a\\n0,1\\n\""), std::string::npos);
  EXPECT_NE(text.find("class=\"frames\""), std::string::npos);
  EXPECT_EQ(text.find("</script><b>"), std::string::npos) << "what a summary says cannot end the script";
  EXPECT_EQ(text.find("http://"), std::string::npos) << "nothing is fetched";
  ASSERT_EQ(page.frames()->entries().size(), 3u);
  EXPECT_EQ(page.frames()->entries()[2].record.particles, world.fluid()->size() + world.bullets()->size());
}

TEST(RunPage, has_no_frames_where_the_scene_asks_for_none) {
  scene::Scene scene = test::smallScene();
  scene.output.png = scene.output.h5 = scene.output.vdb = false;
  const World world = test::worldOf(scene);
  TemporaryFolder folder;
  RunPage page(folder.path(), scene, 0);
  page.take(world, 0);
  page.write(world, "{}");
  EXPECT_EQ(folder.files(), std::vector<std::string>{"index.html"});
}

}  // namespace
}  // namespace froude::exporting
