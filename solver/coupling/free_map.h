// How far from an obstacle every place of the domain is, in a byte a cell: what lets most particles fly without a
// query.
#pragma once

#include <cstdint>

#include <froude/base/aligned.h>
#include <froude/solver/coupling/obstacles.h>

namespace froude {

/// Cells over the domain. The value of a cell, times `quantum` [m], is a distance that a disc may travel from the
/// middle of the cell in any direction without touching an obstacle during the sub-step; from another point of the cell
/// it is less by the distance to the middle. A lower bound: it decides which particles are looked at closely, never
/// where they go.
class FreeMap {
 public:
  /// What a loop needs to look a place up: cell (floor((x − originX)·inverse), …), row by row. Places beyond the cells
  /// have no value. Three bytes behind the last cell may be read.
  struct View {
    const std::uint8_t* cells = nullptr;
    double originX = 0.0, originY = 0.0;  // [m]
    double cell = 1.0;                    // side of a cell [m]
    double inverse = 1.0;                 // cells per metre
    double quantum = 0.0;                 // [m]
    int nx = 0, ny = 0;
  };

  /// For discs of `radius` [m]. Finer for more particles: a map must not cost more than they do. Builds the part of
  /// the fixed obstacles when it is called first, when they have changed, or for so many more particles that a finer
  /// map pays; cheap otherwise.
  void prepare(const Obstacles& obstacles, double radius, const CollisionFilter& filter, std::size_t particles);
  /// Enters the moving bodies; once a sub-step, after Obstacles::beginStep. Cost: cells near them; nothing if none.
  void refresh(const Obstacles& obstacles);

  View view() const;
  std::size_t memoryBytes() const { return fixed_.capacity() + all_.capacity(); }

 private:
  template <typename Bound>
  void lower(std::uint8_t* cells, int x, int y, int side, const Bound& bound) const;
  void enterFixed(const Obstacles& obstacles);
  std::uint8_t steps(double distance) const;
  Vec2 center(int x, int y, int side) const;

  Obstacles::Tiles tiles_;
  int perTile_ = 0;       // cells along the side of a tile
  double cell_ = 1.0;     // [m]
  double quantum_ = 1.0;  // [m]
  double margin_ = 0.0;   // radius and a little for rounding [m]
  CollisionFilter filter_;
  std::uint64_t fixedVersion_ = 0;
  bool moving_ = false;
  AlignedArray<std::uint8_t> fixed_, all_;
};

}  // namespace froude
