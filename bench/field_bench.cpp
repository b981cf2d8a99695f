// What does a question to a distance field cost, and what does the field itself cost? A wavy outline in the unit
// square, of 1,000 edges unless said.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <froude/fields/batch.h>
#include <froude/fields/sweep.h>
#include "field_outline.h"
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kPoints = 20000;  // their columns stay in the second cache

void withThreads(int count, FunctionRef<void()> body) {
  tbb::task_arena arena(count);
  arena.execute([&] { body(); });
}

// Distance and normal of many points: 0 coherent in the band, 1 random in the band, 2 random in the box; edges;
// threads.
void batch(benchmark::State& state) {
  const DistanceField field(bench::wavyOutline(static_cast<int>(state.range(1))), 0.02);
  const bench::Points points = bench::pointsFor(field, static_cast<bench::Where>(state.range(0)), kPoints);
  std::vector<double> distance(kPoints), normalX(kPoints), normalY(kPoints);
  FieldBatch columns{points.x, points.y};
  columns.distance = distance;
  columns.normalX = normalX;
  columns.normalY = normalY;
  const auto threads = static_cast<int>(state.range(2));
  withThreads(threads, [&] {
    for (auto _ : state) {
      sampleBatch(field, Transform(), columns);
      benchmark::DoNotOptimize(distance.data());
    }
  });
  bench::items(state, kPoints);
  bench::threads(state, threads);
}
BENCHMARK(batch)
    ->ArgsProduct({{0, 1, 2}, {10, 100, 1000, 10000}, {1}})
    ->ArgsProduct({{0, 1, 2}, {1000}, {2}})
    ->UseRealTime();

// The same point by point: 0 coherent, 1 random in the band, 2 random in the box.
void point(benchmark::State& state) {
  const DistanceField field(bench::wavyOutline(1000), 0.02);
  const bench::Points points = bench::pointsFor(field, static_cast<bench::Where>(state.range(0)), kPoints);
  for (auto _ : state) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      benchmark::DoNotOptimize(field.sample(Vec2(points.x[i], points.y[i])).distance);
    }
  }
  bench::items(state, kPoints);
}
BENCHMARK(point)->Arg(0)->Arg(1)->Arg(2);

// Random points in the box, exact everywhere; the argument is the band in thousandths of a metre.
void exactEverywhere(benchmark::State& state) {
  const DistanceField field(bench::wavyOutline(1000), 1e-3 * static_cast<double>(state.range(0)));
  const bench::Points points = bench::pointsFor(field, bench::Where::Box, kPoints);
  for (auto _ : state) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      benchmark::DoNotOptimize(field.sampleExact(Vec2(points.x[i], points.y[i])).distance);
    }
  }
  bench::items(state, kPoints);
}
BENCHMARK(exactEverywhere)->Arg(20)->Arg(200);

// One item is a field: edges, cells along a side of the unit square (0: the field's own choice), threads. The console
// shows bytes a cell, and what part of the cells is near the outline.
void build(benchmark::State& state) {
  const Polygon outline = bench::wavyOutline(static_cast<int>(state.range(0)));
  const double cell = state.range(1) == 0 ? 0.0 : 1.0 / static_cast<double>(state.range(1));
  const auto threads = static_cast<int>(state.range(2));
  withThreads(threads, [&] {
    for (auto _ : state) {
      const DistanceField field(outline, 0.02, cell);
      benchmark::DoNotOptimize(field.cellSize());
    }
  });
  const DistanceField field(outline, 0.02, cell);
  state.counters["bytes_per_cell"] =
      static_cast<double>(field.memoryBytes()) / static_cast<double>(field.grid().cellCount());
  state.counters["kilobytes"] = static_cast<double>(field.memoryBytes()) / 1024.0;
  state.counters["cells"] = static_cast<double>(field.grid().cellCount());
  bench::items(state, 1);
  bench::threads(state, threads);
}
BENCHMARK(build)
    ->ArgsProduct({{4, 10, 100, 1000, 10000}, {0}, {1}})
    ->ArgsProduct({{1000}, {64, 128, 256, 512, 1024}, {1}})
    ->ArgsProduct({{1000, 10000}, {256}, {2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// A disc of 2 mm radius outside, that moves in a random direction: 0 within 20 mm of the outline, 1 anywhere in the
// unit square; millimetres of the way; the outline stands still (0) or turns by 0.1 rad (1).
void sweep(benchmark::State& state) {
  const DistanceField field(bench::wavyOutline(1000), 0.02);
  const double length = 1e-3 * static_cast<double>(state.range(1));
  std::vector<Vec2> from, to;
  RandomStream random(2, 1);
  while (from.size() < kPoints) {
    const Vec2 p(random.uniform(), random.uniform());
    const double distance = field.sampleExact(p).distance;
    if (distance < 0.0021 || (state.range(0) == 0 && distance > 0.02)) continue;
    const double angle = random.uniform(0.0, 2.0 * kPi);
    from.push_back(p);
    to.push_back(p + length * Vec2(std::cos(angle), std::sin(angle)));
  }
  const RigidMotion motion{{}, {0.0, 0.0}, 0.1};
  const bool turning = state.range(2) == 1;
  for (auto _ : state) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      const SweepHit hit =
          turning ? sweepDisc(field, motion, 1.0, from[i], to[i], 0.002) : sweepDisc(field, from[i], to[i], 0.002);
      benchmark::DoNotOptimize(hit.time);
    }
  }
  bench::items(state, kPoints);
}
BENCHMARK(sweep)->ArgsProduct({{0, 1}, {1, 10}, {0, 1}});

}  // namespace
