// CutReach: which faces around a part of a cell lie on its side of walls that are thinner than a cell.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <froude/fields/cut_cells.h>

namespace froude {

/// The twelve faces between which velocities in cell (i, j) are interpolated: left faces of (i, j−1), (i+1, j−1), (i,
/// j), (i+1, j), (i, j+1), (i+1, j+1); then bottom faces of (i−1, j), (i, j), (i+1, j), (i−1, j+1), (i, j+1), (i+1,
/// j+1).
struct CutStencil {
  static constexpr std::int32_t kHidden = -1;  ///< closed, or not to be reached within the cells around
  static constexpr std::int32_t kMain = 0;     ///< reached through what is open between the main parts of two cells
  std::int32_t i = 0, j = 0;
  std::int32_t part = -1;               ///< in parts(); −1: the cell is wholly open
  std::array<std::int32_t, 12> face{};  ///< kHidden, kMain, or 1 + an index into edges()
};

/// Stencils of all parts that must not use every open face around them: those split off by a wall, those behind whose
/// walls another part opens to a face. Parts that are not listed use the faces' main openings as they are. A face
/// counts as reached if the part opens to it, or opens to a part of a neighbour that does.
class FROUDE_API CutReach {
 public:
  /// Cost: about 1 µs a listed cell. No allocation in a steady state.
  void build(const CutGrid& grid, const CutCells& cut);

  /// In the order of cells (see CutCells::cells), of each the main part first.
  std::span<const CutStencil> stencils() const { return stencils_; }
  /// Index of the first stencil of the cell or of those behind it. Cost: a binary search.
  std::size_t begin(std::int32_t i, std::int32_t j) const;

 private:
  struct Place {
    std::int32_t i, j, cell, part;  // −1, −1: a cell that is not listed
  };
  struct Step {
    bool open = false;
    std::int32_t face = CutStencil::kHidden;
    Place beyond{0, 0, -1, -1};
  };
  Place neighbour(const Place& at, CutSide side) const;
  Step step(const Place& at, CutSide side) const;
  std::int32_t faceBeyond(const Place& at, CutSide first, CutSide second) const;
  bool mainOpen(std::int32_t i, std::int32_t j, bool vertical) const;
  void consider(const Place& at);

  CutGrid grid_;
  const CutCells* cut_ = nullptr;
  std::vector<CutStencil> stencils_;
  std::vector<std::uint64_t> near_;  // keys of cells that are not listed, beside split ones
};

}  // namespace froude
