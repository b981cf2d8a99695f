// The third stage of cut cells: cells that were cut one by one become lists in which parts know their neighbours.
// Internal.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <froude/fields/cut_layer.h>

namespace froude::detail {

/// The lists of CutCells.
class CutList {
 public:
  /// `sources` in the order of keys.
  void build(const CutGrid& grid, std::span<const CutSource> sources);

  /// Index into `cells`; −1: not listed.
  std::int32_t find(std::int32_t i, std::int32_t j) const;
  std::size_t memoryBytes() const;

  std::vector<CutCell> cells;
  std::vector<CutPart> parts;
  std::vector<CutJoint> joints;
  std::vector<CutWall> walls;
  std::vector<CutEdge> edges;

 private:
  /// Indices of a tile's cells, −1 where there is none.
  struct Tile {
    std::uint64_t key = 0;
    std::array<std::int32_t, 256> cell{};
  };
  /// An opening of a cell, matched with one of the cell beyond.
  struct Pair {
    CutSide side;
    std::uint32_t own;   // part of the cell
    std::int32_t other;  // in parts; −1: a cell that is wholly open
    double length;
  };

  void addCell(const CutSource& source);
  void indexTiles();
  std::int32_t tileOf(std::uint64_t key) const;
  void joinCell(std::uint32_t cell, std::size_t tile, std::span<const CutSource> sources);
  void pairSide(std::uint32_t cell, CutSide side, std::int32_t beyond, std::span<const CutSource> sources);
  void addPair(const Pair& pair);
  void nameEdges();
  void addEdge(const CutCell& cell, const Pair& pair, bool listedBeyond);

  CutGrid grid_;
  std::vector<Tile> tiles_;
  std::vector<Pair> pairs_;
};

}  // namespace froude::detail
