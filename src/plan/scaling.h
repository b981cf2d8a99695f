// How the time of a step and the memory grow with particles and threads.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "plan/points.h"
#include "scene/scene.h"

namespace froude::plan {

struct ScalingOptions {
  bool quick = false;
  std::string folder = "out/scaling";
  double limit = 30.0;                  // wall time of the sub-steps of a measurement at most [s]
  std::vector<std::string> subjects{};  // none: all
};

/// A shipped scene that may be made larger: `changes(k)` gives it about k times its particles.
struct Subject {
  std::string name, scene;
  std::function<std::vector<scene::Override>(double k)> changes;
  double most = 1.0;  // largest k
};
const std::vector<Subject>& scalingSubjects();

/// One size of one subject on so many threads.
struct Sample {
  std::string subject;
  std::size_t particles = 0;
  int threads = 1;
  std::size_t substeps = 0;
  double sweeps = 0.0;              // a sub-step, of pressure; acoustic steps of wcsph
  double median = 0.0, best = 0.0;  // wall time of a particle in a sub-step; of wcsph in an acoustic step [ns]
  int runs = 0;
  double bytes = 0.0;  // a particle, of the whole world; 0 where the system does not tell
};

/// The same sub-steps of the same scene on each number of threads, in turn, `rounds` times: as many as take `seconds`
/// of wall time on the first of them, at least three, after three that are not counted. Throws Error for a scene that
/// is refused or goes unstable.
std::vector<Sample> measureScaling(const Subject& subject, double k, std::span<const int> threads, double seconds,
                                   int rounds);

/// How many times as fast three arrays of 64 MB are streamed by so many threads as by one: what the machine's memory
/// gives at best. The median of several.
double triadScaling(int threads);

/// Bytes of the picture of the samples: nanoseconds over particles, and the gain by threads.
std::string drawScaling(const std::string& file, std::span<const Sample> samples, double triad,
                        const std::string& caption);

/// `froude bench scaling`: rows in the folder's scaling.csv, pictures scaling.svg and scaling.png, a table on stdout
/// and the folder as its last line. Returns the exit code.
int scalingCommand(const ScalingOptions& options);

}  // namespace froude::plan
