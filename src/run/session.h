// One run from its scene or its checkpoint to its end, without a word on the terminal.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/run.h"
#include "run/run_folder.h"
#include "run/run_loop.h"
#include "scene/scene.h"

namespace froude::run {

/// Owns scene, world, gauges, folder and open files of a run. Computes in the arena of whoever calls it, which may be
/// another one after each pause.
class Session {
 public:
  /// A world at its start; nothing is written yet. Throws SceneError, or UsageError for what the library refuses.
  Session(scene::Scene scene, SessionOptions options);
  /// The world of the folder's checkpoint, unless `nothingLeft`. Throws UsageError when there is none, or none for this
  /// SIMD target; InputError when it cannot be read.
  Session(RunFolder folder, SessionOptions options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Writes the first files of a run that starts anew. Throws exporting::OutputError, and leaves the folder as it was.
  void begin(RunFolder folder);
  /// The folder's run is done, and its end does not lie before the one that is wanted.
  bool nothingLeft() const { return !world_.has_value(); }
  /// To the end, or until the observer wants a pause. Whatever is thrown from here on belongs to a run that has begun.
  LoopResult advance(RunObserver& observer);
  void markFailed(const std::string& reason) noexcept { loop_->markFailed(reason); }

  /// What a person should know before it starts: repairs, warnings, a build that differs. Lines for stderr.
  const std::vector<std::string>& notes() const { return notes_; }
  const scene::Scene& scene() const { return scene_; }
  const World& world() const { return *world_; }
  const RunRecord& record() const { return loop_ ? loop_->record() : record_; }
  const std::string& folder() const { return folder_->path(); }
  const SessionOptions& options() const { return options_; }
  double time() const { return time_; }                                    // at which it was taken up [s]
  double end() const { return options_.until.value_or(scene_.duration); }  // [s]

 private:
  void build();
  void take(Checkpoint& checkpoint);

  SessionOptions options_;
  scene::Scene scene_;
  std::vector<std::string> notes_;
  double time_ = 0.0;
  RunRecord record_;
  std::optional<RunFolder> folder_;
  std::optional<World> world_;
  std::optional<GaugeSet> gauges_;
  std::optional<RunLoop> loop_;
};

}  // namespace froude::run
