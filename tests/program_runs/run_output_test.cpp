// What a run says and leaves behind.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

using Output = ProgramTest;

TEST_F(Output, quiet_leaves_the_folder_alone_on_stdout) {
  write("s.toml", tinyScene());
  const Outcome outcome = froude({"run", "s.toml", "--quiet"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, "out/s\n");
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Output, results_go_to_stdout_and_the_last_line_is_the_folder) {
  write("s.toml", tinyScene());
  const Outcome outcome = froude({"run", "s.toml", "-o", "here/"});
  EXPECT_EQ(outcome.lastLine(), "here");
  EXPECT_NE(outcome.out.find("done"), std::string::npos);
  EXPECT_NE(outcome.out.find(stateHash("here")), std::string::npos);
}

TEST_F(Output, verbose_tells_of_steps_on_stderr) {
  write("s.toml", mixedScene());
  const Outcome outcome = froude({"run", "s.toml", "--verbose", "--trace-leaks", "--set", "model.time_step=0.001"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("sub-step 100:"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("leak:"), std::string::npos) << outcome.err;
}

TEST_F(Output, the_summary_has_every_key_of_the_contract) {
  write("s.toml", tinyScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o", "--threads", "1"}).code, 0);
  const nlohmann::json found = summary("o");
  for (const char* key : {"schema",
                          "froude_version",
                          "git_commit",
                          "build_type",
                          "compiler",
                          "simd",
                          "cpu",
                          "command",
                          "scene",
                          "scene_sha256",
                          "seed",
                          "threads",
                          "model",
                          "spacing",
                          "particles",
                          "steps",
                          "substeps",
                          "simulated_seconds",
                          "wall_seconds",
                          "particle_steps_per_second",
                          "step_limits",
                          "leaks",
                          "crushed",
                          "retired",
                          "wall_hits",
                          "max_density_error",
                          "mean_density_error",
                          "volume_error",
                          "energy_drift",
                          "momentum_error",
                          "state_hash",
                          "warnings",
                          "status",
                          "gauges"}) {
    EXPECT_TRUE(found.contains(key)) << key;
  }
  EXPECT_EQ(found["schema"], 1);
  EXPECT_EQ(found["particles"], 100);
  EXPECT_EQ(found["threads"], 1);
  EXPECT_EQ(found["leaks"], 0);
  EXPECT_EQ(found["model"], "pbf");
  EXPECT_EQ(found["gauges"]["front"], "m");
  EXPECT_GE(found["simulated_seconds"].get<double>(), 0.1);
  EXPECT_EQ(found["state_hash"].get<std::string>().size(), 16u);
  // A hundred particles that fall do not gain or lose a tenth of their volume, nor momentum from nowhere.
  EXPECT_LT(std::abs(found["volume_error"].get<double>()), 0.1);
  EXPECT_LT(found["momentum_error"].get<double>(), 1e-6);
  std::uint64_t bound = 0;
  for (const auto& limit : found["step_limits"]) bound += limit.get<std::uint64_t>();
  EXPECT_EQ(bound, found["substeps"].get<std::uint64_t>());
}

TEST_F(Output, gauges_have_a_row_at_the_start_at_every_multiple_and_at_the_end) {
  write("s.toml", tinyScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o"}).code, 0);
  std::istringstream rows(read("o/gauges.csv"));
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line.rfind("t,front,energy.", 0), 0u) << line;
  std::vector<double> times;
  while (std::getline(rows, line)) times.push_back(std::stod(line));
  ASSERT_GE(times.size(), 13u);  // 0, 0.01 … 0.1; 0.025 and 0.075; perhaps an end beyond
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_DOUBLE_EQ(times.back(), summary("o")["simulated_seconds"].get<double>());
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LT(times[i - 1], times[i]);
  for (const double due : {0.01, 0.025, 0.05, 0.075, 0.1}) {
    EXPECT_TRUE(std::any_of(times.begin(), times.end(), [&](double t) { return std::abs(t - due) < 1e-12; })) << due;
  }
}

TEST_F(Output, frames_are_written_as_asked) {
  write("s.toml", tinyScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "png", "--frames", "png", "--set", "output.png={width = 120}"}).code, 0);
  Words found = files("png");
  EXPECT_EQ(std::count_if(found.begin(), found.end(), [](const std::string& f) { return f.ends_with(".png"); }), 6);
  ASSERT_EQ(froude({"run", "s.toml", "-o", "h5", "--frames", "h5"}).code, 0);
  found = files("h5");
  for (const char* name : {"frames.h5", "frames.xdmf", "frames/0000.h5", "player.frames", "index.html"}) {
    EXPECT_NE(std::find(found.begin(), found.end(), name), found.end()) << name;
  }
  ASSERT_EQ(froude({"run", "s.toml", "-o", "none", "--frames", "none"}).code, 0);
  EXPECT_EQ(files("none"), (Words{"checkpoint.h5", "gauges.csv", "index.html", "scene.toml", "summary.json"}));
}

TEST_F(Output, vdb_frames_are_written_dropped_by_resume_and_replaced_by_force) {
  const bool has =
      nlohmann::json::parse(froude({"doctor", "--json"}).out)["dependencies"]["OpenVDB"].get<std::string>().find(
          "not in this build") == std::string::npos;
  write("s.toml", tinyScene());
  const Outcome outcome = froude({"run", "s.toml", "-o", "o", "--frames", "vdb"});
  if (!has) {
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("no OpenVDB"), std::string::npos) << outcome.err;
    return;
  }
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("grids: o/frame_*.vdb (6)"), std::string::npos) << outcome.out;
  Words found = files("o");
  EXPECT_EQ(std::count_if(found.begin(), found.end(), [](const std::string& f) { return f.ends_with(".vdb"); }), 6);
  const std::string hash = stateHash("o");
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o", "--force", "--frames", "vdb", "--until", "0.05"}).code, 0);
  std::filesystem::copy(path("o/frame_00000.vdb"), path("o/frame_00009.vdb"));  // later than the checkpoint
  ASSERT_EQ(froude({"resume", "o"}).code, 0);
  found = files("o");
  EXPECT_EQ(std::count_if(found.begin(), found.end(), [](const std::string& f) { return f.ends_with(".vdb"); }), 6);
  EXPECT_EQ(stateHash("o"), hash);
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o", "--force", "--frames", "none"}).code, 0);
  EXPECT_EQ(files("o"), (Words{"checkpoint.h5", "gauges.csv", "index.html", "scene.toml", "summary.json"}));
}

TEST_F(Output, folders_are_numbered_and_force_replaces) {
  write("s.toml", tinyScene());
  EXPECT_EQ(froude({"run", "s.toml"}).lastLine(), "out/s");
  EXPECT_EQ(froude({"run", "s.toml"}).lastLine(), "out/s-2");
  EXPECT_EQ(froude({"run", "s.toml", "-o", "out/s"}).code, 2);
  write("out/s/mine.txt", "mine");
  const Outcome forced = froude({"run", "s.toml", "-o", "out/s", "--force", "--set", "model.spacing=0.1"});
  EXPECT_EQ(forced.code, 0) << forced.err;
  EXPECT_EQ(summary("out/s")["particles"], 16);
  EXPECT_EQ(read("out/s/mine.txt"), "mine");
  EXPECT_EQ(summary("out/s-2")["particles"], 100);
}

TEST_F(Output, a_refused_scene_does_not_cost_an_earlier_run_its_files) {
  write("s.toml", tinyScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o"}).code, 0);
  const std::string before = read("o/summary.json");
  EXPECT_EQ(froude({"run", "s.toml", "-o", "o", "--force", "--set", "model.spacing=-1"}).code, 2);
  EXPECT_EQ(read("o/summary.json"), before);
}

TEST_F(Output, a_set_reaches_array_tables_by_index) {
  write("s.toml", tinyScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o", "--set", "fluid.block.0.shape={ box = [0, 0, 0.2, 0.2] }"}).code, 0);
  EXPECT_EQ(summary("o")["particles"], 25);
}

TEST_F(Output, errors_are_coloured_on_a_terminal_unless_no_color_is_set) {
  Circumstances terminal;
  terminal.terminal = true;
  terminal.environment = {{"TERM", "xterm"}, {"NO_COLOR", ""}};
  EXPECT_NE(froude({"resume", "absent"}, terminal).err.find("\033["), std::string::npos);
  terminal.environment = {{"TERM", "xterm"}, {"NO_COLOR", "1"}};
  EXPECT_EQ(froude({"resume", "absent"}, terminal).err.find("\033["), std::string::npos);
  EXPECT_EQ(froude({"resume", "absent"}).err.find("\033["), std::string::npos);
}

TEST_F(Output, help_and_version_go_to_stdout) {
  for (const char* command : {"run", "check", "explain", "resume", "doctor"}) {
    const Outcome help = froude({command, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_NE(help.out.find("Example:\n  froude " + std::string(command)), std::string::npos);
    EXPECT_NE(help.out.find("Exit codes: 0"), std::string::npos);
  }
  const Outcome version = froude({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.rfind("froude ", 0), 0u) << version.out;
}

TEST_F(Output, check_judges_and_runs_nothing) {
  write("good.toml", tinyScene());
  write("bad.toml", "format = 1\n");
  EXPECT_EQ(froude({"check", "good.toml"}).code, 0);
  EXPECT_EQ(froude({"check", "good.toml", "bad.toml"}).code, 2);
  const Outcome json = froude({"check", "good.toml", "--json"});
  EXPECT_FALSE(nlohmann::json::parse(json.out, nullptr, false).is_discarded()) << json.out;
  EXPECT_EQ(files(""), (Words{"bad.toml", "good.toml"}));
}

TEST_F(Output, explain_says_what_is_modelled_and_what_is_not) {
  write("s.toml", tinyScene());
  const Outcome text = froude({"explain", "s.toml"});
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* part : {"Modelled", "pbf", "Not modelled", "bullets", "because", "sub-steps", "memory"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part;
  }
  const auto json = nlohmann::json::parse(froude({"explain", "s.toml", "--json"}).out, nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_GT(json["predicted"]["memory_bytes"].get<double>(), 0.0);
  EXPECT_GT(json["predicted"]["substeps"].get<double>(), 1.0);
  EXPECT_EQ(files(""), Words{"s.toml"});
  EXPECT_EQ(froude({"explain", "absent.toml"}).code, 2);
}

TEST_F(Output, doctor_tells_the_build_and_its_libraries) {
  const Outcome text = froude({"doctor"});
  EXPECT_EQ(text.code, 0);
  for (const char* part : {"build", "SIMD", "threads", "clock noise", "ffmpeg", "HDF5", "oneTBB"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part;
  }
  const auto json = nlohmann::json::parse(froude({"doctor", "--json"}).out, nullptr, false);
  ASSERT_TRUE(json.is_object());
  for (const char* library : {"oneTBB", "Eigen", "HDF5", "OpenVDB", "Cairo", "fmt", "toml++", "muParser", "CLI11"}) {
    EXPECT_TRUE(json["dependencies"].contains(library)) << library;
  }
}

}  // namespace
}  // namespace froude::testing
