#include <froude/solver/particle_sums.h>

#include <algorithm>
#include <array>

#include <froude/base/parallel.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/particle_sums.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef FROUDE_PARTICLE_SUMS_PARTIAL
#define FROUDE_PARTICLE_SUMS_PARTIAL
namespace froude {
namespace {

// The partial sums of a block, by lane.
struct PartialSums {
  static constexpr int kSums = 6, kExtremes = 5;
  double sum[kSums][8];
  double most[kExtremes][8];  // v², x, −x, y, −y
};

struct Columns {
  const double* x;
  const double* y;
  const double* vx;
  const double* vy;
};

}  // namespace
}  // namespace froude
#endif

HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void sumBlock(const Columns& c, std::size_t begin, std::size_t end, PartialSums& out) {
  const hn::CappedTag<double, 8> d;
  using V = hn::Vec<decltype(d)>;
  constexpr std::size_t kLanes = HWY_LANES(double);
  const V zero = hn::Zero(d), lowest = hn::Set(d, -kInfinity);
  for (std::size_t lane = 0; lane < 8; lane += kLanes) {
    V sx = zero, sy = zero, su = zero, sv = zero, s2 = zero, sa = zero;
    V most = zero, mx = lowest, nx = lowest, my = lowest, ny = lowest;
    auto add = [&](V x, V y, V u, V v, auto keep) HWY_ATTR {
      const V speed2 = hn::Add(hn::Mul(u, u), hn::Mul(v, v));
      sx = hn::Add(sx, x);
      sy = hn::Add(sy, y);
      su = hn::Add(su, u);
      sv = hn::Add(sv, v);
      s2 = hn::Add(s2, speed2);
      sa = hn::Add(sa, hn::Sub(hn::Mul(x, v), hn::Mul(y, u)));
      most = hn::Max(most, speed2);
      mx = hn::Max(mx, keep(x));
      nx = hn::Max(nx, keep(hn::Neg(x)));
      my = hn::Max(my, keep(y));
      ny = hn::Max(ny, keep(hn::Neg(y)));
    };
    std::size_t i = begin + lane;
    for (; i + kLanes <= end; i += 8) {
      add(hn::LoadU(d, c.x + i), hn::LoadU(d, c.y + i), hn::LoadU(d, c.vx + i), hn::LoadU(d, c.vy + i),
          [](V v) HWY_ATTR { return v; });
    }
    if (i < end) {
      const auto some = hn::FirstN(d, end - i);
      auto load = [&](const double* from) HWY_ATTR { return hn::IfThenElseZero(some, hn::LoadU(d, from + i)); };
      add(load(c.x), load(c.y), load(c.vx), load(c.vy), [&](V v) HWY_ATTR { return hn::IfThenElse(some, v, lowest); });
    }
    const V sums[PartialSums::kSums] = {sx, sy, su, sv, s2, sa};
    const V extremes[PartialSums::kExtremes] = {most, mx, nx, my, ny};
    for (int k = 0; k < PartialSums::kSums; ++k) hn::StoreU(sums[k], d, out.sum[k] + lane);
    for (int k = 0; k < PartialSums::kExtremes; ++k) hn::StoreU(extremes[k], d, out.most[k] + lane);
  }
}

}  // namespace

auto blockSums() { return &sumBlock; }

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {
namespace {

using SumBlock = void (*)(const Columns&, std::size_t, std::size_t, PartialSums&);

SumBlock sumBlockOf(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::blockSums();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::blockSums();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::blockSums();
#endif
    default:
      return HWY_STATIC_DISPATCH(blockSums)();
  }
}

}  // namespace

ParticleSums sumParticles(const ParticlePool& pool, SimdTarget target) {
  constexpr std::size_t kMaxBlocks = 256;
  const std::size_t n = pool.size();
  std::size_t blockSize = kBlockSize;
  while (blockCount(n, blockSize) > kMaxBlocks) blockSize *= 2;
  std::array<PartialSums, kMaxBlocks> partial;
  const Columns columns{pool.x().data(), pool.y().data(), pool.vx().data(), pool.vy().data()};
  const SumBlock sumBlock = sumBlockOf(target);
  parallelFor(n, blockSize,
              [&](std::size_t begin, std::size_t end) { sumBlock(columns, begin, end, partial[begin / blockSize]); });
  std::array<double, PartialSums::kSums> sum{};
  std::array<double, PartialSums::kExtremes> most{0.0, -kInfinity, -kInfinity, -kInfinity, -kInfinity};
  for (std::size_t b = 0; b < blockCount(n, blockSize); ++b) {
    for (std::size_t k = 0; k < sum.size(); ++k) {
      for (const double lane : partial[b].sum[k]) sum[k] += lane;
    }
    for (std::size_t k = 0; k < most.size(); ++k) {
      for (const double lane : partial[b].most[k]) most[k] = std::max(most[k], lane);
    }
  }
  ParticleSums result{sum[0], sum[1], sum[2], sum[3], sum[4], sum[5], most[0], {}};
  if (n > 0) result.bounds = {{-most[2], -most[4]}, {most[1], most[3]}};
  return result;
}

}  // namespace froude
#endif
