// What does the pressure solve on a grid cost, and how do its iterations grow with the grid?
//
// A square tank of n × n cells: 0 full, 1 with a free surface, 2 with 40 discs under one; it falls freely
// for a step, with noise. Nanoseconds are those of one
// cell in one iteration; `iterations` is what a divergence × step of 1e-3 takes from nothing.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <vector>

#include <froude/base/random.h>
#include <froude/solver/fluid/grid/pressure_system.h>
#include "rows.h"

namespace {

using namespace froude;

struct Tank {
  Tank(int kind, int n) {
    std::vector<TileIndex> tiles;
    for (int y = 0; y <= n / 16; ++y) {
      for (int x = 0; x <= n / 16; ++x) tiles.push_back({x, y});
    }
    grid.build(tiles);
    std::vector<GridCell> cells(grid.values(), GridCell::Air);
    AlignedArray<float> wx, wy;
    grid.clear(wx);
    grid.clear(wy);
    grid.clear(b);
    RandomStream random(1, static_cast<std::uint64_t>(n));
    std::vector<std::array<double, 3>> discs;
    RandomStream places(1, 7);
    for (int k = 0; kind == 2 && k < 40; ++k) {
      discs.push_back({places.uniform(0.0, 1.0) * n, places.uniform(0.0, 0.9) * n, places.uniform(0.02, 0.05) * n});
    }
    const auto open = [&](double x, double y) {
      for (const auto& [cx, cy, r] : discs) {
        if (std::hypot(x - cx, y - cy) < r) return 0.0f;
      }
      return 1.0f;
    };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const std::size_t k = grid.place(i, j);
        const double x = (i + 0.5) / n, y = (j + 0.5) / n;
        const double top =
            kind == 0 ? 2.0 : (kind == 1 ? 0.6 + 0.15 * std::sin(5.0 * x) + 0.03 * std::sin(40.0 * x) : 0.92);
        cells[k] = open(i + 0.5, j + 0.5) == 0.0f ? GridCell::Solid : (y < top ? GridCell::Fluid : GridCell::Air);
        if (cells[k] == GridCell::Fluid) ++wet;
        for (int s = 0; s < 8; ++s) {
          const double along = (s + 0.5) / 8.0;
          if (i > 0) wx[k] += open(i, j + along) / 8.0f;
          if (j > 0) wy[k] += open(i + along, j) / 8.0f;
        }
        b[k] = static_cast<float>(random.uniform(-0.3, 0.3) + (j == 0 ? 20.0 / n : 0.0));
      }
    }
    coefficients.fromWeights(grid, cells.data(), wx.data(), wy.data());
    grid.clear(kappa);
  }
  TileGrid grid;
  AlignedArray<float> b, kappa;
  PressureCoefficients coefficients;
  std::size_t wet = 0;
};

// Arguments: tank, n, threads.
void solve(benchmark::State& state) {
  Tank tank(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  tbb::task_arena arena(static_cast<int>(state.range(2)));
  PressureSystem system;
  PressureReport report;
  arena.execute([&] {
    system.prepare(tank.grid, tank.coefficients);
    for (auto _ : state) {
      tank.grid.clear(tank.kappa);
      report = system.solve(tank.b.data(), tank.kappa.data(), {1e-3f, 60});
    }
  });
  bench::items(state, tank.wet * static_cast<std::size_t>(report.iterations));
  bench::threads(state, static_cast<int>(state.range(2)));
  bench::error(state, static_cast<double>(report.residual));
  state.counters["iterations"] = report.iterations;
  state.counters["wet"] = static_cast<double>(tank.wet);
}

// The levels: what a step pays before its first iteration. Per cell.
void prepare(benchmark::State& state) {
  Tank tank(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  tbb::task_arena arena(static_cast<int>(state.range(2)));
  PressureSystem system;
  arena.execute([&] {
    for (auto _ : state) system.prepare(tank.grid, tank.coefficients);
  });
  bench::items(state, tank.wet);
  bench::threads(state, static_cast<int>(state.range(2)));
}

BENCHMARK(solve)->ArgsProduct({{0, 1, 2}, {64, 128, 256, 512, 1024}, {1, 2}})->UseRealTime();
BENCHMARK(prepare)->ArgsProduct({{1}, {200, 1024}, {1, 2}})->UseRealTime();

}  // namespace
