// How many threads the program computes with. The library runs in its caller's arena; this is where the caller makes
// one.
#pragma once

#include <string>

#include <froude/base/parallel.h>

namespace froude::run {

/// Calls body once, in an arena of exactly `threads` threads, of which the caller is one. More threads than cores are
/// allowed: the bits do not depend on it.
void withThreads(int threads, FunctionRef<void()> body);

/// Version of oneTBB that is running, "2021.8".
std::string tbbVersion();

}  // namespace froude::run
