// Frames of a run: HDF5 segments with XDMF, PNG pictures, .vdb files, and a film of the pictures.
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

/// Writes frames into a run's folder, of the kinds that the scene asks for: frame_00000.png …, frame_00000.vdb …, and
/// segments frames/0000.h5 … with frames.h5 and frames.xdmf over them. Frames are numbered from 0; nothing here alters
/// the world. A segment is built in memory and written whole, so what is on disk is always sound; one that outgrows 256
/// MB is closed early.
class FrameWriter {
 public:
  /// `nextFrame` > 0 when a run is resumed: frames from that number on are dropped first. Throws OutputError.
  FrameWriter(std::string folder, const scene::Scene& scene, const World& world, int nextFrame);
  /// Frames of a segment that was not closed are lost.
  ~FrameWriter();

  /// Writes frame `index` of the present state. Throws OutputError.
  void write(const World& world, int index);
  /// Closes the open HDF5 segment, so that what was written so far is whole; rewrites frames.h5 and frames.xdmf.
  /// Called at each checkpoint and at the end. Throws OutputError; then the segment stays open.
  void closeSegment();
  /// Joins the pictures to film.mp4 when ffmpeg is installed; returns the file or an empty string.
  std::string makeFilm();
  /// Why the last `makeFilm` made none.
  const std::string& filmNote() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One picture of the present state as PNG, written beside and renamed.
void drawPng(const std::string& file, const World& world, const scene::Scene& scene);

}  // namespace froude::exporting
