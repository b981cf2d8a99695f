// Other programs, run as processes: an argument vector in, an exit code out, no shell in between.
#pragma once

#include <string>
#include <vector>

namespace froude::run {

struct ProcessResult {
  int exitCode = -1;   // 128 + signal for a process that a signal ended
  std::string errors;  // what it wrote on its standard error: the last few kilobytes
  bool ok() const { return exitCode == 0; }
};

/// Runs `arguments` ([0] is the program, with a path or looked up on PATH) in `folder` (empty: here) and waits.
/// Standard input and output are /dev/null. Throws froude::Error when it cannot be started at all.
ProcessResult runProcess(const std::vector<std::string>& arguments, const std::string& folder = {});

}  // namespace froude::run
