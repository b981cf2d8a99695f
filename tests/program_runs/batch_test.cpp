// Batches as a user runs them: sweeps, failing runs, resumed batches, baselines, locks.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

namespace fs = std::filesystem;

class Batch : public ProgramTest {
 protected:
  Batch() { write("s.toml", tinyScene()); }

  /// The rows of a results.csv by run, cells by column. Our cells hold no quotes but in `reason` and `command`.
  std::map<std::string, std::map<std::string, std::string>> results(const std::string& folder) const {
    std::map<std::string, std::map<std::string, std::string>> rows;
    std::istringstream lines(read(folder + "/results.csv"));
    Words header;
    for (std::string line; std::getline(lines, line);) {
      Words cells(1);
      bool quoted = false;
      for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted)
          cells.emplace_back();
        else if (c != '"')
          cells.back() += c;
      }
      if (header.empty()) {
        header = cells;
        continue;
      }
      for (std::size_t i = 0; i < header.size(); ++i) rows[cells[0]][header[i]] = cells.at(i);
    }
    return rows;
  }
  /// A tiny scene that goes on for long.
  void writeLong(const std::string& name, const std::string& duration = "1000.0") const {
    std::string text = tinyScene();
    write(name, text.replace(text.find("duration = 0.1"), 14, "duration = " + duration));
  }
};

TEST_F(Batch, every_combination_has_a_folder_and_a_row_and_the_bits_of_a_run_alone) {
  const Outcome outcome = froude({"batch", "s.toml", "-o", "b", "--sweep", "model.spacing=0.04,0.05", "--sweep",
                                  "model.fluid=pbf,dfsph", "--threads", "2"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lastLine(), "b");
  const auto rows = results("b");
  ASSERT_EQ(rows.size(), 4u);
  for (const char* spacing : {"0.04", "0.05"}) {
    for (const char* fluid : {"pbf", "dfsph"}) {
      const std::string name = std::string("spacing=") + spacing + "_fluid=" + fluid;
      ASSERT_TRUE(rows.count(name)) << name;
      const auto& row = rows.at(name);
      EXPECT_EQ(row.at("model.spacing"), spacing);
      EXPECT_EQ(row.at("model.fluid"), fluid);
      EXPECT_EQ(row.at("status"), "done");
      EXPECT_EQ(row.at("scene"), "s.toml");
      const std::string alone = hashOfRun("s.toml", "alone_" + name,
                                          {"--set", std::string("model.spacing=") + spacing, "--set",
                                           std::string("model.fluid=") + fluid, "--threads", "1"});
      EXPECT_EQ(row.at("state_hash"), alone) << name;
      EXPECT_EQ(read("b/" + name + "/gauges.csv"), read("alone_" + name + "/gauges.csv"));
      // The last value of the gauge is the last cell of its own file.
      const std::string gauges = read("b/" + name + "/gauges.csv");
      const std::string last = gauges.substr(gauges.rfind('\n', gauges.size() - 2) + 1);
      const std::string front =
          last.substr(last.find(',') + 1, last.find(',', last.find(',') + 1) - last.find(',') - 1);
      EXPECT_EQ(std::stod(row.at("gauge.front.last")), std::stod(front));
      EXPECT_GE(std::stod(row.at("gauge.front.max")), std::stod(row.at("gauge.front.mean")));
    }
  }
}

TEST_F(Batch, a_failing_run_is_told_with_its_reason_and_stops_nothing) {
  const Outcome outcome = froude({"batch", "s.toml", "-o", "b", "--sweep", "model.spacing=-1,0.04", "--sweep",
                                  "model.time_step=1.0,0.004", "--until", "30", "--set", "duration=0.05"});
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  const auto rows = results("b");
  EXPECT_EQ(rows.at("spacing=-1_time_step=1.0").at("status"), "refused");
  EXPECT_NE(rows.at("spacing=-1_time_step=1.0").at("reason").find("model.spacing"), std::string::npos);
  EXPECT_EQ(rows.at("spacing=0.04_time_step=1.0").at("status"), "unstable");
  EXPECT_NE(rows.at("spacing=0.04_time_step=1.0").at("reason").find("limit"), std::string::npos);
  EXPECT_FALSE(fs::exists(path("b/spacing=-1_time_step=1.0")));
}

TEST_F(Batch, what_is_wrong_in_every_run_is_refused_and_nothing_is_written) {
  const Outcome outcome = froude({"batch", "s.toml", "-o", "b", "--sweep", "model.spacng=0.04,0.05"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("s.toml:0:0: model.spacng"), std::string::npos) << outcome.err;
  EXPECT_EQ(files(""), Words{"s.toml"});
}

TEST_F(Batch, a_batch_that_was_stopped_goes_on_and_runs_nothing_twice) {
  writeLong("long.toml", "60.0");
  const Words sweep{"--sweep", "seed=1,2,3", "--set", "output.checkpoint=0.05"};
  Words words{"batch", "s.toml", "long.toml", "-o", "b", "--threads", "2"};
  words.insert(words.end(), sweep.begin(), sweep.end());
  {
    Process process(words, home_);
    waitFor("b/long_seed=1/checkpoint.h5");
    process.signal(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_EQ(outcome.lastLine(), "b");
  }
  auto rows = results("b");
  EXPECT_EQ(rows.at("s_seed=3").at("status"), "done");
  EXPECT_EQ(rows.at("long_seed=1").at("status"), "interrupted");
  EXPECT_EQ(rows.at("long_seed=3").at("status"), "not begun");
  const double reached = std::stod(rows.at("long_seed=1").at("simulated_seconds"));
  const auto before = fs::last_write_time(path("b/s_seed=1/summary.json"));
  // Somebody shortens the rest: --until belongs to the batch, and another one is refused.
  EXPECT_EQ(froude({"batch", "-o", "b", "--resume", "--until", "1"}).code, 2);
  Process process({"batch", "-o", "b", "--resume", "--threads", "3"}, home_);
  waitFor("b/long_seed=3/checkpoint.h5");
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().code, 143);
  rows = results("b");
  EXPECT_GT(std::stod(rows.at("long_seed=1").at("simulated_seconds")), reached);
  EXPECT_EQ(fs::last_write_time(path("b/s_seed=1/summary.json")), before);
}

TEST_F(Batch, a_batch_that_was_killed_ends_with_the_hashes_of_one_that_was_not) {
  writeLong("long.toml", "4.0");
  const Words words{"batch", "long.toml", "--sweep", "seed=1,2,3,4", "--set", "output.checkpoint=0.02", "-o"};
  for (const int wait : {0, 1, 2}) {
    Words killed = words;
    killed.emplace_back("b");
    if (wait > 0) killed.emplace_back("--resume");
    Process process(killed, home_);
    if (wait == 0) waitFor("b/seed=1/summary.json");
    usleep(static_cast<useconds_t>(wait) * 150000);
    process.signal(SIGKILL);
    process.wait();
  }
  const Outcome outcome = froude({"batch", "-o", "b", "--resume"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  Words whole = words;
  whole.emplace_back("straight");
  ASSERT_EQ(froude(whole).code, 0);
  const auto first = results("b"), second = results("straight");
  ASSERT_EQ(first.size(), second.size());
  for (const auto& [name, row] : first) {
    EXPECT_EQ(row.at("state_hash"), second.at(name).at("state_hash")) << name;
    EXPECT_EQ(read("b/" + name + "/gauges.csv"), read("straight/" + name + "/gauges.csv")) << name;
  }
  // Nothing is left to do, and it says the same once more.
  const std::string table = read("b/results.csv");
  EXPECT_EQ(froude({"batch", "-o", "b", "--resume"}).code, 0);
  EXPECT_EQ(read("b/results.csv"), table);
}

TEST_F(Batch, two_batches_do_not_write_into_one_folder) {
  writeLong("long.toml");
  Process process({"batch", "long.toml", "-o", "b"}, home_);
  waitFor("b/long/summary.json");
  for (const Words& words : {Words{"batch", "-o", "b", "--resume"}, Words{"batch", "s.toml", "-o", "b"}}) {
    const Outcome outcome = froude(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("another batch is writing here"), std::string::npos) << outcome.err;
  }
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().code, 143);
}

TEST_F(Batch, a_folder_that_is_somebody_elses_or_of_another_batch_is_refused) {
  fs::create_directory(path("mine"));
  write("mine/letter", "dear");
  EXPECT_EQ(froude({"batch", "s.toml", "-o", "mine"}).code, 2);
  EXPECT_EQ(files("mine"), Words{"letter"});
  ASSERT_EQ(froude({"batch", "s.toml", "-o", "b", "--quiet"}).code, 0);
  EXPECT_EQ(froude({"batch", "s.toml", "-o", "b"}).code, 2);
  const Outcome other = froude({"batch", "s.toml", "-o", "b", "--resume", "--sweep", "seed=1,2"});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("another batch"), std::string::npos) << other.err;
  write("s.toml", tinyScene() + "\n");
  const Outcome changed = froude({"batch", "-o", "b", "--resume"});
  EXPECT_EQ(changed.code, 2);
  EXPECT_NE(changed.err.find("s.toml has been changed"), std::string::npos) << changed.err;
}

TEST_F(Batch, a_baseline_marks_what_has_changed) {
  ASSERT_EQ(froude({"batch", "s.toml", "-o", "a", "--sweep", "model.spacing=0.04,0.05"}).code, 0);
  const Outcome same =
      froude({"batch", "s.toml", "-o", "b", "--sweep", "model.spacing=0.04,0.05,0.06", "--baseline", "a/results.csv"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_NE(same.out.find("  same"), std::string::npos) << same.out;
  EXPECT_NE(same.out.find("  new"), std::string::npos) << same.out;
  EXPECT_EQ(same.out.find("change"), std::string::npos) << same.out;
  const Outcome other = froude({"batch", "s.toml", "-o", "c", "--sweep", "model.spacing=0.04", "--set",
                                "fluid.viscosity=0.01", "--baseline", "a/results.csv"});
  EXPECT_EQ(other.code, 0);
  EXPECT_NE(other.out.find("state_hash"), std::string::npos) << other.out;
  EXPECT_EQ(froude({"batch", "s.toml", "-o", "d", "--baseline", "absent.csv"}).code, 4);
  EXPECT_EQ(froude({"batch", "s.toml", "-o", "d", "--baseline", "a/spacing=0.04/gauges.csv"}).code, 2);
  EXPECT_FALSE(fs::exists(path("d")));
}

TEST_F(Batch, a_batch_file_runs_checks_and_collects) {
  fs::create_directory(path("sub"));
  write("sub/b.toml",
        "[batch]\nscenes = [\"../s.toml\"]\nset = { output.frames = [\"h5\"] }\n[batch.sweep]\n"
        "seed = { from = 1, to = 3, step = 1 }\n");
  const Outcome check = froude({"check", "sub/b.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_NE(check.out.find("sub/b.toml: seed=3: sound"), std::string::npos) << check.out;
  const Outcome outcome = froude({"batch", "sub/b.toml", "-o", "b", "--quiet", "--jobs", "2"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "b\n");
  EXPECT_EQ(outcome.err, "");
  EXPECT_TRUE(fs::exists(path("b/seed=3/frames.h5")));
  const std::string table = read("b/results.csv");
  fs::remove(path("b/results.csv"));
  EXPECT_EQ(froude({"batch", "--collect", "b"}).code, 0);
  EXPECT_EQ(read("b/results.csv"), table);
  fs::remove_all(path("b/seed=2"));
  EXPECT_EQ(froude({"batch", "--collect", "b"}).code, 5);
  EXPECT_EQ(results("b").at("seed=2").at("status"), "not begun");
}

TEST_F(Batch, a_terminal_shows_a_line_for_each_run_at_work) {
  writeLong("long.toml", "3.0");
  Circumstances terminal;
  terminal.terminal = true;
  const Outcome outcome = froude({"batch", "long.toml", "-o", "b", "--sweep", "seed=1,2", "--threads", "2"}, terminal);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("seed=1: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("of 2 runs ended"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("[2/2] "), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace froude::testing
