// The commands `froude run` and `froude resume`: from a scene or a checkpoint to a folder of results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <froude/base/simd.h>
#include "scene/scene.h"

namespace froude::run {

/// What both commands share.
struct SessionOptions {
  int threads = 0;                 // 0: all usable cores
  std::optional<double> until;     // end instead of the scene's duration [s]
  std::optional<SimdTarget> simd;  // empty: run: the best; resume: the checkpoint's
  bool force = false;              // run: replace an earlier run; resume: accept another SIMD target
  bool traceLeaks = false, quiet = false, verbose = false;
  std::string command;  // as typed, for the summary
};

struct RunOptions {
  std::string scene;
  std::vector<scene::Override> overrides;
  std::string folder;  // empty: out/SCENE
  SessionOptions session;
};

struct ResumeOptions {
  std::string folder;
  SessionOptions session;
};

/// Runs a scene to its end. Returns the exit code; throws what is wrong before anything was written (SceneError,
/// UsageError, exporting::OutputError).
int runScene(const RunOptions& options);

/// Goes on from a folder's checkpoint, with the same bits as if the run had never stopped. Same errors, and InputError
/// for a checkpoint that cannot be read.
int resumeRun(const ResumeOptions& options);

}  // namespace froude::run
