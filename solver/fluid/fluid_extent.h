// How far a fluid reaches: the length over which its viscosity has to be followed in time.
#pragma once

#include <froude/particles/pool.h>
#include <froude/solver/definitions.h>

namespace froude {

/// The smaller side of the box around particles of that spacing [m]; where x is periodic that of y, and the other way
/// round; of a domain without sides half a period. Cost: O(particles), in parallel.
double smallerExtent(const ParticlePool& pool, const DomainDef& domain, double spacing);

}  // namespace froude
