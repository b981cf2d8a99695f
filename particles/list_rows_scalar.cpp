#include <froude/particles/list_rows.h>

#include <array>

namespace froude {

void listRowsScalar(const CellGrid& grid, const ListRowsFrame& frame, std::size_t begin, std::size_t end,
                    AlignedArray<std::uint32_t>& buffer) {
  std::array<CellRun, 9> runs;
  std::size_t runCount = 0, candidates = 0, used = 0;
  std::uint32_t cell = 0xFFFFFFFFu;
  for (std::size_t i = begin; i < end; ++i) {
    const double xi = frame.x[i], yi = frame.y[i];
    if (const std::uint32_t c = grid.cellOf(xi, yi); c != cell) {
      cell = c;
      runCount = candidates = 0;
      grid.forEachRun(cell, [&](const CellRun& run) {
        runs[runCount++] = run;
        candidates += run.end - run.begin;
      });
    }
    // Room for all candidates, and half as much again so that a slightly denser step later does not allocate.
    if (buffer.size() < used + candidates) buffer.resize(used + candidates + (used + candidates) / 2);
    frame.first[i] = static_cast<std::uint32_t>(used);
    std::uint32_t* out = buffer.data() + used;
    for (std::size_t r = 0; r < runCount; ++r) out = scalarRow(frame, runs[r], static_cast<std::uint32_t>(i), out);
    frame.count[i] = static_cast<std::uint32_t>(out - buffer.data()) - frame.first[i];
    used += frame.count[i];
  }
}

}  // namespace froude
