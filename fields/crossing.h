// Does a straight piece of a path enter a solid? Decided by exact orientation: independent of the swept query, whose
// answers it certifies.
#pragma once

#include <froude/base/api.h>
#include <froude/base/parallel.h>
#include <froude/base/types.h>

namespace froude {

class DistanceField;

namespace detail {

class EdgeGrid;

/// The first edge in the order of the search, of a source that `accepts` says, through which the piece enters.
FROUDE_API std::int32_t enteredEdge(const EdgeGrid& grid, const Vec2& from, const Vec2& to,
                                    FunctionRef<bool(std::uint32_t)> accepts);

}  // namespace detail

/// Number of an edge through which the straight piece from → to [m, the polygon's own frame] enters the polygon from
/// outside or from its boundary; −1: none. Exact: running along an edge, touching it or a vertex, ending on the
/// boundary and leaving are no entries. Every entry inside the field's grid is found; of several any one is told. No
/// allocation. Cost: one look-up where the field's clearance proves the piece free, else the edges within the band
/// along it.
FROUDE_API std::int32_t enteredEdge(const DistanceField& field, const Vec2& from, const Vec2& to);

}  // namespace froude
