// Which tiles of the grid a fluid needs, and its particles in the order of their cells.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/fields/cut_cells.h>
#include <froude/fields/tile_grid.h>
#include <froude/particles/key_sort.h>

namespace froude {

/// The tiles that hold particles and those next to them. Memory and work follow the particles, not the domain.
class ParticleTiles {
 public:
  /// x, y [m], same length; along periodic axes inside the period. Cost: O(particles + cells of the tiles).
  void build(std::span<const double> x, std::span<const double> y, const CutGrid& grid);

  const TileGrid& tiles() const { return tiles_; }
  /// new[i] = old[order()[i]] sorts by cell.
  std::span<const std::uint32_t> order() const { return sort_.order(); }
  bool sorted() const { return sort_.sorted(); }
  /// After sorting: particles of cell c of tile t are [start(t)[c], start(t)[c + 1]).
  const std::uint32_t* start(std::size_t tile) const { return sort_.start().data() + tile * TileGrid::kCells; }
  bool empty(std::size_t tile) const { return start(tile)[0] == start(tile)[TileGrid::kCells]; }
  std::size_t memoryBytes() const;

 private:
  void findTiles(std::span<const double> x, std::span<const double> y, const CutGrid& grid);
  void addNeighbours(const CutGrid& grid);
  void addWrappedNeighbours(const CutGrid& grid);

  TileGrid tiles_;
  KeySort sort_;
  AlignedArray<std::uint32_t> key_;
  struct Found {
    std::vector<TileIndex> tiles;
    std::vector<std::uint32_t> first;  // key of each tile's first cell
  };
  std::vector<Found> found_;  // by block of particles
  std::vector<TileIndex> wanted_, rows_;
};

}  // namespace froude
