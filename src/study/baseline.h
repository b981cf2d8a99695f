// Results against those of an earlier batch: what is not as it was.
#pragma once

#include <string>
#include <vector>

#include "study/csv.h"
#include "study/results.h"

namespace froude::study {

/// A column of one run that differs.
struct Change {
  std::string column, before, now;
  /// "max_density_error 0.01 → 0.02 (+100 %)".
  std::string words() const;
};

struct Comparison {
  bool known = false;  // the earlier batch has this run
  std::vector<Change> changes;
  double speed = 0.0;  // particle-steps per second, now against before; 0 where unknown
  /// "same", "new" or "3 changes".
  std::string mark() const;
};

/// For each run, against the row with the same scene file name and parameters. Every column that both have is compared
/// as text, but for what tells of the machine and the moment (times, rates, processor, compiler, versions, threads,
/// command, path). A run that is not done any more is a change too.
std::vector<Comparison> compare(const CsvTable& baseline, const BatchPlan& plan, const std::vector<RunResult>& results);

/// The changes in words, a line for each run that has any, at most a few columns of each.
std::string changesText(const BatchPlan& plan, const std::vector<Comparison>& comparisons);

}  // namespace froude::study
