// What came of the runs, as a table for people and as rows for programs.
#pragma once

#include <string>
#include <vector>

#include "validation/runner.h"

namespace froude::validation {

/// The runs of one case by one method, coarse to fine.
struct Series {
  const Case* entry = nullptr;
  std::string method;
  std::vector<Outcome> outcomes;
};

/// The machine and the build: the tail of every row. Times are left out of rows and tables of a build with assertions
/// or without optimisation, which would mean nothing.
struct Context {
  int threads = 1;
  bool timed = true;
};
/// Of this build.
Context context(int threads);

/// Lines of a table, without the column heads.
std::vector<std::string> tableLines(const Series& series, const Context& context);
std::string tableHead();

/// Lines of CSV: one for each metric and spacing, one without a metric for a run that did not reach its end. `order`
/// stands in the rows of the finest spacing.
std::vector<std::string> csvLines(const Series& series, const Context& context);
std::string csvHead();

}  // namespace froude::validation
