// What does a question to a distance field cost? A wavy outline of 1,000 edges in the unit square, random points.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/sweep.h>
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kPoints = 100000;

Polygon outline() {
  std::vector<Vec2> ring;
  for (int i = 0; i < 1000; ++i) {
    const double f = 2.0 * kPi * i / 1000.0, r = 0.3 + 0.1 * std::sin(7.0 * f) + 0.02 * std::sin(61.0 * f);
    ring.push_back(Vec2(0.5, 0.5) + r * Vec2(std::cos(f), std::sin(f)));
  }
  return Polygon::make(std::move(ring));
}

// Argument of all: the band in thousandths of a metre.
struct Questions {
  explicit Questions(benchmark::State& state)
      : field(outline(), 1e-3 * static_cast<double>(state.range(0))), points(kPoints), ends(kPoints) {
    RandomStream random(1, 1);
    for (std::size_t i = 0; i < kPoints; ++i) {
      points[i] = {random.uniform(), random.uniform()};
      const double angle = random.uniform(0.0, 2.0 * kPi);
      ends[i] = points[i] + 0.01 * Vec2(std::cos(angle), std::sin(angle));
    }
    bench::items(state, kPoints);
  }
  DistanceField field;
  std::vector<Vec2> points, ends;
};

// Distance, normal and closest point; exact within the band, a bound beyond it.
void sample(benchmark::State& state) {
  const Questions q(state);
  for (auto _ : state) {
    for (const Vec2& p : q.points) benchmark::DoNotOptimize(q.field.sample(p).distance);
  }
}
BENCHMARK(sample)->Arg(20)->Arg(200);

// Exact everywhere.
void sampleExact(benchmark::State& state) {
  const Questions q(state);
  for (auto _ : state) {
    for (const Vec2& p : q.points) benchmark::DoNotOptimize(q.field.sampleExact(p).distance);
  }
}
BENCHMARK(sampleExact)->Arg(20)->Arg(200);

void lowerBound(benchmark::State& state) {
  const Questions q(state);
  for (auto _ : state) {
    for (const Vec2& p : q.points) benchmark::DoNotOptimize(q.field.lowerBound(p));
  }
}
BENCHMARK(lowerBound)->Arg(20)->Arg(200);

// A disc of 2 mm that moves by 10 mm in a random direction; starts inside the outline are reported at once.
void sweep(benchmark::State& state) {
  const Questions q(state);
  for (auto _ : state) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      benchmark::DoNotOptimize(sweepDisc(q.field, q.points[i], q.ends[i], 0.002).time);
    }
  }
}
BENCHMARK(sweep)->Arg(20)->Arg(200);

// The same while the outline turns by 0.1 rad.
void sweepTurning(benchmark::State& state) {
  const Questions q(state);
  const RigidMotion motion{{}, {0.0, 0.0}, 0.1};
  for (auto _ : state) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      benchmark::DoNotOptimize(sweepDisc(q.field, motion, 1.0, q.points[i], q.ends[i], 0.002).time);
    }
  }
}
BENCHMARK(sweepTurning)->Arg(20)->Arg(200);

}  // namespace
