// The rows over SIMD lanes, compiled once for each target; see list_rows_scalar.cpp for the same in plain C++.
#include <froude/particles/list_rows.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "froude/particles/list_rows_wide.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace froude {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using U = hn::Rebind<std::uint32_t, D>;

void listRows(const CellGrid& grid, const ListRowsFrame& frame, std::size_t begin, std::size_t end,
              AlignedArray<std::uint32_t>& buffer) {
  const D d;
  const U u;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const auto limit = hn::Set(d, frame.limit);
  const auto particles = static_cast<std::uint32_t>(grid.size());
  CellRun runs[9];
  std::size_t runCount = 0, candidates = 0, used = 0;
  const std::uint32_t* start = grid.cellStart().data();
  std::size_t cellEnd = begin;  // the particles before it are of `cell`, or not sorted
  std::uint32_t cell = 0xFFFFFFFFu;
  for (std::size_t i = begin; i < end; ++i) {
    const double xi = frame.x[i], yi = frame.y[i];
    if (i >= cellEnd) {
      cell = grid.cellOf(xi, yi);
      cellEnd = start[cell + 1];
      runCount = candidates = 0;
      grid.forEachRun(cell, [&](const CellRun& run) {
        if (run.begin == run.end) return;
        runs[runCount++] = run;
        candidates += run.end - run.begin + lanes;
      });
    }
    // Room for all candidates and a vector behind each run, and half as much again so that a slightly denser step later
    // does not allocate.
    if (HWY_UNLIKELY(buffer.size() < used + candidates)) {
      buffer.resize(used + candidates + (used + candidates) / 2);
    }
    frame.first[i] = static_cast<std::uint32_t>(used);
    std::uint32_t* const row = buffer.data() + used;
    std::uint32_t* out = row;
    const auto own = static_cast<std::uint32_t>(i);
    for (std::size_t r = 0; r < runCount; ++r) {
      const double shiftedX = xi - runs[r].shiftX, shiftedY = yi - runs[r].shiftY;
      const auto xr = hn::Set(d, shiftedX), yr = hn::Set(d, shiftedY);
      const std::uint32_t last = runs[r].end;
      std::uint32_t j = runs[r].begin;
      for (; j < last && j + lanes <= particles; j += lanes) {
        const auto dx = hn::Sub(hn::LoadU(d, frame.x + j), xr), dy = hn::Sub(hn::LoadU(d, frame.y + j), yr);
        const auto square = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::And(hn::Lt(square, limit), hn::FirstN(d, last - j)), bits);
        if (own - j < lanes) bits[0] = static_cast<std::uint8_t>(bits[0] & ~(1u << (own - j)));
        // Packed in a register and stored whole: a packing store is microcode on some processors.
        hn::StoreU(hn::CompressBits(hn::Iota(u, j), bits), u, out);
        out += static_cast<unsigned>(__builtin_popcount(bits[0]));
      }
      for (; j < last; ++j) {  // at the end of all particles, where a vector would read beyond them
        const double dx = frame.x[j] - shiftedX, dy = frame.y[j] - shiftedY;
        *out = j;
        out += static_cast<std::size_t>((dx * dx + dy * dy < frame.limit) & (j != own));
      }
    }
    frame.count[i] = static_cast<std::uint32_t>(out - row);
    used += frame.count[i];
  }
}

}  // namespace

ListRows wideListRows() { return listRows; }

}  // namespace HWY_NAMESPACE
}  // namespace froude
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace froude {

ListRows listRowsLoop(SimdTarget target) {
  switch (target) {
#if (HWY_TARGETS & HWY_AVX3)
    case SimdTarget::Avx3:
      return N_AVX3::wideListRows();
#endif
#if (HWY_TARGETS & HWY_AVX2)
    case SimdTarget::Avx2:
      return N_AVX2::wideListRows();
#endif
#if (HWY_TARGETS & HWY_SSE4)
    case SimdTarget::Sse4:
      return N_SSE4::wideListRows();
#endif
    default:
      return listRowsScalar;
  }
}

}  // namespace froude
#endif
