// A convex polygon made ready for pair queries: the narrow phase's only shape. Knows no bodies.
#pragma once

#include <span>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/transform.h>
#include <froude/fields/polygon.h>

namespace froude {

/// By so much may a contact's direction leave a vertex's cone before it counts as a ghost [rad].
inline constexpr double kConeTolerance = 1e-3;

/// Vertices counter-clockwise; edge k runs from vertex k to the next. Collinear runs are allowed, each of their edges
/// is then a feature of its own. A shape that is a
/// piece of a concave polygon knows which of its edges are cuts: nothing outside the polygon can touch those, and
/// contacts against them would be ghosts at the seams.
class FROUDE_API ConvexShape {
 public:
  /// Throws Error for fewer than three vertices, a vertex that is not finite, the same vertex twice in a row, no area,
  /// a turn to the right or more than one turn in all. Decided exactly.
  explicit ConvexShape(std::vector<Vec2> vertices);
  /// The convex pieces of a polygon, in the order of `convexPieces`, vertices relative to `origin` [m].
  static std::vector<ConvexShape> piecesOf(const Polygon& polygon, const Vec2& origin = {0.0, 0.0});

  std::uint32_t size() const { return size_; }
  std::span<const Vec2> vertices() const { return vertices_; }
  /// Unit outward normals of the edges.
  std::span<const Vec2> normals() const { return normals_; }
  const Vec2& vertex(std::uint32_t k) const { return corners_[k].vertex; }
  const Vec2& normal(std::uint32_t k) const { return corners_[k].normal; }
  std::uint32_t next(std::uint32_t k) const { return k + 1 == size() ? 0 : k + 1; }
  std::uint32_t previous(std::uint32_t k) const { return k == 0 ? size() - 1 : k - 1; }

  const Vec2& centroid() const { return centroid_; }
  /// Largest distance of a vertex from the centroid, least distance of an edge's line from it [m].
  double outerRadius() const { return outerRadius_; }
  double innerRadius() const { return innerRadius_; }
  /// Largest distance of a vertex from the origin of its frame [m].
  double reach() const { return reach_; }
  /// Radius of the largest disc about the origin that the shape holds [m]; negative where the origin is outside.
  double hold() const { return hold_; }
  Box box(const Transform& pose) const;
  /// Two edges' lines side by side, for loops over all edges two at a time: n · (p − centroid) = offset on the line. An
  /// odd number is made up with the last one again. Offsets are from the centroid, which is where rounding is least.
  struct LinePair {
    Eigen::Array2d normalX, normalY, offset;
  };
  std::span<const LinePair> linePairs() const { return lines_; }

  /// A vertex that is farthest in `direction` (any length). Cost: O(size) up to 32 vertices, O(log size) beyond.
  std::uint32_t farthest(const Vec2& direction) const;

  /// True for a whole polygon: then all edges and directions can be touched.
  bool isWhole() const { return whole_; }
  /// Is the edge one of the polygon's outline, not a cut?
  bool isOutline(std::uint32_t edge) const { return isWhole() || outline_[edge] != 0; }
  /// Can something outside the polygon touch this vertex with `direction` (unit, pointing out of the shape)? True in
  /// the cone between the normals of the polygon's own edges at that vertex, widened by kConeTolerance; never at a
  /// reflex one.
  bool allows(std::uint32_t vertex, const Vec2& direction) const;

 private:
  struct Corner {  // a vertex and the normal of the edge that begins there, in one cache line
    Vec2 vertex, normal;
  };
  struct Cone {          // of the directions in which a vertex of the whole polygon can be touched
    Vec2 before, after;  // the polygon's own normals on both sides
    bool open = false;   // false at a reflex vertex
  };
  ConvexShape() = default;
  void finish();

  // What every query reads comes first.
  std::vector<Corner> corners_;
  std::uint32_t size_ = 0;
  bool whole_ = true;
  Vec2 centroid_{0.0, 0.0};
  double outerRadius_ = 0.0, innerRadius_ = 0.0, reach_ = 0.0, hold_ = 0.0;
  std::vector<LinePair> lines_;
  std::vector<Vec2> vertices_, normals_;
  std::vector<std::uint8_t> outline_;  // by edge
  std::vector<Cone> cone_;             // by vertex; empty for a whole polygon
};

}  // namespace froude
