// What the program's exit codes mean, and the errors that lead to them.
#pragma once

#include <froude/base/error.h>

namespace froude::run {

/// The contract with scripts; `--help` of every command lists the codes that it can end with.
enum ExitCode : int {
  kDone = 0,
  kInternalError = 1,
  kUsageError = 2,   // the command line or the scene is wrong; nothing was written
  kUnstable = 3,     // stopped; the last sound state is kept
  kOutputError = 4,  // input or output failed; nothing half-written is left
  kNotAllDone = 5,   // a batch in which some runs are not done
  kInterrupted = 130,
  kTerminated = 143,
};

/// The command line is wrong: `what()` says what, and what would be right.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// Something that was written earlier cannot be read.
class InputError : public Error {
 public:
  using Error::Error;
};

}  // namespace froude::run
