// The main of every benchmark: refuses to print a rate that would not be a user's.
#include <benchmark/benchmark.h>

#include <cstdio>

#include <froude/base/assert.h>

int main(int argc, char** argv) {
  if (froude::kAssertionsOn || !froude::kOptimized) {
    std::fprintf(stderr, "%s: this build has %s; configure with the preset 'bench' for rates that mean something\n",
                 argv[0], froude::kAssertionsOn ? "assertions on" : "no optimisation");
    return 2;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
