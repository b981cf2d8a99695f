// SIGINT and SIGTERM: the first asks for a checkpoint and an end, the second ends at once.
#pragma once

namespace froude::run {

/// From here on a write to a closed pipe or over a file-size limit fails instead of killing the program.
void letWritesFail();

/// Catches both signals while it lives; also lets writes to a closed pipe or over a file-size limit fail instead of
/// kill. One object at a time.
class SignalGuard {
 public:
  SignalGuard();
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  /// 0, SIGINT or SIGTERM.
  int pending() const;
};

}  // namespace froude::run
