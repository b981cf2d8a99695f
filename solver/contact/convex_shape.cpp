// Convex shapes: checked once, their normals and radii made ready.
#include <froude/solver/contact/convex_shape.h>

#include <froude/base/error.h>
#include <froude/fields/convex_pieces.h>
#include <froude/fields/predicates.h>

namespace froude {

namespace {

// At a bend smaller than this a vertex of the polygon counts as lying on a straight run [rad].
constexpr double kStraight = 1e-9;
// From so many vertices on a search by halves is quicker than a look at all [measured].
constexpr std::uint32_t kMany = 32;

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
  innerRadius_ = hold_ = kInfinity;
  for (std::uint32_t k = 0; k < n; ++k) {
    outerRadius_ = std::max(outerRadius_, (vertices_[k] - centroid_).norm());
    reach_ = std::max(reach_, vertices_[k].norm());
    hold_ = std::min(hold_, normals_[k].dot(vertices_[k]));
    innerRadius_ = std::min(innerRadius_, normals_[k].dot(vertices_[k] - centroid_));
  }
  innerRadius_ = std::max(innerRadius_, 0.0);
  for (std::uint32_t k = 0; k < n; k += 2) {
    const std::uint32_t l = std::min(k + 1, n - 1);
    const Vec2 &p = normals_[k], &q = normals_[l];
    lines_.push_back(
        {{p.x(), q.x()}, {p.y(), q.y()}, {p.dot(vertices_[k] - centroid_), q.dot(vertices_[l] - centroid_)}});
  }
}

Box ConvexShape::box(const Transform& pose) const {
  Box box;
  for (const Vec2& v : vertices_) box.include(pose.toWorld(v));
  return box;
}

std::uint32_t ConvexShape::farthest(const Vec2& direction) const {
  const double x = direction.x(), y = direction.y();
  const auto along = [&](std::uint32_t k) { return x * corners_[k].vertex.x() + y * corners_[k].vertex.y(); };
  std::uint32_t low = 0, high = size_;
  if (size_ > kMany) {
    // Halves the range of normals in which the direction lies, by their angles from the first normal: `low` is not past
    // it, `high` is. Rounding may put neighbours of a straight run in the wrong order: those around have the last word.
    const Vec2& first = corners_[0].normal;
    const auto isBeyond = [&](const Vec2& d) { return cross(first, d) < 0.0; };
    const bool beyond = isBeyond(direction);
    while (high - low > 1) {
      const std::uint32_t middle = low + (high - low) / 2;
      const Vec2& n = corners_[middle].normal;
      const bool passed = isBeyond(n) != beyond ? beyond : cross(n, direction) >= 0.0;
      (passed ? low : high) = middle;
    }
    std::uint32_t best = high == size_ ? 0 : high;
    while (along(next(best)) > along(best)) best = next(best);
    while (along(previous(best)) > along(best)) best = previous(best);
    return best;
  }
  std::uint32_t best = 0;
  double most = along(0);
  for (std::uint32_t k = 1; k < size_; ++k) {
    const double here = along(k);
    best = here > most ? k : best;
    most = here > most ? here : most;
  }
  return best;
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
