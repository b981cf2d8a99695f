// What a lattice of particles is to the kernel and to a wall: constants of a resolution, found once for a fluid.
#pragma once

#include <froude/solver/fluid/kernel.h>

namespace froude {

/// Volume of a particle in kernel units² (a unit is half a support radius), with which a fluid on the square lattice
/// has density 1. ratio: spacing/unit, in (0, 1]; Blend at 1 gives 1, its own norm (kernel.h). Cost: O(1/ratio²).
double latticeVolume(double ratio, kernel::Kind kind);

/// By how much a wall must stand back, in units, for a row of particles half a spacing from it to find density 1: a
/// lattice is not a continuum, and else a block at rest would start over-dense. Closed sums of the square lattice and
/// the half plane; absolute error 1e-7.
double latticeRecession(double ratio, kernel::Kind kind);

}  // namespace froude
