// What `froude chart` is asked for.
#pragma once

#include <string>
#include <vector>

namespace froude::plan {

struct ChartOptions {
  bool quick = false;
  std::string folder = "out/chart";
  int threads = 0;                             // 0: all usable cores
  double limit = 120.0;                        // wall time of the steps of a point at most [s]
  std::vector<std::string> cases{}, models{};  // none: all
};

}  // namespace froude::plan
