// The loops of a front over SIMD lanes, compiled once for each target. The formulas are those of
// front_loops_scalar.cpp.
#include <froude/solver/fluid/grid/front_loops.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/fluid/grid/front_loops_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR  // scalar is front_loops_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using V = hn::Vec<F>;
using M = hn::Mask<F>;
constexpr std::size_t kLanes = HWY_LANES(float) < 16 ? HWY_LANES(float) : 16;

HWY_INLINE M maskOf(std::uint16_t word, std::size_t shift) {
  const std::uint32_t bits = static_cast<std::uint32_t>(word) >> shift;
  // LoadMaskBits reads eight bytes at most.
  const std::uint8_t bytes[8] = {
      static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), 0, 0, 0, 0, 0, 0};
  return hn::LoadMaskBits(F(), bytes);
}

HWY_INLINE V onesOf(std::uint16_t word, std::size_t shift) {
  return hn::IfThenElseZero(maskOf(word, shift), hn::Set(F(), 1.0f));
}

void means(const float* values, const TileLinks& link, const FrontRows& rows, std::size_t tile, float* next) {
  const F f;
  for (std::int32_t j = 0; j < 16; ++j) {
    if (rows.fresh[j] == 0) continue;
    const auto line = static_cast<std::size_t>(16 * j);
    const std::size_t row = tile * 256 + line;
    const std::size_t below = j == 0 ? link.down : row - 16, above = j == link.rows - 1 ? link.up : row + 16;
    const V before = hn::Set(f, values[link.left + line]), beyond = hn::Set(f, values[link.right + line]);
    for (std::size_t shift = 0; shift < 16; shift += kLanes) {
      const std::size_t at = row + shift;
      const V lane = hn::Iota(f, static_cast<float>(shift));
      const V left = hn::IfThenElse(hn::Eq(lane, hn::Zero(f)), before, hn::LoadU(f, values + at - 1));
      const M last = hn::Eq(lane, hn::Set(f, static_cast<float>(link.lane)));
      const V right = hn::IfThenElse(last, beyond, hn::LoadU(f, values + at + 1));
      const V count = hn::Add(hn::Add(onesOf(rows.left[j], shift), onesOf(rows.right[j], shift)),
                              hn::Add(onesOf(rows.down[j], shift), onesOf(rows.up[j], shift)));
      const V sum = hn::Add(hn::Add(left, right),
                            hn::Add(hn::Load(f, values + below + shift), hn::Load(f, values + above + shift)));
      const M fresh = maskOf(rows.fresh[j], shift);
      const V mean = hn::Div(sum, hn::IfThenElse(fresh, count, hn::Set(f, 1.0f)));
      hn::Store(hn::IfThenElse(fresh, mean, hn::Load(f, values + at)), f, next + at);
    }
  }
}

void take(const float* next, const std::uint16_t* fresh, std::size_t tile, float* values, float* known) {
  const F f;
  for (std::size_t j = 0; j < 16; ++j) {
    if (fresh[j] == 0) continue;
    for (std::size_t shift = 0; shift < 16; shift += kLanes) {
      const std::size_t at = tile * 256 + 16 * j + shift;
      hn::Store(hn::Load(f, next + at), f, values + at);
      if (known == nullptr) continue;
      hn::Store(hn::IfThenElse(maskOf(fresh[j], shift), hn::Set(f, 1.0f), hn::Load(f, known + at)), f, known + at);
    }
  }
}

}  // namespace

const FrontLoops& wideFrontLoops() {
  static constexpr FrontLoops kLoops{means, take};
  return kLoops;
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace froude {

const FrontLoops& frontLoops(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideFrontLoops();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideFrontLoops();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideFrontLoops();
#endif
    default:
      return scalarFrontLoops();
  }
}

}  // namespace froude
#endif
