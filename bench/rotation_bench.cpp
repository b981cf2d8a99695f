// What does a rotation cost, and how wrong is it? Sine and cosine of an angle, and updates that need none.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rotation_bench.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>  // once for each target, so behind foreach_target.h

HWY_BEFORE_NAMESPACE();
namespace froude::bench {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Highway's functions, one for the sine and one for the cosine.
void kept(const double* angle, double* sine, double* cosine, std::size_t count) {
  const hn::ScalableTag<double> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto a = hn::LoadU(d, angle + i);
    hn::StoreU(hn::Sin(d, a), d, sine + i);
    hn::StoreU(hn::Cos(d, a), d, cosine + i);
  }
}

// A small turn added to a rotation (c, s): by the tangent of its half, which for a fraction of a radian is the half
// itself to second order (Cayley map), or by the first terms of the series, drawn back to length 1 by one Newton step.
void cayley(const double* turn, double* sine, double* cosine, std::size_t count) {
  const hn::ScalableTag<double> d;
  const auto one = hn::Set(d, 1.0);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto t = hn::Mul(hn::LoadU(d, turn + i), hn::Set(d, 0.5));
    const auto q = hn::Mul(t, t);
    const auto scale = hn::Div(one, hn::Add(one, q));
    const auto c = hn::Mul(hn::Sub(one, q), scale), s = hn::Mul(hn::Add(t, t), scale);
    const auto c0 = hn::LoadU(d, cosine + i), s0 = hn::LoadU(d, sine + i);
    hn::StoreU(hn::NegMulAdd(s0, s, hn::Mul(c0, c)), d, cosine + i);
    hn::StoreU(hn::MulAdd(s0, c, hn::Mul(c0, s)), d, sine + i);
  }
}

void multiply(const double* turn, double* sine, double* cosine, std::size_t count) {
  const hn::ScalableTag<double> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto t = hn::LoadU(d, turn + i);
    const auto c0 = hn::LoadU(d, cosine + i), s0 = hn::LoadU(d, sine + i);
    const auto c = hn::NegMulAdd(s0, t, c0), s = hn::MulAdd(c0, t, s0);
    const auto square = hn::MulAdd(c, c, hn::Mul(s, s));
    const auto scale = hn::Div(hn::Set(d, 1.0), hn::Sqrt(square));
    hn::StoreU(hn::Mul(c, scale), d, cosine + i);
    hn::StoreU(hn::Mul(s, scale), d, sine + i);
  }
}

}  // namespace

struct Loops {
  void (*kept)(const double*, double*, double*, std::size_t) = HWY_NAMESPACE::kept;
  void (*cayley)(const double*, double*, double*, std::size_t) = HWY_NAMESPACE::cayley;
  void (*multiply)(const double*, double*, double*, std::size_t) = HWY_NAMESPACE::multiply;
};

}  // namespace HWY_NAMESPACE
}  // namespace froude::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <benchmark/benchmark.h>

#include <froude/base/random.h>
#include <froude/base/simd.h>
#include <froude/base/sincos.h>
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kCount = 4096;  // fits the first caches
using Loop = std::function<void(const double*, double*, double*, std::size_t)>;

void standard(const double* angle, double* sine, double* cosine, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    sine[i] = std::sin(angle[i]);
    cosine[i] = std::cos(angle[i]);
  }
}

template <typename Get>
Loop loopOf(SimdTarget target, Get get) {
#if (HWY_TARGETS & HWY_AVX3)
  if (target == SimdTarget::Avx3) return get(bench::N_AVX3::Loops());
#endif
#if (HWY_TARGETS & HWY_AVX2)
  if (target == SimdTarget::Avx2) return get(bench::N_AVX2::Loops());
#endif
#if (HWY_TARGETS & HWY_SSE4)
  if (target == SimdTarget::Sse4) return get(bench::N_SSE4::Loops());
#endif
  return standard;
}

void measure(benchmark::State& state, const Loop& loop, double range) {
  std::vector<double> angle(kCount), sine(kCount), cosine(kCount, 1.0);
  RandomStream random(1, 1);
  for (double& a : angle) a = random.uniform(-range, range);
  // Once from rotation 0, where an update by an angle is that angle's rotation.
  loop(angle.data(), sine.data(), cosine.data(), kCount);
  long double error = 0.0L;
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto a = static_cast<long double>(angle[i]);
    error = std::max({error, std::abs(static_cast<long double>(sine[i]) - std::sin(a)),
                      std::abs(static_cast<long double>(cosine[i]) - std::cos(a))});
  }
  for (auto _ : state) {
    loop(angle.data(), sine.data(), cosine.data(), kCount);
    benchmark::ClobberMemory();
  }
  bench::items(state, kCount);
  bench::error(state, static_cast<double>(error));
}

const int kRegistered = [] {
  const auto add = [](const std::string& label, const Loop& loop, double range) {
    benchmark::RegisterBenchmark((label + "/" + std::to_string(range).substr(0, 5)).c_str(),
                                 [=](benchmark::State& state) { measure(state, loop, range); });
  };
  for (const double range : {3.1416, 1000.0}) add("standard", standard, range);
  for (const SimdTarget t : supportedSimdTargets()) {
    if (t == SimdTarget::Scalar) continue;
    const std::string on = "/" + std::string(name(t));
    for (const double range : {3.1416, 1000.0}) {
      add("highway" + on, loopOf(t, [](auto l) { return l.kept; }), range);
      add(
          "sinCos" + on,
          [t](const double* angle, double* sine, double* cosine, std::size_t count) {
            sinCos({angle, count}, {sine, count}, {cosine, count}, t);
          },
          range);
    }
    for (const double range : {0.5, 0.05, 0.005}) {
      add("cayley" + on, loopOf(t, [](auto l) { return l.cayley; }), range);
      add("multiply" + on, loopOf(t, [](auto l) { return l.multiply; }), range);
    }
  }
  return 0;
}();

}  // namespace
#endif
