// What does it cost to cut cells? Per listed cell: octagons that move (most cells have one straight edge or two), an
// outline of 1,000 edges (many have several), both over the walls of a tank; and the list alone where nothing moves.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <froude/fields/cut_cells.h>

#include "field_outline.h"
#include "rows.h"

namespace {

using namespace froude;

constexpr std::array<std::int32_t, 4> kRange{-2, -2, 474, 316};
const CutGrid kGrid{{0.0, 0.0}, 2.0 / 316.0, 0, 0};
const CutWalls kTank{{{0.0, 0.0}, {3.0, 2.0}}, {true, true, true, true}};

void cut(benchmark::State& state, const Polygon& polygon, int columns, int rows, bool moving) {
  const int count = columns * rows;
  tbb::task_arena(static_cast<int>(state.range(0))).execute([&] {
    CutCells cells;
    std::vector<CutOutline> outlines(static_cast<std::size_t>(count));
    auto place = [&](double time) {
      for (int k = 0; k < count; ++k) {
        const Vec2 at(1.15 + 0.09 * (k % columns) + 0.01 * time, 0.08 + 0.09 * (k / columns));
        outlines[static_cast<std::size_t>(k)] = {&polygon, Transform::of(at, 0.1 * k + time), at, k};
      }
    };
    place(0.0);
    if (moving) cells.setFixed(kGrid, {}, kTank);
    double time = 0.0;
    std::size_t listed = 0;
    for (auto _ : state) {
      place(moving ? time += 0.01 : 0.0);
      if (!moving) cells.setFixed(kGrid, outlines, kTank);
      cells.update(kRange, moving ? std::span<const CutOutline>(outlines) : std::span<const CutOutline>());
      listed = cells.cells().size();
    }
    bench::items(state, listed);
    bench::threads(state, static_cast<int>(state.range(0)));
    state.counters["cells"] = static_cast<double>(listed);
  });
}

void movingOctagons(benchmark::State& state) { cut(state, Polygon::regular(8, 0.03), 20, 10, true); }
void fixedOctagons(benchmark::State& state) { cut(state, Polygon::regular(8, 0.03), 20, 10, false); }
void movingBox(benchmark::State& state) { cut(state, Polygon::box({{-0.3, -0.05}, {0.3, 0.05}}), 1, 1, true); }
void movingOutline(benchmark::State& state) { cut(state, bench::wavyOutline(1000), 1, 1, true); }

BENCHMARK(movingOctagons)->Arg(1)->Arg(2);
BENCHMARK(fixedOctagons)->Arg(1)->Arg(2);
BENCHMARK(movingBox)->Arg(1)->Arg(2);
BENCHMARK(movingOutline)->Arg(1)->Arg(2);

}  // namespace
