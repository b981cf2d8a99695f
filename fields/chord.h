// First contact of a disc on a straight path with the edges of a grid: the core of every swept query. Internal.
#pragma once

#include <froude/base/parallel.h>
#include <froude/fields/edge_grid.h>

namespace froude::detail {

/// A straight path in the grid's frame. All lengths [m].
struct Chord {
  Vec2 from, to;
  double radius;
  double skin;         ///< how far off the solid a contact is placed; 256 roundings of the largest coordinate
  double floor;        ///< what stays farther from the solid is no contact
  double slack = 0.0;  ///< the true path deviates by up to 4 · slack · t · (1 − t) from the chord at fraction t
};

struct ChordHit {
  bool hit = false;
  double time = 1.0;  ///< fraction of the chord; the true path is free before it
  std::uint32_t edge = 0;
  bool vertex = false;  ///< at the start of `edge`
};

/// The floor of a sweep that starts at `distance` from the solid: most of the skin, or less for a disc that is already
/// closer: then it may stay as close as it is.
inline double floorFor(double radius, double skin, double distance) {
  return std::min(radius + 0.75 * skin, distance - 0.0625 * skin);
}

/// Which sources count; null: all.
using SourceFilter = FunctionRef<bool(std::uint32_t)>;

/// Precondition: the disc does not overlap a solid at the start by more than the skin, and
/// radius + slack + skin ≤ kBandMargin · band. Cost: cells crossed.
///
/// A contact is reported if the disc would come closer to the solid than half the skin (plus slack), and is placed
/// where it comes within the whole skin; a disc that starts closer is reported if it approaches. With radius and slack
/// 0 this last decision is exact. The margins are many times the rounding of the distances they are compared with, so
/// that nothing falls between an edge and its neighbour.
ChordHit firstContact(const EdgeGrid& grid, const Chord& chord, const SourceFilter* accepts = nullptr);

/// Outward normal of the feature that was hit, for a disc centred at `center`.
Vec2 contactNormal(const EdgeGrid& grid, const ChordHit& hit, const Vec2& center);
/// Where the feature touches a disc centred at `center`.
Vec2 contactPoint(const EdgeGrid& grid, const ChordHit& hit, const Vec2& center);

}  // namespace froude::detail
