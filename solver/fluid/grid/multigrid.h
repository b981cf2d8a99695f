// The levels under a pressure system, and the cycle over them that preconditions its iterations.
//
// Cells are joined 2 × 2 from level to level until none is coupled to another. A coarse face's coefficient is the mean
// of the fine ones, so that walls stay closed however thin they are (Weber, Mueller-Roemer, Stork & Fellner, Comput.
// Graph. Forum 34 (2015)); a coarse cell is tied to κ = 0 nearly as strongly as its cells together. Corrections are
// constant over a coarse cell, sweeps are Chebyshev's polynomial in D⁻¹A: the cycle is symmetric, as conjugate
// gradients demand.
#pragma once

#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/base/crew.h>
#include <froude/fields/tile_grid.h>
#include <froude/solver/fluid/grid/grid_loops.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude {

/// One level's matrix, and the arrays that its sweeps need. The finest has places beyond its tiles for extra unknowns.
struct GridLevel {
  TileGrid own;                    // of all but the finest
  const TileGrid* grid = nullptr;  // the finest's is the user's
  AlignedArray<TileLinks> links;
  AlignedArray<TileParent> parents;    // into the next level
  AlignedArray<float> ax, ay, ground;  // of all but the finest
  AlignedArray<float> ar, diagonal, inverse;
  AlignedArray<float> r, one, two;
  AlignedArray<double> sums;  // by tile
  bool coupled = false;       // any two cells
  GridOperator matrix;

  std::size_t tiles() const { return grid->size() + 1; }
};

class Multigrid {
 public:
  explicit Multigrid(const GridLoops& loops) : loops_(&loops) {}

  /// References to grid and coefficients are kept.
  void build(const TileGrid& grid, const PressureCoefficients& coefficients);

  const GridLevel& finest() const { return levels_.front(); }
  GridLevel& finest() { return levels_.front(); }
  std::size_t extra() const { return coefficients_->ground.size() - finest().grid->values(); }

  /// The weight of the first sweep, whose result from κ = 0, weight·D⁻¹r, `cycle` finds in finest().one.
  float firstWeight(std::size_t level = 0) const;
  /// Preconditions the residual r: returns where the result is (finest().one or two). Leaves r·result in `product`.
  const float* cycle(Crew& crew, const float* r, double& product);

  /// q = A x of the finest level; returns x·q.
  double apply(Crew& crew, const float* x, float* q);
  /// r = b − A x of the finest level.
  void residual(Crew& crew, const float* b, const float* x, float* r);

  std::size_t memoryBytes() const;

 private:
  void finish(GridLevel& level, const AlignedArray<float>& ax, const AlignedArray<float>& ay,
              const AlignedArray<float>& ground);
  void addEdges();
  void coarsen(GridLevel& fine, GridLevel& coarse);
  void findAnchors();
  void joinExtras(GridLevel& coarse) const;
  const float* visit(Crew& crew, std::size_t k, const float* r, double* product);
  void correct(Crew& crew, std::size_t k, const float* r, float* x);
  void restrictExtras(const float* r, const float* x);
  std::size_t parentOf(std::size_t cell) const;
  double smooth(Crew& crew, GridLevel& level, const float* r, const float* x, float weight, float* out, bool sum);

  const GridLoops* loops_;
  const PressureCoefficients* coefficients_ = nullptr;
  std::vector<GridLevel> levels_;
  std::size_t used_ = 0;
  AlignedArray<TileIndex> indices_;
  AlignedArray<std::uint32_t> anchors_;  // by extra: the cell with which it is corrected; in the null tile: none
};

}  // namespace froude
