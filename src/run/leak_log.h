// leaks.csv and the lines of --trace-leaks: which particle leaked when, where, and into what.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "run/gauge_log.h"

namespace froude::run {

/// Columns: t,kind,particle,x,y,body,depth,from_x,from_y [s, m]. `particle` is SLOT.GENERATION; `body` is the name of a
/// body, or the side of the domain as "left wall". Throws exporting::OutputError.
class LeakLog {
 public:
  /// A new file, or with `resumedAt` [s] the one that is there, without rows of later times.
  LeakLog(const std::string& file, std::optional<double> resumedAt);

  /// The leaks of the last sub-step.
  void append(const World& world);
  void sync() { log_->sync(); }

 private:
  std::optional<GaugeLog> log_;
  std::vector<std::string> rows_;
};

/// One line for each leak of the last sub-step, at most `most`, then how many more there are.
std::vector<std::string> leakLines(const World& world, std::size_t most);

}  // namespace froude::run
