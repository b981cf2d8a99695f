// The loop behind EdgeSieve: drops the edges of one outline that are nowhere in a box the nearest. Internal.
#pragma once

#include <cstdint>
#include <vector>

#include <froude/base/simd.h>
#include <froude/fields/grid_edge.h>

namespace froude::detail {

/// Edges of one outline, and what their distances are compared with.
struct SieveTask {
  const GridEdge* edges;
  const std::uint32_t* candidates;
  std::size_t count;  // > 0
  Box box;
  double rounding;  // [m], see EdgeGrid::rounding
  bool exact;       // false: a bound of the least distance will do
};

struct SieveResult {
  std::size_t kept;  // > 0
  double least;      // distance of the box's nearest point to the outline, or a bound below it [m]
  double most;       // no point of the box is farther [m]
};

/// Writes the edges that can be the nearest to a point of the box to `kept` (room for `count`), in order. `squares` is
/// scratch for 4 · count numbers. The bits are the same for all targets.
///
/// For two points p and q, |x − p|² − |x − q|² is linear in x, so if an edge is farther than q from all corners of the
/// box, each of its points is, everywhere in it. The points q tried are those of the outline that are closest to the
/// corners and to the centre.
using SieveLoop = SieveResult (*)(const SieveTask& task, double* squares, std::uint32_t* kept);

/// The loop of a target; Scalar has that of the oldest processors, two lanes.
SieveLoop sieveLoop(SimdTarget target);

/// Squared distance of the nearest point of a box to an edge [m²], 0 if it passes within a rounding.
double squaredDistance(const GridEdge& edge, const Box& box, double rounding);

/// Share by which an edge must be farther to be dropped: many times what rounding can do to a squared distance.
inline constexpr double kSieveSlack = 1e-9;

}  // namespace froude::detail
