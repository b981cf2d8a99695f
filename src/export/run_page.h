// The page of a run: its frames taken while it goes on, and index.html made from what its folder holds.
#pragma once

#include <optional>
#include <string>

#include <froude/solver/world.h>
#include "export/page_frames.h"
#include "scene/scene.h"

namespace froude::exporting {

/// Takes frames into player.frames, unless the scene asks for no frames at all, and writes index.html. Of long runs of
/// many particles each second, third … frame is taken, so that the page stays within what a browser opens.
class RunPage {
 public:
  static constexpr const char* kFile = "index.html";

  /// `nextFrame` > 0 when a run is resumed. Throws OutputError.
  RunPage(std::string folder, const scene::Scene& scene, int nextFrame);

  /// Takes frame `index` of the present state, if it is one for the page. Throws OutputError.
  void take(const World& world, int index);
  void sync() {
    if (frames_) frames_->sync();
  }
  /// Writes index.html from the frames so far, this summary, and gauges.csv and scene.toml as they stand in the folder.
  /// Throws OutputError.
  void write(const World& world, const std::string& summary) const;

  const std::optional<PageFrames>& frames() const { return frames_; }

 private:
  std::string folder_;
  const scene::Scene& scene_;
  FrameRanges ranges_;
  int every_ = 1;  // frames
  std::optional<PageFrames> frames_;
};

}  // namespace froude::exporting
