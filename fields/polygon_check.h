// Repair and refusal of rings: what Polygon::make does before a polygon exists. Internal.
#pragma once

#include <string>
#include <vector>

#include <froude/fields/polygon.h>

namespace froude::detail {

using Ring = std::vector<Vec2>;

/// Removes what repeats and what lies in the middle of a straight run; turns the ring to the wanted winding. `name` is
/// how messages call the ring. Throws PolygonError.
void repairRing(Ring* ring, bool counterClockwise, const std::string& name, std::vector<std::string>* notes);

/// Throws PolygonError if any two edges meet other than neighbours at their common vertex, or a hole is not inside.
/// Rings are repaired; the first is the outer one. Cost: near O(n log n).
void refuseCrossings(const std::vector<Ring>& rings);

/// +1 inside, 0 on the boundary, −1 outside of one closed ring. Exact.
int locate(const Vec2* ring, std::size_t count, const Vec2& p);

}  // namespace froude::detail
