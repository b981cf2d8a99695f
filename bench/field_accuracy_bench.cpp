// How fast is a distance, and how wrong? Random points in the band of 20 mm of an outline of 1,000 edges, 0.8 m across,
// one thread; errors in metres against every edge in long double. The last argument: 0 the largest error, 1 the root
// mean square.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <froude/fields/batch.h>
#include <froude/fields/openvdb/level_set.h>
#include <froude/fields/sampled_field.h>
#include "field_outline.h"
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kPoints = 20000;
constexpr double kBand = 0.02;

long double boundaryDistance(const Polygon& polygon, const Vec2& p) {
  long double best = std::numeric_limits<long double>::infinity();
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    const Vec2& a = polygon.edgeStart(e);
    const Vec2& b = polygon.edgeEnd(e);
    const long double ux = static_cast<long double>(b.x()) - a.x(), uy = static_cast<long double>(b.y()) - a.y();
    const long double px = static_cast<long double>(p.x()) - a.x(), py = static_cast<long double>(p.y()) - a.y();
    const long double t = std::clamp((px * ux + py * uy) / (ux * ux + uy * uy), 0.0L, 1.0L);
    const long double x = px - t * ux, y = py - t * uy;
    best = std::min(best, x * x + y * y);
  }
  return std::sqrt(best);
}

/// The outline, its points, and what is true of them: worked out once.
struct Case {
  Polygon polygon = bench::wavyOutline(1000);
  DistanceField field{polygon, kBand};
  bench::Points points = bench::pointsFor(field, bench::Where::Band, kPoints);
  std::vector<long double> truth;

  Case() {
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Vec2 p(points.x[i], points.y[i]);
      const long double d = boundaryDistance(polygon, p);
      truth.push_back(polygon.contains(p) ? -d : d);
    }
  }
  static const Case& get() {
    static const Case one;
    return one;
  }
};

void finish(benchmark::State& state, std::span<const double> distance, bool rootMeanSquare) {
  long double largest = 0.0L, squares = 0.0L;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const long double e = std::abs(static_cast<long double>(distance[i]) - Case::get().truth[i]);
    largest = std::max(largest, e);
    squares += e * e;
  }
  bench::items(state, kPoints);
  bench::error(state, static_cast<double>(rootMeanSquare ? std::sqrt(squares / kPoints) : largest));
}

template <typename Ask>
void ask(benchmark::State& state, bool rootMeanSquare, const Ask& fill) {
  std::vector<double> distance(kPoints);
  tbb::task_arena arena(1);
  arena.execute([&] {
    for (auto _ : state) {
      fill(std::span<double>(distance));
      benchmark::DoNotOptimize(distance.data());
    }
  });
  finish(state, distance, rootMeanSquare);
}

FieldBatch distances(std::span<double> into) {
  FieldBatch batch{Case::get().points.x, Case::get().points.y};
  batch.distance = into;
  return batch;
}

void exact(benchmark::State& state) {
  ask(state, state.range(0) == 1,
      [&](std::span<double> out) { sampleBatch(Case::get().field, Transform(), distances(out)); });
}
BENCHMARK(exact)->Arg(0)->Arg(1);

// Cells along a side of the unit square.
void sampled(benchmark::State& state) {
  const SampledField field(Case::get().field, 1.0 / static_cast<double>(state.range(0)));
  ask(state, state.range(1) == 1, [&](std::span<double> out) { sampleBatch(field, Transform(), distances(out)); });
}
BENCHMARK(sampled)->ArgsProduct({{128, 256, 512, 1024, 2048}, {0, 1}});

// Point by point, to be compared with the next.
void sampledPoints(benchmark::State& state) {
  const SampledField field(Case::get().field, 1.0 / static_cast<double>(state.range(0)));
  const bench::Points& points = Case::get().points;
  ask(state, state.range(1) == 1, [&](std::span<double> out) {
    for (std::size_t i = 0; i < kPoints; ++i) out[i] = field.sample(Vec2(points.x[i], points.y[i])).distance;
  });
}
BENCHMARK(sampledPoints)->ArgsProduct({{128, 256, 512, 1024}, {0, 1}});

// Catmull-Rom splines through the same nodes, point by point: what a higher order would bring. The table reaches twice
// as far, so that each point of the band has its sixteen nodes.
void cubicPoints(benchmark::State& state) {
  const DistanceField wide(Case::get().polygon, 2.0 * kBand);
  const SampledField field(wide, 1.0 / static_cast<double>(state.range(0)));
  const bench::Points& points = Case::get().points;
  const auto weights = [](double t, double* w) {
    w[0] = 0.5 * t * (t * (2.0 - t) - 1.0);
    w[1] = 0.5 * (t * t * (3.0 * t - 5.0) + 2.0);
    w[2] = 0.5 * t * (t * (4.0 - 3.0 * t) + 1.0);
    w[3] = 0.5 * t * t * (t - 1.0);
  };
  const auto stride = static_cast<std::size_t>(field.nx() + 1);
  ask(state, state.range(1) == 1, [&](std::span<double> out) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double x = (points.x[k] - field.origin().x()) * field.inverseCellSize();
      const double y = (points.y[k] - field.origin().y()) * field.inverseCellSize();
      const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
      double wx[4], wy[4];
      weights(x - static_cast<double>(i), wx);
      weights(y - static_cast<double>(j), wy);
      double sum = 0.0;
      for (std::size_t r = 0; r < 4; ++r) {
        const float* row = field.nodes().data() + (j + r - 1) * stride + i - 1;
        sum += wy[r] * (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
      }
      out[k] = sum;
    }
  });
}
BENCHMARK(cubicPoints)->ArgsProduct({{256, 512, 1024}, {0, 1}});

// OpenVDB's level set of the extruded outline through its BoxSampler; voxels along a side of the unit square. Its band
// holds all points.
void openvdb(benchmark::State& state) {
  const double voxel = 1.0 / static_cast<double>(state.range(0));
  const vdb::LevelSet levelSet(Case::get().polygon, voxel, kBand / voxel + 2.0);
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < kPoints; ++i) points.emplace_back(Case::get().points.x[i], Case::get().points.y[i]);
  ask(state, state.range(1) == 1, [&](std::span<double> out) { levelSet.sample(points, out); });
}
BENCHMARK(openvdb)->ArgsProduct({{128, 256, 512}, {0, 1}});

// Every edge for every point, in double precision.
void bruteForce(benchmark::State& state) {
  const Polygon& polygon = Case::get().polygon;
  const bench::Points& points = Case::get().points;
  ask(state, state.range(0) == 1, [&](std::span<double> out) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Vec2 p(points.x[i], points.y[i]);
      double best = kInfinity;
      for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
        const Vec2 u = polygon.edgeEnd(e) - polygon.edgeStart(e), arm = p - polygon.edgeStart(e);
        best = std::min(best, (arm - std::clamp(arm.dot(u) / u.squaredNorm(), 0.0, 1.0) * u).squaredNorm());
      }
      out[i] = std::copysign(std::sqrt(best), static_cast<double>(Case::get().truth[i]));
    }
  });
}
BENCHMARK(bruteForce)->Arg(0)->Arg(1)->Iterations(2);

}  // namespace
