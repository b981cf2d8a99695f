// The first stage of cut cells: outlines broken into pieces at the lines of the grid, and the winding number of every
// cell's corner. Internal.
#pragma once

#include <vector>

#include <froude/fields/cut_cells.h>

namespace froude::detail {

/// Where a piece begins or ends, beside the four of CutSide: at a vertex inside the cell.
inline constexpr std::uint8_t kInside = 4;

/// A straight piece of an outline's edge in one cell; the solid is on its left. What follows it round the outline
/// begins exactly where it ends: winding numbers are whole whatever is rounded.
struct CutPiece {
  std::uint64_t key = 0;      // of the cell
  double x0 = 0.0, y0 = 0.0;  // in the cell, 0 … 1
  double x1 = 0.0, y1 = 0.0;
  std::uint32_t outline = 0;
  std::uint8_t from = kInside, to = kInside;
  std::int16_t wrapX = 0, wrapY = 0;  // the outline passes here this many periods farther on
};

/// By how much the winding number rises from the left to the right of where an outline crosses the bottom of a cell;
/// once sorted, what it is to the right of it.
struct CutCrossing {
  std::uint64_t key = 0;  // of the row, then of the column
  std::int32_t winding = 0;
};

/// Cells in the order of tiles of 16 × 16, row after row.
inline std::uint64_t cutKey(std::int32_t i, std::int32_t j) {
  const std::uint32_t x = static_cast<std::uint32_t>(i) ^ 0x80000000u, y = static_cast<std::uint32_t>(j) ^ 0x80000000u;
  return (static_cast<std::uint64_t>(y >> 4) << 36) | (static_cast<std::uint64_t>(x >> 4) << 8) | ((y & 15u) << 4) |
         (x & 15u);
}
inline std::uint64_t cutTile(std::uint64_t key) { return key >> 8; }
inline std::int32_t cutColumn(std::uint64_t key) {
  return static_cast<std::int32_t>((static_cast<std::uint32_t>(key >> 8) << 4 | (key & 15u)) ^ 0x80000000u);
}
inline std::int32_t cutRow(std::uint64_t key) {
  return static_cast<std::int32_t>((static_cast<std::uint32_t>(key >> 36) << 4 | ((key >> 4) & 15u)) ^ 0x80000000u);
}
/// Crossings in the order of rows, then of columns.
inline std::uint64_t crossingKey(std::int32_t i, std::int32_t j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(j) ^ 0x80000000u) << 32) |
         (static_cast<std::uint32_t>(i) ^ 0x80000000u);
}

/// x [cells], put on a grid line that it is nearly on.
double snapped(double x);

/// Pieces and crossings of a set of outlines.
class CutPieces {
 public:
  void clear();
  /// Cost: cells that the outline passes.
  void add(const CutGrid& grid, const CutOutline& outline, std::uint32_t number);
  void add(const CutPiece& piece) { pieces_.push_back(piece); }
  /// Forgets the pieces beyond the first `count`.
  void truncate(std::size_t count) { pieces_.resize(count); }
  /// Sorts crossings and adds them up; `windingAt` needs it.
  void sumCrossings();

  const std::vector<CutPiece>& pieces() const { return pieces_; }
  /// Number of outlines round the lower left corner of the cell, just beyond of all that its pieces touch.
  std::int32_t windingAt(std::int32_t i, std::int32_t j) const;
  std::size_t memoryBytes() const;

 private:
  struct Vertex {
    double x, y;        // in cells
    std::int32_t i, j;  // the cell that it counts to
  };
  void place(const CutGrid& grid, const CutOutline& outline);
  void walk(const CutGrid& grid, const Vertex& a, const Vertex& b, std::uint32_t number);

  std::vector<CutPiece> pieces_;
  std::vector<CutCrossing> crossings_;
  std::int32_t leftmost_ = 0, lowest_ = 0, highest_ = 0;  // columns and rows of crossings
  std::vector<Vertex> vertices_;
};

}  // namespace froude::detail
