// The transfers over SIMD lanes, compiled once for each target: lanes are faces where particles give, particles where
// they take. The formulas are those of transfer_scalar.cpp.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/fluid/grid/transfer_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <array>
#include <cstring>

#include <froude/solver/fluid/grid/transfer.h>

#ifndef FROUDE_TRANSFER_NODES
#define FROUDE_TRANSFER_NODES
namespace froude {
namespace {

// The faces and nodes that a particle reaches, seen from the corner of its cell: six of u, six of v, four nodes.
alignas(64) constexpr float kNodeX[16] = {0, 1, 0, 1, 0, 1, -0.5f, 0.5f, 1.5f, -0.5f, 0.5f, 1.5f, 0, 1, 0, 1};
alignas(64) constexpr float kNodeY[16] = {-0.5f, -0.5f, 0.5f, 0.5f, 1.5f, 1.5f, 0, 0, 0, 1, 1, 1, 0, 0, 1, 1};
alignas(64) constexpr float kIsV[16] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

}  // namespace
}  // namespace froude
#endif

#if HWY_TARGET != HWY_SCALAR  // scalar is transfer_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;
using I = hn::RebindToSigned<F>;
using VI = hn::Vec<I>;
constexpr int kLanes = HWY_LANES(float) > 16 ? 16 : HWY_LANES(float);
constexpr int kParts = 16 / kLanes;

HWY_INLINE VF hat(VF d) {
  const F f;
  return hn::Max(hn::Zero(f), hn::Sub(hn::Set(f, 1.0f), hn::Abs(d)));
}

void give(const GridParticles& p, const std::uint32_t* start, TileSums& sums) {
  const F f;
  std::memset(static_cast<void*>(&sums), 0, sizeof sums);
  VF nodeX[kParts], nodeY[kParts];
  hn::Mask<F> isV[kParts];
  for (int part = 0; part < kParts; ++part) {
    nodeX[part] = hn::Load(f, kNodeX + part * kLanes);
    nodeY[part] = hn::Load(f, kNodeY + part * kLanes);
    isV[part] = hn::Gt(hn::Load(f, kIsV + part * kLanes), hn::Zero(f));
  }
  alignas(64) float weight[16], value[16];
  for (int j = 0; j < kTileSide; ++j) {
    const auto cy = static_cast<float>(j);
    for (int i = 0; i < kTileSide; ++i) {
      const std::uint32_t* cell = start + j * kTileSide + i;
      const std::uint32_t first = cell[0], last = cell[1];
      if (first == last) continue;
      const auto cx = static_cast<float>(i);
      VF w[kParts], m[kParts];
      for (int part = 0; part < kParts; ++part) w[part] = m[part] = hn::Zero(f);
      for (std::uint32_t k = first; k < last; ++k) {
        const VF x = hn::Set(f, p.x[k] - cx), y = hn::Set(f, p.y[k] - cy);
        const VF u = hn::Set(f, p.u[k]), v = hn::Set(f, p.v[k]);
        const VF ux = hn::Set(f, p.gradient[0][k]), uy = hn::Set(f, p.gradient[1][k]);
        const VF vx = hn::Set(f, p.gradient[2][k]), vy = hn::Set(f, p.gradient[3][k]);
        for (int part = 0; part < kParts; ++part) {
          const VF dx = hn::Sub(nodeX[part], x), dy = hn::Sub(nodeY[part], y);
          const VF share = hn::Mul(hat(dx), hat(dy));
          const VF base = hn::IfThenElse(isV[part], v, u);
          const VF alongX = hn::IfThenElse(isV[part], vx, ux), alongY = hn::IfThenElse(isV[part], vy, uy);
          w[part] = hn::Add(w[part], share);
          const VF there = hn::Add(base, hn::Add(hn::Mul(alongX, dx), hn::Mul(alongY, dy)));
          m[part] = hn::Add(m[part], hn::Mul(share, there));
        }
      }
      for (int part = 0; part < kParts; ++part) {
        hn::Store(w[part], f, weight + part * kLanes);
        hn::Store(m[part], f, value + part * kLanes);
      }
      const int at = TileSums::at(i, j);
      for (int b = 0; b < 3; ++b) {
        for (int a = 0; a < 2; ++a) {
          const int to = at + (b - 1) * TileSums::kStride + a;
          sums.uWeight[to] += weight[2 * b + a];
          sums.uSum[to] += value[2 * b + a];
        }
      }
      for (int b = 0; b < 2; ++b) {
        for (int a = 0; a < 3; ++a) {
          const int to = at + b * TileSums::kStride + a - 1;
          sums.vWeight[to] += weight[6 + 3 * b + a];
          sums.vSum[to] += value[6 + 3 * b + a];
        }
        for (int a = 0; a < 2; ++a) sums.node[at + b * TileSums::kStride + a] += weight[12 + 2 * b + a];
      }
    }
  }
}

HWY_INLINE VF weighted(const float* f, int step) {
  const F d;
  auto at = [&](int k) HWY_ATTR { return hn::LoadU(d, f + k * step); };
  const VF near = hn::Add(at(0), hn::Add(at(-1), at(1)));
  const VF far = hn::Add(hn::Mul(hn::Set(d, 2.0f), hn::Add(at(-2), at(2))), hn::Add(at(-3), at(3)));
  return hn::Mul(hn::Set(d, 1.0f / 15.0f), hn::Add(hn::Mul(hn::Set(d, 3.0f), near), far));
}

// A row is 32 faces; the last vector of a row overlaps the one before it.
HWY_INLINE void smoothField(const float* from, float* to) {
  const F f;
  constexpr int kStride = TileWindow::kStride;
  alignas(64) float along[TileWindow::kSize];
  std::memcpy(along, from, sizeof along);
  for (int j = 0; j < kStride; ++j) {
    for (int i = 3; i < kStride - 3; i += kLanes) {
      const int at = j * kStride + (i + kLanes <= kStride - 3 ? i : kStride - 3 - kLanes);
      hn::StoreU(weighted(from + at, 1), f, along + at);
    }
  }
  std::memcpy(to, along, sizeof along);
  for (int k = 3 * kStride; k < TileWindow::kSize - 3 * kStride; k += kLanes)
    hn::StoreU(weighted(along + k, kStride), f, to + k);
}

void smooth(const TileWindow& window, TileWindow& out) {
  smoothField(window.u, out.u);
  smoothField(window.v, out.v);
}

struct Place {
  VI at;
  VF x, y;
};

HWY_INLINE Place placeOf(VF x, VF y, float shiftX, float shiftY) {
  const F f;
  const I n;
  constexpr float kMargin = TileWindow::kMargin;
  const VF last = hn::Set(f, TileWindow::kStride - 2), zero = hn::Zero(f);
  const VF px = hn::Min(hn::Max(hn::Add(x, hn::Set(f, kMargin - shiftX)), zero), last);
  const VF py = hn::Min(hn::Max(hn::Add(y, hn::Set(f, kMargin - shiftY)), zero), last);
  const VI i = hn::ConvertTo(n, px), j = hn::ConvertTo(n, py);
  static_assert(TileWindow::kStride == 32);
  return {hn::Add(hn::ShiftLeft<5>(j), i), hn::Sub(px, hn::ConvertTo(f, i)), hn::Sub(py, hn::ConvertTo(f, j))};
}

struct Sample {
  VF value, alongX, alongY;
};

HWY_INLINE Sample sampleOf(const float* field, const Place& p) {
  const F f;
  const VF f00 = hn::GatherIndex(f, field, p.at), f10 = hn::GatherIndex(f, field + 1, p.at);
  const VF f01 = hn::GatherIndex(f, field + TileWindow::kStride, p.at);
  const VF f11 = hn::GatherIndex(f, field + TileWindow::kStride + 1, p.at);
  const VF low = hn::Sub(f10, f00), high = hn::Sub(f11, f01);
  const VF bottom = hn::Add(f00, hn::Mul(p.x, low)), top = hn::Add(f01, hn::Mul(p.x, high));
  const VF up = hn::Sub(top, bottom);
  return {hn::Add(bottom, hn::Mul(p.y, up)), hn::Add(low, hn::Mul(p.y, hn::Sub(high, low))), up};
}

// Particles on their way along `smooth`, each with what its velocity has beyond that. A function, not a closure: GCC
// leaves those for other targets than the file's in memory.
struct Carried {
  const TileWindow& smooth;
  VF x, y, ownX, ownY;
  HWY_INLINE void velocityAfter(float time, VF alongX, VF alongY, VF& u, VF& v) const {
    const F f;
    const VF x2 = hn::Add(x, hn::Mul(hn::Set(f, time), alongX)), y2 = hn::Add(y, hn::Mul(hn::Set(f, time), alongY));
    u = hn::Add(ownX, sampleOf(smooth.u, placeOf(x2, y2, 0.0f, 0.5f)).value);
    v = hn::Add(ownY, sampleOf(smooth.v, placeOf(x2, y2, 0.5f, 0.0f)).value);
  }
};

// Lanes behind the end compute with what stands there, and store nothing.
void take(const GridParticles& p, const TileWindow& w, const TileWindow& smooth, const TileWindow& shift, float time,
          std::uint32_t begin, std::uint32_t end, const GridMotion& motion) {
  const F f;
  const float ninth = time / 9.0f;
  for (std::uint32_t k = begin; k < end; k += kLanes) {
    const auto some = hn::FirstN(f, end - k);
    const VF x = hn::IfThenElseZero(some, hn::LoadU(f, p.x + k)), y = hn::IfThenElseZero(some, hn::LoadU(f, p.y + k));
    const Place atU = placeOf(x, y, 0.0f, 0.5f), atV = placeOf(x, y, 0.5f, 0.0f);
    const Sample u = sampleOf(w.u, atU), v = sampleOf(w.v, atV);
    const VF shiftX = sampleOf(shift.u, atU).value, shiftY = sampleOf(shift.v, atV).value;
    const VF ownX = hn::Sub(u.value, sampleOf(smooth.u, atU).value),
             ownY = hn::Sub(v.value, sampleOf(smooth.v, atV).value);
    VF u2, v2, u3, v3;
    const Carried own{smooth, x, y, ownX, ownY};
    own.velocityAfter(0.5f * time, u.value, v.value, u2, v2);
    own.velocityAfter(0.75f * time, u2, v2, u3, v3);
    auto path = [&](VF first, VF second, VF third, VF more) HWY_ATTR {
      const VF sum = hn::Add(hn::Add(hn::Mul(hn::Set(f, 2.0f), first), hn::Mul(hn::Set(f, 3.0f), second)),
                             hn::Mul(hn::Set(f, 4.0f), third));
      return hn::Add(hn::Mul(hn::Set(f, ninth), sum), hn::Mul(hn::Set(f, time), more));
    };
    hn::BlendedStore(u.value, some, f, motion.u + k);
    hn::BlendedStore(v.value, some, f, motion.v + k);
    hn::BlendedStore(u.alongX, some, f, motion.gradient[0] + k);
    hn::BlendedStore(u.alongY, some, f, motion.gradient[1] + k);
    hn::BlendedStore(v.alongX, some, f, motion.gradient[2] + k);
    hn::BlendedStore(v.alongY, some, f, motion.gradient[3] + k);
    hn::BlendedStore(path(u.value, u2, u3, shiftX), some, f, motion.dx + k);
    hn::BlendedStore(path(v.value, v2, v3, shiftY), some, f, motion.dy + k);
  }
}

void sample(const GridParticles& p, const TileWindow& w, std::uint32_t begin, std::uint32_t end, float* u, float* v) {
  const F f;
  for (std::uint32_t k = begin; k < end; k += kLanes) {
    const auto some = hn::FirstN(f, end - k);
    const VF x = hn::IfThenElseZero(some, hn::LoadU(f, p.x + k)), y = hn::IfThenElseZero(some, hn::LoadU(f, p.y + k));
    hn::BlendedStore(sampleOf(w.u, placeOf(x, y, 0.0f, 0.5f)).value, some, f, u + k);
    hn::BlendedStore(sampleOf(w.v, placeOf(x, y, 0.5f, 0.0f)).value, some, f, v + k);
  }
}

}  // namespace

const TransferLoops& wideTransferLoops() {
  static constexpr TransferLoops kLoops{give, smooth, take, sample};
  return kLoops;
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace froude {

const TransferLoops& transferLoops(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideTransferLoops();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideTransferLoops();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideTransferLoops();
#endif
    default:
      return scalarTransferLoops();
  }
}

}  // namespace froude
#endif
