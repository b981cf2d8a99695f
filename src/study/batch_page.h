// The page of a batch: index.html with its table, plots over parameters, and the gauges of its runs.
#pragma once

#include <string>
#include <vector>

#include "study/plan.h"
#include "study/results.h"

namespace froude::study {

/// Writes FOLDER/index.html from the results and the runs' gauges.csv; curves are thinned to some hundred points. Pages
/// of the runs are linked, not copied. Throws exporting::OutputError. Cost: reads the gauges of all runs.
void writeBatchPage(const std::string& folder, const BatchPlan& plan, const std::vector<RunResult>& results);

}  // namespace froude::study
