// The command `froude batch`: many runs, one folder, one table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "run/run.h"
#include "study/plan.h"

namespace froude::study {

struct BatchOptions {
  BatchInput input;
  std::string folder;  // of the batch
  int jobs = 0;        // runs side by side; 0: by their size
  bool resume = false;
  bool slurm = false;    // hand the runs in as a job array instead of running them
  int task = -1;         // run this one of the batch in the folder, alone; -1: all
  bool collect = false;  // gather the table, run nothing
  std::string baseline;  // results.csv of an earlier batch, or empty
  run::SessionOptions session;
};

/// Returns the exit code: 0 when all runs are done, 5 when some are not, 130 and 143 after a signal. Throws what is
/// wrong before anything was written (SceneError, UsageError, InputError), exporting::OutputError when the table cannot
/// be.
int runBatch(const BatchOptions& options);

/// What `froude check` is to look at: scenes themselves, and of batch files each run. Throws SceneError for a batch
/// file that is wrong.
std::vector<scene::CheckItem> itemsToCheck(const std::vector<std::string>& files);

}  // namespace froude::study
