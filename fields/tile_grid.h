// A sparse grid of square cells: tiles of 16 × 16 cells where something is, and nothing where nothing is.
//
// Cell (i, j) covers origin + [i, i+1]·h × [j, j+1]·h of an unbounded index plane; origin and h belong to the user. A
// field is an array of (tiles + 1)·256 values: cell (i, j) of tile t at t·256 + (j mod 16)·16 + (i mod 16). Tile 0 is
// the null tile: it stands for every neighbour that is absent, holds zeros in every field and is never written, so that
// stencils need no branch. On a staggered grid the x face (i, j) is the left side of cell (i, j) and the y face (i, j)
// its bottom side; both are stored at the cell's place. Work and memory follow the tiles, not the plane.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>

#include <froude/base/aligned.h>
#include <froude/base/api.h>

namespace froude {

/// Coordinates of a tile: it holds cells [16x, 16x + 16) × [16y, 16y + 16). Ordered by rows.
struct TileIndex {
  std::int32_t x = 0, y = 0;
  friend bool operator==(const TileIndex&, const TileIndex&) = default;
  friend std::strong_ordering operator<=>(const TileIndex& a, const TileIndex& b) {
    return a.y != b.y ? a.y <=> b.y : a.x <=> b.x;
  }
};

/// A tile and its neighbours (numbers of tiles, 0 where there is none). `columns` and `rows` are 16 but for the last
/// tiles of a period, which end there: the right neighbour of the cells in column `columns` − 1 is column 0 of `right`.
struct Tile {
  TileIndex at;
  std::uint32_t left = 0, right = 0, down = 0, up = 0;
  std::uint32_t downLeft = 0, downRight = 0, upLeft = 0, upRight = 0;
  std::int32_t columns = 16, rows = 16;
};

/// The tile with one more cell on every side: cell (column, row) of [−1, columns] × [−1, rows] at `value(column, row)`.
/// Rows begin on 64-byte boundaries; what lies beyond a period's last cell and its halo is zero.
struct TileHalo {
  static constexpr std::int32_t kStride = 48;
  alignas(64) std::array<float, 18 * kStride> values;
  float* row(std::int32_t j) { return values.data() + (j + 1) * kStride + 16; }
  const float* row(std::int32_t j) const { return values.data() + (j + 1) * kStride + 16; }
  float value(std::int32_t i, std::int32_t j) const { return row(j)[i]; }
};

/// Cells after which the plane repeats itself; 0: never. With a period in x, cells lie in [0, x); likewise in y.
struct TilePeriod {
  std::int32_t x = 0, y = 0;
};

class FROUDE_API TileGrid {
 public:
  static constexpr std::int32_t kSide = 16;
  static constexpr std::size_t kCells = 256;  // of a tile

  /// Makes tiles 1 … n of `tiles`, in their order. Preconditions: sorted by rows, no tile twice, coordinates of cells
  /// within ±2³⁰, within the periods. Cost O(n), without allocation once as many tiles were held before.
  void build(std::span<const TileIndex> tiles, TilePeriod period = {});

  /// Without the null tile. Numbers of tiles go from 1 to this.
  std::size_t size() const { return tiles_.empty() ? 0 : tiles_.size() - 1; }
  /// Values of a field: (size() + 1)·256.
  std::size_t values() const { return (size() + 1) * kCells; }
  const Tile& tile(std::size_t t) const { return tiles_[t]; }
  TilePeriod period() const { return period_; }

  /// Number of the tile at these coordinates of tiles (not wrapped), 0 if absent. One look-up; where the tiles lie far
  /// apart (more than 32 places of their bounding box a tile), a binary search.
  std::uint32_t find(std::int32_t x, std::int32_t y) const;
  /// Place of cell (i, j) in a field: in the null tile if absent. Periods are taken into account for cells up to one
  /// period outside.
  std::size_t place(std::int32_t i, std::int32_t j) const;
  /// Coordinates of the cell at a place outside the null tile.
  std::array<std::int32_t, 2> cell(std::size_t place) const;

  /// Makes `field` one of this grid, all zeros. Memory is reused.
  template <typename T>
  void clear(AlignedArray<T>& field) const {
    field.clear();
    fit(field);
  }
  /// Makes `field` one of this grid; the null tile holds zeros if nobody wrote there, all else is undefined. What grows
  /// takes an eighth more than it needs: fields are many, and doubled ones would be half empty.
  template <typename T>
  void fit(AlignedArray<T>& field) const {
    if (values() > field.capacity()) {
      field.clear();
      field.reserve(values() + values() / 8);
    }
    field.resize(values());
  }
  /// Copies tile t and the cells around it.
  void loadHalo(const float* field, std::size_t t, TileHalo& halo) const;

  std::size_t memoryBytes() const;

 private:
  struct Row {
    std::int32_t y;
    std::uint32_t first;  // tile
  };
  void buildDirectory();
  std::uint32_t neighbour(const Tile& tile, std::int32_t dx, std::int32_t dy) const;

  AlignedArray<Tile> tiles_;  // [0] is the null tile
  TilePeriod period_;
  std::int32_t minX_ = 0, minY_ = 0;
  std::int64_t wide_ = 0, high_ = 0;       // tiles of the bounding box
  AlignedArray<std::uint32_t> directory_;  // of the bounding box; empty: rows_ are searched
  AlignedArray<Row> rows_;                 // with one more behind the last
};

}  // namespace froude
