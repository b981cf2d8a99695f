// The coarse level of a pressure solve: one equation a cell, for what sweeps over particles are too slow for.
//
// A Jacobi-like sweep carries pressure one support radius far, so a fluid N particles deep needs sweeps in proportion
// to N². In the continuum the multipliers solve −∇²κ = E (E: excess of density, lengths in spacings); on cells of one
// support radius that is a five-point system with a fifth of the unknowns, in which free surfaces hold κ = 0 and walls
// let nothing pass. Its solution corrects the smooth part of κ, the sweeps after it the rest. A two-level scheme in the
// sense of multigrid (Brandt, Math. Comput. 31 (1977)); the coarse equation is the continuum's, not a projection of the
// fine one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/particles/cell_grid.h>
#include <froude/solver/coupling/obstacles.h>

namespace froude {

/// Memory is reused from step to step. Same bits on any number of threads.
class CoarsePressure {
 public:
  /// Finds the cells that are full (mean density of their particles at least 0.85 of rest) and what separates them. x,
  /// y [m] and density (relative to rest) are in the order of the grid.
  void build(const Obstacles& obstacles, const CollisionFilter& filter, const CellGrid& grid,
             std::span<const std::uint32_t> occupied, const float* density);

  /// Solves for the correction of κ that removes `excess` (per particle; 0 where there is none) and adds it,
  /// interpolated between cell centres, to `correction` (per particle, overwritten). Conjugate gradients until the
  /// residual has fallen to a tenth. Returns the number of iterations.
  int solve(const CellGrid& grid, std::span<const double> x, std::span<const double> y, const float* excess,
            float* correction);

  std::size_t memoryBytes() const;

 private:
  static constexpr std::int32_t kAir = -1, kSolid = -2;
  std::int32_t unknownAt(std::int32_t ix, std::int32_t iy) const;
  void apply(const AlignedArray<double>& in, AlignedArray<double>& out) const;
  double valueAt(std::int32_t ix, std::int32_t iy, double own) const;

  GridFrame frame_;
  AlignedArray<std::int32_t> kind_;      // per cell: number of the unknown, kAir or kSolid
  AlignedArray<std::uint32_t> cells_;    // per unknown: its cell
  AlignedArray<std::int32_t> neighbor_;  // 4 per unknown: unknown, kAir (κ = 0 there) or kSolid (closed)
  AlignedArray<double> solution_, residual_, direction_, product_, diagonal_;
};

}  // namespace froude
