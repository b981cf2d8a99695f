// What a batch runs: scenes and parameters in, one planned run for each combination out; kept as batch.json.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "study/sweep.h"

namespace froude::study {

/// One run of a batch.
struct PlannedRun {
  std::string folder;                       // its name within the batch's folder, from its parameters
  std::string scene;                        // the file as it was named
  std::string file;                         // its full path
  std::vector<scene::Override> changes;     // all that is set, in this order
  std::vector<scene::Override> parameters;  // those of the sweeps
};

/// All runs of a batch, in order.
struct BatchPlan {
  std::string command;                        // as typed
  std::optional<double> until;                // end of each run instead of its duration [s]
  std::string simd;                           // the SIMD target of all runs
  std::map<std::string, std::string> scenes;  // SHA-256 of each scene file, by full path
  std::vector<std::string> parameters;        // paths of all sweeps, in order
  std::vector<PlannedRun> runs;
};

/// What is asked for on the command line.
struct BatchInput {
  std::vector<std::string> files;         // scenes and batch files
  std::vector<Sweep> sweeps;              // of all of them, on top of their own
  std::vector<scene::Override> settings;  // --set and the like, for all runs
};

/// SHA-256 of a scene file. Throws SceneError where it cannot be read.
std::string checksumOf(const std::string& file);

/// Expands scenes, batch files and sweeps. Scenes are not read yet, but for their checksum. Throws SceneError for what
/// is wrong in a batch file, run::UsageError for sweeps that meet twice.
BatchPlan makePlan(const BatchInput& input);

std::string toJson(const BatchPlan& plan);
/// Throws run::InputError for a text that is not one.
BatchPlan planFromJson(const std::string& text, const std::string& file);

/// In words, why the batch that was begun is not the one that is asked for now; empty where it is.
std::string difference(const BatchPlan& begun, const BatchPlan& asked);

}  // namespace froude::study
