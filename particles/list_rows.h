// The loop that fills neighbour lists: candidates stream through SIMD lanes, those near are packed together.
#pragma once

#include <cstdint>

#include <froude/base/simd.h>
#include <froude/particles/cell_grid.h>

namespace froude {

/// What the rows of a neighbour list are made of.
struct ListRowsFrame {
  const double* x;  // sorted positions [m]
  const double* y;
  double limit;          // square of the largest distance [m²]
  std::uint32_t* first;  // per particle: where its row begins in the block's buffer, and how long it is
  std::uint32_t* count;
};

/// Rows of the particles [begin, end) into `buffer`, which grows as needed: the indices, in the order of the grid's
/// runs, of all others whose squared distance is below the limit. Same rows for all targets.
using ListRows = void (*)(const CellGrid& grid, const ListRowsFrame& frame, std::size_t begin, std::size_t end,
                          AlignedArray<std::uint32_t>& buffer);

/// Adds the part of particle i's row that comes from one run; returns the row's new end. Writes at most the run's
/// length.
inline std::uint32_t* scalarRow(const ListRowsFrame& frame, const CellRun& run, std::uint32_t i, std::uint32_t* out) {
  const double x = frame.x[i] - run.shiftX, y = frame.y[i] - run.shiftY;
  for (std::uint32_t j = run.begin; j < run.end; ++j) {
    const double dx = frame.x[j] - x, dy = frame.y[j] - y;
    *out = j;  // written always, kept if near: a branch here would be mispredicted half the time
    out += static_cast<std::size_t>((dx * dx + dy * dy < frame.limit) & (j != i));
  }
  return out;
}

/// Plain C++: the oracle of the wide versions.
void listRowsScalar(const CellGrid& grid, const ListRowsFrame& frame, std::size_t begin, std::size_t end,
                    AlignedArray<std::uint32_t>& buffer);
/// The loop of a target; below AVX-512 that is `listRowsScalar`, which is then faster.
ListRows listRowsLoop(SimdTarget target);

}  // namespace froude
