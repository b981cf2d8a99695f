// The program `validation`: rows come out, for runs that fail too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <froude/base/assert.h>
#include "validation/rows.h"

namespace froude::validation {
namespace {

/// Cells of a line of CSV, quotes taken away.
std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      out.emplace_back();
    } else if (c != '"') {
      out.back() += c;
    }
  }
  return out;
}

struct Rows {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::string at(std::size_t row, const std::string& column) const {
    const auto place = std::find(head.begin(), head.end(), column);
    return rows.at(row).at(static_cast<std::size_t>(place - head.begin()));
  }
};

int run(const std::string& words) {
  const std::string command = std::string("\"") + FROUDE_VALIDATION_PROGRAM + "\" " + words + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ValidationProgram, quick_runs_write_a_row_for_each_metric) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "froude_validation_rows.csv";
  std::filesystem::remove(file);
  ASSERT_EQ(run("--quick --methods pbf --cases taylor_green,drop,couette_start,rotating_patch --rows \"" +
                file.string() + "\""),
            0);
  Rows table;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, csvHead());
  table.head = cells(line);
  while (std::getline(stream, line)) table.rows.push_back(cells(line));
  std::filesystem::remove(file);

  std::set<std::string> seen;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    ASSERT_EQ(table.rows[i].size(), table.head.size());
    seen.insert(table.at(i, "case") + "/" + table.at(i, "metric"));
    EXPECT_EQ(table.at(i, "method"), "pbf");
    EXPECT_EQ(table.at(i, "state"), "done");
    EXPECT_GT(std::stod(table.at(i, "particles")), 100.0);
    EXPECT_GT(std::stod(table.at(i, "substeps")), 0.0);
    EXPECT_TRUE(std::isfinite(std::stod(table.at(i, "error"))));
    EXPECT_EQ(table.at(i, "wall_seconds").empty(), kAssertionsOn || !kOptimized) << "times of this build mean nothing";
    const std::string target = table.at(i, "target");
    const bool small = !target.empty() && std::abs(std::stod(table.at(i, "error"))) <= std::stod(target);
    EXPECT_EQ(table.at(i, "reached"), target.empty() ? "" : small ? "yes" : "no");
  }
  EXPECT_EQ(seen, (std::set<std::string>{
                      "couette_start/profile", "drop/axis_x", "drop/axis_y", "drop/energy",
                      "rotating_patch/angular_momentum", "rotating_patch/area", "rotating_patch/center_pressure",
                      "rotating_patch/clumped", "rotating_patch/kinetic_energy", "rotating_patch/nearest_pair",
                      "rotating_patch/torn_off", "taylor_green/decay_rate", "taylor_green/velocity"}));
  EXPECT_EQ(table.rows.size(), seen.size());
}

TEST(ValidationProgram, wrong_words_are_refused) {
  EXPECT_EQ(run("--cases nothing_like_it"), 2);
  EXPECT_EQ(run("--methods nothing_like_it"), 2);
  EXPECT_EQ(run("--threads 0"), 2);
  EXPECT_EQ(run("--limit soon"), 2);
  EXPECT_EQ(run("--rows"), 2);
  EXPECT_EQ(run("--cases ,"), 2);
  EXPECT_EQ(run("--list"), 0);
  EXPECT_EQ(run("--help"), 0);
  EXPECT_EQ(run("--quick --methods pbf --cases drop --rows /nowhere/at/all.csv"), 4);
}

TEST(ValidationProgram, rows_are_not_appended_to_a_file_of_something_else) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "froude_validation_notes.txt";
  std::ofstream(file) << "my notes\n";
  EXPECT_EQ(run("--quick --methods pbf --cases drop --rows \"" + file.string() + "\""), 2);
  std::ifstream stream(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "my notes\n");
  std::filesystem::remove(file);
}

class Nothing final : public Measure {
 public:
  void read(const World&, double) override {}
  std::vector<Metric> results() const override { return {{"nothing", "1", 0.0, {}}}; }
};

Case made(const std::string& scene) {
  Case c;
  c.name = "made";
  c.scene = scene;
  c.measure = [](const scene::Scene&) { return std::make_unique<Nothing>(); };
  return c;
}

TEST(ValidationRunner, a_run_that_goes_unstable_is_a_row_that_says_so) {
  const Case entry = made("dam_speed");
  Series series{&entry, "pbf", {runOnce(entry, "pbf", 0.1, {{"model.time_step", "10.0"}})}};
  EXPECT_EQ(series.outcomes[0].state.rfind("unstable: ", 0), 0u) << series.outcomes[0].state;
  EXPECT_TRUE(series.outcomes[0].metrics.empty());
  const std::vector<std::string> lines = csvLines(series, context(1));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(cells(lines[0]).size(), cells(csvHead()).size());
  EXPECT_EQ(tableLines(series, context(1)).size(), 1u);
}

TEST(ValidationRunner, a_run_that_takes_too_long_is_given_up_and_says_so) {
  const Outcome slow = runOnce(made("dam_speed"), "pbf", 0.1, {}, {1e-9, {}});  // seconds: no step is as fast
  EXPECT_EQ(slow.state.rfind("stopped: ", 0), 0u) << slow.state;
  EXPECT_EQ(slow.ledger.substeps, 1u);
  EXPECT_TRUE(slow.metrics.empty());
}

TEST(ValidationRunner, a_method_that_cannot_take_a_scene_is_told_in_words) {
  const Case entry = made("poiseuille");
  const Outcome narrow = runOnce(entry, "pbf", 0.1, {});
  EXPECT_EQ(narrow.state.rfind("refused: ", 0), 0u) << narrow.state;
  EXPECT_EQ(runOnce(entry, "no_such_method", 0.04, {}).state.rfind("refused: ", 0), 0u);
}

TEST(ValidationRunner, knows_the_methods_of_this_build_and_every_case_is_complete) {
  const std::vector<std::string> methods = fluidMethods();
  EXPECT_NE(std::find(methods.begin(), methods.end(), "pbf"), methods.end());
  EXPECT_EQ(std::find(methods.begin(), methods.end(), "ballistic"), methods.end());
  EXPECT_GE(allCases().size(), 12u);
  for (const Case& c : allCases()) {
    SCOPED_TRACE(c.name);
    // A chain of beads and a rope are as fine as their reference is.
    if (c.softModels.empty()) {
      EXPECT_EQ(c.full.spacings.size(), 3u);
    }
    EXPECT_FALSE(c.full.spacings.empty());
    EXPECT_TRUE(std::is_sorted(c.full.spacings.rbegin(), c.full.spacings.rend()));
    EXPECT_FALSE(c.quick.spacings.empty());
    EXPECT_FALSE(c.measures.empty());
    EXPECT_TRUE(std::filesystem::exists(scenePath(c.scene)));
  }
}

}  // namespace
}  // namespace froude::validation
