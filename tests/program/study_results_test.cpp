// Tables of results: what is read from the runs' folders, how it is written, and how it is compared.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "run/exit_codes.h"
#include "study/baseline.h"
#include "study/csv.h"
#include "study/gauge_statistics.h"
#include "study/results.h"
#include "study/shares.h"
#include "study/slurm.h"

namespace froude::study {
namespace {

namespace fs = std::filesystem;

TEST(Csv, what_needs_quotes_comes_back_as_it_was) {
  const std::vector<std::string> cells{"plain", "", "a,b", "say \"no\"", "two\nlines", "[0.0, -9.81]"};
  const CsvTable table = parseCsv(csvLine({"1", "2", "3", "4", "5", "6"}) + csvLine(cells), "t.csv");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0], cells);
}

TEST(Csv, a_torn_or_empty_table_is_refused) {
  EXPECT_THROW(parseCsv("", "t.csv"), run::InputError);
  EXPECT_THROW(parseCsv("a,b\n1\n", "t.csv"), run::InputError);
}

TEST(GaugeStatistics, end_extremes_and_mean_of_the_course_over_time) {
  // A tent over uneven times: its area is known.
  const auto found = gaugeStatistics("t,a,b.x\n0,0,5\n1,2,\n4,0.5,7\n", "g.csv");
  const std::map<std::string, std::string> values(found.begin(), found.end());
  EXPECT_EQ(values.at("gauge.a.last"), "0.5");
  EXPECT_EQ(values.at("gauge.a.min"), "0");
  EXPECT_EQ(values.at("gauge.a.max"), "2");
  EXPECT_DOUBLE_EQ(std::stod(values.at("gauge.a.mean")), (0.5 * 1 * 2 + 3 * 1.25) / 4);
  EXPECT_DOUBLE_EQ(std::stod(values.at("gauge.b.x.mean")), 6.0);
}

TEST(GaugeStatistics, values_that_are_not_finite_do_not_count_but_as_the_last) {
  const auto found = gaugeStatistics("t,a,b\n0,nan,nan\n1,3,nan\n2,nan,nan\n", "g.csv");
  const std::map<std::string, std::string> values(found.begin(), found.end());
  EXPECT_EQ(values.at("gauge.a.last"), "nan");
  EXPECT_EQ(values.at("gauge.a.mean"), "3");
  EXPECT_EQ(values.at("gauge.b.max"), "nan");
  EXPECT_TRUE(gaugeStatistics("", "g.csv").empty());
}

BatchPlan twoRuns() {
  BatchPlan plan;
  plan.parameters = {"model.spacing"};
  for (const char* value : {"0.02", "0.01"})
    plan.runs.push_back({std::string("spacing=") + value, "dam.toml", "/dam.toml", {}, {{"model.spacing", value}}});
  return plan;
}

TEST(Results, a_run_without_a_summary_has_not_begun_and_a_torn_one_is_told) {
  std::string pattern = (fs::temp_directory_path() / "froude-results-XXXXXX").string();
  const fs::path home = mkdtemp(pattern.data());
  EXPECT_EQ(readResult(home.string()).status, "not begun");
  std::ofstream(home / "summary.json") << "{ \"status\": ";
  const RunResult torn = readResult(home.string());
  EXPECT_EQ(torn.status, "failed");
  EXPECT_NE(torn.reason.find("summary.json"), std::string::npos);
  std::ofstream(home / "summary.json")
      << R"({"status": "unstable", "reason": "too fast", "particles": 5, "x": 0.1, "spacing": null,
             "step_limits": {"speed": 3}, "warnings": ["a", "b"], "gauges": {"g": "m"}, "momentum_error": "nan"})";
  const RunResult result = readResult(home.string());
  EXPECT_EQ(result.status, "unstable");
  EXPECT_EQ(result.reason, "too fast");
  EXPECT_TRUE(result.settled());
  EXPECT_FALSE(result.done());
  EXPECT_EQ(result.value("x"), "0.1");
  EXPECT_EQ(result.value("spacing"), "");
  EXPECT_EQ(result.value("step_limits.speed"), "3");
  EXPECT_EQ(result.value("warnings"), "2");
  EXPECT_EQ(result.value("momentum_error"), "nan");
  fs::remove_all(home);
}

TEST(Results, columns_are_those_of_any_run_and_rows_keep_the_order_of_the_plan) {
  std::vector<RunResult> results(2);
  results[0] = {"refused", "dam.toml:1:1: a, b", {}};
  results[1] = {"done", "", {{"leaks", "0"}, {"model.spacing", "hidden"}, {"gauge.a.last", "1"}}};
  const CsvTable table = parseCsv(resultsCsv(twoRuns(), results), "r.csv");
  EXPECT_EQ(table.columns,
            (std::vector<std::string>{"run", "scene", "model.spacing", "status", "reason", "leaks", "gauge.a.last"}));
  EXPECT_EQ(table.rows[0],
            (std::vector<std::string>{"spacing=0.02", "dam.toml", "0.02", "refused", "dam.toml:1:1: a, b", "", ""}));
  EXPECT_EQ(table.rows[1], (std::vector<std::string>{"spacing=0.01", "dam.toml", "0.01", "done", "", "0", "1"}));
}

TEST(Baseline, what_is_not_as_it_was_is_marked_and_the_machine_does_not_count) {
  std::vector<RunResult> before(2);
  for (RunResult& r : before)
    r = {"done",
         "",
         {{"leaks", "0"},
          {"volume_error", "0.01"},
          {"wall_seconds", "1"},
          {"particle_steps_per_second", "100"},
          {"cpu", "a"}}};
  const CsvTable baseline = parseCsv(resultsCsv(twoRuns(), before), "r.csv");
  std::vector<RunResult> now = before;
  now[0].values[2].second = "2";
  now[0].values[3].second = "250";
  now[0].values[4].second = "b";
  now[1].values[1].second = "0.02";
  now[1].status = "unstable";
  const std::vector<Comparison> found = compare(baseline, twoRuns(), now);
  EXPECT_EQ(found[0].mark(), "same");
  EXPECT_DOUBLE_EQ(found[0].speed, 2.5);
  EXPECT_EQ(found[1].mark(), "2 changes");
  EXPECT_EQ(found[1].changes[1].words(), "volume_error 0.01 → 0.02 (+1e+02 %)");
  BatchPlan other = twoRuns();
  other.runs[0].parameters[0].second = "0.03";
  EXPECT_EQ(compare(baseline, other, now)[0].mark(), "new");
}

TEST(JobArray, indices_are_ranges_where_they_follow_each_other) {
  EXPECT_EQ(arrayIndices({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  EXPECT_EQ(arrayIndices({4}), "4");
}

TEST(JobArray, the_script_quotes_its_paths_and_asks_for_a_signal_and_a_requeue) {
  const std::string script = jobScript("/opt/fro ude", "/data/it's 5%", {0, 1}, 3);
  EXPECT_EQ(script.rfind("#!/bin/sh\n#SBATCH", 0), 0u);
  for (const char* part :
       {"--array=0-1\n", "--cpus-per-task=3\n", "--signal=B:TERM@60\n", "--requeue",
        "'/opt/fro ude' batch -o '/data/it'\\''s 5%' --task", "--output=\"/data/it's 5%%/slurm-%a.log\""})
    EXPECT_NE(script.find(part), std::string::npos) << part << script;
}

TEST(Shares, small_runs_have_one_core_and_a_large_one_all) {
  EXPECT_EQ(wantedCores(5000, 8), 1);
  EXPECT_EQ(wantedCores(0, 8), 1);
  EXPECT_EQ(wantedCores(kParticlesPerThread * 100, 8), 8);
  EXPECT_EQ(dealCores({5000, 5000}, 2), (std::vector<int>{1, 1}));
  EXPECT_EQ(dealCores({1000000}, 8), (std::vector<int>{8}));
  EXPECT_EQ(dealCores({100}, 8), (std::vector<int>{1}));  // too small to use a second
  EXPECT_EQ(dealCores({600000, 200000}, 8), (std::vector<int>{6, 2}));
  EXPECT_EQ(dealCores({5000, 5000, 5000}, 2), (std::vector<int>{1, 1, 1}));
  EXPECT_TRUE(dealCores({}, 2).empty());
}

}  // namespace
}  // namespace froude::study
