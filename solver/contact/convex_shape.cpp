// Convex shapes: checked once, their normals and radii made ready.
#include <froude/solver/contact/convex_shape.h>

#include <froude/base/error.h>
#include <froude/fields/convex_pieces.h>
#include <froude/fields/predicates.h>

namespace froude {

namespace {

// At a bend smaller than this a vertex of the polygon counts as lying on a straight run [rad].
constexpr double kStraight = 1e-9;

[[noreturn]] void refuse(const std::string& what) { throw Error("convex shape: " + what); }

std::string name(std::size_t k, const Vec2& v) {
  return "vertex " + std::to_string(k) + " (" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ")";
}

// A direction's half of the circle; a convex ring changes it exactly twice.
bool isUpper(const Vec2& d) { return d.y() > 0.0 || (d.y() == 0.0 && d.x() > 0.0); }

void checkConvex(const std::vector<Vec2>& v) {
  const std::size_t n = v.size();
  if (n < 3) refuse(std::to_string(n) + " vertices; at least 3 are needed");
  for (std::size_t k = 0; k < n; ++k)
    if (!v[k].allFinite()) refuse("vertex " + std::to_string(k) + " is not finite");
  int changes = 0;
  bool turns = false;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 &at = v[k], &next = v[(k + 1) % n], &after = v[(k + 2) % n];
    if (at == next) refuse(name(k, at) + " stands there twice");
    const int turn = orientation(at, next, after);
    if (turn < 0) refuse(name((k + 1) % n, next) + " turns right; counter-clockwise and convex is asked for");
    turns = turns || turn > 0;
    changes += isUpper(next - at) != isUpper(after - next) ? 1 : 0;
  }
  if (!turns) refuse("no area: all vertices are on one line");
  if (changes != 2) refuse("the outline runs around more than once, or back on itself");
}

}  // namespace

ConvexShape::ConvexShape(std::vector<Vec2> vertices) : vertices_(std::move(vertices)) {
  checkConvex(vertices_);
  finish();
}

std::vector<ConvexShape> ConvexShape::piecesOf(const Polygon& polygon, const Vec2& origin) {
  const std::vector<ConvexPiece> pieces = convexPieces(polygon);
  const auto normalOf = [&](std::uint32_t edge) -> Vec2 {
    return rightNormal(polygon.edgeEnd(edge) - polygon.edgeStart(edge)).normalized();
  };
  std::vector<ConvexShape> shapes;
  shapes.reserve(pieces.size());
  for (const ConvexPiece& piece : pieces) {
    ConvexShape shape;
    for (const std::uint32_t v : piece.vertex) shape.vertices_.push_back(polygon.vertices()[v] - origin);
    shape.finish();
    if (pieces.size() > 1) {
      shape.whole_ = false;
      for (std::size_t k = 0; k < piece.size(); ++k) {
        const std::uint32_t v = piece.vertex[k];
        const Cone cone{normalOf(polygon.previous(v)), normalOf(v)};
        const bool straight = cone.before.dot(cone.after) > 0.0 && cross(cone.before, cone.after) > -kStraight;
        shape.cone_.push_back({cone.before, cone.after, polygon.convexAt(v) || straight});
        shape.outline_.push_back(piece.outlineEdge[k] >= 0 ? 1 : 0);
      }
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

void ConvexShape::finish() {
  const auto n = static_cast<std::uint32_t>(vertices_.size());
  size_ = n;
  normals_.resize(n);
  corners_.resize(n);
  double area = 0.0;
  Vec2 moment{0.0, 0.0};
  for (std::uint32_t k = 0; k < n; ++k) {
    normals_[k] = rightNormal(vertices_[next(k)] - vertices_[k]).stableNormalized();
    corners_[k] = {vertices_[k], normals_[k]};
    // From the first vertex, so that a shape far from its frame's origin keeps its digits.
    const Vec2 p = vertices_[k] - vertices_[0];
    const Vec2 q = vertices_[next(k)] - vertices_[0];
    area += cross(p, q);
    moment += cross(p, q) * (p + q);
  }
  if (!(area > 0.0)) refuse("no area");
  centroid_ = vertices_[0] + moment / (3.0 * area);
  innerRadius_ = kInfinity;
  for (std::uint32_t k = 0; k < n; ++k) {
    outerRadius_ = std::max(outerRadius_, (vertices_[k] - centroid_).norm());
    innerRadius_ = std::min(innerRadius_, normals_[k].dot(vertices_[k] - centroid_));
  }
  innerRadius_ = std::max(innerRadius_, 0.0);
}

Box ConvexShape::box(const Transform& pose) const {
  Box box;
  for (const Vec2& v : vertices_) box.include(pose.toWorld(v));
  return box;
}

// An edge's rise is judged by its unit normal and not by its end points: edges of one rounding step have a direction
// too, and a plateau of equal products does not end the climb too early.
std::uint32_t ConvexShape::support(const Vec2& direction, std::uint32_t hint) const {
  const std::uint32_t start = hint < size_ ? hint : 0;
  const Corner* corner = corners_.data();
  std::uint32_t k = start, before = previous(start);
  if (cross(corner[k].normal, direction) > 0.0) {
    for (std::uint32_t step = size_; step > 0 && cross(corner[k].normal, direction) > 0.0; --step) k = next(k);
    before = previous(k);
  } else {
    for (std::uint32_t step = size_; step > 0 && cross(corner[before].normal, direction) < 0.0; --step) {
      k = before;
      before = previous(k);
    }
  }
  // In the middle of a straight run on the far side both edges are level, and yet it is the lowest vertex.
  if (k == start && corner[k].normal.dot(direction) < 0.0 && corner[before].normal.dot(direction) < 0.0)
    for (std::uint32_t i = 0; i < size_; ++i)
      if (direction.dot(corner[i].vertex - corner[k].vertex) > 0.0) k = i;
  return k;
}

// Halves the range of normals in which the direction lies, by their angles from the first normal.
std::uint32_t ConvexShape::support(const Vec2& direction) const {
  const Vec2& first = normal(0);
  const auto isBeyond = [&](const Vec2& d) {
    return cross(first, d) < 0.0 || (cross(first, d) == 0.0 && first.dot(d) < 0.0);
  };
  const bool beyond = isBeyond(direction);
  std::uint32_t low = 0, high = size_;  // the normal `low` is not past the direction, `high` is
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    const Vec2& n = normal(middle);
    const bool passed = isBeyond(n) != beyond ? beyond : cross(n, direction) >= 0.0;
    (passed ? low : high) = middle;
  }
  // Rounding may put neighbours of a straight run in the wrong order: the climb has the last word.
  return support(direction, high == size_ ? 0 : high);
}

bool ConvexShape::allows(std::uint32_t vertex, const Vec2& direction) const {
  if (isWhole()) return true;
  const Cone& cone = cone_[vertex];
  if (!cone.open) return false;
  const bool inside =
      cross(cone.before, direction) >= -kConeTolerance && cross(direction, cone.after) >= -kConeTolerance;
  // Between the two bounds of a narrow cone there is also its opposite.
  return inside && (direction.dot(cone.before) > 0.0 || direction.dot(cone.after) > 0.0);
}

}  // namespace froude
