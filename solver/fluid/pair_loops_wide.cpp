// The pair loops over SIMD lanes, compiled once for each target. The formulas are those of pair_loops_scalar.cpp.
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/pair_loops.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/solver/fluid/pair_loops_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

// A lambda of an inner loop, which must become part of the loop.
#ifndef FROUDE_INLINE
#define FROUDE_INLINE HWY_ATTR __attribute__((always_inline))
#endif

HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;

constexpr float kUnit = 1.0f / static_cast<float>(lattice::kUnitsPerSpacing);
constexpr auto kNorm = static_cast<float>(kernel::kNorm);
constexpr auto kTail = static_cast<float>(kernel::kTail);

// The kernel without its factor, from m and m³.
HWY_INLINE VF shapeOf(VF m, VF m3) {
  const F f;
  return hn::Mul(hn::Mul(m3, m), hn::MulAdd(hn::Mul(m3, m3), hn::Set(f, kTail), hn::Set(f, 1.0f)));
}

// The gradient's factor without −2·kNorm, from m³.
HWY_INLINE VF slopeOf(VF m3) {
  const F f;
  return hn::Mul(m3, hn::MulAdd(hn::Mul(m3, m3), hn::Set(f, 2.5f * kTail), hn::Set(f, 1.0f)));
}

// The candidates of a cell's particles: runs of indices and what to take off the asking particle's coordinates.
struct Runs {
  struct Run {
    std::uint32_t begin, end;
    std::int32_t shiftX, shiftY;
  };
  std::uint32_t count = 0;
  Run run[9];
};

HWY_INLINE void collectRuns(const PairFrame& frame, std::uint32_t cell, Runs& runs) {
  runs.count = 0;
  frame.grid->forEachRun(cell, [&](const CellRun& r) {
    const std::int32_t shiftX = r.shiftX > 0.0 ? frame.periodX : r.shiftX < 0.0 ? -frame.periodX : 0;
    const std::int32_t shiftY = r.shiftY > 0.0 ? frame.periodY : r.shiftY < 0.0 ? -frame.periodY : 0;
    runs.run[runs.count++] = {r.begin, r.end, shiftX, shiftY};
  });
}

// Candidates of one particle, a vector at a time: pair(j, dx, dy, m) with dx, dy in lattice units and m = max(0, 1 −
// q²/4), 0 in lanes that hold no visible neighbour. Inlined by force: a call for each vector would cost as much as the
// vector.
template <typename Pair>
HWY_INLINE void forEachVector(const PairFrame& frame, const Runs& runs, std::uint32_t i, const Pair& pair) {
  const F f;
  const I n;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(f));
  const VF one = hn::Set(f, 1.0f);
  const VF minusQuarter = hn::Set(f, -0.25f * kUnit * kUnit);
  const std::int32_t hidden = frame.hidden.offset != nullptr ? frame.hidden.offset[i] : -1;
  const std::uint64_t* words = frame.hidden.words + (hidden >= 0 ? hidden : 0);
  for (std::uint32_t r = 0; r < runs.count; ++r) {
    const Runs::Run& run = runs.run[r];
    const VI xi = hn::Set(n, lattice::difference(frame.x[i], run.shiftX));
    const VI yi = hn::Set(n, lattice::difference(frame.y[i], run.shiftY));
    for (std::uint32_t j = run.begin; j < run.end; j += lanes) {
      const VF dx = hn::ConvertTo(f, hn::Sub(xi, hn::LoadU(n, frame.x + j)));
      const VF dy = hn::ConvertTo(f, hn::Sub(yi, hn::LoadU(n, frame.y + j)));
      const VF q2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
      VF m = hn::Max(hn::MulAdd(q2, minusQuarter, one), hn::Zero(f));
      m = hn::IfThenElseZero(hn::FirstN(f, run.end - j), m);
      if (HWY_UNLIKELY(hidden >= 0)) {
        const std::uint32_t k = j - run.begin;
        const std::uint64_t bits = words[k / 64] >> (k % 64);
        m = hn::IfThenElseZero(hn::LoadMaskBits(f, reinterpret_cast<const std::uint8_t*>(&bits)), m);
      }
      pair(j, dx, dy, m);
    }
    if (HWY_UNLIKELY(hidden >= 0)) words += (run.end - run.begin + 63) / 64;
  }
}

template <typename Particle>
HWY_INLINE void forEachParticle(const PairFrame& frame, std::size_t begin, std::size_t end, const Particle& particle) {
  const std::uint32_t* start = frame.grid->cellStart().data();
  Runs runs;
  for (std::size_t c = begin; c < end; ++c) {
    const std::uint32_t cell = frame.cells[c];
    collectRuns(frame, cell, runs);
    for (std::uint32_t i = start[cell]; i < start[cell + 1]; ++i) particle(runs, i);
  }
}

HWY_INLINE float sumOf(VF v) {
  const F f;
  return hn::GetLane(hn::SumOfLanes(f, v));
}

void density(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  forEachParticle(frame, begin, end, [&](const Runs& runs, std::uint32_t i) FROUDE_INLINE {
    float wall = 0.0f, gx = 0.0f, gy = 0.0f;
    if (loop.lambda != nullptr) {
      gx = loop.wallX[i];
      gy = loop.wallY[i];
      wall = loop.lambda[i] + gx * loop.shiftX[i] + gy * loop.shiftY[i];
    }
    VF sum = hn::Zero(f);
    if (loop.diagonal == nullptr) {
      forEachVector(frame, runs, i, [&](std::uint32_t, VF, VF, VF m) FROUDE_INLINE {
        sum = hn::Add(sum, shapeOf(m, hn::Mul(m, hn::Mul(m, m))));
      });
      loop.density[i] = kNorm * sumOf(sum) + wall;
      return;
    }
    VF sx = hn::Zero(f), sy = hn::Zero(f), squares = hn::Zero(f);
    forEachVector(frame, runs, i, [&](std::uint32_t, VF dx, VF dy, VF m) FROUDE_INLINE {
      const VF m3 = hn::Mul(m, hn::Mul(m, m));
      sum = hn::Add(sum, shapeOf(m, m3));
      const VF slope = slopeOf(m3);
      const VF px = hn::Mul(slope, dx), py = hn::Mul(slope, dy);
      sx = hn::Add(sx, px);
      sy = hn::Add(sy, py);
      squares = hn::MulAdd(px, px, hn::MulAdd(py, py, squares));
    });
    loop.density[i] = kNorm * sumOf(sum) + wall;
    const float scale = -2.0f * kNorm * kUnit;
    const float px = scale * sumOf(sx), py = scale * sumOf(sy);
    loop.diagonal[i] = (px + gx) * (px + 2.0f * gx) + (py + gy) * (py + 2.0f * gy) + scale * scale * sumOf(squares);
  });
}

void displace(const PairFrame& frame, const DisplacementLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  forEachParticle(frame, begin, end, [&](const Runs& runs, std::uint32_t i) FROUDE_INLINE {
    const float own = loop.pressure[i];
    const VF ownPressure = hn::Set(f, own);
    VF sx = hn::Zero(f), sy = hn::Zero(f);
    forEachVector(frame, runs, i, [&](std::uint32_t j, VF dx, VF dy, VF m) FROUDE_INLINE {
      const VF both = hn::Add(ownPressure, hn::LoadU(f, loop.pressure + j));
      const VF weight = hn::Mul(both, slopeOf(hn::Mul(m, hn::Mul(m, m))));
      sx = hn::MulAdd(weight, dx, sx);
      sy = hn::MulAdd(weight, dy, sy);
    });
    float unitsX = 2.0f * kNorm * sumOf(sx), unitsY = 2.0f * kNorm * sumOf(sy);
    if (loop.wallX != nullptr) {
      const float gx = loop.wallX[i], gy = loop.wallY[i];
      const float along = loop.tangent[i] * (gx * unitsY - gy * unitsX);
      unitsX -= 2.0f / kUnit * own * gx + along * gy;
      unitsY -= 2.0f / kUnit * own * gy - along * gx;
    }
    loop.shiftX[i] += unitsX * kUnit;
    loop.shiftY[i] += unitsY * kUnit;
    loop.newX[i] = lattice::sum(frame.x[i], static_cast<std::int32_t>(std::lrintf(unitsX)));
    loop.newY[i] = lattice::sum(frame.y[i], static_cast<std::int32_t>(std::lrintf(unitsY)));
  });
}

void viscosity(const PairFrame& frame, const ViscosityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  const VF a = hn::Set(f, loop.a), twiceB = hn::Set(f, 2.0f * loop.b);
  forEachParticle(frame, begin, end, [&](const Runs& runs, std::uint32_t i) FROUDE_INLINE {
    const VF vx = hn::Set(f, loop.vx[i]), vy = hn::Set(f, loop.vy[i]);
    VF sx = hn::Zero(f), sy = hn::Zero(f);
    forEachVector(frame, runs, i, [&](std::uint32_t j, VF, VF, VF m) FROUDE_INLINE {
      const VF m3 = hn::Mul(m, hn::Mul(m, m));
      const VF weight = hn::MulAdd(a, shapeOf(m, m3), hn::Mul(twiceB, slopeOf(m3)));
      sx = hn::MulAdd(weight, hn::Sub(hn::LoadU(f, loop.vx + j), vx), sx);
      sy = hn::MulAdd(weight, hn::Sub(hn::LoadU(f, loop.vy + j), vy), sy);
    });
    loop.changeX[i] = kNorm * sumOf(sx);
    loop.changeY[i] = kNorm * sumOf(sy);
  });
}

}  // namespace

const PairLoops& widePairLoops() {
  static constexpr PairLoops kLoops{density, displace, viscosity};
  return kLoops;
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {

const PairLoops& pairLoops(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::widePairLoops();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::widePairLoops();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::widePairLoops();
#endif
    default:
      return scalarPairLoops();
  }
}

}  // namespace froude
#endif
