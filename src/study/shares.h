// How the cores of a machine are shared between the runs of a batch.
#pragma once

#include <cstddef>
#include <vector>

namespace froude::study {

/// From as many particles on, a run is worth another thread: below, runs side by side are faster.
inline constexpr std::size_t kParticlesPerThread = 50000;
/// With fewer particles for each, another thread makes a run no faster.
inline constexpr std::size_t kLeastParticlesPerThread = 2000;

/// Cores that a run should have before another is begun beside it, 1 … cores.
int wantedCores(std::size_t particles, int cores);

/// Deals `cores` out to runs with so many particles: one to each, and each further one to the run with the most
/// particles for each of its cores, unless it is too small to use it. More runs than cores: one each all the same.
std::vector<int> dealCores(const std::vector<std::size_t>& particles, int cores);

}  // namespace froude::study
