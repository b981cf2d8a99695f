// checkpoint.h5: the whole state of a run, from which it goes on as if it had never stopped.
#pragma once

#include <cstdint>
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
  std::string reason;                 // why it is not done, in words; not saved
};

/// Saves world, gauges and record, written beside and renamed. Throws exporting::OutputError. Cost: two copies of the
/// state in memory for as long as it takes, about 70 bytes a particle. Not compressed: deflate takes 42 % off the state
/// of a flow of 10,000 particles, which is not worth the time of one thread at the checkpoints of a large run.
void saveCheckpoint(const std::string& file, World& world, GaugeSet& gauges, const RunRecord& record);

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

/// Version and commit of this build, as checkpoints carry it.
std::string buildVersion();

}  // namespace froude::run
