// A field of a tile grid that goes outwards from where it is known, a layer of cells at a time: the loops of one tile.
#pragma once

#include <cstddef>
#include <cstdint>

#include <froude/solver/fluid/grid/grid_loops.h>

namespace froude {

/// A layer within one tile, a word of 16 cells for each row. The sides say which of the cells beside are known.
struct FrontRows {
  std::uint16_t fresh[16];  // cells that the layer reaches
  std::uint16_t left[16], right[16], down[16], up[16];
};

struct FrontLoops {
  /// To `next`, in rows with fresh cells: the mean of the known cells beside a fresh one, and what stands in `values`
  /// elsewhere. Both are fields; values are 0 where they are not known.
  void (*means)(const float* values, const TileLinks& link, const FrontRows& rows, std::size_t tile, float* next);
  /// Rows with fresh cells from `next` to `values`; `known`, if there is one, becomes 1 in those cells.
  void (*take)(const float* next, const std::uint16_t* fresh, std::size_t tile, float* values, float* known);
};

/// Plain C++: the oracle of the wide versions, which give the same bits.
const FrontLoops& scalarFrontLoops();
const FrontLoops& frontLoops(SimdTarget target);

/// Rows of the layer that surrounds what `known` has (16 words a tile; cells outside of a period are never known).
/// Returns whether there is a fresh cell.
bool findFront(const std::uint16_t* known, const TileLinks& link, std::size_t tile, FrontRows& rows);

}  // namespace froude
