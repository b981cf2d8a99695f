// Slow, simple, independent answers about polygons: every edge, wide arithmetic, none of the code under test.
#pragma once

#include <span>
#include <vector>

#include <froude/fields/polygon.h>

namespace froude::test {

__extension__ typedef __float128 Wide;  // 113 bits: products of differences of like-sized doubles are exact

/// Sign of the area of a, b, c. In long double where that is certain, else in 113 bits.
inline int side(const Vec2& a, const Vec2& b, const Vec2& c) {
  const long double l = (static_cast<long double>(a.x()) - c.x()) * (static_cast<long double>(b.y()) - c.y());
  const long double r = (static_cast<long double>(a.y()) - c.y()) * (static_cast<long double>(b.x()) - c.x());
  const long double d = l - r;
  if (std::abs(d) > 1e-17L * (std::abs(l) + std::abs(r))) return d > 0 ? 1 : -1;
  const Wide wl = (static_cast<Wide>(a.x()) - c.x()) * (static_cast<Wide>(b.y()) - c.y());
  const Wide wr = (static_cast<Wide>(a.y()) - c.y()) * (static_cast<Wide>(b.x()) - c.x());
  return wl > wr ? 1 : (wl < wr ? -1 : 0);
}

struct OracleEdge {
  Vec2 a, b;
};

inline std::vector<OracleEdge> oracleEdges(const Polygon& polygon) {
  std::vector<OracleEdge> edges;
  const std::span<const std::uint32_t> rings = polygon.ringStarts();
  for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
    for (std::uint32_t i = rings[r]; i < rings[r + 1]; ++i) {
      edges.push_back({polygon.vertices()[i], polygon.vertices()[i + 1 < rings[r + 1] ? i + 1 : rings[r]]});
    }
  }
  return edges;
}

/// +1 inside, 0 on the boundary, −1 outside: crossings of a ray to the right.
inline int whereIs(std::span<const OracleEdge> edges, const Vec2& p) {
  int crossings = 0;
  for (const OracleEdge& e : edges) {
    const Vec2& low = e.a.y() <= e.b.y() ? e.a : e.b;
    const Vec2& high = e.a.y() <= e.b.y() ? e.b : e.a;
    if (p.y() < low.y() || p.y() > high.y()) continue;
    const int s = side(low, high, p);
    if (s == 0 && p.x() >= std::min(low.x(), high.x()) && p.x() <= std::max(low.x(), high.x())) return 0;
    if (p.y() < high.y() && s > 0) ++crossings;
  }
  return crossings % 2 == 1 ? 1 : -1;
}

/// Distance from p to the segment.
inline long double segmentDistance(const OracleEdge& e, const Vec2& p) {
  const long double ux = static_cast<long double>(e.b.x()) - e.a.x();
  const long double uy = static_cast<long double>(e.b.y()) - e.a.y();
  const long double px = static_cast<long double>(p.x()) - e.a.x();
  const long double py = static_cast<long double>(p.y()) - e.a.y();
  const long double t = std::clamp((px * ux + py * uy) / (ux * ux + uy * uy), 0.0L, 1.0L);
  if (t > 0.0L && t < 1.0L) return std::abs(ux * py - uy * px) / std::hypot(ux, uy);
  return std::hypot(px - t * ux, py - t * uy);
}

inline long double boundaryDistance(std::span<const OracleEdge> edges, const Vec2& p) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const OracleEdge& e : edges) best = std::min(best, segmentDistance(e, p));
  return best;
}

/// Signed distance, negative inside.
inline long double signedDistance(std::span<const OracleEdge> edges, const Vec2& p) {
  const long double d = boundaryDistance(edges, p);
  return whereIs(edges, p) > 0 ? -d : d;
}

/// True if the straight step p → q meets the boundary and p is not on it: exact, over all edges.
inline bool crosses(std::span<const OracleEdge> edges, const Vec2& p, const Vec2& q) {
  const Vec2 low = p.cwiseMin(q);
  const Vec2 high = p.cwiseMax(q);
  for (const OracleEdge& e : edges) {
    if (std::max(e.a.x(), e.b.x()) < low.x() || std::min(e.a.x(), e.b.x()) > high.x() ||
        std::max(e.a.y(), e.b.y()) < low.y() || std::min(e.a.y(), e.b.y()) > high.y()) {
      continue;
    }
    // Inwards only: the solid is on the left of a → b.
    if (side(e.a, e.b, p) <= 0 && side(e.a, e.b, q) > 0 && side(p, q, e.a) * side(p, q, e.b) <= 0) return true;
  }
  return false;
}

}  // namespace froude::test
