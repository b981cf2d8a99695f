// What a benchmark says of itself beside its time, so that bench_main can write it as a row of bench/results.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>

namespace froude::bench {

/// Each iteration handles `count` items (particles, points, objects): the row's nanoseconds are those of one of them.
inline void items(benchmark::State& state, std::size_t count) {
  state.counters["per_item"] = benchmark::Counter(
      static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
inline void threads(benchmark::State& state, int count) { state.counters["on_threads"] = count; }
/// Simulated seconds that an iteration advances.
inline void timeStep(benchmark::State& state, double dt) { state.counters["dt"] = dt; }
/// Largest error, in the unit that the benchmark's file names.
inline void error(benchmark::State& state, double largest) { state.counters["error"] = largest; }

}  // namespace froude::bench
