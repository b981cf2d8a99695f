// Sines and cosines over SIMD lanes, compiled once for each target: the first terms of their series on ±π/4, what is
// cut off being below 1e-18 there; before that, multiples of π/2 are subtracted in three parts of 33 bits.
#include <froude/base/sincos.h>

#include <cmath>
#include <cstdint>
#include <iterator>

#include <froude/base/assert.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/base/sincos.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

constexpr double kLargestReduced = 1e5;

// 1/(2k+1)! and 1/(2k)! with alternating signs, the highest first; all factorials are exact as doubles.
constexpr double kSine[] = {1.0 / 355687428096000.0, -1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0,
                            1.0 / 362880.0,          -1.0 / 5040.0,          1.0 / 120.0,        -1.0 / 6.0};
constexpr double kCosine[] = {1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
                              1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0};

HWY_INLINE V set(double v) { return hn::Set(D(), v); }

HWY_INLINE void vector(const double* angle, double* sine, double* cosine) {
  const D d;
  const hn::Rebind<std::int64_t, D> n;
  const auto a = hn::LoadU(d, angle);
  const auto turns = hn::Round(hn::Mul(a, set(0.63661977236758134308)));
  auto r = hn::NegMulAdd(turns, set(1.57079632673412561417e+00), a);
  r = hn::NegMulAdd(turns, set(6.07710050630396597660e-11), r);
  r = hn::NegMulAdd(turns, set(2.02226624879595063154e-21), r);
  const auto q = hn::Mul(r, r);
  auto s = set(kSine[0]);
  for (std::size_t k = 1; k < std::size(kSine); ++k) s = hn::MulAdd(q, s, set(kSine[k]));
  s = hn::MulAdd(hn::Mul(q, r), s, r);
  auto c = set(kCosine[0]);
  for (std::size_t k = 1; k < std::size(kCosine); ++k) c = hn::MulAdd(q, c, set(kCosine[k]));
  const auto half = hn::Mul(q, set(0.5));
  const auto high = hn::Sub(set(1.0), half);
  c = hn::Add(high, hn::MulAdd(hn::Mul(q, q), c, hn::Sub(hn::Sub(set(1.0), high), half)));
  // The quadrant sits in the lowest bits of the number of quarter turns plus 2⁵² + 2⁵¹.
  const auto bits = hn::BitCast(n, hn::Add(turns, set(6755399441055744.0)));
  const auto odd = hn::MaskFromVec(hn::BitCast(d, hn::Sub(hn::Zero(n), hn::And(bits, hn::Set(n, 1)))));
  const auto signOf = [&](auto b) { return hn::BitCast(d, hn::ShiftLeft<62>(hn::And(b, hn::Set(n, 2)))); };
  const auto sineOf = hn::Xor(hn::IfThenElse(odd, c, s), signOf(bits));
  const auto cosineOf = hn::Xor(hn::IfThenElse(odd, s, c), signOf(hn::Add(bits, hn::Set(n, 1))));
  if (HWY_UNLIKELY(!hn::AllTrue(d, hn::Le(hn::Abs(a), set(kLargestReduced))))) {
    double copy[8];
    hn::StoreU(a, d, copy);
    hn::StoreU(sineOf, d, sine);
    hn::StoreU(cosineOf, d, cosine);
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
      if (std::abs(copy[i]) <= kLargestReduced) continue;
      sine[i] = std::sin(copy[i]);
      cosine[i] = std::cos(copy[i]);
    }
    return;
  }
  hn::StoreU(sineOf, d, sine);
  hn::StoreU(cosineOf, d, cosine);
}

void loop(const double* angle, double* sine, double* cosine, std::size_t count) {
  const std::size_t lanes = hn::Lanes(D());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) vector(angle + i, sine + i, cosine + i);
  if (i == count) return;
  double in[8] = {}, outSine[8], outCosine[8];
  for (std::size_t k = 0; i + k < count; ++k) in[k] = angle[i + k];
  vector(in, outSine, outCosine);
  for (std::size_t k = 0; i + k < count; ++k) {
    sine[i + k] = outSine[k];
    cosine[i + k] = outCosine[k];
  }
}

}  // namespace

using SinCosLoop = void (*)(const double*, double*, double*, std::size_t);
SinCosLoop wideSinCos() { return loop; }

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {

void sinCos(std::span<const double> angle, std::span<double> sine, std::span<double> cosine, SimdTarget target) {
  FROUDE_ASSERT(sine.size() == angle.size() && cosine.size() == angle.size());
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideSinCos()(angle.data(), sine.data(), cosine.data(), angle.size());
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideSinCos()(angle.data(), sine.data(), cosine.data(), angle.size());
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideSinCos()(angle.data(), sine.data(), cosine.data(), angle.size());
#endif
    default:
      for (std::size_t i = 0; i < angle.size(); ++i) {
        const double x = angle[i];
        sine[i] = std::sin(x);
        cosine[i] = std::cos(x);
      }
  }
}

}  // namespace froude
#endif
