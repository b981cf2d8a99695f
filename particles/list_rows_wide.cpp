// The rows over SIMD lanes; see list_rows_scalar.cpp for the same in plain C++. For AVX-512 alone: without its
// instruction that packs lanes this loop is slower than the plain one (docs/decisions/particles-neighbours.md).
#include <froude/particles/list_rows.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/particles/list_rows_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#if HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using U = hn::Rebind<std::uint32_t, D>;

constexpr std::uint32_t kMostPacked = 1024;
constexpr std::uint32_t kChunk = 16;

// The candidates of a cell side by side: one loop of one length for all of its particles.
struct Packed {
  alignas(64) double x[kMostPacked + kChunk];
  alignas(64) double y[kMostPacked + kChunk];
  alignas(64) std::uint32_t index[kMostPacked + kChunk];
  std::uint32_t count = 0;

  // In whole chunks, since the lengths of runs are what a processor cannot predict; `particles` is where reading ends.
  HWY_INLINE void append(const ListRowsFrame& frame, const CellRun& run, std::uint32_t particles) {
    const D d;
    const U u;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    std::uint32_t at = count;
    count += run.end - run.begin;
    for (std::uint32_t j = run.begin; j < run.end; j += kChunk, at += kChunk) {
      if (HWY_UNLIKELY(j + kChunk > particles)) {
        for (; j < run.end; ++j, ++at) {
          x[at] = frame.x[j];
          y[at] = frame.y[j];
          index[at] = j;
        }
        return;
      }
      for (std::uint32_t k = 0; k < kChunk; k += lanes) {
        hn::StoreU(hn::LoadU(d, frame.x + j + k), d, x + at + k);
        hn::StoreU(hn::LoadU(d, frame.y + j + k), d, y + at + k);
        hn::StoreU(hn::Iota(u, j + k), u, index + at + k);
      }
    }
  }
};

// The row of particle i from the candidates of its cell, among which it stands at `own`; runs are seen through their
// shifts by moving the particle, as in the scalar loop, so that the bits of the distances are the same.
HWY_INLINE std::uint32_t* appendRow(const Packed& packed, std::uint32_t from, std::uint32_t to, double xi, double yi,
                                    double limitSquare, std::uint32_t own, std::uint32_t* out) {
  const D d;
  const U u;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const auto limit = hn::Set(d, limitSquare), x = hn::Set(d, xi), y = hn::Set(d, yi);
  for (std::uint32_t j = from; j < to; j += lanes) {
    const auto dx = hn::Sub(hn::LoadU(d, packed.x + j), x), dy = hn::Sub(hn::LoadU(d, packed.y + j), y);
    const auto square = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Lt(square, limit), bits);
    const std::uint32_t left = to - j, ahead = own - j;
    std::uint64_t kept = left < lanes ? (std::uint64_t{1} << left) - 1 : 0xFF;
    kept &= ~(static_cast<std::uint64_t>(ahead < 64) << (ahead & 63));
    bits[0] = static_cast<std::uint8_t>(bits[0] & kept);
    // Packed in a register and stored whole: a packing store is microcode on some processors.
    hn::StoreU(hn::CompressBits(hn::LoadU(u, packed.index + j), bits), u, out);
    out += static_cast<unsigned>(__builtin_popcount(bits[0]));
  }
  return out;
}

void listRows(const CellGrid& grid, const ListRowsFrame& frame, std::size_t begin, std::size_t end,
              AlignedArray<std::uint32_t>& buffer) {
  CellRun runs[9];
  Packed packed;
  std::size_t runCount = 0, candidates = 0, used = 0;
  bool shifted = false;
  std::uint32_t ownRun = 0;
  const std::uint32_t* start = grid.cellStart().data();
  std::size_t cellEnd = begin;
  for (std::size_t i = begin; i < end; ++i) {
    const double xi = frame.x[i], yi = frame.y[i];
    const auto self = static_cast<std::uint32_t>(i);
    if (i >= cellEnd) {
      const std::uint32_t cell = grid.cellOf(xi, yi);
      cellEnd = start[cell + 1];
      runCount = candidates = 0;
      shifted = false;
      grid.forEachRun(cell, [&](const CellRun& run) {
        runs[runCount++] = run;
        candidates += run.end - run.begin;
        shifted |= run.shiftX != 0.0 || run.shiftY != 0.0;
      });
      packed.count = 0;
      for (std::size_t r = 0; r < runCount && candidates <= kMostPacked; ++r) {
        if (self >= runs[r].begin && self < runs[r].end) ownRun = packed.count - runs[r].begin;
        packed.append(frame, runs[r], static_cast<std::uint32_t>(grid.size()));
      }
    }
    // Room for all candidates and a vector, and half as much again so that a slightly denser step later does not
    // allocate.
    const std::size_t room = candidates + 8;
    if (HWY_UNLIKELY(buffer.size() < used + room)) buffer.resize(used + room + (used + room) / 2);
    std::uint32_t* const row = buffer.data() + used;
    std::uint32_t* out = row;
    if (candidates > kMostPacked) {
      for (std::size_t r = 0; r < runCount; ++r) out = scalarRow(frame, runs[r], self, out);
    } else if (!shifted) {
      out = appendRow(packed, 0, packed.count, xi, yi, frame.limit, self + ownRun, out);
    } else {
      std::uint32_t from = 0;
      for (std::size_t r = 0; r < runCount; ++r) {
        const std::uint32_t to = from + (runs[r].end - runs[r].begin);
        out = appendRow(packed, from, to, xi - runs[r].shiftX, yi - runs[r].shiftY, frame.limit, self + ownRun, out);
        from = to;
      }
    }
    frame.first[i] = static_cast<std::uint32_t>(used);
    frame.count[i] = static_cast<std::uint32_t>(out - row);
    used += frame.count[i];
  }
}

}  // namespace

ListRows wideListRows() { return listRows; }

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();
#endif  // HWY_AVX3

#if HWY_ONCE
namespace froude {

ListRows listRowsLoop(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideListRows();
#endif
    default:
      return listRowsScalar;
  }
}

}  // namespace froude
#endif
