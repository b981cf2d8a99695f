// Stopped, killed, locked and resumed: the files and the bits are those of a run that never stopped.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <string>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

namespace fs = std::filesystem;

// A scene that goes on for as long as a test wants.
std::string endless(const std::string& scene) {
  std::string text = scene;
  const std::size_t at = text.find("duration = 0.");
  return text.replace(at, text.find('\n', at) - at, "duration = 1000.0");
}

class Resume : public ProgramTest {
 protected:
  void expectSameAs(const std::string& straight, const std::string& resumed) const {
    EXPECT_EQ(stateHash(straight), stateHash(resumed));
    EXPECT_EQ(read(straight + "/gauges.csv"), read(resumed + "/gauges.csv"));
    Words pictures = files(straight);
    std::erase_if(pictures, [](const std::string& file) { return !file.ends_with(".png"); });
    for (const std::string& file : pictures) {
      EXPECT_TRUE(read(straight + "/" + file) == read(resumed + "/" + file)) << file;
    }
    const auto first = summary(straight), second = summary(resumed);
    for (const char* key : {"substeps", "particles", "simulated_seconds", "frames", "volume_error", "energy_drift",
                            "scene", "scene_sha256", "max_density_error", "momentum_error", "step_limits", "status"}) {
      EXPECT_EQ(first[key], second[key]) << key;
    }
  }
  // Starts an endless run, waits for FILE in its folder, ends it by a signal.
  Outcome interrupt(const std::string& scene, const std::string& folder, int number, const std::string& file) const {
    Process process({"run", scene, "-o", folder}, home_);
    waitFor(folder + "/" + file);
    process.signal(number);
    return process.wait();
  }
};

TEST_F(Resume, a_run_stopped_at_several_times_is_as_if_it_had_never_stopped) {
  for (const auto& [scene, method] :
       {std::pair{tinyScene(), "pbf"}, std::pair{mixedScene(), "pbf"}, std::pair{mixedScene(), "dfsph"}}) {
    write("s.toml", scene);
    const Words words{
        "--frames", "png,h5", "--set", "output.png={width = 160}", "--set", std::string("model.fluid=") + method,
        "--force"};
    hashOfRun("s.toml", "straight", words);
    Words first = words;
    first.insert(first.end(), {"--until", "0.013"});
    hashOfRun("s.toml", "stopped", first);
    for (const char* until : {"0.03", "0.0301", "0.07"}) {
      const Outcome outcome = froude({"resume", "stopped", "--until", until, "--threads", "3"});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
    }
    const Outcome outcome = froude({"resume", "stopped", "--quiet"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "stopped\n");
    expectSameAs("straight", "stopped");
  }
}

TEST_F(Resume, every_frame_of_a_resumed_run_is_in_its_segments) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o", {"--frames", "h5", "--until", "0.045"});
  const Outcome outcome = froude({"resume", "o"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string list = read("o/frames.xdmf");
  std::size_t grids = 0;
  for (std::size_t at = list.find("<Time"); at != std::string::npos; at = list.find("<Time", at + 1)) ++grids;
  EXPECT_EQ(grids, summary("o")["frames"].get<std::size_t>());
  EXPECT_EQ(grids, 6u);
}

TEST_F(Resume, sigint_and_sigterm_end_with_a_checkpoint_that_goes_on) {
  write("s.toml", endless(tinyScene()));
  for (const auto& [number, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    const std::string folder = "o" + std::to_string(code), straight = "straight" + std::to_string(code);
    const Outcome outcome = interrupt("s.toml", folder, number, "gauges.csv");
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.lastLine(), folder);
    EXPECT_EQ(summary(folder)["status"], "interrupted");
    const std::string until = std::to_string(summary(folder)["simulated_seconds"].get<double>() + 0.04);
    EXPECT_EQ(froude({"resume", folder, "--until", until}).code, 0);
    hashOfRun("s.toml", straight, {"--until", until});
    expectSameAs(straight, folder);
  }
}

TEST_F(Resume, a_killed_run_goes_on_from_its_last_checkpoint) {
  write("s.toml", endless(mixedScene()));
  // A checkpoint every 20 ms of wall time; the kill comes at whatever moment it comes, files half-grown and all.
  {
    Process process({"run", "s.toml", "-o", "o", "--frames", "h5", "--set", "output.checkpoint=0.02"}, home_);
    waitFor("o/checkpoint.h5");
    usleep(50000);
    process.signal(SIGKILL);
    EXPECT_EQ(process.wait().code, -SIGKILL);
  }
  EXPECT_EQ(summary("o")["status"], "running");
  // The summary is written after the checkpoint, so the kill may have come between them: the end lies many intervals
  // ahead of either.
  const std::string until = std::to_string(summary("o")["simulated_seconds"].get<double>() + 2.0);
  const Outcome outcome = froude({"resume", "o", "--until", until});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  hashOfRun("s.toml", "straight", {"--until", until, "--frames", "h5", "--set", "output.checkpoint=1000"});
  expectSameAs("straight", "o");
}

TEST_F(Resume, a_second_signal_ends_at_once) {
  write("s.toml", endless(tinyScene()));
  Process process({"run", "s.toml", "-o", "o", "--threads", "1"}, home_);
  waitFor("o/gauges.csv");
  process.signal(SIGSTOP);  // both are there before the run can look at the first
  process.signal(SIGINT);
  process.signal(SIGTERM);
  process.signal(SIGCONT);
  const int code = process.wait().code;
  EXPECT_TRUE(code == 130 || code == 143) << code;
  EXPECT_EQ(summary("o")["status"], "running");
}

TEST_F(Resume, a_finished_run_says_so) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o");
  const std::string before = read("o/summary.json");
  const Outcome outcome = froude({"resume", "o"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("done"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.lastLine(), "o");
  EXPECT_EQ(read("o/summary.json"), before);
}

TEST_F(Resume, a_missing_checkpoint_is_said) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o");
  fs::remove(path("o/checkpoint.h5"));
  const Outcome outcome = froude({"resume", "o"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("checkpoint.h5"), std::string::npos) << outcome.err;
}

TEST_F(Resume, a_damaged_checkpoint_is_not_taken) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o", {"--until", "0.05"});
  const std::string sound = read("o/checkpoint.h5"), gauges = read("o/gauges.csv");
  for (const std::size_t at : {std::size_t{0}, std::size_t{600}, sound.size() / 2, sound.size() - 1}) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    write("o/checkpoint.h5", damaged);
    const Outcome outcome = froude({"resume", "o"});
    EXPECT_EQ(outcome.code, 4) << at << outcome.err;
    EXPECT_NE(outcome.err.find("checkpoint.h5"), std::string::npos) << outcome.err;
  }
  write("o/checkpoint.h5", sound.substr(0, sound.size() / 3));
  EXPECT_EQ(froude({"resume", "o"}).code, 4);
  EXPECT_EQ(read("o/gauges.csv"), gauges);
}

TEST_F(Resume, a_checkpoint_of_another_scene_is_not_taken) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o", {"--until", "0.05"});
  write("o/scene.toml", mixedScene());
  const Outcome outcome = froude({"resume", "o"});
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("scene.toml"), std::string::npos) << outcome.err;
}

TEST_F(Resume, lost_gauge_rows_are_said) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o", {"--until", "0.05"});
  write("o/gauges.csv", "t\n");
  EXPECT_EQ(froude({"resume", "o"}).code, 4);
}

TEST_F(Resume, another_simd_target_needs_force) {
  write("s.toml", tinyScene());
  hashOfRun("s.toml", "o", {"--until", "0.03", "--simd", "scalar"});
  const Outcome refused = froude({"resume", "o", "--simd", "sse4"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("scalar"), std::string::npos) << refused.err;
  EXPECT_EQ(froude({"resume", "o", "--until", "0.05"}).code, 0);  // by itself it takes the target of the run
  EXPECT_EQ(summary("o")["simd"], "scalar");
  EXPECT_EQ(froude({"resume", "o", "--simd", "sse4", "--force"}).code, 0);
  EXPECT_EQ(summary("o")["simd"], "sse4");
}

TEST_F(Resume, nobody_else_may_write_into_the_folder_of_a_run_at_work) {
  write("s.toml", endless(tinyScene()));
  Process process({"run", "s.toml", "-o", "o"}, home_);
  waitFor("o/gauges.csv");
  for (const Words& words : {Words{"resume", "o"}, Words{"run", "s.toml", "-o", "o", "--force"}}) {
    const Outcome outcome = froude(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("another run"), std::string::npos) << outcome.err;
  }
  process.signal(SIGINT);
  EXPECT_EQ(process.wait().code, 130);
  EXPECT_EQ(froude({"resume", "o", "--until", "0"}).code, 0);
}

}  // namespace
}  // namespace froude::testing
