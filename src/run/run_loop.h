// The loop of a run: step, read the gauges, take the frames, keep the state; until the end, trouble or a signal.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "export/frames.h"
#include "export/run_page.h"
#include "run/checkpoint.h"
#include "run/gauge_log.h"
#include "run/gauges.h"
#include "run/leak_log.h"
#include "run/run.h"
#include "run/run_folder.h"
#include "run/run_observer.h"
#include "run/summary.h"
#include "scene/scene.h"

namespace froude::run {

/// How a loop ended. Running: it was asked to pause, and `run` goes on with it.
struct LoopResult {
  Status status = Status::Done;
  int signal = 0;        // Interrupted: by which
  StepReport report;     // Unstable: why
  std::string film;      // Done: the film, if one was made
  std::string filmNote;  // Done: why none was
};

/// Owns the open files of a run and what the run remembers. Output never alters a step: nothing that the loop does
/// beside World::substep changes the world.
class RunLoop {
 public:
  enum class Start { New, Resumed };

  /// Opens the files of a run that starts anew, or cuts those of an earlier one back to the record. Writes a first
  /// summary. Throws exporting::OutputError, InputError.
  RunLoop(const RunFolder& folder, const scene::Scene& scene, World& world, GaugeSet& gauges, RunRecord record,
          Start start);

  /// To the first step end at or after `end` [s]. Leaves checkpoint and summary behind, whatever the status, but for a
  /// pause.
  LoopResult run(double end, const SessionOptions& options, RunObserver& observer);
  /// The summary of a run that was ended by an exception, and why; failing again is no news.
  void markFailed(const std::string& reason) noexcept;

  const RunRecord& record() const { return record_; }

 private:
  using Clock = std::chrono::steady_clock;

  void takeOutput();
  void checkpoint();
  std::string summaryNow(Status status) const;
  void writeSummary(Status status);
  void writeSummaryAndPage(Status status);
  void openLeakLog(const SessionOptions& options);
  void trace(const StepReport& report, const SessionOptions& options, RunObserver& observer);
  LoopResult finish(LoopResult result);
  void countWallTime();
  std::size_t liveParticles() const;

  const RunFolder& folder_;
  const scene::Scene& scene_;
  World& world_;
  GaugeSet& gauges_;
  RunRecord record_;
  Start start_;
  bool begun_ = false;
  std::optional<GaugeLog> gaugeLog_;
  std::optional<LeakLog> leakLog_;
  std::optional<exporting::FrameWriter> frames_;
  std::optional<exporting::RunPage> page_;
  std::vector<std::string> rows_;
  Clock::time_point lastMoment_, lastCheckpoint_;
};

}  // namespace froude::run
