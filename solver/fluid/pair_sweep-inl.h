// The walk of the pair loops over SIMD lanes: candidates of a cell in registers, sums of a particle over them. Included
// once for each target, by the loops alone.
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/pair_loops.h>

#include <hwy/highway.h>

#include <type_traits>

// A guard that toggles: the targets' passes each need the text once.
#if defined(FROUDE_PAIR_SWEEP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FROUDE_PAIR_SWEEP_INL_H
#undef FROUDE_PAIR_SWEEP_INL_H
#else
#define FROUDE_PAIR_SWEEP_INL_H
#endif

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

// The gradient's factor without −2·kNorm, from m³.
HWY_INLINE VF slopeOf(VF m3) {
  const F f;
  return hn::Mul(m3, hn::MulAdd(hn::Mul(m3, m3), hn::Set(f, 2.5f * kTail), hn::Set(f, 1.0f)));
}

// A kernel and (dW/dq)/q, as shape·kShape and −slope·kSlope, from m = max(0, 1 − q²/4): 0 for m = 0.
struct Blend {
  static constexpr float kShape = kNorm, kSlope = 2.0f * kNorm;
  static HWY_INLINE VF shape(VF m) {
    const F f;
    const VF m3 = hn::Mul(m, hn::Mul(m, m));
    return hn::Mul(hn::Mul(m3, m), hn::MulAdd(hn::Mul(m3, m3), hn::Set(f, kTail), hn::Set(f, 1.0f)));
  }
  static HWY_INLINE VF slope(VF m) { return slopeOf(hn::Mul(m, hn::Mul(m, m))); }
};

struct WendlandC2 {
  static constexpr auto kShape = static_cast<float>(kernel::kWendland);
  static constexpr auto kSlope = static_cast<float>(5.0 * kernel::kWendland);
  static HWY_INLINE VF half(VF m) {  // q/2
    const F f;
    return hn::Sqrt(hn::Sub(hn::Set(f, 1.0f), m));
  }
  static HWY_INLINE VF shape(VF m) {
    const F f;
    const VF h = half(m), k = hn::Sub(hn::Set(f, 1.0f), h), k2 = hn::Mul(k, k);
    return hn::Mul(hn::Mul(k2, k2), hn::MulAdd(hn::Set(f, 4.0f), h, hn::Set(f, 1.0f)));
  }
  static HWY_INLINE VF slope(VF m) {
    const VF k = hn::Sub(hn::Set(F(), 1.0f), half(m));
    return hn::Mul(k, hn::Mul(k, k));
  }
};

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
    HWY_UNROLL(8)
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

// Rows of neighbours pay where the candidates of a cell are four registers at most, and a look-up in two of them is one
// instruction.
#if HWY_TARGET <= HWY_AVX3
constexpr bool kNearPays = kLanes == kNearRow;
#else
constexpr bool kNearPays = false;
#endif
constexpr std::uint8_t kMany = 255;  // first of a row: its particle has more neighbours than the row has places

// Where candidate i of a cell is itself among the candidates, counted along the registers.
HWY_INLINE std::uint32_t placeOf(const CellRuns& cell, std::uint32_t i) {
  std::uint32_t beyond = 0;
  for (std::uint32_t r = 0; r < 3; ++r) {
    const std::uint32_t k = i - cell.begin[r];
    if (k < cell.count[r]) {
      return k < CellRuns::kUsual ? r * CellRuns::kUsual + k : 3 * CellRuns::kUsual + beyond + k - CellRuns::kUsual;
    }
    beyond += cell.count[r] > CellRuns::kUsual ? cell.count[r] - CellRuns::kUsual : 0;
  }
  return 0;
}

// What is left of a row is filled with the particle itself: as a neighbour it adds nothing.
HWY_INLINE void findNear(const PairFrame& frame, const CellRuns& cell, const UsualCell<0>& c, std::uint32_t vectors,
                         std::uint32_t i, std::uint8_t* row) {
  const F f;
  const I n;
  const VF scale = hn::Set(f, 0.5f * kUnit), reach = hn::Set(f, kNearReach * kNearReach);
  const VF xi = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::Set(n, frame.x[i]), hn::Set(n, frame.x[cell.first]))), scale);
  const VF yi = hn::Mul(hn::ConvertTo(f, hn::Sub(hn::Set(n, frame.y[i]), hn::Set(n, frame.y[cell.first]))), scale);
  const auto place = static_cast<std::int32_t>(placeOf(cell, i));
  const VI self = hn::Set(n, place);
  alignas(64) std::int32_t found[5 * CellRuns::kUsual];
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < vectors; ++v) {
    const VF dx = hn::Sub(xi, c.x[v]), dy = hn::Sub(yi, c.y[v]);
    const VI places = hn::Iota(n, static_cast<std::int32_t>(v * kLanes));
    const auto inside = hn::RebindMask(n, hn::Lt(hn::MulAdd(dy, dy, hn::Mul(dx, dx)), reach));
    const auto near = hn::AndNot(hn::Eq(places, self), inside);
    hn::StoreU(hn::Compress(places, near), n, found + count);
    count += hn::CountTrue(n, near);
  }
  for (std::uint32_t k = 0; k < kNearRow; k += kLanes) hn::StoreU(self, n, found + count + k);
  if (count > kNearRow) found[0] = kMany;
  const hn::Rebind<std::uint8_t, I> bytes;
  for (std::uint32_t k = 0; k < kNearRow; k += kLanes) {
    hn::StoreU(hn::DemoteTo(bytes, hn::Load(n, found + k)), bytes, row + k);
  }
}

// A row as places in registers.
struct Places {
  VI at;
  hn::Mask<F> upper;  // in the third register or the fourth
};

HWY_INLINE Places placesOf(const std::uint8_t* row) {
  const F f;
  const I n;
  const hn::Rebind<std::uint8_t, I> bytes;
  const VI at = hn::PromoteTo(n, hn::LoadU(bytes, row));
  return {at, hn::RebindMask(f, hn::Gt(at, hn::Set(n, 2 * static_cast<std::int32_t>(kLanes) - 1)))};
}

// Values of a cell's candidates at these places. (Highway of Debian 12 has no look-up in two registers.)
HWY_INLINE VF pick(const VF* v, const Places& places, bool fourth) {
#if HWY_TARGET <= HWY_AVX3
  const __m512 lower = _mm512_permutex2var_ps(v[0].raw, places.at.raw, v[1].raw);
  if (!fourth) return VF{_mm512_mask_permutexvar_ps(lower, places.upper.raw, places.at.raw, v[2].raw)};
  const __m512 upper = _mm512_permutex2var_ps(v[2].raw, places.at.raw, v[3].raw);
  return VF{_mm512_mask_blend_ps(places.upper.raw, lower, upper)};
#else
  (void)places;
  (void)fourth;
  return v[0];
#endif
}

HWY_INLINE hn::Mask<F> notItself(const Places& places, const CellRuns& cell, std::uint32_t i) {
  const VI self = hn::Set(I(), static_cast<std::int32_t>(placeOf(cell, i)));
  return hn::Not(hn::RebindMask(F(), hn::Eq(places.at, self)));
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

// Of the particles of a usual cell, by place in it: values that candidates are met with.
struct Owners {
  static constexpr std::uint32_t kMost = 2 * CellRuns::kUsual;
  alignas(64) float x[kMost], y[kMost];  // half spacings from the reference
  alignas(64) float value[3][kMost];     // of a fold
};

HWY_INLINE void loadOwners(const PairFrame& frame, const CellRuns& cell, Owners& owners) {
  const F f;
  const I n;
  const VF scale = hn::Set(f, 0.5f * kUnit);
  const VI fromX = hn::Set(n, frame.x[cell.first]), fromY = hn::Set(n, frame.y[cell.first]);
  for (std::uint32_t k = 0; k < cell.last - cell.first; k += kLanes) {
    const VI x = hn::LoadU(n, frame.x + cell.first + k), y = hn::LoadU(n, frame.y + cell.first + k);
    hn::Store(hn::Mul(hn::ConvertTo(f, hn::Sub(x, fromX)), scale), f, owners.x + k);
    hn::Store(hn::Mul(hn::ConvertTo(f, hn::Sub(y, fromY)), scale), f, owners.y + k);
  }
}

// Is a value the same for all particles of a cell?
HWY_INLINE bool sameInCell(const float* value, const CellRuns& cell) {
  const F f;
  const VF first = hn::Set(f, value[cell.first]);
  for (std::uint32_t i = cell.first; i < cell.last; i += kLanes) {
    const auto differ = hn::Ne(hn::LoadU(f, value + i), first);
    if (!hn::AllFalse(f, hn::And(differ, hn::FirstN(f, cell.last - i)))) return false;
  }
  return true;
}

// A fold makes three values of a cell's own, in place, by which its pairs are cheaper: bool fold(cell, candidates,
// vectors, owners), false where it can not; then add3 takes them in the place of `add`.
struct NoFold {
  static constexpr bool kFolds = false;
};

// The particles of cells [begin, end). For each, add(m, dx, dy, own, other, sums) over vectors of candidates: dx, dy in
// half spacings from candidate to particle, m = max(0, 1 − q²/4), 0 in lanes without a visible neighbour, own and other
// the kValues values of particle and candidates; `own` has kOwn more. Then finish(i, count, sums) with the kSums sums
// of up to kLanes particles from i on, one a lane. `itself`: what a particle adds to its first sum, By::RowsAndItself.
enum class By { Candidates, Rows, RowsAndItself };
template <int kSums, int kValues, int kOwn, By kBy, typename Add, typename Finish, typename Fold>
HWY_INLINE void sweepAll(const PairFrame& frame, std::size_t begin, std::size_t end, const float* const* values,
                         const Add& add, const Finish& finish, const Fold& fold, VF itself) {
  const F f;
  const VF one = hn::Set(f, 1.0f);
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
      HWY_UNROLL(8)
      for (int s = 0; s < kSums; ++s) sums[s] = hn::Load(f, total[s] + r);
      finish(last - filled + r, filled - r, sums);
    }
    filled = 0;
  };
  auto nothing = [&](VF* sums) FROUDE_INLINE {
    HWY_UNROLL(8)
    for (int s = 0; s < kSums; ++s) sums[s] = hn::Zero(f);
  };
  auto done = [&](std::uint32_t i, const VF* sums) FROUDE_INLINE {
    HWY_UNROLL(8)
    for (int s = 0; s < kSums; ++s) hn::Store(sums[s], f, rows[s][filled]);
    if (++filled == kRows) finishRows(i + 1);
  };
  auto ownValues = [&](std::uint32_t i, VF* own) FROUDE_INLINE {
    HWY_UNROLL(8)
    for (int a = 0; a < kValues + kOwn; ++a) own[a] = hn::Set(f, values[a][i]);
  };
  VF own[kValues + kOwn + 1], other[kValues + 1], sums[kSums];
  Owners owners;
  // All pairs of a usual cell, kCount values each.
  auto sweepPairs = [&](const CellRuns& cell, const UsualCell<kValues>& c, const std::uint32_t vectors, auto countTag,
                        const auto& findOwn, const auto& addPair) FROUDE_INLINE {
    constexpr int kCount = decltype(countTag)::value;
    for (std::uint32_t i = cell.first; i < cell.last; ++i) {
      const VF xi = hn::Set(f, owners.x[i - cell.first]), yi = hn::Set(f, owners.y[i - cell.first]);
      findOwn(i, own);
      nothing(sums);
      if constexpr (kBy != By::Candidates) {
        const std::uint8_t* row = frame.near + kNearRow * i;
        if (HWY_LIKELY(row[0] != kMany)) {
          const Places places = placesOf(row);
          const bool fourth = vectors > kVectors;
          const VF dx = hn::Sub(xi, pick(c.x, places, fourth)), dy = hn::Sub(yi, pick(c.y, places, fourth));
          VF m = hn::Max(hn::NegMulAdd(dy, dy, hn::NegMulAdd(dx, dx, one)), hn::Zero(f));
          if constexpr (kBy == By::RowsAndItself) {
            m = hn::IfThenElseZero(notItself(places, cell, i), m);
            sums[0] = itself;
          }
          HWY_UNROLL(8)
          for (int a = 0; a < kCount; ++a) other[a] = pick(c.value[a], places, fourth);
          addPair(m, dx, dy, own, other, sums);
          done(i, sums);
          continue;
        }
      }
      HWY_UNROLL(16)
      for (std::uint32_t v = 0; v < vectors; ++v) {
        const VF dx = hn::Sub(xi, c.x[v]), dy = hn::Sub(yi, c.y[v]);
        const VF m = hn::Max(hn::NegMulAdd(dy, dy, hn::NegMulAdd(dx, dx, one)), hn::Zero(f));
        HWY_UNROLL(8)
        for (int a = 0; a < kCount; ++a) other[a] = c.value[a][v];
        addPair(m, dx, dy, own, other, sums);
      }
      done(i, sums);
    }
  };
  auto sweepUsual = [&](const CellRuns& cell, UsualCell<kValues>& c, const std::uint32_t vectors) FROUDE_INLINE {
    loadOwners(frame, cell, owners);
    if constexpr (Fold::kFolds) {
      if (HWY_LIKELY(fold(cell, c, vectors, owners))) {
        auto folded = [&](std::uint32_t i, VF* to) FROUDE_INLINE {
          HWY_UNROLL(3)
          for (int a = 0; a < 3; ++a) to[a] = hn::Set(f, owners.value[a][i - cell.first]);
        };
        sweepPairs(cell, c, vectors, std::integral_constant<int, 3>(), folded, Fold::add3);
        return;
      }
    }
    sweepPairs(cell, c, vectors, std::integral_constant<int, kValues>(), ownValues, add);
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
        ownValues(i, own);
        nothing(sums);
        forEachVector(frame, runs, i, [&](VF dx, VF dy, VF m, std::uint32_t j, auto inside) FROUDE_INLINE {
          HWY_UNROLL(8)
          for (int a = 0; a < kValues; ++a) other[a] = hn::IfThenElseZero(inside, hn::LoadU(f, values[a] + j));
          add(m, dx, dy, own, other, sums);
        });
        done(i, sums);
      }
    }
    if (k + 1 == end && filled > 0) finishRows(cell.last);
  }
}

template <int kSums, int kValues, int kOwn = 0, typename Add, typename Finish>
HWY_INLINE void sweepCells(const PairFrame& frame, std::size_t begin, std::size_t end, const float* const* values,
                           const Add& add, const Finish& finish) {
  sweepAll<kSums, kValues, kOwn, By::Candidates>(frame, begin, end, values, add, finish, NoFold(), hn::Zero(F()));
}

// As `sweepCells`, over the rows of neighbours where there are any. By::Rows is for sums to which a particle adds
// nothing where it is its own neighbour.
template <By kBy, int kSums, int kValues, int kOwn = 0, typename Add, typename Finish, typename Fold = NoFold>
HWY_INLINE void sweepNear(const PairFrame& frame, std::size_t begin, std::size_t end, const float* const* values,
                          const Add& add, const Finish& finish, const Fold& fold = Fold(), VF itself = hn::Zero(F())) {
  if (kNearPays && frame.near != nullptr) {
    sweepAll<kSums, kValues, kOwn, kNearPays ? kBy : By::Candidates>(frame, begin, end, values, add, finish, fold,
                                                                     itself);
  } else {
    sweepAll<kSums, kValues, kOwn, By::Candidates>(frame, begin, end, values, add, finish, fold, itself);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif

#endif
