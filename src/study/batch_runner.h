// Runs many runs of a batch: which of them are at work at a time, with how many cores each.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "run/progress.h"
#include "study/run_task.h"

namespace froude::study {

/// How a batch is carried out.
struct RunnerSettings {
  int cores = 1;  // for all runs together
  int jobs = 0;   // runs side by side; 0: by their size
  bool quiet = false;
};

/// Begins runs in the order given. A run is begun beside others while the cores that they are worth (wantedCores) leave
/// it as many as it is worth itself, and while the memory it needs is free; with `jobs` as long as there are fewer at
/// work. All cores are dealt out to the runs at work (dealCores), anew whenever one begins or ends: the last run has
/// them all. The bits of a run do not depend on it.
class BatchRunner {
 public:
  /// `finished` is called in the thread of `run` after each run, with its index in the plan.
  BatchRunner(const BatchPlan& plan, const TaskSettings& tasks, const RunnerSettings& settings,
              std::function<void(std::size_t, const RunResult&)> finished);

  /// Runs these of the plan to their ends, or all at work to their next sub-step once there is a signal.
  void run(const std::vector<std::size_t>& which);

 private:
  struct Slot {
    std::size_t index;
    std::unique_ptr<RunTask> task;
  };

  bool reap();
  void startNext();
  void admit();
  void deal();
  int coresWanted() const;
  void draw();
  void tellEnd(const Slot& slot);
  void wake();

  const BatchPlan& plan_;
  const TaskSettings& tasks_;
  RunnerSettings settings_;
  std::function<void(std::size_t, const RunResult&)> finished_;
  std::deque<std::size_t> waiting_;
  std::vector<Slot> slots_;
  std::size_t ended_ = 0, total_ = 0;
  run::LiveLines lines_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool anyChange_ = false;  // under the mutex
};

}  // namespace froude::study
