// The points of the work-precision chart, measured by the validation cases.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plan/chart_options.h"
#include "plan/points.h"
#include "validation/validation.h"

namespace froude::validation {

/// A point to measure.
struct Task {
  const Case* entry = nullptr;
  std::string model;
  double spacing = 0.0;
  double courant = 0.0;  // 0: the scene's or the model's own
};

/// Every case that has a norm, with every model that it takes, at all of its spacings and with a shorter step; coarse
/// ones first over all cases, so that an early end leaves something of each. Throws run::UsageError for a case or a
/// model that there is not.
std::vector<Task> chartTasks(const plan::ChartOptions& options);

/// Runs it; `stop` is asked between sub-steps.
plan::Point measure(const Task& task, double limit, const std::function<bool()>& stop);

/// `froude chart`: measures what is not yet in the folder's points.csv, then draws chart.svg, chart.png and
/// index.html. A line a point on stderr, the folder as the last line on stdout. Returns the exit code.
int chartCommand(const plan::ChartOptions& options);

}  // namespace froude::validation
