// What does sorting into cells, permuting and listing neighbours cost a particle?
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include <froude/base/random.h>
#include <froude/particles/cell_grid.h>
#include <froude/particles/neighbour_list.h>
#include <froude/particles/pool.h>

namespace {

using namespace froude;

constexpr double kSpacing = 0.01;

// A square block of fluid on a jittered lattice in a domain four times its area, as after a few steps.
struct Fluid {
  Fluid(std::size_t count, double cell, bool shuffled) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
    RandomStream random(1, 2);
    for (std::size_t i = 0; i < count; ++i) {
      x.push_back((static_cast<double>(i % side) + random.uniform()) * kSpacing);
      y.push_back((static_cast<double>(i / side) + random.uniform()) * kSpacing);
    }
    const double extent = 2.0 * kSpacing * static_cast<double>(side);
    frame = GridFrame::cover({{0.0, 0.0}, {extent, extent}}, cell);
    if (shuffled) return;
    sort();
    for (std::size_t i = 0; i < count; ++i) {  // one step of motion after the sort: nearly sorted
      x[i] += 0.2 * kSpacing * random.uniform(-1.0, 1.0);
      y[i] += 0.2 * kSpacing * random.uniform(-1.0, 1.0);
    }
  }
  void sort() {
    grid.build(x, y, frame);
    const std::vector<double> oldX = x, oldY = y;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = oldX[grid.order()[i]];
      y[i] = oldY[grid.order()[i]];
    }
    grid.build(x, y, frame);
  }
  std::vector<double> x, y;
  GridFrame frame;
  CellGrid grid;
};

void perParticle(benchmark::State& state, std::size_t count) {
  state.counters["per_particle"] = benchmark::Counter(
      static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Arguments: particles, cell in spacings, threads.
void build(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  Fluid fluid(count, kSpacing * static_cast<double>(state.range(1)), false);
  tbb::task_arena arena(static_cast<int>(state.range(2)));
  arena.execute([&] {
    for (auto _ : state) fluid.grid.build(fluid.x, fluid.y, fluid.frame);
  });
  perParticle(state, count);
}

// A pool of fluid, 12 columns: sorted, moved a little, again and again.
void permute(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  Fluid fluid(count, 2.0 * kSpacing, false);
  ParticlePool pool({count, GrowthPolicy::Fixed, "bench"});
  for (const char* name : {"a", "b", "c", "d", "e"}) pool.addColumn<float>(name, ColumnKind::State);
  for (std::size_t i = 0; i < count; ++i) pool.create();
  fluid.grid.build(fluid.x, fluid.y, fluid.frame);
  tbb::task_arena arena(static_cast<int>(state.range(1)));
  arena.execute([&] {
    for (auto _ : state) pool.permute(fluid.grid.order());
  });
  perParticle(state, count);
}

void list(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const double radius = kSpacing * static_cast<double>(state.range(1));
  Fluid fluid(count, radius, true);
  fluid.sort();
  NeighbourList neighbours;
  tbb::task_arena arena(static_cast<int>(state.range(2)));
  arena.execute([&] {
    for (auto _ : state) neighbours.build(fluid.grid, fluid.x, fluid.y, radius);
  });
  perParticle(state, count);
  state.counters["neighbours"] = static_cast<double>(neighbours.entryCount()) / static_cast<double>(count);
}

BENCHMARK(build)->ArgsProduct({{10000, 100000, 1000000}, {2, 4}, {1, 2}})->UseRealTime();
BENCHMARK(permute)->ArgsProduct({{10000, 100000, 1000000}, {1, 2}})->UseRealTime();
BENCHMARK(list)->ArgsProduct({{10000, 100000}, {2, 3, 4}, {1, 2}})->UseRealTime();

}  // namespace
