#include <froude/fields/chord.h>

#include <array>
#include <utility>

#include <froude/fields/predicates.h>

namespace froude::detail {
namespace {

/// A part of the path.
struct Interval {
  double begin = 0.0;
  double end = 1.0;

  /// Keeps where value + t · slope ≤ 0; false if nothing is left.
  bool keepBelow(double value, double slope) {
    if (value > 0.0 && slope >= 0.0) return false;
    if (value > 0.0) begin = std::max(begin, -value / slope);
    if (value <= 0.0 && slope > 0.0) end = std::min(end, -value / slope);
    return begin <= end;
  }
};

/// Tests one path against one feature after the other and keeps the earliest contact.
class ContactSearch {
 public:
  ContactSearch(const EdgeGrid& grid, const Chord& chord)
      : grid_(grid),
        from_(chord.from),
        to_(chord.to),
        path_(chord.to - chord.from),
        reach_(chord.radius + chord.slack + chord.skin),
        near_(chord.floor + chord.slack),
        floor_(chord.floor),
        skin_(chord.skin),
        rounding_(0.0625 * chord.skin),
        slack_(chord.slack),
        curved_(chord.slack > rounding_),
        exact_(chord.radius == 0.0 && chord.slack == 0.0 && chord.floor < 0.5 * chord.skin) {}

  const ChordHit& best() const { return best_; }
  double reach() const { return reach_; }

  void test(std::uint32_t index) {
    const GridEdge& e = grid_.edges()[index];
    const Vec2 arm = from_ - e.a;
    const double sFrom = -cross(e.direction, arm);  // outwards
    const double sPath = -cross(e.direction, path_);
    if (sFrom > reach_ && sFrom + sPath > reach_) return;  // outside this edge's line all the way, so of its start too
    testEdge(index, e, arm, sFrom, sPath);
    if (e.convexStart != 0 && !exact_) testStart(index, e, arm);
  }

  /// What must not happen, a path that gets deep inside without a contact, ends where it is.
  void stopAt(double time, std::uint32_t edge) { keep({true, time, edge, false}); }

 private:
  void keep(const ChordHit& hit) {
    if (!best_.hit || hit.time < best_.time || (hit.time == best_.time && hit.edge < best_.edge)) best_ = hit;
  }

  /// True if the true path, where the chord is at `distance` from a feature and leaves it faster than they can part, is
  /// not below the floor already: a feature that is met on the way, not at the start, may have been passed by then.
  bool staysOff(double distance, double time) const { return distance - 4.0 * slack_ * time * (1.0 - time) >= floor_; }

  /// The part of the path over the edge's own strip. At a concave vertex, which no disc can touch, the strip is a skin
  /// longer, so that nothing slips between it and its neighbour's.
  void testEdge(std::uint32_t index, const GridEdge& e, const Vec2& arm, double sFrom, double sPath) {
    const double low = e.convexStart != 0 ? 0.0 : -skin_;
    const double high = e.length + (e.convexEnd != 0 ? 0.0 : skin_);
    const double along = e.direction.dot(arm);
    const double step = e.direction.dot(path_);
    Interval part;
    if (!part.keepBelow(low - along, -step) || !part.keepBelow(along - high, step)) return;
    const double sBegin = sFrom + part.begin * sPath;
    const double sEnd = sFrom + part.end * sPath;
    if (sBegin < -skin_) return;  // from behind: the path enters, if it does, elsewhere
    if (exact_) {
      const bool deeper = sBegin < 0.0 && sEnd < sBegin - rounding_ && orientation(e.a, e.b, from_) > 0;
      if (!deeper && !crossesExactly(index, e)) return;
    } else if (curved_) {
      if (sBegin > reach_ ? sEnd >= reach_ : sPath >= 4.0 * slack_ && staysOff(sBegin, part.begin)) return;
    } else if (sEnd >= near_) {
      return;
    }
    const double into = sBegin > reach_ ? (sBegin - reach_) / (sBegin - sEnd) : 0.0;
    keep({true, part.begin + into * (part.end - part.begin), index, false});
  }

  /// The convex vertex at the start of the edge, over the part of the path that lies beyond both of its edges' strips.
  /// That part is taken a rounding wider than it is, so that nothing slips between.
  void testStart(std::uint32_t index, const GridEdge& e, const Vec2& arm) {
    const GridEdge& before = grid_.edges()[static_cast<std::size_t>(e.previous)];
    Interval part;
    if (!part.keepBelow(e.direction.dot(arm) - rounding_, e.direction.dot(path_)) ||
        !part.keepBelow(-before.direction.dot(arm) - rounding_, -before.direction.dot(path_))) {
      return;
    }
    const Vec2 armBegin = arm + part.begin * path_;
    const double begin = armBegin.norm();
    const double length = path_.norm();
    if (length == 0.0) return;
    const double derivative = armBegin.dot(path_) / length;
    if (begin <= reach_ && curved_) {
      if (derivative * length < 4.0 * slack_ || !staysOff(begin, part.begin)) keep({true, part.begin, index, true});
      return;
    }
    const double passing = std::abs(cross(path_, arm)) / length;
    const double passingTime = -arm.dot(path_) / (length * length);
    double closest = begin;
    if (derivative < 0.0) closest = passingTime <= part.end ? passing : (arm + part.end * path_).norm();
    if (begin > reach_) {
      if (closest >= (curved_ ? reach_ : near_)) return;
      const double half = std::sqrt(std::max(0.0, (reach_ - passing) * (reach_ + passing))) / length;
      keep({true, std::clamp(passingTime - half, part.begin, part.end), index, true});
    } else if (closest < near_) {
      keep({true, part.begin, index, true});
    }
  }

  /// True if the path passes from outside, or from the boundary, through this edge or one of its ends to the inside.
  bool crossesExactly(std::uint32_t index, const GridEdge& e) const {
    if (orientation(e.a, e.b, from_) > 0 || orientation(e.a, e.b, to_) <= 0) return false;
    const int start = orientation(from_, to_, e.a);
    const int end = orientation(from_, to_, e.b);
    if (start * end > 0) return false;
    if (start == 0 && e.convexStart != 0) {
      return orientation(grid_.edges()[static_cast<std::size_t>(e.previous)].a, e.a, to_) > 0;
    }
    if (end == 0 && e.convexEnd != 0) {
      return orientation(e.b, grid_.edges()[static_cast<std::size_t>(grid_.next(index))].b, to_) > 0;
    }
    return true;
  }

  const EdgeGrid& grid_;
  const Vec2 from_, to_, path_;
  const double reach_;  // contacts are placed at this distance
  const double near_;   // what stays farther is no contact
  const double floor_;  // the same of the true path
  const double skin_, rounding_, slack_;
  const bool curved_;
  const bool exact_;  // a point that starts in contact: only what really crosses an edge counts
  ChordHit best_;
};

/// Fractions of the path within the box; empty (first > second) if it misses it.
std::pair<double, double> clip(const Vec2& from, const Vec2& path, const Box& box) {
  double begin = 0.0;
  double end = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    if (path[axis] == 0.0) {
      if (from[axis] < box.min[axis] || from[axis] > box.max[axis]) return {1.0, 0.0};
      continue;
    }
    const double t0 = (box.min[axis] - from[axis]) / path[axis];
    const double t1 = (box.max[axis] - from[axis]) / path[axis];
    begin = std::max(begin, std::min(t0, t1));
    end = std::min(end, std::max(t0, t1));
  }
  return {begin, end};
}

/// Fraction at which the path leaves the block of `span` cells round column i, row j.
double exitTime(const EdgeGrid& grid, const Chord& chord, int i, int j, int span) {
  const Vec2 path = chord.to - chord.from;
  double time = kInfinity;
  const std::array<int, 2> block{i / span * span, j / span * span};
  for (int axis = 0; axis < 2; ++axis) {
    if (path[axis] == 0.0) continue;
    const int side = block[static_cast<std::size_t>(axis)] + (path[axis] > 0.0 ? span : 0);
    time = std::min(time, (grid.origin()[axis] + side * grid.cellSize() - chord.from[axis]) / path[axis]);
  }
  return time;
}

}  // namespace

ChordHit firstContact(const EdgeGrid& grid, const Chord& chord, const SourceFilter* accepts) {
  ContactSearch search(grid, chord);
  const Vec2 path = chord.to - chord.from;
  const auto [enter, leave] = clip(chord.from, path, grid.box());
  const double length = path.norm();
  const double perMetre = length > 0.0 ? 1.0 / length : 0.0;
  // A little over the border of a cell; cells know their surroundings ten times as far.
  const double nudge = std::max(1e-7 * grid.cellSize() * perMetre, 0x1p-51);
  double time = enter;
  while (time <= leave) {
    const Vec2 at = chord.from + time * path;
    const int i = grid.column(at.x());
    const int j = grid.row(at.y());
    const std::size_t cell = grid.cellOf(at);
    double exit = exitTime(grid, chord, i, j, accepts == nullptr ? 1 : grid.coarseness());
    const double clearance = static_cast<double>(grid.clearance()[cell]);
    if (clearance > search.reach()) {
      exit = std::max(exitTime(grid, chord, i, j, 1), time + (clearance - search.reach()) * perMetre);
    } else if (accepts != nullptr) {
      for (const std::uint32_t e : grid.within(at)) {
        if ((*accepts)(grid.edges()[e].source)) search.test(e);
      }
    } else if (grid.nearest(cell).empty()) {
      if (clearance < 0.0) search.stopAt(time, static_cast<std::uint32_t>(std::max(0, grid.sampleExact(at).edge)));
    } else {
      for (const std::uint32_t e : grid.nearest(cell)) search.test(e);
    }
    if (search.best().hit && search.best().time <= exit) break;
    time = std::max(exit, time) + nudge;
  }
  return search.best();
}

Vec2 contactNormal(const EdgeGrid& grid, const ChordHit& hit, const Vec2& center) {
  const GridEdge& e = grid.edges()[hit.edge];
  if (!hit.vertex) return e.normal();
  const Vec2 arm = center - e.a;
  const double length = arm.norm();
  return length > 0.0 ? Vec2(arm / length) : e.normal();
}

Vec2 contactPoint(const EdgeGrid& grid, const ChordHit& hit, const Vec2& center) {
  const GridEdge& e = grid.edges()[hit.edge];
  if (hit.vertex) return e.a;
  const double along = std::clamp(e.direction.dot(center - e.a), 0.0, e.length);
  return e.a + along * e.direction;
}

}  // namespace froude::detail
