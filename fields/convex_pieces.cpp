#include <froude/fields/convex_pieces.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>

#include <froude/fields/predicates.h>
#include <froude/fields/triangulation.h>

namespace froude {
namespace {

constexpr std::int32_t kCut = -1;
constexpr std::uint32_t kNoTwin = 0xFFFFFFFFu;

/// An edge of a piece, the piece on its left.
struct HalfEdge {
  std::uint32_t from = 0, to = 0;
  std::uint32_t next = 0, previous = 0;
  std::uint32_t twin = kNoTwin;  // of a cut: the same edge of the piece beyond
  bool removed = false;
};

/// A cut and the sharpest of the four angles beside it when it was noted.
struct Candidate {
  double angle;
  std::uint32_t half;
  bool operator<(const Candidate& o) const { return angle != o.angle ? angle > o.angle : half > o.half; }
};

class Merger {
 public:
  explicit Merger(const Polygon& polygon) : polygon_(polygon) {
    const std::vector<detail::TriangleCorners> triangles = detail::triangulate(polygon);
    halves_.reserve(3 * triangles.size());
    std::unordered_map<std::uint64_t, std::uint32_t> byEnds;
    for (const detail::TriangleCorners& t : triangles) {
      const auto first = static_cast<std::uint32_t>(halves_.size());
      for (std::uint32_t k = 0; k < 3; ++k) {
        halves_.push_back({t[k], t[(k + 1) % 3], first + (k + 1) % 3, first + (k + 2) % 3});
        byEnds.emplace(key(t[k], t[(k + 1) % 3]), first + k);
      }
    }
    for (HalfEdge& h : halves_)
      if (const auto beyond = byEnds.find(key(h.to, h.from)); beyond != byEnds.end()) h.twin = beyond->second;
  }

  /// Removes cuts, the one with the sharpest angle beside it first, as long as both its ends stay convex.
  void merge() {
    std::priority_queue<Candidate> open;
    const auto note = [&](std::uint32_t h) {
      if (halves_[h].twin != kNoTwin) open.push({sharpest(h), std::min(h, halves_[h].twin)});
    };
    for (std::uint32_t h = 0; h < halves_.size(); ++h)
      if (h < halves_[h].twin) note(h);
    while (!open.empty()) {
      const auto [angle, h] = open.top();
      open.pop();
      // An angle beside a cut only grows, so an old note is too sharp and a newer one is there.
      if (halves_[h].removed || angle != sharpest(h) || !removable(h)) continue;
      const HalfEdge one = halves_[h], two = halves_[one.twin];
      link(one.previous, two.next);
      link(two.previous, one.next);
      halves_[h].removed = halves_[one.twin].removed = true;
      for (const std::uint32_t beside : {one.previous, one.next, two.previous, two.next}) note(beside);
    }
  }

  /// Pieces by the least of their vertices' numbers, which each begins with.
  std::vector<ConvexPiece> pieces() const {
    std::vector<ConvexPiece> result;
    std::vector<bool> seen(halves_.size(), false);
    for (std::uint32_t first = 0; first < halves_.size(); ++first) {
      if (seen[first] || halves_[first].removed) continue;
      std::uint32_t start = first;
      for (std::uint32_t h = halves_[first].next; h != first; h = halves_[h].next)
        if (halves_[h].from < halves_[start].from) start = h;
      ConvexPiece piece;
      std::uint32_t h = start;
      do {
        seen[h] = true;
        piece.vertex.push_back(halves_[h].from);
        piece.outlineEdge.push_back(halves_[h].twin == kNoTwin ? static_cast<std::int32_t>(halves_[h].from) : kCut);
        h = halves_[h].next;
      } while (h != start);
      result.push_back(std::move(piece));
    }
    std::sort(result.begin(), result.end(),
              [](const ConvexPiece& a, const ConvexPiece& b) { return a.vertex < b.vertex; });
    return result;
  }

 private:
  static std::uint64_t key(std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; }
  const Vec2& point(std::uint32_t v) const { return polygon_.vertices()[v]; }

  void link(std::uint32_t h, std::uint32_t next) {
    halves_[h].next = next;
    halves_[next].previous = h;
  }

  /// Of the piece of h, at the start of h [rad].
  double angleAt(const HalfEdge& h) const {
    const Vec2 out = point(h.to) - point(h.from), in = point(halves_[h.previous].from) - point(h.from);
    return std::atan2(std::abs(cross(out, in)), out.dot(in));
  }

  double sharpest(std::uint32_t h) const {
    const HalfEdge &one = halves_[h], &two = halves_[one.twin];
    return std::min({angleAt(one), angleAt(halves_[one.next]), angleAt(two), angleAt(halves_[two.next])});
  }

  /// True if both ends stay convex, or straight, without the cut.
  bool removable(std::uint32_t h) const {
    const HalfEdge &one = halves_[h], &two = halves_[one.twin];
    const auto convex = [&](const HalfEdge& in, const HalfEdge& out) {
      return orientation(point(in.from), point(in.to), point(out.to)) >= 0;
    };
    return convex(halves_[one.previous], halves_[two.next]) && convex(halves_[two.previous], halves_[one.next]);
  }

  const Polygon& polygon_;
  std::vector<HalfEdge> halves_;
};

/// A polygon without reflex vertices and holes needs no search.
bool isConvex(const Polygon& polygon) {
  if (polygon.ringStarts().size() != 2) return false;
  for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i)
    if (!polygon.convexAt(i)) return false;
  return true;
}

}  // namespace

std::vector<Vec2> ConvexPiece::points(const Polygon& polygon) const {
  std::vector<Vec2> points;
  points.reserve(vertex.size());
  for (const std::uint32_t v : vertex) points.push_back(polygon.vertices()[v]);
  return points;
}

std::vector<ConvexPiece> convexPieces(const Polygon& polygon) {
  if (isConvex(polygon)) {
    ConvexPiece whole;
    for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
      whole.vertex.push_back(i);
      whole.outlineEdge.push_back(static_cast<std::int32_t>(i));
    }
    return {whole};
  }
  Merger merger(polygon);
  merger.merge();
  return merger.pieces();
}

}  // namespace froude
