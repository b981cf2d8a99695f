// What does one pass over the pairs of a fluid cost, for each instruction set? A sweep of pbf is `density` with the
// pressure update and `displace`.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <froude/base/parallel.h>
#include <froude/base/random.h>
#include <froude/solver/fluid/fluid_cells.h>
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/pair_loops.h>
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kCellBlock = 128;  // as pbf takes them

// A square of side² particles, one a spacing, each up to 0.2 spacings from its place; sorted into cells of 2.1
// spacings.
struct Fluid {
  explicit Fluid(std::size_t side) : count(side * side) {
    DomainDef domain;
    domain.box = {{0.0, 0.0}, {static_cast<double>(side) + 4.0, static_cast<double>(side) + 4.0}};
    RandomStream random(3, count);
    std::vector<double> px, py;
    for (std::size_t k = 0; k < count; ++k) {
      px.push_back(2.5 + static_cast<double>(k % side) + random.uniform(-0.2, 0.2));
      py.push_back(2.5 + static_cast<double>(k / side) + random.uniform(-0.2, 0.2));
    }
    grid.build(px, py, fluidFrame(domain, px, py, 2.1));
    for (AlignedArray<std::int32_t>* a : {&x, &y, &newX, &newY}) a->resize(count);
    for (AlignedArray<float>* a : {&value, &density, &diagonal, &shiftX, &shiftY, &target, &kappa, &change}) {
      a->resize(count);
    }
    for (std::size_t k = 0; k < count; ++k) {
      x[k] = lattice::coordinate(px[grid.order()[k]]);
      y[k] = lattice::coordinate(py[grid.order()[k]]);
      value[k] = static_cast<float>(random.uniform(0.0, 0.1));
      target[k] = 1.0f;
    }
    findOccupiedCells(grid, cells);
    findCellRuns(grid, cells, {}, runs);
  }
  PairFrame frame() const { return {&grid, cells, runs.data(), x.data(), y.data(), 0, 0, {}}; }

  std::size_t count;
  CellGrid grid;
  std::vector<std::uint32_t> cells;
  AlignedArray<CellRuns> runs;
  AlignedArray<std::int32_t> x, y, newX, newY;
  AlignedArray<float> value, density, diagonal, shiftX, shiftY, target, kappa, change;
  // dfsph: S, B, κB and the displacement of the sub-step.
  AlignedArray<float> skewX, skewY, totalX, totalY, bxx, bxy, byy, kxx, kxy, kyy;
};

enum class Pass { Density, DensityAndDiagonal, Displace, Viscosity, Sweep, Moments, Divergence, Push };

// Arguments: particles along a side, instruction set (0 scalar, 1 sse4, 2 avx2, 3 avx3), threads.
void pass(benchmark::State& state, Pass what) {
  Fluid fluid(static_cast<std::size_t>(state.range(0)));
  const PairLoops& loops = pairLoops(static_cast<SimdTarget>(state.range(1)));
  const PairFrame frame = fluid.frame();
  DensityLoop density{};
  density.density = fluid.density.data();
  density.diagonal = fluid.diagonal.data();
  loops.density(frame, density, 0, fluid.cells.size());
  DensityLoop update = density;
  update.diagonal = nullptr;
  update.update = {fluid.target.data(), fluid.diagonal.data(), fluid.kappa.data(), fluid.change.data(), 0.6f};
  DisplacementLoop displacement{};
  displacement.pressure = fluid.value.data();
  displacement.shiftX = fluid.shiftX.data();
  displacement.shiftY = fluid.shiftY.data();
  displacement.newX = fluid.newX.data();
  displacement.newY = fluid.newY.data();
  for (AlignedArray<float>* a : {&fluid.skewX, &fluid.skewY, &fluid.totalX, &fluid.totalY, &fluid.bxx, &fluid.bxy,
                                 &fluid.byy, &fluid.kxx, &fluid.kxy, &fluid.kyy}) {
    a->resize(fluid.count);
  }
  const MomentLoop moments{nullptr,
                           fluid.density.data(),
                           fluid.skewX.data(),
                           fluid.skewY.data(),
                           fluid.diagonal.data(),
                           {fluid.bxx.data(), fluid.bxy.data(), fluid.byy.data()}};
  DivergenceLoop divergence{};
  divergence.ux = fluid.totalX.data();
  divergence.uy = fluid.totalY.data();
  divergence.correction = {fluid.bxx.data(), fluid.bxy.data(), fluid.byy.data()};
  divergence.update = update.update;
  PushLoop push{};
  push.pressure = fluid.value.data();
  push.scaled = {fluid.kxx.data(), fluid.kxy.data(), fluid.kyy.data()};
  push.skewX = fluid.skewX.data();
  push.skewY = fluid.skewY.data();
  push.shiftX = fluid.shiftX.data();
  push.shiftY = fluid.shiftY.data();
  push.totalX = fluid.totalX.data();
  push.totalY = fluid.totalY.data();
  const ViscosityLoop viscosity{fluid.value.data(),  fluid.kappa.data(), 0.05f, 0.02f,
                                fluid.shiftX.data(), fluid.shiftY.data()};
  const auto run = [&](auto&& loop) { parallelFor(fluid.cells.size(), kCellBlock, loop); };
  tbb::task_arena(static_cast<int>(state.range(2))).execute([&] {
    for (auto _ : state) {
      if (what == Pass::Density || what == Pass::Sweep) {
        run([&](std::size_t b, std::size_t e) { loops.density(frame, update, b, e); });
      }
      if (what == Pass::DensityAndDiagonal) {
        run([&](std::size_t b, std::size_t e) { loops.density(frame, density, b, e); });
      }
      if (what == Pass::Displace || what == Pass::Sweep) {
        run([&](std::size_t b, std::size_t e) { loops.displace(frame, displacement, b, e); });
      }
      if (what == Pass::Moments) {
        run([&](std::size_t b, std::size_t e) { loops.moments(frame, moments, b, e); });
      }
      if (what == Pass::Divergence) {
        run([&](std::size_t b, std::size_t e) { loops.divergence(frame, divergence, b, e); });
      }
      if (what == Pass::Push) {
        run([&](std::size_t b, std::size_t e) { loops.push(frame, push, b, e); });
      }
      if (what == Pass::Viscosity) {
        run([&](std::size_t b, std::size_t e) { loops.viscosity(frame, viscosity, b, e); });
      }
    }
  });
  bench::items(state, fluid.count);
  bench::threads(state, static_cast<int>(state.range(2)));
}

void arguments(benchmark::internal::Benchmark* b) {
  for (const SimdTarget t : supportedSimdTargets()) b->Args({100, static_cast<int>(t), 1});
  const int best = static_cast<int>(bestSimdTarget());
  b->Args({100, best, 2})->Args({316, best, 1})->Args({316, best, 2})->UseRealTime();
}

BENCHMARK_CAPTURE(pass, density, Pass::Density)->Apply(arguments);
BENCHMARK_CAPTURE(pass, densityAndDiagonal, Pass::DensityAndDiagonal)->Apply(arguments);
BENCHMARK_CAPTURE(pass, displace, Pass::Displace)->Apply(arguments);
BENCHMARK_CAPTURE(pass, viscosity, Pass::Viscosity)->Apply(arguments);
BENCHMARK_CAPTURE(pass, sweep, Pass::Sweep)->Apply(arguments);
BENCHMARK_CAPTURE(pass, moments, Pass::Moments)->Apply(arguments);
BENCHMARK_CAPTURE(pass, divergence, Pass::Divergence)->Apply(arguments);
BENCHMARK_CAPTURE(pass, push, Pass::Push)->Apply(arguments);

}  // namespace
