// Other programs, run as processes: an argument vector in, an exit code out, no shell in between.
#pragma once

#include <string>
#include <vector>

namespace froude::run {

/// What is kept of a program's words.
enum class Listen { ToErrors, ToAll };

struct ProcessResult {
  int exitCode = -1;   // 128 + signal for a process that a signal ended
  std::string errors;  // what it wrote on its standard error, or on both outputs: the last few kilobytes
  bool ok() const { return exitCode == 0; }
};

/// Runs `arguments` ([0] is the program, with a path or looked up on PATH) in `folder` (empty: here) and waits.
/// Standard input is /dev/null, and so is standard output unless it is listened to. Throws froude::Error when it cannot
/// be started at all.
ProcessResult runProcess(const std::vector<std::string>& arguments, const std::string& folder = {},
                         Listen listen = Listen::ToErrors);

}  // namespace froude::run
