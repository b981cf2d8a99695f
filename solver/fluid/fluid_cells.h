// The cells of a fluid: a frame around the particles, and the list of cells that hold any.
#pragma once

#include <span>
#include <vector>

#include <froude/particles/cell_grid.h>
#include <froude/solver/definitions.h>

namespace froude {

/// A frame of cells of at least `cellSize` [m] around the positions, on the lattice of cells that starts at the
/// domain's corner; along periodic axes the whole period. Work and memory follow the fluid, not the domain; where a
/// stray particle would make it too many cells (more than 16 a particle and 65,536), the cells are larger.
GridFrame fluidFrame(const DomainDef& domain, std::span<const double> x, std::span<const double> y, double cellSize);

/// Cells that hold particles, in order. Reuses the memory of `cells`.
void findOccupiedCells(const CellGrid& grid, std::vector<std::uint32_t>& cells);

}  // namespace froude
