// checkpoint.h5: the whole state of a run, from which it goes on as if it had never stopped; and the one before it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "run/gauges.h"
#include "run/hdf5_archive.h"

namespace froude::run {

/// What a run knows about itself beside the state of its world; goes with the checkpoint.
struct RunRecord {
  std::string command;                // as typed
  std::string sceneFile, sceneName;   // as first given
  std::string sceneSha256;            // of the first file [hex]
  std::vector<std::string> warnings;  // of the scene, as printed
  double wallSeconds = 0.0;           // of stepping and output, all sessions [s]
  double fluidArea0 = 0.0;            // at the start [m²]
  int nextFrame = 0;                  // number of the next frame
  std::uint64_t gaugeBytes = 0;       // of gauges.csv that belong to the state
  // Not saved:
  std::string reason;              // why it is not done, in words
  double checkpointSeconds = 0.0;  // that the last one took [s]
  std::uint64_t checkpointBytes = 0;
};

/// Names in the folder of a run.
inline constexpr const char* kCheckpointName = "checkpoint.h5";
inline constexpr const char* kOlderCheckpointName = "checkpoint_before.h5";

/// Has the folder a checkpoint of either name, whole or not?
bool hasCheckpoint(const std::string& folder);

/// Saves world, gauges and record as the folder's checkpoint, written beside and renamed; the one that was there stays
/// as the older one. Returns its bytes. Throws exporting::OutputError, and leaves both as they were. Cost: a copy of
/// the state in memory for as long as it takes, about 85 bytes a particle, for which the world gives back its own for
/// undoing. Not compressed: deflate takes 42 % off
/// the state of a flow of 10,000 particles, which is not worth the time of one thread at the checkpoints of a large
/// run.
std::uint64_t saveCheckpoint(const std::string& folder, World& world, GaugeSet& gauges, const RunRecord& record);

/// A checkpoint that was found whole: its parts can be asked before any world is made.
class Checkpoint {
 public:
  /// Throws InputError when the file is damaged, UsageError when it is of a format that this build does not know.
  explicit Checkpoint(const std::string& file);

  double time() const { return time_; }  // [s]
  const std::string& simd() const { return simd_; }
  const std::string& stateHash() const { return stateHash_; }
  const std::string& version() const { return version_; }  // "0.1.0 (commit)" that wrote it
  const RunRecord& record() const { return record_; }

  /// Loads into a world and gauges that were made from the same scene. Throws InputError when what was loaded does not
  /// have the hash of what was saved.
  void load(World& world, GaugeSet& gauges);

 private:
  std::string file_;
  Hdf5Reader reader_;
  double time_ = 0.0;
  std::string simd_, stateHash_, version_;
  RunRecord record_;
};

/// The folder's checkpoint, or the older one where it is missing, damaged or foreign; then `notes` says so. Throws
/// UsageError when there is none, else what is wrong with the newest when none can be read.
std::unique_ptr<Checkpoint> openCheckpoint(const std::string& folder, std::vector<std::string>& notes);

/// Version and commit of this build, as checkpoints carry it.
std::string buildVersion();

}  // namespace froude::run
