// The program as a function: a command line in, an exit code out.
#pragma once

namespace froude::cli {

/// Never throws: every error becomes words on stderr and an exit code (run/exit_codes.h).
int runProgram(int argc, const char* const* argv);

}  // namespace froude::cli
