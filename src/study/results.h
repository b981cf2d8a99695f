// The results of a batch: one row a run, read from the runs' own folders; as results.csv and as a table for people.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "study/plan.h"

namespace froude::study {

/// How one run of a batch stands.
struct RunResult {
  std::string status;  // of summary.json, or "refused" (its scene is wrong) or "not begun"
  std::string reason;  // in words, where it is not done
  std::vector<std::pair<std::string, std::string>> values;  // of summary and gauges, by column

  bool done() const { return status == "done"; }
  /// An end that another attempt would meet again.
  bool settled() const { return done() || status == "unstable"; }
  /// A value by its column; empty where there is none.
  std::string value(const std::string& column) const;
};

/// What the folder of a run says. Never throws: what cannot be read is told in `reason`.
RunResult readResult(const std::string& folder);

/// All runs, in the order of the plan. Columns: run, scene, the parameters, status, reason, then every number and word
/// of summary.json (step_limits.NAME for those within; without what a parameter of that name says already) and the
/// statistics of the gauges.
std::string resultsCsv(const BatchPlan& plan, const std::vector<RunResult>& results);

/// The same as a table for people, a few columns of it. `marks`: a word behind each row, or empty.
std::string resultsTable(const BatchPlan& plan, const std::vector<RunResult>& results,
                         const std::vector<std::string>& marks);

}  // namespace froude::study
