// Runs one case with one fluid method at its spacings.
#pragma once

#include <string>
#include <vector>

#include "validation/validation.h"

namespace froude::validation {

/// What came of one run. `metrics` is empty unless it reached its end.
struct Outcome {
  double spacing = 0.0;  // [m]
  std::vector<Metric> metrics;
  std::string state = "done";  // "done", "unstable: …", "stopped: …" or "refused: …", in words
  std::size_t particles = 0;
  Ledger ledger;
  double simulated = 0.0;  // [s]
  double wall = 0.0;       // of the steps alone [s]
  bool done() const { return state == "done"; }
};

/// When a run is given up.
struct Patience {
  double seconds = kInfinity;    // of wall time for the steps
  std::function<bool()> stop{};  // asked between sub-steps; empty: never
};

/// Never throws for what a method does: a run that is refused or goes unstable says so in its state, and so does one
/// that was given up.
Outcome runOnce(const Case& entry, const std::string& method, double spacing,
                const std::vector<scene::Override>& overrides, const Patience& patience = {});

/// Names of the fluid methods that this build can make.
std::vector<std::string> fluidMethods();

/// What a case is run with: the models that it names, or all fluid methods.
std::vector<std::string> methodsOf(const Case& entry);

/// Order of convergence of the metric with that name: the slope of log |error| over log spacing, by least squares over
/// the runs that reached their end. Errors within rounding of 0 do not count, nor metrics that do not converge; NaN
/// with fewer than two.
double order(const std::vector<Outcome>& outcomes, const std::string& metric);

}  // namespace froude::validation
