// Offset curves: all points at one signed distance from a polygon, as straight pieces and arcs.
#pragma once

#include <vector>

#include <froude/base/api.h>
#include <froude/fields/field_sample.h>
#include <froude/fields/polygon.h>

namespace froude {

/// A piece of an offset curve, walked with the solid on its left.
struct FROUDE_API OffsetPiece {
  FeatureKind feature = FeatureKind::Edge;  ///< Edge: straight, parallel to it; StartVertex: an arc about it
  std::uint32_t edge = 0;                   ///< number of the edge or vertex
  Vec2 from{0.0, 0.0}, to{0.0, 0.0};        ///< [m]
  double startAngle = 0.0;                  ///< arcs: direction from the vertex to `from` [rad]
  double sweep = 0.0;                       ///< arcs: counter-clockwise positive, less than π in size [rad]

  /// Its point at u in [0, 1].
  Vec2 at(double u, const Polygon& polygon, double offset) const;
};

/// The points whose signed distance is `offset` [m]: outside for positive, inside for negative, the outline for 0.
/// Exact to rounding: each edge's parallel and each vertex's arc, without what another edge is nearer to, cut at the
/// points where the two distances are equal. Pieces come in the order of the polygon's vertices; empty where nothing is
/// as deep. Throws Error unless `offset` is finite. Cost: O(edges²) tests of boxes, the rest by edges within twice the
/// offset.
FROUDE_API std::vector<OffsetPiece> offsetCurve(const Polygon& polygon, double offset);

}  // namespace froude
