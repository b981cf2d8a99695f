// Distance and depth of two convex polygons by trying everything, in long double: shares no code with the narrow phase.
#pragma once

#include <vector>

#include <froude/base/transform.h>
#include <froude/base/types.h>

namespace froude::test {

using Real = long double;
struct RealVec {
  Real x = 0, y = 0;
};
using RealRing = std::vector<RealVec>;

inline RealVec operator-(const RealVec& a, const RealVec& b) { return {a.x - b.x, a.y - b.y}; }
inline RealVec operator+(const RealVec& a, const RealVec& b) { return {a.x + b.x, a.y + b.y}; }
inline Real dot(const RealVec& a, const RealVec& b) { return a.x * b.x + a.y * b.y; }
inline Real length(const RealVec& a) { return std::sqrt(dot(a, a)); }

/// The ring in another frame, without the rounding that a Transform of doubles would add.
template <typename Ring>
RealRing placed(const Ring& ring, const Transform& pose) {
  RealRing out;
  for (const Vec2& v : ring) {
    const Real c = pose.rotation.c, s = pose.rotation.s;
    out.push_back({pose.position.x() + c * v.x() - s * v.y(), pose.position.y() + s * v.x() + c * v.y()});
  }
  return out;
}

struct OracleAxis {
  Real separation = -std::numeric_limits<Real>::infinity();
  RealVec normal;  // unit, from A to B
};

/// The edge normal of `self` along which `other` is farthest away.
inline OracleAxis bestNormal(const RealRing& self, const RealRing& other) {
  OracleAxis best;
  for (std::size_t k = 0; k < self.size(); ++k) {
    const RealVec edge = self[(k + 1) % self.size()] - self[k];
    const RealVec n{edge.y / length(edge), -edge.x / length(edge)};
    Real nearest = std::numeric_limits<Real>::infinity();
    for (const RealVec& v : other) nearest = std::min(nearest, dot(n, v - self[k]));
    if (nearest > best.separation) best = {nearest, n};
  }
  return best;
}

/// Largest separation over all edge normals of both: −depth where they overlap. The faces of the Minkowski difference
/// have no other normals.
inline OracleAxis oracleAxis(const RealRing& a, const RealRing& b) {
  const OracleAxis ofA = bestNormal(a, b), ofB = bestNormal(b, a);
  if (ofA.separation >= ofB.separation) return ofA;
  return {ofB.separation, {-ofB.normal.x, -ofB.normal.y}};
}

inline Real segmentDistance(const RealVec& p, const RealVec& a, const RealVec& b) {
  const RealVec d = b - a;
  const Real t = std::clamp<Real>(dot(p - a, d) / dot(d, d), 0, 1);
  return length(p - RealVec{a.x + t * d.x, a.y + t * d.y});
}

/// Least distance of a vertex of one from an edge of the other, over all pairs: the distance of polygons that are
/// apart.
inline Real oracleDistance(const RealRing& a, const RealRing& b) {
  Real least = std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      least = std::min(least, segmentDistance(a[i], b[j], b[(j + 1) % b.size()]));
      least = std::min(least, segmentDistance(b[j], a[i], a[(i + 1) % a.size()]));
    }
  return least;
}

}  // namespace froude::test
