// Lists of neighbours within a radius, for methods that visit the same pairs many times.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/simd.h>
#include <froude/particles/cell_grid.h>

namespace froude {

/// For each particle the others closer than a radius, both ways (j in the list of i and i in the list of j), in the
/// order of the grid's runs: the same on any number of threads. Compressed rows, in one buffer for each block of
/// kBlockSize particles. Along periodic axes a pair is listed once, through its nearest image: take differences of
/// positions through GridFrame::minimumImage. Allocates only where a build needs more than all before.
class FROUDE_API NeighbourList {
 public:
  /// x, y: positions sorted by `grid` [m] (permuted by its order). Lists pairs with distance < radius + skin: with a
  /// skin, the lists stay complete for `radius` until two particles have together moved by more than `skin`, see
  /// `stillHolds`. Precondition: radius + skin ≤ grid.frame().cellSize.
  /// The lists are the same for all targets.
  void build(const CellGrid& grid, std::span<const double> x, std::span<const double> y, double radius,
             double skin = 0.0, SimdTarget target = bestSimdTarget());

  std::size_t size() const { return count_.size(); }
  double radius() const { return radius_; }
  double skin() const { return skin_; }
  std::span<const std::uint32_t> of(std::size_t i) const {
    const auto& block = blocks_[i / kRowsPerBlock];
    return {block.data() + first_[i], count_[i]};
  }
  /// Entries of all lists: twice the number of pairs.
  std::size_t entryCount() const { return entries_; }
  /// True while no particle is farther than skin/2 from where it was at `build`. x, y in the same order as then.
  bool stillHolds(std::span<const double> x, std::span<const double> y) const;
  std::size_t memoryBytes() const;

 private:
  static constexpr std::size_t kRowsPerBlock = 1024;

  std::vector<AlignedArray<std::uint32_t>> blocks_;
  AlignedArray<std::uint32_t> first_, count_;
  AlignedArray<double> builtX_, builtY_;  ///< positions at build; empty without a skin
  GridFrame frame_;
  double radius_ = 0.0, skin_ = 0.0;
  std::size_t entries_ = 0;
};

}  // namespace froude
