// What does sorting into cells and permuting cost a particle?
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include <froude/particles/pool.h>
#include "fluid_block.h"
#include "rows.h"

namespace {

using namespace froude;
using bench::FluidBlock;
using bench::kSpacing;

// Arguments: particles, cell in spacings, threads.
void build(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  FluidBlock fluid(count, kSpacing * static_cast<double>(state.range(1)), false);
  tbb::task_arena arena(static_cast<int>(state.range(2)));
  arena.execute([&] {
    for (auto _ : state) fluid.grid.build(fluid.x, fluid.y, fluid.frame);
  });
  bench::items(state, count);
  bench::threads(state, static_cast<int>(state.range(2)));
}

// A pool of fluid, 12 columns: sorted, moved a little, again and again.
void permute(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  FluidBlock fluid(count, 2.0 * kSpacing, false);
  ParticlePool pool({count, GrowthPolicy::Fixed, "bench"});
  for (const char* name : {"a", "b", "c", "d", "e"}) pool.addColumn<float>(name, ColumnKind::State);
  for (std::size_t i = 0; i < count; ++i) pool.create();
  fluid.grid.build(fluid.x, fluid.y, fluid.frame);
  tbb::task_arena arena(static_cast<int>(state.range(1)));
  arena.execute([&] {
    for (auto _ : state) pool.permute(fluid.grid.order());
  });
  bench::items(state, count);
  bench::threads(state, static_cast<int>(state.range(1)));
}

BENCHMARK(build)->ArgsProduct({{10000, 100000, 1000000}, {2, 4}, {1, 2}})->UseRealTime();
BENCHMARK(permute)->ArgsProduct({{10000, 100000, 1000000}, {1, 2}})->UseRealTime();

}  // namespace
