// `froude doctor`: what this build and this machine are, for bug reports and for trust in timings.
#pragma once

namespace froude::cli {

/// Prints to stdout; returns the exit code.
int doctorCommand(bool json);

}  // namespace froude::cli
