// Every way a run can be refused or end, by the code that a script sees.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

class ExitCodes : public ProgramTest {
 protected:
  // The scene is refused: exit 2, all `parts` are said on stderr, nothing is said on stdout, nothing is written.
  void expectRefusal(const std::string& text, const Words& parts) {
    write("s.toml", text);
    const Outcome outcome = froude({"run", "s.toml"});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("s.toml:", 0), 0u) << outcome.err;
    for (const std::string& part : parts) EXPECT_NE(outcome.err.find(part), std::string::npos) << part << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(files(""), Words{"s.toml"});
  }
  // tinyScene with one text in it replaced by another.
  static std::string with(const std::string& old, const std::string& fresh) {
    std::string text = tinyScene();
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), fresh);
  }
};

TEST_F(ExitCodes, a_sound_scene_ends_with_0) {
  write("s.toml", tinyScene());
  const Outcome outcome = froude({"run", "s.toml"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lastLine(), "out/s");
  EXPECT_EQ(summary("out/s")["status"], "done");
}

TEST_F(ExitCodes, a_missing_scene_is_refused) {
  const Outcome outcome = froude({"run", "absent.toml"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("absent.toml"), std::string::npos) << outcome.err;
  EXPECT_EQ(files(""), Words{});
}

TEST_F(ExitCodes, a_folder_in_the_scenes_place_is_refused) {
  std::filesystem::create_directory(path("s.toml"));
  EXPECT_EQ(froude({"run", "s.toml"}).code, 2);
}

TEST_F(ExitCodes, an_empty_scene_is_refused) { expectRefusal("", {}); }
TEST_F(ExitCodes, what_is_not_toml_is_refused_at_its_place) {
  expectRefusal("format = 1\nduration = = 2\n", {"s.toml:2:"});
}
TEST_F(ExitCodes, bytes_of_a_picture_are_refused) { expectRefusal(std::string("\x89PNG\r\n\x1a\n\0\0", 10), {}); }

TEST_F(ExitCodes, an_unknown_key_is_refused_with_the_nearest) {
  expectRefusal(with("spacing = 0.04", "spacng = 0.04"), {"s.toml:10:", "spacng", "spacing"});
}

TEST_F(ExitCodes, a_wrong_type_is_refused) {
  expectRefusal(with("duration = 0.1", "duration = \"long\""), {"duration"});
}
TEST_F(ExitCodes, a_number_that_is_nan_is_refused) {
  expectRefusal(with("duration = 0.1", "duration = nan"), {"duration"});
}
TEST_F(ExitCodes, a_number_that_is_infinite_is_refused) { expectRefusal(with("0.04", "inf"), {"spacing"}); }

TEST_F(ExitCodes, a_billion_particles_are_refused_with_the_memory_they_need) {
  expectRefusal(with("spacing = 0.04", "spacing = 1.2e-5"), {"GB"});
}

TEST_F(ExitCodes, a_self_crossing_polygon_is_refused) {
  expectRefusal(tinyScene() + "\n[[body]]\nshape = { polygon = [[0.6, 0.1], [0.8, 0.3], [0.8, 0.1], [0.6, 0.3]] }\n",
                {"shape", "cross"});
}

TEST_F(ExitCodes, a_block_with_no_free_place_is_refused) {
  expectRefusal(tinyScene() + "\n[[body]]\nname = \"lid\"\nshape = { box = [0.0, 0.0, 0.5, 0.5] }\n", {"block"});
}

TEST_F(ExitCodes, a_body_wholly_outside_is_refused) {
  expectRefusal(tinyScene() + "\n[[body]]\nname = \"far\"\nshape = { box = [5.0, 5.0, 6.0, 6.0] }\n", {"far"});
}

TEST_F(ExitCodes, a_wrong_set_is_refused) {
  write("s.toml", tinyScene());
  const Outcome outcome = froude({"run", "s.toml", "--set", "model.spacng=0.02"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("spacng"), std::string::npos) << outcome.err;
  EXPECT_EQ(files(""), Words{"s.toml"});
}

TEST_F(ExitCodes, wrong_command_lines_end_with_2_and_write_nothing) {
  write("s.toml", tinyScene());
  for (const Words& words : std::vector<Words>{{},
                                               {"rnu", "s.toml"},
                                               {"batch", "s.toml"},
                                               {"batch", "absent.toml", "-o", "b"},
                                               {"batch", "-o", "b", "--resume"},
                                               {"batch", "--collect", "absent"},
                                               {"run"},
                                               {"run", "s.toml", "--forse"},
                                               {"run", "s.toml", "--threads", "0"},
                                               {"run", "s.toml", "--accuracy", "5%"},
                                               {"run", "s.toml", "--frames", "vbd"},
                                               {"resume", "absent"},
                                               {"resume", "."}}) {
    const Outcome outcome = froude(words);
    EXPECT_EQ(outcome.code, 2) << (words.empty() ? "nothing" : words.back());
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err, "");
  }
  EXPECT_EQ(files(""), Words{"s.toml"});
}

TEST_F(ExitCodes, a_time_step_that_is_far_too_long_ends_with_3_and_keeps_the_last_sound_state) {
  write("s.toml", with("spacing = 0.04", "spacing = 0.04\ntime_step = 1.0"));
  const Outcome outcome = froude({"run", "s.toml", "--until", "30"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("model.time_step"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("the step was set by literal.\n"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("checkpoint.h5"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.lastLine(), "out/s");
  EXPECT_EQ(summary("out/s")["status"], "unstable");
  // The kept state is sound: it loads, and meets the same end again.
  EXPECT_EQ(froude({"resume", "out/s", "--until", "30"}).code, 3);
}

TEST_F(ExitCodes, a_folder_that_cannot_be_made_ends_with_4_before_the_first_step) {
  write("s.toml", tinyScene());
  write("plain", "mine");
  for (const char* folder : {"plain/below", "/proc/froude"}) {
    const Outcome outcome = froude({"run", "s.toml", "-o", folder});
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_NE(outcome.err.find(folder), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(files(""), (Words{"plain", "s.toml"}));
  EXPECT_EQ(read("plain"), "mine");
}

TEST_F(ExitCodes, a_file_size_limit_met_at_the_start_leaves_nothing) {
  write("s.toml", tinyScene());
  Circumstances full;
  full.fileSizeLimit = 100;
  EXPECT_EQ(froude({"run", "s.toml", "-o", "o"}, full).code, 4);
  EXPECT_EQ(files(""), Words{"s.toml"});
}

TEST_F(ExitCodes, a_disk_that_fills_up_ends_with_4_and_leaves_nothing_half_written) {
  write("s.toml", tinyScene());
  Circumstances full;
  full.fileSizeLimit = 8000;  // summary and gauges fit, the checkpoint does not
  const Outcome outcome = froude({"run", "s.toml", "-o", "o"}, full);
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("checkpoint.h5"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.lastLine(), "o");
  EXPECT_EQ(files("o"), (Words{"gauges.csv", "scene.toml", "summary.json"}));
  EXPECT_EQ(summary("o")["status"], "failed");
}

TEST_F(ExitCodes, gauges_end_with_a_whole_line_when_the_disk_fills_up) {
  std::string scene = with("every = 0.01", "every = 0.0001");
  write("s.toml", scene);
  Circumstances full;
  full.fileSizeLimit = 6000;
  EXPECT_EQ(froude({"run", "s.toml", "-o", "o"}, full).code, 4);
  const std::string rows = read("o/gauges.csv");
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.back(), '\n');
}

TEST_F(ExitCodes, a_full_standard_output_ends_with_4) {
  write("s.toml", tinyScene());
  Circumstances full;
  full.stdoutFile = "/dev/full";
  EXPECT_EQ(froude({"run", "s.toml", "-o", "o"}, full).code, 4);
  EXPECT_EQ(summary("o")["status"], "done");
  EXPECT_EQ(froude({"--version"}, full).code, 4);
}

}  // namespace
}  // namespace froude::testing
