// What machines do to runs: kills, full and read-only disks, folders that go, clocks that jump, memory that ends.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

namespace fs = std::filesystem;

// Moments that are the same in every session: splitmix64.
class Moments {
 public:
  explicit Moments(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t bound) {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return (z ^ (z >> 31)) % bound;
  }

 private:
  std::uint64_t state_;
};

class Faults : public ProgramTest {
 protected:
  ~Faults() override {
    for (const std::string& place : mounted_) umount2(place.c_str(), MNT_DETACH);
  }

  /// A file system of its own, of so many kB; false where this process may not make one.
  bool mountSmall(const std::string& name, int kilobytes) {
    fs::create_directory(path(name));
    const std::string size = "size=" + std::to_string(kilobytes) + "k";
    if (mount("tmpfs", path(name).c_str(), "tmpfs", 0, size.c_str()) != 0) return false;
    mounted_.push_back(path(name).string());
    return true;
  }
  bool remount(const std::string& name, unsigned long flags, const std::string& options) const {
    return mount("tmpfs", path(name).c_str(), "tmpfs", MS_REMOUNT | flags, options.c_str()) == 0;
  }

  /// Kills a run of the scene at random moments until it ends by itself, at most `most` times; then looks whether hash,
  /// gauges and frames are those of a run that was left alone. Returns the number of kills.
  int killUntilDone(const std::string& scene, const std::string& until, Moments& moments, int most) {
    const Words words{"--until", until, "--frames", "h5", "--set", "output.checkpoint=0.01"};
    const std::string straight = "straight_" + fs::path(scene).stem().string() + until;
    if (!fs::exists(path(straight))) {
      Words run{"run", scene, "-o", straight, "--quiet"};
      run.insert(run.end(), words.begin(), words.end());
      EXPECT_EQ(froude(run).code, 0) << scene;
    }
    const double whole = summary(straight)["wall_seconds"].get<double>();
    int kills = 0;
    for (bool ended = false; !ended;) {
      const bool begun = fs::exists(path("killed/checkpoint.h5")) || fs::exists(path("killed/checkpoint_before.h5"));
      Words run = begun ? Words{"resume", "killed", "--until", until} : Words{"run", scene, "-o", "killed", "--force"};
      if (!begun) run.insert(run.end(), words.begin(), words.end());
      run.insert(run.end(), {"--quiet", "--threads", std::to_string(1 + moments.below(3))});
      Process process(run, home_);
      if (kills < most) {
        usleep(static_cast<useconds_t>(moments.below(static_cast<std::uint64_t>(1e6 * whole) + 60000)));
        process.signal(SIGKILL);
      }
      const Outcome outcome = process.wait();
      EXPECT_TRUE(outcome.code == 0 || outcome.code == -SIGKILL) << scene << outcome.code << outcome.err;
      ended = outcome.code != -SIGKILL;
      kills += ended ? 0 : 1;
    }
    EXPECT_EQ(stateHash("killed"), stateHash(straight)) << scene;
    EXPECT_EQ(read("killed/gauges.csv"), read(straight + "/gauges.csv")) << scene;
    EXPECT_EQ(summary("killed")["frames"], summary(straight)["frames"]) << scene;
    for (const std::string& file : files("killed")) EXPECT_FALSE(file.ends_with(".part")) << scene << file;
    fs::remove_all(path("killed"));
    return kills;
  }

 private:
  std::vector<std::string> mounted_;
};

using LongFaults = Faults;

TEST_F(Faults, five_runs_that_are_killed_at_random_moments_end_with_the_same_hash) {
  write("tiny.toml", tinyScene());
  write("mixed.toml", mixedScene());
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    Moments moments(seed);
    killUntilDone(seed % 2 == 0 ? "tiny.toml" : "mixed.toml", seed % 2 == 0 ? "2.0" : "1.0", moments, 2);
  }
}

TEST_F(LongFaults, a_hundred_kills_over_the_shipped_scenes_end_with_the_same_hashes) {
  const bool all = std::getenv("FROUDE_LONG") != nullptr;
  fs::copy(std::string(FROUDE_SOURCE_DIR) + "/scenes", path("scenes"), fs::copy_options::recursive);
  Words scenes;
  for (const auto& entry : fs::directory_iterator(path("scenes")))
    if (entry.path().extension() == ".toml") scenes.push_back("scenes/" + entry.path().filename().string());
  std::sort(scenes.begin(), scenes.end());
  int kills = 0;
  const int wanted = all ? 100 : 6;
  Moments moments(2026);
  for (std::size_t i = 0; kills < wanted && i < 1000; ++i) {
    const std::string& scene = scenes[(all ? i : i * 7) % scenes.size()];
    kills += killUntilDone(scene, "0.02", moments, std::min(3, wanted - kills));
  }
  EXPECT_EQ(kills, wanted);
}

TEST_F(Faults, a_full_disk_ends_with_4_and_loses_nothing_that_was_written) {
  if (!mountSmall("disk", 1500)) GTEST_SKIP() << "a file system of its own cannot be mounted here";
  write("s.toml", mixedScene());
  const Words words{
      "--frames", "h5,png",           "--set", "output.png={width = 320}", "--set", "output.checkpoint=0.02",
      "--set",    "output.every=0.01"};
  Words full{"run", "s.toml", "-o", "disk/o", "--until", "20"};
  full.insert(full.end(), words.begin(), words.end());
  const Outcome outcome = froude(full);
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("No space left on device"), std::string::npos) << outcome.err;
  EXPECT_TRUE(summary("disk/o").is_object());
  for (const std::string& file : files("disk/o")) EXPECT_FALSE(file.ends_with(".part")) << file;
  ASSERT_TRUE(fs::exists(path("disk/o/checkpoint.h5")));
  // With room again it goes on, and is as if the disk had never been full.
  ASSERT_TRUE(remount("disk", 0, "size=200m"));
  const double reached = summary("disk/o")["simulated_seconds"].get<double>();
  const std::string until = std::to_string(reached + 0.2);
  const Outcome resumed = froude({"resume", "disk/o", "--until", until, "--quiet"});
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  Words straight{"run", "s.toml", "-o", "straight", "--until", until, "--quiet"};
  straight.insert(straight.end(), words.begin(), words.end());
  ASSERT_EQ(froude(straight).code, 0);
  EXPECT_EQ(stateHash("disk/o"), stateHash("straight"));
  EXPECT_EQ(read("disk/o/gauges.csv"), read("straight/gauges.csv"));
  EXPECT_EQ(summary("disk/o")["frames"], summary("straight")["frames"]);
}

TEST_F(Faults, a_read_only_disk_ends_with_4_before_the_first_step) {
  if (!mountSmall("disk", 1000) || !remount("disk", MS_RDONLY, "size=1000k"))
    GTEST_SKIP() << "a file system of its own cannot be mounted here";
  write("s.toml", tinyScene());
  for (const Words& words : {Words{"run", "s.toml", "-o", "disk/o"}, Words{"batch", "s.toml", "-o", "disk/o"}}) {
    const Outcome outcome = froude(words);
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_NE(outcome.err.find("disk/o"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("Read-only file system"), std::string::npos) << outcome.err;
  }
}

TEST_F(Faults, a_folder_that_is_removed_during_the_run_ends_it_with_4) {
  std::string text = tinyScene();
  write("s.toml", text.replace(text.find("duration = 0.1"), 14, "duration = 1e4"));
  for (const std::string command : {"run", "batch"}) {
    Process process({command, "s.toml", "-o", "gone", "--set", "output.checkpoint=0.1"}, home_);
    waitFor(command == "run" ? "gone/gauges.csv" : "gone/s/gauges.csv");
    fs::rename(path("gone"), path("doomed"));
    fs::remove_all(path("doomed"));
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_NE(outcome.err.find("No such file or directory"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(path("gone"))) << "nothing is left half-made";
  }
}

TEST_F(Faults, a_clock_that_jumps_changes_no_bit) {
  write("s.toml", mixedScene());
  const std::string hash = hashOfRun("s.toml", "straight");
  // A clock that goes back and forth by hours at every look.
  Circumstances jumping;
  jumping.environment = {{"LD_PRELOAD", FROUDE_JUMPING_CLOCK}};
  const Outcome outcome = froude({"run", "s.toml", "-o", "o", "--set", "output.checkpoint=0.05"}, jumping);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(stateHash("o"), hash);
  EXPECT_EQ(read("o/gauges.csv"), read("straight/gauges.csv"));
}

TEST_F(Faults, a_scene_beyond_the_limit_on_memory_is_refused_before_anything_is_written) {
  std::string text = tinyScene();
  write("s.toml", text.replace(text.find("spacing = 0.04"), 14, "spacing = 0.0003"));
  Circumstances limited;
  limited.addressSpace = 900L << 20;
  for (const Words& words : {Words{"run", "s.toml", "-o", "o"}, Words{"batch", "s.toml", "-o", "o"}}) {
    const Outcome outcome = froude(words, limited);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("are available"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(files(""), Words{"s.toml"});
}

TEST_F(Faults, a_damaged_or_foreign_checkpoint_is_said_and_the_one_before_it_is_taken) {
  write("s.toml", mixedScene());
  const std::string hash = hashOfRun("s.toml", "straight");
  hashOfRun("s.toml", "o", {"--until", "0.05"});
  ASSERT_EQ(froude({"resume", "o", "--until", "0.1", "--quiet"}).code, 0);
  const std::string sound = read("o/checkpoint.h5");
  std::string flipped = sound, foreign = sound;
  flipped[sound.size() / 2] = static_cast<char>(flipped[sound.size() / 2] ^ 1);
  for (const std::string& bad : {flipped, sound.substr(0, sound.size() / 2), std::string("letter"), std::string()}) {
    fs::remove_all(path("copy"));
    fs::copy(path("o"), path("copy"), fs::copy_options::recursive);
    write("copy/checkpoint.h5", bad);
    const Outcome outcome = froude({"resume", "copy"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("the checkpoint before it, of t = 0.0"), std::string::npos) << outcome.err;
    EXPECT_EQ(stateHash("copy"), hash);
    EXPECT_EQ(read("copy/gauges.csv"), read("straight/gauges.csv"));
  }
  // Neither can be read.
  write("o/checkpoint.h5", flipped);
  write("o/checkpoint_before.h5", "letter");
  EXPECT_EQ(froude({"resume", "o"}).code, 4);
}

}  // namespace
}  // namespace froude::testing
