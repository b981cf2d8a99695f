// One run of a batch in a thread of its own, with as many cores as it is given at the moment.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "run/run_observer.h"
#include "run/session.h"
#include "study/plan.h"
#include "study/results.h"

namespace froude::study {

/// What all runs of a batch share.
struct TaskSettings {
  std::string folder;           // of the batch
  run::SessionOptions session;  // of each run; `force` does not count
  std::function<int()> signal;  // 0, or the signal at which all save their state and end
};

/// Loads its scene at once, on one core; then waits for cores; then runs. A run that was begun before goes on from its
/// checkpoint, or from its start where there is none that can be read.
class RunTask final : public run::RunObserver {
 public:
  enum class Stage { Loading, Ready, Running, Ended };

  /// `changed` is called, with no lock held, when the stage has changed.
  RunTask(const PlannedRun& plan, const TaskSettings& settings, std::function<void()> changed);
  /// Waits for its end.
  ~RunTask() override;

  Stage stage() const { return stage_; }
  std::size_t particles() const { return particles_; }
  double memory() const { return memory_; }  // that it is going to need [bytes]; known from Ready on, 0 if unknown
  double progress() const;                   // 0 … 1
  double time() const { return time_; }      // [s]
  double end() const { return end_; }        // [s]
  int cores() const { return share_; }

  /// Lets it compute with so many cores from the next sub-step on. The first call starts a run that is ready.
  void share(int cores);
  /// A run that is not running ends without having begun.
  void cancel();

  /// After its end.
  const RunResult& result() const { return result_; }
  const std::vector<std::string>& notes() const { return notes_; }

  int pendingSignal() const override { return settings_.signal(); }
  bool wantsPause() const override { return share_ != taken_; }
  void update(double time, std::size_t particles) override;
  void say(const std::string&) override {}

 private:
  void work();
  void load();
  bool waitForCores();
  void begin();
  void advance();
  void enter(Stage stage);
  void refuse(const std::string& reason, const char* status);

  const PlannedRun& plan_;
  const TaskSettings& settings_;
  std::function<void()> changed_;
  std::string folder_;
  std::optional<scene::Scene> scene_;  // of a run that starts anew, until it has begun
  std::optional<run::Session> session_;
  RunResult result_;
  std::vector<std::string> notes_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool cancelled_ = false;  // under the mutex
  std::atomic<Stage> stage_{Stage::Loading};
  std::atomic<std::size_t> particles_{0};
  std::atomic<double> memory_{0.0}, time_{0.0}, end_{0.0};
  std::atomic<int> share_{0};
  int taken_ = 0;  // share that the thread computes with
  std::thread thread_;
};

}  // namespace froude::study
