// The regions of a pressure system in which nothing says where zero is: connected unknowns without ground. The matrix
// is singular on each; right-hand sides must add up to zero there, and solutions are free by a constant.
#pragma once

#include <cstdint>

#include <froude/base/aligned.h>
#include <froude/fields/tile_grid.h>
#include <froude/solver/fluid/grid/grid_loops.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude {

class ClosedRegions {
 public:
  /// `inverse`: by place, > 0 for unknowns. Rows of cells that hang together are joined by union-find; cost a few
  /// nanoseconds a run of cells, without allocation in a steady state. Regions are numbered by their first cell.
  void find(const GridLoops& loops, const TileGrid& grid, const PressureCoefficients& coefficients,
            const float* inverse, std::span<const PressureBody> bodies);

  int count() const { return static_cast<int>(sizes_.size()); }
  /// Subtracts its mean from each region; returns the largest |mean|. Sums run in the order of places.
  float removeMeans(float* field) const;
  /// The first place of a region.
  std::uint32_t first(int region) const { return firsts_[static_cast<std::size_t>(region)]; }

 private:
  struct Run {
    std::uint32_t place, length;
  };
  struct Piece {
    std::uint32_t place, length, region;
  };
  std::uint32_t runOf(std::size_t place) const;
  std::uint32_t root(std::uint32_t run);
  void join(std::uint32_t a, std::uint32_t b);
  void findBits(const GridLoops& loops, const TileGrid& grid, const PressureCoefficients& coefficients,
                const float* inverse);
  void findRuns(const TileGrid& grid, const PressureCoefficients& coefficients, const float* inverse);
  void joinRows(const TileGrid& grid);
  void groundBodies(std::span<const PressureBody> bodies);
  void listRegions();

  // By row of a tile, a bit for each column: unknowns, coupled to the left, coupled below, grounded.
  AlignedArray<std::uint16_t> known_, left_, down_, ground_;
  AlignedArray<Run> runs_;
  AlignedArray<std::uint32_t> parent_;
  AlignedArray<std::uint8_t> grounded_;    // by run, then by root
  AlignedArray<std::uint32_t> rowFirst_;   // by row of a tile: its first run
  AlignedArray<std::uint16_t> rowStarts_;  // and a bit for each column in which a run begins
  std::size_t extraBase_ = 0;              // places
  std::uint32_t extraFirst_ = 0;           // run of the first extra unknown
  AlignedArray<std::uint32_t> region_;     // by root
  AlignedArray<Piece> pieces_;
  AlignedArray<double> sizes_, push_;
  mutable AlignedArray<double> sums_;
  AlignedArray<std::uint32_t> firsts_;
};

}  // namespace froude
