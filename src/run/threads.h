// How many threads the program computes with. The library runs in its caller's arena; this is where the caller makes
// one.
#pragma once

#include <memory>
#include <string>

#include <froude/base/parallel.h>

namespace froude::run {

/// Calls body once, in an arena of exactly `threads` threads, of which the caller is one. More threads than cores are
/// allowed: the bits do not depend on it.
void withThreads(int threads, FunctionRef<void()> body);

/// All threads of the process together, for as long as it lives: callers of arenas are not counted, their helpers are.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Calls body in an arena of its own, of `threads` threads with the caller; helpers come as the ThreadLimit allows.
void inArena(int threads, FunctionRef<void()> body);

/// Version of oneTBB that is running, "2021.8".
std::string tbbVersion();

}  // namespace froude::run
