// What a command line is read as, and what is said of a wrong one.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/request.h"
#include "export/vdb_frames.h"
#include "run/exit_codes.h"

namespace froude::cli {
namespace {

Request parse(std::vector<std::string> words) {
  words.insert(words.begin(), "froude");
  return parseCommandLine(words);
}

// What is said of a wrong line; empty when it is taken.
std::string complaint(const std::vector<std::string>& words) {
  try {
    parse(words);
  } catch (const run::UsageError& e) {
    return e.what();
  }
  return {};
}

void expectComplaint(const std::vector<std::string>& words, const std::vector<std::string>& parts) {
  const std::string said = complaint(words);
  EXPECT_FALSE(said.empty()) << "taken: " << quoted(words);
  for (const std::string& part : parts) EXPECT_NE(said.find(part), std::string::npos) << part << " in: " << said;
}

TEST(CommandLine, run_takes_all_its_options) {
  const auto run = std::get<run::RunOptions>(parse({"run",
                                                    "a.toml",
                                                    "-o",
                                                    "dir",
                                                    "--force",
                                                    "--threads",
                                                    "3",
                                                    "--until",
                                                    "0.5",
                                                    "--set",
                                                    "model.spacing=0.02",
                                                    "--set",
                                                    "title=a=b",
                                                    "--frames",
                                                    "png",
                                                    "--simd",
                                                    "scalar",
                                                    "--trace-leaks",
                                                    "--quiet",
                                                    "--verbose"}));
  EXPECT_EQ(run.scene, "a.toml");
  EXPECT_EQ(run.folder, "dir");
  EXPECT_EQ(run.session.threads, 3);
  EXPECT_EQ(run.session.until, 0.5);
  EXPECT_EQ(run.session.simd, SimdTarget::Scalar);
  EXPECT_TRUE(run.session.force && run.session.traceLeaks && run.session.quiet && run.session.verbose);
  const std::vector<scene::Override> expected{
      {"model.spacing", "0.02"}, {"title", "a=b"}, {"output.frames", "[\"png\"]"}};
  EXPECT_EQ(run.overrides, expected);
}

TEST(CommandLine, left_out_options_keep_their_defaults) {
  const auto run = std::get<run::RunOptions>(parse({"run", "a.toml"}));
  EXPECT_TRUE(run.folder.empty());
  EXPECT_TRUE(run.overrides.empty());
  EXPECT_EQ(run.session.threads, 0);
  EXPECT_FALSE(run.session.until.has_value());
  EXPECT_FALSE(run.session.simd.has_value());
  EXPECT_FALSE(run.session.force || run.session.quiet || run.session.verbose || run.session.traceLeaks);
}

TEST(CommandLine, a_set_takes_one_word_and_leaves_the_scene_alone) {
  const auto run = std::get<run::RunOptions>(parse({"run", "--set", "seed=2", "a.toml"}));
  EXPECT_EQ(run.scene, "a.toml");
  EXPECT_EQ(run.overrides.size(), 1u);
}

TEST(CommandLine, frames_none_is_an_empty_list_and_both_kinds_keep_their_order) {
  const auto frames = [](const std::string& list) {
    return std::get<run::RunOptions>(parse({"run", "a.toml", "--frames", list})).overrides.at(0).second;
  };
  EXPECT_EQ(frames("none"), "[]");
  EXPECT_EQ(frames("h5,png"), "[\"h5\", \"png\"]");
}

TEST(CommandLine, the_other_commands_are_read) {
  const auto check = std::get<CheckRequest>(parse({"check", "a.toml", "b.toml", "--strict", "--json"}));
  EXPECT_EQ(check.scenes, (std::vector<std::string>{"a.toml", "b.toml"}));
  EXPECT_TRUE(check.strict && check.json);
  EXPECT_TRUE(std::get<ExplainRequest>(parse({"explain", "a.toml", "--json"})).json);
  const auto resume =
      std::get<run::ResumeOptions>(parse({"resume", "out/a", "--until", "1", "--threads", "2", "--force"}));
  EXPECT_EQ(resume.folder, "out/a");
  EXPECT_EQ(resume.session.until, 1.0);
  EXPECT_TRUE(resume.session.force);
  EXPECT_FALSE(std::get<DoctorRequest>(parse({"doctor"})).json);
}

TEST(CommandLine, an_unknown_command_names_the_nearest_and_all) {
  expectComplaint({"rnu", "a.toml"}, {"rnu", "nearest", "run", "check", "explain", "resume", "doctor"});
  expectComplaint({"batsh", "a.toml"}, {"batsh", "batch", "run", "doctor"});
  expectComplaint({}, {"missing", "run", "doctor"});
}

TEST(CommandLine, an_unknown_option_names_the_nearest) {
  expectComplaint({"run", "a.toml", "--forse"}, {"--forse", "--force", "froude run --help"});
  expectComplaint({"run", "a.toml", "--thread=3"}, {"--thread", "--threads"});
  expectComplaint({"run", "--forse"}, {"--forse", "--force"});
  expectComplaint({"--quiet", "run", "a.toml"}, {"--quiet"});
  expectComplaint({"doctor", "--strict"}, {"--strict"});
}

TEST(CommandLine, wrong_values_are_named_with_what_would_be_right) {
  expectComplaint({"run", "a.toml", "--threads", "0"}, {"--threads", "0", "from 1 to"});
  expectComplaint({"run", "a.toml", "--threads", "two"}, {"--threads", "two", "whole number"});
  expectComplaint({"run", "a.toml", "--threads", "1.5"}, {"--threads", "1.5"});
  expectComplaint({"run", "a.toml", "--until", "-1"}, {"--until", "-1", "seconds"});
  expectComplaint({"run", "a.toml", "--until", "nan"}, {"--until", "nan"});
  expectComplaint({"run", "a.toml", "--until", "1s"}, {"--until", "1s"});
  expectComplaint({"run", "a.toml", "--simd", "avx9"}, {"--simd", "avx9", "scalar"});
  expectComplaint({"run", "a.toml", "--frames", "pgn"}, {"--frames", "pgn", "png"});
  expectComplaint({"run", "a.toml", "--frames", "png,,h5"}, {"--frames"});
  expectComplaint({"run", "a.toml", "--set", "seed"}, {"--set", "seed", "PATH=VALUE"});
  expectComplaint({"run", "a.toml", "--set", "=1"}, {"--set", "PATH=VALUE"});
  expectComplaint({"run", "a.toml", "--threads"}, {"--threads"});
}

TEST(CommandLine, what_this_version_does_not_have_is_refused_in_words) {
  expectComplaint({"run", "a.toml", "--accuracy", "5%"}, {"--accuracy", "not in this version", "model.fluid"});
  if (!exporting::kHasOpenVdb) {
    expectComplaint({"run", "a.toml", "--frames", "png,vdb"}, {"vdb", "no OpenVDB", "png"});
  }
}

TEST(CommandLine, missing_and_surplus_arguments_are_named) {
  expectComplaint({"run"}, {"SCENE", "required"});
  expectComplaint({"run", "--quiet"}, {"SCENE", "required"});
  expectComplaint({"check"}, {"SCENE", "required"});
  expectComplaint({"resume"}, {"DIR", "required"});
  expectComplaint({"run", "a.toml", "b.toml"}, {"b.toml", "too many"});
  expectComplaint({"run", "a.toml", "--threads", "1", "--threads", "2"}, {"--threads"});
  expectComplaint({"run", "a.toml", "-o", ""}, {"-o"});
}

TEST(CommandLine, every_help_has_an_example_and_exit_codes) {
  for (const char* command :
       {"run", "check", "explain", "field", "batch", "resume", "chart", "bench", "doctor", "completion", "man"}) {
    const std::string help = std::get<PrintRequest>(parse({command, "--help"})).text;
    EXPECT_NE(help.find("Example"), std::string::npos) << help;
    EXPECT_NE(help.find(":\n  froude " + std::string(command)), std::string::npos) << help;
    EXPECT_NE(help.find("Exit codes: 0"), std::string::npos) << help;
  }
  const std::string help = std::get<PrintRequest>(parse({"--help"})).text;
  for (const char* command :
       {"run", "check", "explain", "field", "batch", "resume", "chart", "bench", "doctor", "completion", "man"}) {
    EXPECT_NE(help.find(command), std::string::npos);
  }
}

TEST(CommandLine, the_version_line_has_version_commit_and_simd_target) {
  const std::string line = std::get<PrintRequest>(parse({"--version"})).text;
  EXPECT_EQ(line.find("froude 0."), 0u) << line;
  EXPECT_NE(line.find("commit "), std::string::npos);
  EXPECT_NE(line.find("SIMD " + std::string(name(bestSimdTarget()))), std::string::npos);
}

TEST(CommandLine, field_takes_all_its_options) {
  const auto field =
      std::get<FieldRequest>(parse({"field", "a.toml#b", "-o", "a.svg", "--offset", "0.1", "--offset", "-0.25",
                                    "--show", "cells,distance", "--width", "640", "--band", "0.5", "--cell", "0.01"}));
  EXPECT_EQ(field.shape, "a.toml#b");
  EXPECT_EQ(field.output, "a.svg");
  EXPECT_EQ(field.picture.offsets, (std::vector<double>{0.1, -0.25}));
  EXPECT_EQ(field.picture.layers,
            (std::vector<exporting::FieldLayer>{exporting::FieldLayer::Cells, exporting::FieldLayer::Distance}));
  EXPECT_EQ(field.picture.width, 640);
  EXPECT_EQ(field.picture.band, 0.5);
  EXPECT_EQ(field.picture.cell, 0.01);
  const auto points = std::get<FieldRequest>(parse({"field", "a.csv", "--at", "-"}));
  EXPECT_EQ(points.points, "-");
  EXPECT_TRUE(points.output.empty());
  EXPECT_EQ(std::get<FieldRequest>(parse({"field", "a.svg#b", "-o", "a.png", "--scale", "0.001"})).svg.scale, 0.001);
}

TEST(CommandLine, field_says_what_it_could_be_asked) {
  expectComplaint({"field", "a.toml"}, {"-o FILE.png", "--at POINTS.csv", "--check"});
  expectComplaint({"field", "a.toml", "-o", "a.jpg"}, {"a.jpg", "FILE.svg or FILE.html"});
  expectComplaint({"field", "a.toml", "-o", ".png"}, {".png"});
  expectComplaint({"field", "a.toml", "--at", "p.csv", "-o", "a.png"}, {"a.png", "FILE.csv"});
  expectComplaint({"field", "a.toml", "--at", "p.csv", "--offset", "1"}, {"--offset", "pictures"});
  expectComplaint({"field", "a.toml", "--check", "-o", "a.png"}, {"--check stands alone"});
  expectComplaint({"field", "a.toml", "-o", "a.png", "--show", "cels"}, {"'cels'", "\"cells\""});
  expectComplaint({"field", "a.toml", "-o", "a.png", "--show", "cells,cells"}, {"'cells'", "twice"});
  expectComplaint({"field", "a.toml", "-o", "a.png", "--width", "100"}, {"100", "from 320"});
  expectComplaint({"field", "a.toml", "-o", "a.png", "--band", "0"}, {"--band", "above 0"});
  expectComplaint({"field", "a.toml", "-o", "a.png", "--offset", "nan"}, {"--offset", "nan"});
  expectComplaint({"field", "a.toml", "-o", "a.png", "--scale", "2"}, {"--scale", "FILE.svg#ID"});
}

TEST(CommandLine, batch_takes_all_its_options) {
  const auto batch = std::get<study::BatchOptions>(
      parse({"batch",      "a.toml", "b.toml", "--sweep", "seed=1,2",  "--sweep", "gravity=[0, -1],[0, -2]",
             "-o",         "dir/",   "--jobs", "3",       "--threads", "2",       "--resume",
             "--baseline", "r.csv",  "--set",  "title=x", "--frames",  "none",    "--until",
             "0.5",        "--simd", "scalar", "--quiet"}));
  EXPECT_EQ(batch.input.files, (std::vector<std::string>{"a.toml", "b.toml"}));
  ASSERT_EQ(batch.input.sweeps.size(), 2u);
  EXPECT_EQ(batch.input.sweeps[1].values, (std::vector<std::string>{"[0, -1]", "[0, -2]"}));
  EXPECT_EQ(batch.folder, "dir");
  EXPECT_EQ(batch.jobs, 3);
  EXPECT_EQ(batch.session.threads, 2);
  EXPECT_TRUE(batch.resume && batch.session.quiet && !batch.collect);
  EXPECT_EQ(batch.baseline, "r.csv");
  EXPECT_EQ(batch.input.settings, (std::vector<scene::Override>{{"title", "x"}, {"output.frames", "[]"}}));
  EXPECT_EQ(batch.session.until, 0.5);
  EXPECT_EQ(batch.session.simd, SimdTarget::Scalar);
  const auto collect = std::get<study::BatchOptions>(parse({"batch", "--collect", "dir"}));
  EXPECT_TRUE(collect.collect);
  EXPECT_EQ(collect.folder, "dir");
}

TEST(CommandLine, a_batch_that_cannot_be_meant_is_refused) {
  expectComplaint({"batch", "a.toml"}, {"-o DIR", "missing"});
  expectComplaint({"batch", "-o", "d"}, {"SCENE", "--resume"});
  expectComplaint({"batch", "a.toml", "-o", "d", "--jobs", "0"}, {"--jobs", "from 1"});
  expectComplaint({"batch", "a.toml", "-o", "d", "--sweep", "seed"}, {"--sweep", "seed", "PATH="});
  expectComplaint({"batch", "--resume", "-o", "d", "--sweep", "seed=1"}, {"--sweep", "scenes"});
  expectComplaint({"batch", "a.toml", "--collect", "d"}, {"--collect"});
  expectComplaint({"batch", "a.toml", "-o", "d", "--task", "1"}, {"--task"});
  expectComplaint({"batch", "-o", "d", "--task", "-1"}, {"--task", "from 0"});
  expectComplaint({"batch", "a.toml", "-o", "d", "--slurm", "--jobs", "2"}, {"--jobs", "Slurm"});
  expectComplaint({"completion", "tcsh"}, {"tcsh", "bash, zsh and fish"});
}

TEST(CommandLine, quoting_gives_back_what_a_shell_would_split) {
  EXPECT_EQ(quoted({"froude", "run", "a b.toml"}), "froude run 'a b.toml'");
  EXPECT_EQ(quoted({"--set", "title='x'"}), "--set 'title='\\''x'\\'''");
  EXPECT_EQ(quoted({""}), "''");
}

}  // namespace
}  // namespace froude::cli
