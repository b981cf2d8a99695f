// The flight of bullets that meet nothing: the loop over all of them, which most never leave.
#pragma once

#include <cstddef>
#include <cstdint>

#include <froude/base/simd.h>
#include <froude/base/types.h>
#include <froude/solver/coupling/free_map.h>

namespace froude {

/// One sub-step of flight under constant gravity.
struct Flight {
  double* x = nullptr;  // columns [m], [m/s]
  double* y = nullptr;
  double* vx = nullptr;
  double* vy = nullptr;
  double dt = 0.0;          // [s]
  Vec2 halfKick{0.0, 0.0};  // gravity · dt/2 [m/s]
  FreeMap::View map;
  Box domain;  // [m]
};

/// True if a bullet is out of the domain or on the upper side of a periodic axis, where its image is in.
inline bool hasLeft(const Box& domain, double x, double y) {
  return !(x >= domain.min.x() && x < domain.max.x() && y >= domain.min.y() && y < domain.max.y());
}

/// What became of the bullets of a block.
struct FlightResult {
  std::size_t near = 0;  // bullets that were not moved, because the map does not prove their path free
  bool left = false;     // one of the others has left, see hasLeft
};

/// Moves the bullets [begin, end) whose path the map proves free: v += halfKick, x += dt·v, v += halfKick. The indices
/// of the others, in order, go to `near` (room for end − begin). A path is proven by steps, each as long as the map's
/// value at its place; a bullet that is not finite is never proven free. The bits are the same for all targets.
/// Columns must be readable and writable up to a whole vector behind `end` (AlignedArray); other blocks are not
/// touched.
using FlyLoop = FlightResult (*)(const Flight& flight, std::size_t begin, std::size_t end, std::uint32_t* near);

/// Plain C++: the oracle of the wide versions.
FlightResult flyScalar(const Flight& flight, std::size_t begin, std::size_t end, std::uint32_t* near);
/// The loop of a target; that of Scalar is `flyScalar`.
FlyLoop flyLoop(SimdTarget target);

/// Steps along a path before the exact query is asked instead.
inline constexpr int kFlightSteps = 6;

}  // namespace froude
