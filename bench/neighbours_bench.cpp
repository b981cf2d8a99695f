// What does a particle's list of neighbours cost, from positions that moved a little since the last sort?
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <froude/particles/neighbour_list.h>
#include "fluid_block.h"
#include "rows.h"

namespace {

using namespace froude;
using bench::FluidBlock;
using bench::kSpacing;

void say(benchmark::State& state, const NeighbourList& list, int threads) {
  bench::items(state, list.size());
  bench::threads(state, threads);
  state.counters["neighbours"] = static_cast<double>(list.entryCount()) / static_cast<double>(list.size());
}

// Arguments: particles, radius in spacings, threads.
void list(benchmark::State& state) {
  const double radius = kSpacing * static_cast<double>(state.range(1));
  FluidBlock fluid(static_cast<std::size_t>(state.range(0)), radius, true);
  fluid.sort();
  NeighbourList neighbours;
  tbb::task_arena(static_cast<int>(state.range(2))).execute([&] {
    for (auto _ : state) neighbours.build(fluid.grid, fluid.x, fluid.y, radius);
  });
  say(state, neighbours, static_cast<int>(state.range(2)));
}
BENCHMARK(list)->ArgsProduct({{10000, 100000}, {2, 3, 4}, {1, 2}})->UseRealTime();

// Sorting into cells and listing, as a step does them; the permutation of the columns is cell_grid_bench's.
void sortAndList(benchmark::State& state) {
  const double radius = kSpacing * static_cast<double>(state.range(1));
  FluidBlock fluid(static_cast<std::size_t>(state.range(0)), radius, true);
  fluid.sort();
  NeighbourList neighbours;
  tbb::task_arena(static_cast<int>(state.range(2))).execute([&] {
    for (auto _ : state) {
      fluid.grid.build(fluid.x, fluid.y, fluid.frame);
      neighbours.build(fluid.grid, fluid.x, fluid.y, radius);
    }
  });
  say(state, neighbours, static_cast<int>(state.range(2)));
}
BENCHMARK(sortAndList)->ArgsProduct({{100000, 1000000}, {2}, {1, 2}})->UseRealTime();

// By target: 0 scalar, 1 sse4, 2 avx2, 3 avx3.
void byTarget(benchmark::State& state) {
  const auto target = static_cast<SimdTarget>(state.range(0));
  FluidBlock fluid(100000, 2.0 * kSpacing, true);
  fluid.sort();
  NeighbourList neighbours;
  tbb::task_arena(1).execute([&] {
    for (auto _ : state) neighbours.build(fluid.grid, fluid.x, fluid.y, 2.0 * kSpacing, 0.0, target);
  });
  say(state, neighbours, 1);
}
BENCHMARK(byTarget)->Apply([](auto* b) {
  for (const SimdTarget t : supportedSimdTargets()) b->Arg(static_cast<int>(t));
});

}  // namespace
