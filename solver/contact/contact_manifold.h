// Where two convex polygons touch, or nearly: one or two points by which a solver keeps them apart.
#pragma once

#include <froude/solver/contact/closest_features.h>

namespace froude {

struct ManifoldPoint {
  Vec2 at{0, 0};            // midway between the two surfaces, in A's frame [m]
  double separation = 0.0;  // along the normal, negative where they overlap [m]
  std::uint32_t id = 0;     // of the features that made it: the same from step to step while they stay
};

struct ContactManifold {
  PairStatus status = PairStatus::Failed;
  std::uint32_t count = 0;  // of points: 0 unless Near or Overlapping; 0 there too for a touch at a seam only
  Vec2 normal{0, 0};        // unit, from A to B, in A's frame
  std::array<ManifoldPoint, 2> points;
};

/// bInA: B's pose in A's frame; margin [m] ≥ 0: pairs nearer than this get points before they touch. Built from the
/// edge of `sat` where they overlap, else straight from the closest features: no second search. Contacts at cuts of a
/// concave polygon are left out. Swapping A and B gives the mirrored answer to rounding.
FROUDE_API ContactManifold contactManifold(const ConvexShape& a, const ConvexShape& b, const Transform& bInA,
                                           double margin, PairCache& cache);

}  // namespace froude
