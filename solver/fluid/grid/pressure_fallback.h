// The pressure system by Eigen's conjugate gradients with an incomplete Cholesky factor: slower than the multigrid's,
// but without a grid under it that could be unlucky.
#pragma once

#include <span>

#include <froude/solver/fluid/grid/closed_regions.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude {

/// Solves A κ = b until no residual is above `tolerance`, from what κ holds on. `inverse`: by place, > 0 for unknowns;
/// b must add up to zero over each closed region. Returns whether it got there. Allocates.
bool solvePressureByFallback(const TileGrid& grid, const PressureCoefficients& coefficients,
                             std::span<const PressureBody> bodies, const ClosedRegions& regions, const float* inverse,
                             const float* b, float tolerance, float* kappa);

}  // namespace froude
