// Who looks on while a run goes on: what it is told, and what it may ask for.
#pragma once

#include <cstddef>
#include <string>

namespace froude::run {

/// Called by the thread that steps, between sub-steps; nothing that it does alters a bit of the run.
class RunObserver {
 public:
  virtual ~RunObserver() = default;

  /// Not 0: the signal at which the run is to save its state and end.
  virtual int pendingSignal() const = 0;
  /// The run is to return where it is, to be taken up again, perhaps by other threads.
  virtual bool wantsPause() const { return false; }
  /// After each sub-step: simulated time [s] and live particles. Cheap.
  virtual void update(double time, std::size_t particles) = 0;
  /// A line about the run: a leak, a sub-step of --verbose.
  virtual void say(const std::string& line) = 0;
};

}  // namespace froude::run
