#include <froude/fields/crossing.h>

#include <froude/fields/distance_field.h>
#include <froude/fields/predicates.h>
#include <froude/fields/world_field.h>

namespace froude {
namespace detail {
namespace {

bool apart(const GridEdge& e, const Vec2& low, const Vec2& high) {
  return std::max(e.a.x(), e.b.x()) < low.x() || std::min(e.a.x(), e.b.x()) > high.x() ||
         std::max(e.a.y(), e.b.y()) < low.y() || std::min(e.a.y(), e.b.y()) > high.y();
}

// True if the piece passes into the solid through the edge, its end left out, its start counted: through its inside, or
// at its start vertex, where `before` is the edge that ends there (null: none). Precondition: their boxes meet.
bool entersThrough(const GridEdge& e, const GridEdge* before, const Vec2& from, const Vec2& to) {
  const int a = orientation(from, to, e.a), b = orientation(from, to, e.b);
  if (a * b > 0) return false;
  if (a * b < 0) return orientation(e.a, e.b, from) <= 0 && orientation(e.a, e.b, to) > 0;
  // The end vertex is the start of the next edge.
  if (a != 0 || before == nullptr || to == e.a || !onSegment(from, to, e.a)) return false;
  // Of the line through the vertex each half is inside the solid's angle or not, whatever its length.
  const auto isInside = [&](const Vec2& p) {
    const bool ofFirst = orientation(before->a, e.a, p) > 0, ofSecond = orientation(e.a, e.b, p) > 0;
    return e.convexStart != 0 ? ofFirst && ofSecond : ofFirst || ofSecond;
  };
  return isInside(to) && (from == e.a || !isInside(from));
}

// The part of the piece that is in the box, as shares of it; false: none.
bool clip(const Box& box, const Vec2& from, const Vec2& to, double* begin, double* end) {
  *begin = 0.0;
  *end = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double way = to[axis] - from[axis];
    if (way == 0.0) {
      if (from[axis] < box.min[axis] || from[axis] > box.max[axis]) return false;
      continue;
    }
    const double first = (box.min[axis] - from[axis]) / way, second = (box.max[axis] - from[axis]) / way;
    *begin = std::max(*begin, std::min(first, second));
    *end = std::min(*end, std::max(first, second));
  }
  return *begin <= *end;
}

// Where the piece meets the edge, to rounding.
Vec2 meetingPoint(const GridEdge& e, const Vec2& from, const Vec2& to) {
  const double before = cross(e.direction, from - e.a), after = cross(e.direction, to - e.a);
  if (before == after) return e.a;  // along the edge, to its start
  return from + std::clamp(before / (before - after), 0.0, 1.0) * (to - from);
}

}  // namespace

std::int32_t enteredEdge(const EdgeGrid& grid, const Vec2& from, const Vec2& to,
                         FunctionRef<bool(std::uint32_t)> accepts) {
  const double length = (to - from).norm();
  if (!(length > 0.0) || !std::isfinite(length)) return -1;
  const bool starts = grid.inGrid(from);
  if (starts && static_cast<double>(grid.clearance()[grid.cellOf(from)]) > length * (1.0 + 1e-12)) return -1;
  double begin = 0.0, end = 1.0;
  if (!(starts && grid.inGrid(to)) && !clip(grid.box(), from, to, &begin, &end)) return -1;
  const std::span<const GridEdge> edges = grid.edges();
  const Vec2 low = from.cwiseMin(to), high = from.cwiseMax(to);
  // What the lists of a place hold is all that comes within the band of it. A little less each time, for rounding.
  const double stride = 0.99 * grid.band();
  for (double at = begin * length; at <= end * length;) {
    const Vec2 place = (from + at / length * (to - from)).cwiseMax(grid.box().min).cwiseMin(grid.box().max);
    const double clearance = static_cast<double>(grid.clearance()[grid.cellOf(place)]);
    if (clearance > stride) {
      at += 0.99 * clearance;
      continue;
    }
    for (const std::uint32_t i : grid.within(place)) {
      const GridEdge& e = edges[i];
      if (apart(e, low, high)) continue;
      const GridEdge* before = e.previous < 0 ? nullptr : &edges[static_cast<std::size_t>(e.previous)];
      if (!entersThrough(e, before, from, to) || !accepts(e.source)) continue;
      // A wall of the domain goes on beyond the grid, past an open side, where it is none.
      if (grid.inGrid(meetingPoint(e, from, to))) return static_cast<std::int32_t>(i);
    }
    at += stride;
  }
  return -1;
}

}  // namespace detail

std::int32_t enteredEdge(const DistanceField& field, const Vec2& from, const Vec2& to) {
  return detail::enteredEdge(field.grid(), from, to, [](std::uint32_t) { return true; });
}

std::int32_t WorldField::enteredEdge(const Vec2& from, const Vec2& to, const CollisionFilter& filter) const {
  return detail::enteredEdge(grid_, from, to, [&](std::uint32_t source) { return accepts(filter, source); });
}

}  // namespace froude
