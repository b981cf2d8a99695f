// Polygon: a simple polygon with holes, checked once when it is made; never empty, never self-crossing afterwards.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/error.h>
#include <froude/base/transform.h>
#include <froude/base/types.h>

namespace froude {

/// A polygon that cannot be repaired; `what()` names vertices by index and coordinates.
class FROUDE_API PolygonError : public Error {
 public:
  enum class Reason {
    TooFewVertices,  ///< fewer than three different vertices in a ring
    NonFinite,       ///< a coordinate is NaN or infinite
    ZeroArea,        ///< all vertices of a ring on one line, or an area that underflows
    SelfCrossing,    ///< a ring crosses or touches itself
    HoleOutside,     ///< a hole lies outside the outer ring, wholly or in part
    HoleTouching,    ///< a hole touches the outer ring or another hole
    HolesOverlap,    ///< two holes cross, or one lies in the other
  };
  PolygonError(Reason reason, const std::string& message) : Error(message), reason_(reason) {}
  Reason reason() const { return reason_; }

 private:
  Reason reason_;
};

/// Outer ring counter-clockwise, holes clockwise, so that the solid is on the left of every edge. Rings are closed
/// implicitly. Edge i runs from vertex i to its successor in the ring, so edges and vertices share their numbers.
/// Immutable.
class FROUDE_API Polygon {
 public:
  /// Checks and repairs. Repaired, with a line in `notes` for each: wrong winding, a repeated closing or neighbouring
  /// vertex, a vertex in the middle of a straight run. All decisions are exact, for coordinates whose differences are 0
  /// or from 1e-140 to 1e140. Coordinates [m]. Throws PolygonError. Cost: near O(n log n).
  static Polygon make(std::vector<Vec2> outer, std::vector<std::vector<Vec2>> holes = {},
                      std::vector<std::string>* notes = nullptr);
  /// The rectangle of `box`. Throws PolygonError for an empty or flat one.
  static Polygon box(const Box& box);
  /// Regular polygon about the origin, first vertex at angle 0: (radius, 0) [m]. Throws PolygonError for sides < 3.
  static Polygon regular(int sides, double radius);

  /// Vertices of all rings, the outer ring first.
  std::span<const Vec2> vertices() const { return vertices_; }
  /// Where each ring begins in `vertices()`, and their number at the end: size rings + 1.
  std::span<const std::uint32_t> ringStarts() const { return ringStarts_; }
  std::uint32_t edgeCount() const { return static_cast<std::uint32_t>(vertices_.size()); }
  const Vec2& edgeStart(std::uint32_t i) const { return vertices_[i]; }
  const Vec2& edgeEnd(std::uint32_t i) const { return vertices_[next_[i]]; }
  /// Number of the next edge (and vertex) round the same ring.
  std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  std::uint32_t previous(std::uint32_t i) const { return previous_[i]; }
  /// True if the solid's angle at vertex i is less than 180 degrees.
  bool convexAt(std::uint32_t i) const;

  /// Area [m²], holes taken off; positive.
  double area() const { return area_; }
  /// Centre of area [m].
  const Vec2& centroid() const { return centroid_; }
  /// Polar second moment of area about the centroid [m⁴]; times a density [kg/m²] it is the moment of inertia. Accurate
  /// far from the origin.
  double secondMoment() const { return secondMoment_; }
  const Box& bounds() const { return bounds_; }
  /// True inside and exactly on the boundary. Exact. Cost: O(edges).
  bool contains(const Vec2& p) const;

  /// The polygon whose `vertices()` and `ringStarts()` these were, bit by bit; nothing is checked again. For saved
  /// states.
  static Polygon restored(std::vector<Vec2> vertices, std::vector<std::uint32_t> ringStarts);

  /// The same polygon in another frame. Vertices are rounded to the nearest double there; nothing is checked again.
  Polygon transformed(const Transform& transform) const;

 private:
  Polygon() = default;
  void link();
  void measure();

  std::vector<Vec2> vertices_;
  std::vector<std::uint32_t> ringStarts_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> previous_;
  Box bounds_;
  double area_ = 0.0;
  Vec2 centroid_{0.0, 0.0};
  double secondMoment_ = 0.0;
};

}  // namespace froude
