// What does a query of the narrow phase cost, and what do Box2D 2.4 and libccd take for theirs? 16,384 random pairs of
// 256 random convex polygons on the unit circle, one thread; the argument of every case is the number of vertices. Of
// polygons with more than 64 vertices there are fewer, 16,384 vertices in all: else it is memory that is measured.
//
// "Apart": centres 2.05 to 4 apart; "near": 1.2 to 2.05, where most pairs overlap. Every query starts from
// the poses of both in the world. Warm: the cache is the pair's own, and between two queries of a pair it moved by a
// thousandth. Box2D computes in float and knows no more than 8 vertices; libccd computes in double and in three
// dimensions: its polygons are prisms of height 1, their support found among all vertices.
#include <benchmark/benchmark.h>
#include <box2d/b2_collision.h>
#include <box2d/b2_distance.h>
#include <box2d/b2_polygon_shape.h>
#include <box2d/b2_time_of_impact.h>
#include <ccd/ccd.h>

#include <memory>

#include <froude/base/random.h>
#include <froude/solver/contact/contact_manifold.h>
#include <froude/solver/contact/sat.h>
#include <froude/solver/contact/time_of_impact.h>
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kPairs = 16384;
constexpr std::uint32_t kShapes = 256, kVertices = 16384;
constexpr double kMargin = 0.02;   // twice the radius that Box2D gives its polygons
constexpr double kTarget = 0.005;  // its slop

enum class Gap { Apart, Near };

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

struct Pair {
  std::uint32_t a, b;
  Transform poseA;
  std::array<Transform, 2> poseB;  // before and after it moved a little
};

struct Pairs {
  std::vector<ConvexShape> shapes;
  std::vector<Pair> pairs;
};

std::vector<Vec2> roundRing(RandomStream& random, std::uint32_t vertices) {
  std::vector<Vec2> ring;
  for (std::uint32_t k = 0; k < vertices; ++k)
    ring.push_back(unit(2.0 * kPi * (k + random.uniform(0.0, 0.9)) / vertices));
  return ring;
}

Pairs makePairs(std::uint32_t vertices, Gap gap) {
  RandomStream random(11, vertices);
  Pairs made;
  const std::uint32_t shapes = std::min(kShapes, kVertices / vertices);
  for (std::uint32_t k = 0; k < shapes; ++k) made.shapes.emplace_back(roundRing(random, vertices));
  for (std::size_t k = 0; k < kPairs; ++k) {
    const double distance = gap == Gap::Apart ? random.uniform(2.05, 4.0) : random.uniform(1.2, 2.05);
    const Vec2 at(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    const Vec2 apart = distance * unit(random.uniform(-kPi, kPi));
    const double angle = random.uniform(-kPi, kPi);
    const Vec2 step = 0.001 * unit(random.uniform(-kPi, kPi));
    made.pairs.push_back(
        {random.below(shapes),
         random.below(shapes),
         Transform::of(at, random.uniform(-kPi, kPi)),
         {Transform::of(at + apart, angle), Transform::of(at + apart + step, angle + random.uniform(-0.001, 0.001))}});
  }
  return made;
}

// Runs query(pair, poseB, cache) over all pairs, to and fro between their two poses.
template <typename Cache, typename Query>
void run(benchmark::State& state, const Pairs& pairs, bool warm, Query&& query) {
  std::vector<Cache> caches(kPairs);
  for (std::size_t k = 0; k < kPairs; ++k) query(pairs.pairs[k], pairs.pairs[k].poseB[1], caches[k]);
  std::size_t pass = 0;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kPairs; ++k) {
      const Pair& pair = pairs.pairs[k];
      if (!warm) caches[k] = Cache{};
      query(pair, pair.poseB[pass & 1], caches[k]);
    }
    ++pass;
  }
  bench::items(state, kPairs);
}

std::uint32_t vertices(const benchmark::State& state) { return static_cast<std::uint32_t>(state.range(0)); }

void sat(benchmark::State& state, Gap gap, bool warm) {
  const Pairs pairs = makePairs(vertices(state), gap);
  run<PairCache>(state, pairs, warm, [&](const Pair& p, const Transform& poseB, PairCache& cache) {
    benchmark::DoNotOptimize(
        froude::sat(pairs.shapes[p.a], pairs.shapes[p.b], poseIn(p.poseA, poseB), cache).separation);
  });
}

void closest(benchmark::State& state, Gap gap, bool warm) {
  const Pairs pairs = makePairs(vertices(state), gap);
  run<PairCache>(state, pairs, warm, [&](const Pair& p, const Transform& poseB, PairCache& cache) {
    benchmark::DoNotOptimize(
        closestFeatures(pairs.shapes[p.a], pairs.shapes[p.b], poseIn(p.poseA, poseB), cache).distance);
  });
}

void manifold(benchmark::State& state, Gap gap, bool warm) {
  const Pairs pairs = makePairs(vertices(state), gap);
  run<PairCache>(state, pairs, warm, [&](const Pair& p, const Transform& poseB, PairCache& cache) {
    benchmark::DoNotOptimize(
        contactManifold(pairs.shapes[p.a], pairs.shapes[p.b], poseIn(p.poseA, poseB), kMargin, cache).count);
  });
}

// The centres start 4 apart and end in one place, both shapes turn by up to half a radian. The error is the part of
// pairs without an answer.
void impact(benchmark::State& state) {
  const Pairs pairs = makePairs(vertices(state), Gap::Apart);
  RandomStream random(12, 1);
  std::vector<std::array<RigidMotion, 2>> motions;
  for (std::size_t k = 0; k < kPairs; ++k) {
    const Vec2 towards = unit(random.uniform(-kPi, kPi));
    motions.push_back({RigidMotion{pairs.pairs[k].poseA, {0.0, 0.0}, random.uniform(-0.5, 0.5)},
                       RigidMotion{{pairs.pairs[k].poseA.position - 4.0 * towards, pairs.pairs[k].poseB[0].rotation},
                                   4.0 * towards,
                                   random.uniform(-0.5, 0.5)}});
  }
  std::size_t failed = 0, steps = 0;
  for (auto _ : state) {
    failed = steps = 0;
    for (std::size_t k = 0; k < kPairs; ++k) {
      const Pair& p = pairs.pairs[k];
      const TimeOfImpact hit =
          timeOfImpact(pairs.shapes[p.a], motions[k][0], pairs.shapes[p.b], motions[k][1], 1.0, kTarget);
      failed += hit.status == ImpactStatus::Hit ? 0 : 1;
      steps += static_cast<std::size_t>(hit.steps);
    }
  }
  bench::items(state, kPairs);
  bench::error(state, static_cast<double>(failed) / static_cast<double>(kPairs));
  state.counters["steps"] = static_cast<double>(steps) / static_cast<double>(kPairs);
}

#define FROUDE_SIZES ->Arg(4)->Arg(8)->Arg(16)->Arg(32)->Arg(64)->Arg(125)->Arg(250)->Arg(500)->Arg(1000)
BENCHMARK_CAPTURE(sat, apart_cold, Gap::Apart, false) FROUDE_SIZES;
BENCHMARK_CAPTURE(sat, apart_warm, Gap::Apart, true) FROUDE_SIZES;
BENCHMARK_CAPTURE(sat, near_cold, Gap::Near, false) FROUDE_SIZES;
BENCHMARK_CAPTURE(sat, near_warm, Gap::Near, true) FROUDE_SIZES;
BENCHMARK_CAPTURE(closest, apart_cold, Gap::Apart, false) FROUDE_SIZES;
BENCHMARK_CAPTURE(closest, apart_warm, Gap::Apart, true) FROUDE_SIZES;
BENCHMARK_CAPTURE(manifold, apart_cold, Gap::Apart, false) FROUDE_SIZES;
BENCHMARK_CAPTURE(manifold, apart_warm, Gap::Apart, true) FROUDE_SIZES;
BENCHMARK_CAPTURE(manifold, near_cold, Gap::Near, false) FROUDE_SIZES;
BENCHMARK_CAPTURE(manifold, near_warm, Gap::Near, true) FROUDE_SIZES;
BENCHMARK(impact) FROUDE_SIZES;

// Box2D: the same shapes and poses in float.

b2Vec2 boxVec(const Vec2& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y())}; }

b2Transform boxPose(const Transform& pose) {
  b2Transform out;
  out.p = boxVec(pose.position);
  out.q.c = static_cast<float>(pose.rotation.c);
  out.q.s = static_cast<float>(pose.rotation.s);
  return out;
}

struct BoxPairs {
  std::vector<b2PolygonShape> shapes;
  std::vector<b2DistanceProxy> proxies;
  struct Poses {
    b2Transform a;
    std::array<b2Transform, 2> b;
  };
  std::vector<Poses> poses;
};

BoxPairs boxPairs(const Pairs& pairs) {
  BoxPairs made;
  for (const ConvexShape& shape : pairs.shapes) {
    std::vector<b2Vec2> points;
    for (const Vec2& v : shape.vertices()) points.push_back(boxVec(v));
    made.shapes.emplace_back().Set(points.data(), static_cast<int32>(points.size()));
  }
  made.proxies.resize(made.shapes.size());
  for (std::size_t k = 0; k < made.shapes.size(); ++k) made.proxies[k].Set(&made.shapes[k], 0);
  for (const Pair& p : pairs.pairs)
    made.poses.push_back({boxPose(p.poseA), {boxPose(p.poseB[0]), boxPose(p.poseB[1])}});
  return made;
}

void box2dDistance(benchmark::State& state, bool warm) {
  const Pairs pairs = makePairs(vertices(state), Gap::Apart);
  const BoxPairs box = boxPairs(pairs);
  std::vector<b2SimplexCache> caches(kPairs);
  for (b2SimplexCache& cache : caches) cache.count = 0;
  std::size_t pass = 0;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kPairs; ++k) {
      b2DistanceInput input;
      input.proxyA = box.proxies[pairs.pairs[k].a];
      input.proxyB = box.proxies[pairs.pairs[k].b];
      input.transformA = box.poses[k].a;
      input.transformB = box.poses[k].b[pass & 1];
      input.useRadii = false;
      if (!warm) caches[k].count = 0;
      b2DistanceOutput output;
      b2Distance(&output, &caches[k], &input);
      benchmark::DoNotOptimize(output.distance);
    }
    ++pass;
  }
  bench::items(state, kPairs);
}

void box2dManifold(benchmark::State& state, Gap gap) {
  const Pairs pairs = makePairs(vertices(state), gap);
  const BoxPairs box = boxPairs(pairs);
  std::size_t pass = 0;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kPairs; ++k) {
      b2Manifold made;
      b2CollidePolygons(&made, &box.shapes[pairs.pairs[k].a], box.poses[k].a, &box.shapes[pairs.pairs[k].b],
                        box.poses[k].b[pass & 1]);
      benchmark::DoNotOptimize(made.pointCount);
    }
    ++pass;
  }
  bench::items(state, kPairs);
}

void box2dImpact(benchmark::State& state) {
  const Pairs pairs = makePairs(vertices(state), Gap::Apart);
  const BoxPairs box = boxPairs(pairs);
  RandomStream random(12, 1);
  std::vector<b2TOIInput> inputs;
  for (std::size_t k = 0; k < kPairs; ++k) {
    const Pair& p = pairs.pairs[k];
    const Vec2 towards = unit(random.uniform(-kPi, kPi));
    const auto sweep = [&](const Transform& pose, const Vec2& from, const Vec2& to, double turn) {
      b2Sweep made;
      made.localCenter.SetZero();
      made.c0 = boxVec(from);
      made.c = boxVec(to);
      made.a0 = static_cast<float>(std::atan2(pose.rotation.s, pose.rotation.c));
      made.a = made.a0 + static_cast<float>(turn);
      made.alpha0 = 0.0f;
      return made;
    };
    b2TOIInput input;
    input.proxyA = box.proxies[p.a];
    input.proxyB = box.proxies[p.b];
    const Vec2 at = p.poseA.position;
    input.sweepA = sweep(p.poseA, at, at, random.uniform(-0.5, 0.5));
    input.sweepB = sweep(p.poseB[0], at - 4.0 * towards, at, random.uniform(-0.5, 0.5));
    input.tMax = 1.0f;
    inputs.push_back(input);
  }
  std::size_t failed = 0;
  for (auto _ : state) {
    failed = 0;
    for (const b2TOIInput& input : inputs) {
      b2TOIOutput output;
      b2TimeOfImpact(&output, &input);
      failed += output.state == b2TOIOutput::e_touching ? 0 : 1;
    }
  }
  bench::items(state, kPairs);
  bench::error(state, static_cast<double>(failed) / static_cast<double>(kPairs));
}

BENCHMARK_CAPTURE(box2dDistance, cold, false)->Arg(4)->Arg(8);
BENCHMARK_CAPTURE(box2dDistance, warm, true)->Arg(4)->Arg(8);
BENCHMARK_CAPTURE(box2dManifold, apart, Gap::Apart)->Arg(4)->Arg(8);
BENCHMARK_CAPTURE(box2dManifold, near, Gap::Near)->Arg(4)->Arg(8);
BENCHMARK(box2dImpact)->Arg(4)->Arg(8);

// libccd: near pairs.

struct Prism {
  const ConvexShape* shape;
  Transform pose;
};

void supportOfPrism(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& prism = *static_cast<const Prism*>(object);
  const Vec2 local = prism.pose.rotation.applyInverse(Vec2(direction->v[0], direction->v[1]));
  double best = -kInfinity;
  Vec2 found(0.0, 0.0);
  for (const Vec2& v : prism.shape->vertices()) {
    const double reach = v.dot(local);
    if (reach <= best) continue;
    best = reach;
    found = v;
  }
  const Vec2 world = prism.pose.toWorld(found);
  ccdVec3Set(out, world.x(), world.y(), direction->v[2] > 0.0 ? 0.5 : -0.5);
}

void centreOfPrism(const void* object, ccd_vec3_t* out) {
  const auto& prism = *static_cast<const Prism*>(object);
  const Vec2 world = prism.pose.toWorld(prism.shape->centroid());
  ccdVec3Set(out, world.x(), world.y(), 0.0);
}

void libccd(benchmark::State& state, bool depth) {
  const Pairs pairs = makePairs(vertices(state), Gap::Near);
  ccd_t settings;
  CCD_INIT(&settings);
  settings.support1 = settings.support2 = supportOfPrism;
  settings.center1 = settings.center2 = centreOfPrism;
  settings.max_iterations = 100;
  settings.mpr_tolerance = 1e-6;
  std::size_t pass = 0;
  for (auto _ : state) {
    for (const Pair& p : pairs.pairs) {
      const Prism a{&pairs.shapes[p.a], p.poseA}, b{&pairs.shapes[p.b], p.poseB[pass & 1]};
      if (depth) {
        ccd_real_t deep = 0.0;
        ccd_vec3_t direction, at;
        benchmark::DoNotOptimize(ccdMPRPenetration(&a, &b, &settings, &deep, &direction, &at));
      } else {
        benchmark::DoNotOptimize(ccdGJKIntersect(&a, &b, &settings));
      }
    }
    ++pass;
  }
  bench::items(state, kPairs);
}
BENCHMARK_CAPTURE(libccd, gjk_intersect, false)->Arg(4)->Arg(8)->Arg(64)->Arg(1000);
BENCHMARK_CAPTURE(libccd, mpr_penetration, true)->Arg(4)->Arg(8)->Arg(64)->Arg(1000);

}  // namespace
