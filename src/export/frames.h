// Frames of a run: HDF5 segments with XDMF, PNG pictures, and a film of them.
#pragma once

#include <memory>
#include <string>

#include <froude/solver/world.h>
#include "scene/scene.h"

namespace froude::exporting {

/// Input or output failed; exit code 4. `what()` names the file and the reason.
class OutputError : public Error {
 public:
  using Error::Error;
};

/// Writes frames into a run's folder. Frames are numbered from 0; nothing here alters the world.
class FrameWriter {
 public:
  /// `nextFrame` > 0 when a run is resumed: frames from that number on are dropped first.
  FrameWriter(std::string folder, const scene::Scene& scene, const World& world, int nextFrame);
  ~FrameWriter();

  /// Writes frame `index` of the present state.
  void write(const World& world, int index);
  /// Closes the open HDF5 segment, so that what was written so far is whole; rewrites frames.h5 and frames.xdmf.
  /// Called at each checkpoint and at the end.
  void closeSegment();
  /// Joins the pictures to film.mp4 when ffmpeg is installed; returns the file or an empty string.
  std::string makeFilm();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One picture of the present state as PNG, written beside and renamed.
void drawPng(const std::string& file, const World& world, const scene::Scene& scene);

}  // namespace froude::exporting
