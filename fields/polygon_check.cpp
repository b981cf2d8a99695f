#include <algorithm>
#include <array>
#include <sstream>

#include <froude/fields/polygon_check.h>
#include <froude/fields/predicates.h>

namespace froude::detail {
namespace {

using Reason = PolygonError::Reason;

std::string text(const Vec2& p) {
  std::ostringstream out;
  out.precision(17);
  out << '(' << p.x() << ", " << p.y() << ')';
  return out.str();
}

/// A vertex and the number it had in the caller's list, so that messages still point there after repairs.
struct Numbered {
  Vec2 point;
  std::size_t index;
};

void note(std::vector<std::string>* notes, const std::string& line) {
  if (notes != nullptr) notes->push_back(line);
}

std::vector<Numbered> withoutRepeats(const Ring& ring, const std::string& name, std::vector<std::string>* notes) {
  std::vector<Numbered> kept;
  kept.reserve(ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (!kept.empty() && kept.back().point == ring[i]) {
      note(notes, name + ": vertex " + std::to_string(i) + " repeats the one before it and was left out");
    } else {
      kept.push_back({ring[i], i});
    }
  }
  while (kept.size() > 1 && kept.back().point == kept.front().point) {
    note(notes,
         name + ": the closing vertex " + std::to_string(kept.back().index) + " repeats the first and was left out");
    kept.pop_back();
  }
  return kept;
}

/// Drops vertices exactly in the middle of straight runs. A vertex at which the outline turns back on itself stays: the
/// search for crossings cannot see it, so it is refused here.
std::vector<Numbered> withoutStraights(const std::vector<Numbered>& ring, const std::string& name,
                                       std::vector<std::string>* notes) {
  const std::size_t n = ring.size();
  std::vector<Numbered> kept;
  kept.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& before = ring[(i + n - 1) % n].point;
    const Vec2& here = ring[i].point;
    const Vec2& after = ring[(i + 1) % n].point;
    if (orientation(before, here, after) != 0) {
      kept.push_back(ring[i]);
    } else if (onSegment(before, after, here)) {
      note(notes, name + ": vertex " + std::to_string(ring[i].index) + " lies on a straight run and was left out");
    } else {
      throw PolygonError(Reason::SelfCrossing, name + " turns back on itself at vertex " +
                                                   std::to_string(ring[i].index) + ' ' + text(here) +
                                                   "; leave the spike of no width out");
    }
  }
  return kept;
}

bool allOnOneLine(const std::vector<Numbered>& ring) {
  return std::all_of(ring.begin(), ring.end(),
                     [&](const Numbered& v) { return orientation(ring[0].point, ring[1].point, v.point) == 0; });
}

/// Winding by the turn at the lowest of the leftmost vertices, which is convex: exact, unlike the sign of a summed
/// area.
bool turnsLeft(const Ring& ring) {
  const auto lowest = std::min_element(ring.begin(), ring.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  const auto i = static_cast<std::size_t>(lowest - ring.begin());
  const std::size_t n = ring.size();
  return orientation(ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]) > 0;
}

}  // namespace

void repairRing(Ring* ring, bool counterClockwise, const std::string& name, std::vector<std::string>* notes) {
  for (std::size_t i = 0; i < ring->size(); ++i) {
    if (!(*ring)[i].allFinite()) {
      throw PolygonError(Reason::NonFinite,
                         name + ": vertex " + std::to_string(i) + ' ' + text((*ring)[i]) + " is not finite");
    }
  }
  std::vector<Numbered> kept = withoutRepeats(*ring, name, notes);
  if (kept.size() < 3) {
    throw PolygonError(Reason::TooFewVertices, name + " has " + std::to_string(kept.size()) +
                                                   " different vertices; a polygon needs at least 3");
  }
  if (allOnOneLine(kept)) {
    throw PolygonError(Reason::ZeroArea, name + " has no area: all of its vertices lie on the line from " +
                                             text(kept[0].point) + " through " + text(kept[1].point));
  }
  kept = withoutStraights(kept, name, notes);
  ring->resize(kept.size());
  std::transform(kept.begin(), kept.end(), ring->begin(), [](const Numbered& v) { return v.point; });
  if (turnsLeft(*ring) != counterClockwise) {
    std::reverse(ring->begin(), ring->end());
    note(notes, name + (counterClockwise ? " ran clockwise and was turned round"
                                         : " ran counter-clockwise and was turned round"));
  }
}

int locate(const Vec2* ring, std::size_t count, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0, j = count - 1; i < count; j = i++) {
    const Vec2& a = ring[j];
    const Vec2& b = ring[i];
    if ((a.y() > p.y()) == (b.y() > p.y())) {
      if (a.y() == p.y() && b.y() == p.y() && onSegment(a, b, p)) return 0;
      if (b == p) return 0;
      continue;
    }
    const int side = orientation(a, b, p);
    if (side == 0) return 0;
    if ((side > 0) == (b.y() > a.y())) inside = !inside;
  }
  return inside ? 1 : -1;
}

namespace {

/// All edges of all rings under a binary tree of boxes over their order: neighbours along an outline are neighbours in
/// space, so no sorting is needed.
class CrossingSearch {
 public:
  explicit CrossingSearch(const std::vector<Ring>& rings) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const std::size_t n = rings[r].size();
      for (std::size_t i = 0; i < n; ++i) edges_.push_back({rings[r][i], rings[r][(i + 1) % n], r, i, n});
    }
    leaves_ = 1;
    while (leaves_ < edges_.size()) leaves_ *= 2;
    boxes_.resize(2 * leaves_);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      boxes_[leaves_ + i].include(edges_[i].a);
      boxes_[leaves_ + i].include(edges_[i].b);
    }
    for (std::size_t i = leaves_ - 1; i > 0; --i) {
      boxes_[i] = boxes_[2 * i];
      boxes_[i].include(boxes_[2 * i + 1]);
    }
  }

  void refuse() const { within(1); }

 private:
  struct Edge {
    Vec2 a, b;
    std::size_t ring, index, count;
  };

  void within(std::size_t node) const {
    if (node >= leaves_ || boxes_[node].empty()) return;
    within(2 * node);
    within(2 * node + 1);
    between(2 * node, 2 * node + 1);
  }

  void between(std::size_t left, std::size_t right) const {
    if (!boxes_[left].overlaps(boxes_[right])) return;
    if (left >= leaves_) {
      compare(edges_[left - leaves_], edges_[right - leaves_]);
      return;
    }
    for (const std::size_t l : {2 * left, 2 * left + 1}) {
      for (const std::size_t r : {2 * right, 2 * right + 1}) between(l, r);
    }
  }

  static void compare(const Edge& e, const Edge& f) {
    if (e.ring == f.ring && (f.index == e.index + 1 || (e.index == 0 && f.index + 1 == f.count))) return;
    const SegmentContact contact = segmentContact(e.a, e.b, f.a, f.b);
    if (contact == SegmentContact::None) return;
    const bool touching = contact == SegmentContact::Touching;
    const std::string verb = touching ? " touches " : " crosses ";
    if (e.ring == f.ring) {
      throw PolygonError(Reason::SelfCrossing, ringName(e.ring) + verb + "itself: " + text(e) + verb + text(f) +
                                                   "; an outline must be simple");
    }
    const Reason crossing = e.ring == 0 ? Reason::HoleOutside : Reason::HolesOverlap;
    throw PolygonError(touching ? Reason::HoleTouching : crossing,
                       ringName(f.ring) + verb + ringName(e.ring) + ": " + text(e) + verb + text(f) +
                           "; a hole must lie wholly inside, apart from other holes");
  }

  static std::string ringName(std::size_t ring) {
    return ring == 0 ? std::string("the outer ring") : "hole " + std::to_string(ring - 1);
  }

  static std::string text(const Edge& e) { return "the edge from " + detail::text(e.a) + " to " + detail::text(e.b); }

  std::vector<Edge> edges_;
  std::vector<Box> boxes_;
  std::size_t leaves_ = 1;
};

Box boundsOf(const Ring& ring) {
  Box box;
  for (const Vec2& p : ring) box.include(p);
  return box;
}

}  // namespace

void refuseCrossings(const std::vector<Ring>& rings) {
  CrossingSearch(rings).refuse();
  std::vector<Box> boxes(rings.size());
  std::transform(rings.begin(), rings.end(), boxes.begin(), boundsOf);
  for (std::size_t h = 1; h < rings.size(); ++h) {
    // Rings do not meet, so one vertex tells where the whole ring lies.
    const Vec2& p = rings[h].front();
    const std::string name = "hole " + std::to_string(h - 1);
    if (locate(rings[0].data(), rings[0].size(), p) < 0) {
      throw PolygonError(Reason::HoleOutside, name + " with vertex " + text(p) + " lies outside the outer ring");
    }
    for (std::size_t other = 1; other < rings.size(); ++other) {
      if (other == h || !boxes[other].contains(p) || locate(rings[other].data(), rings[other].size(), p) < 0) continue;
      throw PolygonError(Reason::HolesOverlap, name + " lies inside hole " + std::to_string(other - 1) +
                                                   "; an island in a hole is a polygon of its own");
    }
  }
}

}  // namespace froude::detail
