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

#if HWY_TARGET != HWY_SCALAR  // scalar is pair_loops_scalar.cpp
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

constexpr std::uint32_t kLanes = HWY_LANES(float);
constexpr std::uint32_t kRows = 16;  // particles whose sums are reduced together
constexpr float kFar = 1.0e6f;       // half spacings: out of every support

// The candidates of a cell that is not usual: runs of indices and what to take off the asking particle's coordinates.
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

// The candidates of a cell, in half spacings from a reference in the cell, and up to two values of each; lanes without
// a candidate are out of reach. The usual cell has three runs of at most 16, which stay in registers; what three longer
// ones have beyond 16 shares one more.
constexpr std::uint32_t kPerRun = CellRuns::kUsual / kLanes;
constexpr std::uint32_t kVectors = 3 * kPerRun;
template <int kValues>
struct UsualCell {
  VF x[kVectors + kPerRun], y[kVectors + kPerRun], value[kValues > 0 ? kValues : 1][kVectors + kPerRun];
};

template <int kValues>
HWY_INLINE void loadUsual(const PairFrame& frame, const CellRuns& runs, const float* const* values,
                          UsualCell<kValues>& c) {
  const F f;
  const I n;
  const VF scale = hn::Set(f, 0.5f * kUnit), far = hn::Set(f, kFar);
  const VI fromX = hn::Set(n, frame.x[runs.first]), fromY = hn::Set(n, frame.y[runs.first]);
  HWY_UNROLL(12)
  for (std::uint32_t v = 0; v < kVectors; ++v) {
    const std::uint32_t k = v % kPerRun * kLanes, j = runs.begin[v / kPerRun] + k;
    const std::uint32_t count = runs.count[v / kPerRun];
    const auto inside = hn::FirstN(f, count > k ? count - k : 0);
    const VF dx = hn::ConvertTo(f, hn::Sub(hn::LoadU(n, frame.x + j), fromX));
    c.x[v] = hn::IfThenElse(inside, hn::Mul(dx, scale), far);
    c.y[v] = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::LoadU(n, frame.y + j), fromY)), scale);
    for (int a = 0; a < kValues; ++a) c.value[a][v] = hn::IfThenElseZero(inside, hn::LoadU(f, values[a] + j));
  }
}

// Blocks of four lanes, added up.
template <typename D, typename V>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> foldToFour(D d, V v) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return v;
  } else {
    const hn::Half<D> half;
    return foldToFour(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

// The lanes of each of four vectors, summed.
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> sumsOfFour(VF a, VF b, VF c, VF d) {
  const F f;
  const hn::RepartitionToWide<F> pairs;
  const VF ab = hn::Add(hn::InterleaveLower(f, a, b), hn::InterleaveUpper(f, a, b));
  const VF cd = hn::Add(hn::InterleaveLower(f, c, d), hn::InterleaveUpper(f, c, d));
  const auto ab2 = hn::BitCast(pairs, ab), cd2 = hn::BitCast(pairs, cd);
  const VF abcd = hn::Add(hn::BitCast(f, hn::InterleaveLower(pairs, ab2, cd2)),
                          hn::BitCast(f, hn::InterleaveUpper(pairs, ab2, cd2)));
  return foldToFour(f, abcd);
}

// Up to kLanes values of which only `count` may be touched: neighbours belong to another task.
HWY_INLINE VF loadSome(const float* from, std::uint32_t count) {
  const F f;
  if (HWY_LIKELY(count >= kLanes)) return hn::LoadU(f, from);
  alignas(64) float values[kLanes] = {};
  for (std::uint32_t k = 0; k < count; ++k) values[k] = from[k];
  return hn::Load(f, values);
}

HWY_INLINE void storeSome(VF v, float* to, std::uint32_t count) {
  const F f;
  if (HWY_LIKELY(count >= kLanes)) {
    hn::StoreU(v, f, to);
    return;
  }
  alignas(64) float values[kLanes];
  hn::Store(v, f, values);
  for (std::uint32_t k = 0; k < count; ++k) to[k] = values[k];
}

// lattice::sum of coordinates and a displacement in spacings.
HWY_INLINE void storeMoved(const std::int32_t* from, VF spacings, std::int32_t* to, std::uint32_t count) {
  const F f;
  const I n;
  const VI units = hn::NearestInt(hn::Mul(spacings, hn::Set(f, 1.0f / kUnit)));
  if (HWY_LIKELY(count >= kLanes)) {
    hn::StoreU(hn::Add(hn::LoadU(n, from), units), n, to);
    return;
  }
  alignas(64) std::int32_t values[kLanes];
  hn::Store(units, n, values);
  for (std::uint32_t k = 0; k < count; ++k) to[k] = lattice::sum(from[k], values[k]);
}

// The candidates beyond the 16th of each run.
template <int kValues>
HWY_INLINE void loadBeyond(const PairFrame& frame, const CellRuns& runs, const float* const* values,
                           UsualCell<kValues>& c) {
  const F f;
  const I n;
  alignas(64) std::int32_t x[CellRuns::kUsual], y[CellRuns::kUsual];
  alignas(64) float value[kValues + 1][CellRuns::kUsual] = {};
  std::uint32_t count = 0;
  for (std::uint32_t r = 0; r < 3; ++r) {
    for (std::uint32_t k = CellRuns::kUsual; k < runs.count[r]; ++k, ++count) {
      x[count] = frame.x[runs.begin[r] + k];
      y[count] = frame.y[runs.begin[r] + k];
      for (int a = 0; a < kValues; ++a) value[a][count] = values[a][runs.begin[r] + k];
    }
  }
  for (std::uint32_t k = count; k < CellRuns::kUsual; ++k) x[k] = y[k] = 0;
  const VF scale = hn::Set(f, 0.5f * kUnit), far = hn::Set(f, kFar);
  const VI fromX = hn::Set(n, frame.x[runs.first]), fromY = hn::Set(n, frame.y[runs.first]);
  for (std::uint32_t v = 0; v < kPerRun; ++v) {
    const std::uint32_t k = v * kLanes;
    const auto inside = hn::FirstN(f, count > k ? count - k : 0);
    const VF dx = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::Load(n, x + k), fromX)), scale);
    c.x[kVectors + v] = hn::IfThenElse(inside, dx, far);
    c.y[kVectors + v] = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::Load(n, y + k), fromY)), scale);
    for (int a = 0; a < kValues; ++a) c.value[a][kVectors + v] = hn::Load(f, value[a] + k);
  }
}

// Any other cell: runs of any number and length, seams, candidates behind walls. One particle; vector(dx, dy, m, j,
// live) for each vector of candidates.
template <typename Vector>
HWY_INLINE void forEachVector(const PairFrame& frame, const Runs& runs, std::uint32_t i, const Vector& vector) {
  const F f;
  const I n;
  const VF one = hn::Set(f, 1.0f), scale = hn::Set(f, 0.5f * kUnit);
  const std::int32_t hidden = frame.hidden.offset != nullptr ? frame.hidden.offset[i] : -1;
  const std::uint64_t* words = frame.hidden.words + (hidden >= 0 ? hidden : 0);
  for (std::uint32_t r = 0; r < runs.count; ++r) {
    const Runs::Run& run = runs.run[r];
    const VI xi = hn::Set(n, lattice::difference(frame.x[i], run.shiftX));
    const VI yi = hn::Set(n, lattice::difference(frame.y[i], run.shiftY));
    for (std::uint32_t j = run.begin; j < run.end; j += kLanes) {
      const auto inside = hn::FirstN(f, run.end - j);
      const VF dx = hn::Mul(hn::ConvertTo(f, hn::Sub(xi, hn::LoadU(n, frame.x + j))), scale);
      const VF dy = hn::Mul(hn::ConvertTo(f, hn::Sub(yi, hn::LoadU(n, frame.y + j))), scale);
      VF m = hn::Max(hn::NegMulAdd(dy, dy, hn::NegMulAdd(dx, dx, one)), hn::Zero(f));
      m = hn::IfThenElseZero(inside, m);
      if (hidden >= 0) {
        const std::uint32_t k = j - run.begin;
        const std::uint64_t bits = words[k / 64] >> (k % 64);
        m = hn::IfThenElseZero(hn::LoadMaskBits(f, reinterpret_cast<const std::uint8_t*>(&bits)), m);
      }
      vector(dx, dy, m, j, inside);
    }
    if (hidden >= 0) words += (run.end - run.begin + 63) / 64;
  }
}

// The particles of cells [begin, end). For each, add(m, dx, dy, own, other, sums) over vectors of candidates: dx, dy in
// half spacings from candidate to particle, m = max(0, 1 − q²/4), 0 in lanes without a visible neighbour, own and other
// the kValues values of particle and candidates; `own` has kOwn more. Then finish(i, count, sums) with the kSums sums
// of up to kLanes particles from i on, one a lane.
template <int kSums, int kValues, int kOwn = 0, typename Add, typename Finish>
HWY_INLINE void sweepCells(const PairFrame& frame, std::size_t begin, std::size_t end, const float* const* values,
                           const Add& add, const Finish& finish) {
  const F f;
  const I n;
  const VF one = hn::Set(f, 1.0f), scale = hn::Set(f, 0.5f * kUnit);
  alignas(64) float rows[kSums][kRows][kLanes] = {};
  std::uint32_t filled = 0;
  auto finishRows = [&](std::uint32_t last) FROUDE_INLINE {
    alignas(64) float total[kSums][kRows];
    const hn::FixedTag<float, 4> four;
    for (int s = 0; s < kSums; ++s) {
      for (std::uint32_t r = 0; r < kRows; r += 4) {
        hn::Store(sumsOfFour(hn::Load(f, rows[s][r]), hn::Load(f, rows[s][r + 1]), hn::Load(f, rows[s][r + 2]),
                             hn::Load(f, rows[s][r + 3])),
                  four, total[s] + r);
      }
    }
    for (std::uint32_t r = 0; r < filled; r += kLanes) {
      VF sums[kSums];
      for (int s = 0; s < kSums; ++s) sums[s] = hn::Load(f, total[s] + r);
      finish(last - filled + r, filled - r, sums);
    }
    filled = 0;
  };
  auto begun = [&](std::uint32_t i, VF* own, VF* sums) FROUDE_INLINE {
    for (int a = 0; a < kValues + kOwn; ++a) own[a] = hn::Set(f, values[a][i]);
    for (int s = 0; s < kSums; ++s) sums[s] = hn::Zero(f);
  };
  auto done = [&](std::uint32_t i, const VF* sums) FROUDE_INLINE {
    for (int s = 0; s < kSums; ++s) hn::Store(sums[s], f, rows[s][filled]);
    if (++filled == kRows) finishRows(i + 1);
  };
  VF own[kValues + kOwn + 1], other[kValues + 1], sums[kSums];
  auto sweepUsual = [&](const CellRuns& cell, const UsualCell<kValues>& c, const std::uint32_t vectors) FROUDE_INLINE {
    const VI fromX = hn::Set(n, frame.x[cell.first]), fromY = hn::Set(n, frame.y[cell.first]);
    for (std::uint32_t i = cell.first; i < cell.last; ++i) {
      const VF xi = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::Set(n, frame.x[i]), fromX)), scale);
      const VF yi = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::Set(n, frame.y[i]), fromY)), scale);
      begun(i, own, sums);
      HWY_UNROLL(16)
      for (std::uint32_t v = 0; v < vectors; ++v) {
        const VF dx = hn::Sub(xi, c.x[v]), dy = hn::Sub(yi, c.y[v]);
        const VF m = hn::Max(hn::NegMulAdd(dy, dy, hn::NegMulAdd(dx, dx, one)), hn::Zero(f));
        for (int a = 0; a < kValues; ++a) other[a] = c.value[a][v];
        add(m, dx, dy, own, other, sums);
      }
      done(i, sums);
    }
  };
  for (std::size_t k = begin; k < end; ++k) {
    const CellRuns& cell = frame.runs[k];
    if (HWY_LIKELY(cell.kind == CellRuns::Kind::Usual)) {
      UsualCell<kValues> c;
      loadUsual<kValues>(frame, cell, values, c);
      sweepUsual(cell, c, kVectors);
    } else if (HWY_LIKELY(cell.kind == CellRuns::Kind::Long)) {
      UsualCell<kValues> c;
      loadUsual<kValues>(frame, cell, values, c);
      loadBeyond<kValues>(frame, cell, values, c);
      sweepUsual(cell, c, kVectors + kPerRun);
    } else {
      Runs runs;
      collectRuns(frame, frame.cells[k], runs);
      for (std::uint32_t i = cell.first; i < cell.last; ++i) {
        begun(i, own, sums);
        forEachVector(frame, runs, i, [&](VF dx, VF dy, VF m, std::uint32_t j, auto inside) FROUDE_INLINE {
          for (int a = 0; a < kValues; ++a) other[a] = hn::IfThenElseZero(inside, hn::LoadU(f, values[a] + j));
          add(m, dx, dy, own, other, sums);
        });
        done(i, sums);
      }
    }
    if (k + 1 == end && filled > 0) finishRows(cell.last);
  }
}

// The change of κ for a gain of density, whose share of the excess goes to `excess`.
HWY_INLINE void changePressure(const PressureUpdate& update, std::uint32_t i, std::uint32_t count, VF gain, VF diagonal,
                               VF& excess) {
  const F f;
  const VF least = update.least != nullptr ? loadSome(update.least + i, count) : hn::Zero(f);
  VF step = hn::Div(hn::Mul(hn::Set(f, update.relaxation), gain), hn::Max(diagonal, hn::Set(f, kSmallestDiagonal)));
  if (update.momentum > 0.0f) {
    step = hn::MulAdd(hn::Set(f, update.momentum), loadSome(update.change + i, count), step);
  }
  storeSome(hn::Max(hn::Sub(least, loadSome(update.kappa + i, count)), step), update.change + i, count);
  const VF lack = hn::IfThenElseZero(hn::Lt(least, hn::Zero(f)), hn::Neg(gain));
  excess = hn::Add(excess, hn::IfThenElseZero(hn::FirstN(f, count), hn::Max(gain, lack)));
}

HWY_INLINE void updatePressure(const PressureUpdate& update, std::uint32_t i, std::uint32_t count, VF density,
                               VF diagonal, VF& excess) {
  const F f;
  VF target = loadSome(update.target + i, count);
  const auto fresh = hn::Eq(target, hn::Zero(f));
  if (HWY_UNLIKELY(!hn::AllFalse(f, fresh))) {
    target = hn::IfThenElse(fresh, hn::Max(density, hn::Set(f, 1.0f)), target);
    storeSome(target, update.target + i, count);
  }
  changePressure(update, i, count, hn::Sub(density, target), diagonal, excess);
}

struct Wall {
  VF lambda, x, y;
};

HWY_INLINE Wall wallOf(const DensityLoop& loop, std::uint32_t i, std::uint32_t count) {
  const VF gx = loadSome(loop.wallX + i, count), gy = loadSome(loop.wallY + i, count);
  const VF shifted = hn::MulAdd(gx, loadSome(loop.shiftX + i, count), hn::Mul(gy, loadSome(loop.shiftY + i, count)));
  return {hn::Add(loadSome(loop.lambda + i, count), shifted), gx, gy};
}

double densityOnly(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF excess = hn::Zero(f);
  sweepCells<1, 0>(
      frame, begin, end, nullptr,
      [&](VF m, VF, VF, const VF*, const VF*, VF* sums) FROUDE_INLINE {
        const VF m2 = hn::Mul(m, m), m4 = hn::Mul(m2, m2);
        sums[0] = hn::MulAdd(m4, hn::MulAdd(hn::Mul(m4, m2), hn::Set(f, kTail), hn::Set(f, 1.0f)), sums[0]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF density = hn::Mul(hn::Set(f, kNorm), sums[0]);
        if (loop.lambda != nullptr) density = hn::Add(density, wallOf(loop, i, count).lambda);
        storeSome(density, loop.density + i, count);
        if (loop.update.target == nullptr) return;
        updatePressure(loop.update, i, count, density, loadSome(loop.update.diagonal + i, count), excess);
      });
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(f, excess)));
}

// To sums: W, ∇W = (px, py) and |∇W|², without their factors.
HWY_INLINE void addNeighbour(VF m, VF dx, VF dy, VF& px, VF& py, VF* sums) {
  const VF m3 = hn::Mul(m, hn::Mul(m, m));
  sums[0] = hn::Add(sums[0], shapeOf(m, m3));
  const VF slope = slopeOf(m3);
  px = hn::Mul(slope, dx);
  py = hn::Mul(slope, dy);
  sums[1] = hn::Add(sums[1], px);
  sums[2] = hn::Add(sums[2], py);
  sums[3] = hn::MulAdd(px, px, hn::MulAdd(py, py, sums[3]));
}

double densityAndDiagonal(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF excess = hn::Zero(f);
  sweepCells<4, 0>(
      frame, begin, end, nullptr,
      [&](VF m, VF dx, VF dy, const VF*, const VF*, VF* sums) FROUDE_INLINE {
        VF px, py;
        addNeighbour(m, dx, dy, px, py, sums);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF density = hn::Mul(hn::Set(f, kNorm), sums[0]);
        Wall wall{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
        if (loop.lambda != nullptr) wall = wallOf(loop, i, count);
        density = hn::Add(density, wall.lambda);
        storeSome(density, loop.density + i, count);
        const VF scale = hn::Set(f, -4.0f * kNorm), two = hn::Set(f, 2.0f);
        const VF px = hn::Mul(scale, sums[1]), py = hn::Mul(scale, sums[2]);
        const VF skewX = hn::Add(px, wall.x), skewY = hn::Add(py, wall.y);
        VF diagonal = hn::Mul(hn::Mul(scale, scale), sums[3]);
        diagonal = hn::MulAdd(skewX, hn::MulAdd(two, wall.x, px), diagonal);
        diagonal = hn::MulAdd(skewY, hn::MulAdd(two, wall.y, py), diagonal);
        storeSome(diagonal, loop.diagonal + i, count);
        if (loop.update.target != nullptr) updatePressure(loop.update, i, count, density, diagonal, excess);
      });
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(f, excess)));
}

double density(const PairFrame& frame, const DensityLoop& loop, std::size_t begin, std::size_t end) {
  return loop.diagonal != nullptr ? densityAndDiagonal(frame, loop, begin, end) : densityOnly(frame, loop, begin, end);
}

double divergence(const PairFrame& frame, const DivergenceLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  VF excess = hn::Zero(f);
  const Matrices<const float>& b = loop.correction;
  const float* const values[5] = {loop.ux, loop.uy, b.xx, b.xy, b.yy};
  sweepCells<1, 2, 3>(
      frame, begin, end, values,
      [&](VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF px = hn::MulAdd(own[2], dx, hn::Mul(own[3], dy)), py = hn::MulAdd(own[3], dx, hn::Mul(own[4], dy));
        const VF away = hn::MulAdd(hn::Sub(own[0], other[0]), px, hn::Mul(hn::Sub(own[1], other[1]), py));
        sums[0] = hn::MulAdd(slopeOf(hn::Mul(m, hn::Mul(m, m))), away, sums[0]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF gain = hn::Mul(hn::Set(f, -4.0f * kNorm), sums[0]);
        if (loop.wallX != nullptr) {
          gain = hn::MulAdd(loadSome(loop.wallX + i, count), loadSome(loop.ux + i, count), gain);
          gain = hn::MulAdd(loadSome(loop.wallY + i, count), loadSome(loop.uy + i, count), gain);
          gain = hn::Add(gain, loadSome(loop.wallGain + i, count));
        }
        gain = hn::Sub(gain, loadSome(loop.update.target + i, count));
        changePressure(loop.update, i, count, gain, loadSome(loop.update.diagonal + i, count), excess);
      });
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(f, excess)));
}

void moments(const PairFrame& frame, const MomentLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  sweepCells<7, 0>(
      frame, begin, end, nullptr,
      [&](VF m, VF dx, VF dy, const VF*, const VF*, VF* sums) FROUDE_INLINE {
        VF px, py;
        addNeighbour(m, dx, dy, px, py, sums);
        sums[4] = hn::MulAdd(px, dx, sums[4]);
        sums[5] = hn::MulAdd(px, dy, sums[5]);
        sums[6] = hn::MulAdd(py, dy, sums[6]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF density = hn::Mul(hn::Set(f, kNorm), sums[0]);
        if (loop.lambda != nullptr) density = hn::Add(density, loadSome(loop.lambda + i, count));
        storeSome(density, loop.density + i, count);
        const VF scale = hn::Set(f, -4.0f * kNorm), second = hn::Set(f, 8.0f * kNorm);
        storeSome(hn::Mul(scale, sums[1]), loop.skewX + i, count);
        storeSome(hn::Mul(scale, sums[2]), loop.skewY + i, count);
        storeSome(hn::Mul(hn::Mul(scale, scale), sums[3]), loop.squares + i, count);
        storeSome(hn::Mul(second, sums[4]), loop.moment.xx + i, count);
        storeSome(hn::Mul(second, sums[5]), loop.moment.xy + i, count);
        storeSome(hn::Mul(second, sums[6]), loop.moment.yy + i, count);
      });
}

// Adds what a wall does to a move, and gives it to the particles.
template <typename Loop>
HWY_INLINE void takeMove(const Loop& loop, std::uint32_t i, std::uint32_t count, VF& moveX, VF& moveY) {
  const VF own = loadSome(loop.pressure + i, count);
  if (loop.wallX != nullptr) {
    const VF gx = loadSome(loop.wallX + i, count), gy = loadSome(loop.wallY + i, count);
    const VF tangent = loadSome(loop.tangent + i, count);
    const VF along = hn::Mul(tangent, hn::Sub(hn::Mul(gx, moveY), hn::Mul(gy, moveX)));
    const VF twice = hn::Add(own, own);
    moveX = hn::Sub(moveX, hn::MulAdd(twice, gx, hn::Mul(along, gy)));
    moveY = hn::Sub(moveY, hn::Sub(hn::Mul(twice, gy), hn::Mul(along, gx)));
  }
  storeSome(hn::Add(loadSome(loop.shiftX + i, count), moveX), loop.shiftX + i, count);
  storeSome(hn::Add(loadSome(loop.shiftY + i, count), moveY), loop.shiftY + i, count);
  if (loop.kappa != nullptr) storeSome(hn::Add(loadSome(loop.kappa + i, count), own), loop.kappa + i, count);
}

void push(const PairFrame& frame, const PushLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  const float* const values[3] = {loop.scaled.xx, loop.scaled.xy, loop.scaled.yy};
  sweepCells<2, 3>(
      frame, begin, end, values,
      [&](VF m, VF dx, VF dy, const VF*, const VF* other, VF* sums) FROUDE_INLINE {
        const VF slope = slopeOf(hn::Mul(m, hn::Mul(m, m)));
        const VF px = hn::Mul(slope, dx), py = hn::Mul(slope, dy);
        sums[0] = hn::MulAdd(other[0], px, hn::MulAdd(other[1], py, sums[0]));
        sums[1] = hn::MulAdd(other[1], px, hn::MulAdd(other[2], py, sums[1]));
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        const VF qx = loadSome(loop.skewX + i, count), qy = loadSome(loop.skewY + i, count);
        const VF xx = loadSome(loop.scaled.xx + i, count), xy = loadSome(loop.scaled.xy + i, count);
        const VF yy = loadSome(loop.scaled.yy + i, count), scale = hn::Set(f, 4.0f * kNorm);
        VF moveX = hn::NegMulAdd(xx, qx, hn::NegMulAdd(xy, qy, hn::Mul(scale, sums[0])));
        VF moveY = hn::NegMulAdd(xy, qx, hn::NegMulAdd(yy, qy, hn::Mul(scale, sums[1])));
        takeMove(loop, i, count, moveX, moveY);
        storeSome(hn::Add(loadSome(loop.totalX + i, count), moveX), loop.totalX + i, count);
        storeSome(hn::Add(loadSome(loop.totalY + i, count), moveY), loop.totalY + i, count);
      });
}

void displace(const PairFrame& frame, const DisplacementLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  sweepCells<2, 1>(
      frame, begin, end, &loop.pressure,
      [&](VF m, VF dx, VF dy, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF both = hn::Add(own[0], other[0]);
        const VF weight = hn::Mul(both, slopeOf(hn::Mul(m, hn::Mul(m, m))));
        sums[0] = hn::MulAdd(weight, dx, sums[0]);
        sums[1] = hn::MulAdd(weight, dy, sums[1]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        VF moveX = hn::Mul(hn::Set(f, 4.0f * kNorm), sums[0]), moveY = hn::Mul(hn::Set(f, 4.0f * kNorm), sums[1]);
        takeMove(loop, i, count, moveX, moveY);
        storeMoved(frame.x + i, moveX, loop.newX + i, count);
        storeMoved(frame.y + i, moveY, loop.newY + i, count);
      });
}

void viscosity(const PairFrame& frame, const ViscosityLoop& loop, std::size_t begin, std::size_t end) {
  const F f;
  const VF a = hn::Set(f, loop.a), twiceB = hn::Set(f, 2.0f * loop.b);
  const float* const values[2] = {loop.vx, loop.vy};
  sweepCells<2, 2>(
      frame, begin, end, values,
      [&](VF m, VF, VF, const VF* own, const VF* other, VF* sums) FROUDE_INLINE {
        const VF m3 = hn::Mul(m, hn::Mul(m, m));
        const VF weight = hn::MulAdd(a, shapeOf(m, m3), hn::Mul(twiceB, slopeOf(m3)));
        sums[0] = hn::MulAdd(weight, hn::Sub(other[0], own[0]), sums[0]);
        sums[1] = hn::MulAdd(weight, hn::Sub(other[1], own[1]), sums[1]);
      },
      [&](std::uint32_t i, std::uint32_t count, const VF* sums) FROUDE_INLINE {
        storeSome(hn::Mul(hn::Set(f, kNorm), sums[0]), loop.changeX + i, count);
        storeSome(hn::Mul(hn::Set(f, kNorm), sums[1]), loop.changeY + i, count);
      });
}

}  // namespace

const PairLoops& widePairLoops() {
  static constexpr PairLoops kLoops{density, divergence, moments, push, displace, viscosity};
  return kLoops;
}

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif

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
