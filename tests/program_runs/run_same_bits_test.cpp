// Same scene, same build, same SIMD target: the same state, whatever else differs.
#include <gtest/gtest.h>

#include <string>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

using SameBits = ProgramTest;

TEST_F(SameBits, on_any_number_of_threads) {
  write("s.toml", mixedScene());
  std::string other;
  for (const std::string method : {"pbf", "dfsph"}) {
    const std::string model = "model.fluid=" + method;
    const std::string hash = hashOfRun("s.toml", method, {"--threads", "1", "--set", model});
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_NE(hash, other) << "methods differ";
    other = hash;
    for (const char* threads : {"1", "2", "3", "7"}) {
      EXPECT_EQ(hashOfRun("s.toml", method + threads, {"--threads", threads, "--set", model}), hash)
          << model << threads;
    }
  }
}

TEST_F(SameBits, whatever_is_written_out) {
  write("s.toml", mixedScene());
  const std::string hash = hashOfRun("s.toml", "none");
  EXPECT_EQ(hashOfRun("s.toml", "all",
                      {"--frames", "png,h5", "--set", "output.every=0.003", "--set", "output.checkpoint=0.01", "--set",
                       "output.png={width = 64}"}),
            hash);
  EXPECT_EQ(hashOfRun("s.toml", "verbose", {"--verbose", "--set", "gauge.0.every=0.0005"}), hash);
}

TEST_F(SameBits, from_the_resolved_scene_alone) {
  write("s.toml", mixedScene());
  const std::string hash = hashOfRun("s.toml", "first", {"--set", "seed=11", "--set", "bullet.block.0.count=50"});
  EXPECT_EQ(hashOfRun("first/scene.toml", "second"), hash);
  EXPECT_EQ(read("first/scene.toml").substr(read("first/scene.toml").find('\n')),
            read("second/scene.toml").substr(read("second/scene.toml").find('\n')));
}

TEST_F(SameBits, another_seed_gives_another_state) {
  write("s.toml", mixedScene());
  EXPECT_NE(hashOfRun("s.toml", "a"), hashOfRun("s.toml", "b", {"--set", "seed=8"}));
}

using LongSameBits = ProgramTest;

TEST_F(LongSameBits, resumed_at_every_tenth_step_on_changing_threads) {
  write("s.toml", mixedScene());
  const std::string hash = hashOfRun("s.toml", "straight", {"--threads", "1", "--until", "1.0"});
  hashOfRun("s.toml", "o", {"--threads", "2", "--until", "0.01"});
  for (int i = 1; i <= 20; ++i) {
    const std::string until = std::to_string(0.05 * i), threads = std::to_string(1 + i % 4);
    EXPECT_EQ(froude({"resume", "o", "--until", until, "--threads", threads}).code, 0);
  }
  EXPECT_EQ(stateHash("o"), hash);
}

}  // namespace
}  // namespace froude::testing
