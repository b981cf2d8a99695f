// What the chart measures: which points, and their error.
#include <gtest/gtest.h>

#include <set>

#include "run/exit_codes.h"
#include "validation/chart.h"
#include "validation/runner.h"

namespace froude::validation {
namespace {

TEST(ChartTasks, of_each_case_with_a_norm_are_all_models_and_spacings_coarse_ones_first) {
  const std::vector<Task> tasks = chartTasks({.cases = {"dam", "csm1"}});
  std::set<std::pair<std::string, std::string>> first;
  double spacing = 1.0;
  for (const Task& task : tasks) {
    first.insert({task.entry->name, task.model});
    if (task.entry->name != "dam") continue;
    EXPECT_LE(task.spacing, spacing);
    spacing = task.spacing;
  }
  EXPECT_EQ(first.size(), fluidMethods().size() + 1);
  EXPECT_EQ(spacing, tasks.back().entry->full.spacings.back());
}

TEST(ChartTasks, of_the_quick_chart_are_the_coarse_ones_at_the_models_own_steps) {
  const plan::ChartOptions quick{.quick = true, .cases = {"dam"}};
  const std::vector<Task> tasks = chartTasks(quick);
  EXPECT_EQ(tasks.size(), 2 * fluidMethods().size());
  for (const Task& task : tasks) EXPECT_EQ(task.courant, 0.0);
}

TEST(ChartTasks, refuse_a_case_or_a_model_that_there_is_not) {
  EXPECT_THROW(chartTasks({.cases = {"damm"}}), run::UsageError);
  EXPECT_THROW(chartTasks({.models = {"bpf"}}), run::UsageError);
  EXPECT_THROW(chartTasks({.cases = {"sloshing"}}), run::UsageError) << "which has no norm";
}

TEST(ChartPoint, has_the_root_mean_square_of_the_metrics_that_the_case_names) {
  const Case* drop = nullptr;
  for (const Case& entry : allCases())
    if (entry.name == "drop") drop = &entry;
  ASSERT_NE(drop, nullptr);
  const double spacing = drop->full.spacings.front();
  const plan::Point point = measure({drop, "pbf", spacing, 0.0}, kInfinity, {});
  const Outcome run = runOnce(*drop, "pbf", spacing, drop->full.overrides);
  double squares = 0.0;
  for (const Metric& metric : run.metrics)
    if (metric.name == "axis_x" || metric.name == "axis_y") squares += 0.5 * metric.error * metric.error;
  EXPECT_DOUBLE_EQ(point.error, std::sqrt(squares));
  EXPECT_EQ(point.target, 0.02);
  EXPECT_EQ(point.flow, "free surface");
  EXPECT_EQ(point.particles, run.particles);
  EXPECT_GT(point.cost(), 0.0);
}

TEST(ChartPoint, of_a_run_that_was_given_up_has_no_error_and_says_why) {
  const std::vector<Task> tasks = chartTasks({.cases = {"dam"}, .models = {"pbf"}});
  const plan::Point point = measure(tasks.front(), kInfinity, [] { return true; });
  EXPECT_FALSE(point.ended());
  EXPECT_EQ(point.state.rfind("stopped", 0), 0u) << point.state;
}

TEST(ValidationCases, name_metrics_of_their_own_in_their_norms) {
  for (const Case& entry : allCases()) EXPECT_EQ(entry.norm.empty(), entry.flow == FlowKind::None) << entry.name;
}

}  // namespace
}  // namespace froude::validation
