// The program as a function: a command line in, an exit code out.
#pragma once

#include "plan/chart_options.h"

namespace froude::cli {

/// Commands that stand on the validation cases, which are built on top of this library: whoever links both hands them
/// in. One that is not there is refused in words.
struct Studies {
  int (*chart)(const plan::ChartOptions&) = nullptr;
};

/// Never throws: every error becomes words on stderr and an exit code (run/exit_codes.h).
int runProgram(int argc, const char* const* argv, const Studies& studies = {});

}  // namespace froude::cli
