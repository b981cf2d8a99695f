#include <froude/fields/triangle_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include <froude/fields/delaunay.h>
#include <froude/fields/distance_field.h>

namespace froude {

namespace {

using detail::TriangleCorners;

constexpr double kFinest = 1.0 / 64.0;   // shortest piece of the outline, in spacings
constexpr double kWantedAngle = 25.0;    // refined until reached, or for kMostRounds [degrees]
constexpr double kSharp = 60.0;          // corners of the outline below it are never refined away [degrees]
constexpr double kLargestRadius = 0.95;  // of a triangle's circle, in spacings
constexpr double kFreeOfOutline = 0.6;   // points of the filling keep this from the outline, in spacings
constexpr int kMostRounds = 60;
constexpr double kDegree = kPi / 180.0;
constexpr double kMostPoints = 1e8;

std::string printed(const char* format, double a, double b, double c, double d) {
  std::array<char, 320> text{};
  std::snprintf(text.data(), text.size(), format, a, b, c, d);
  return text.data();
}

struct Circle {
  Vec2 center;
  double radius;
};

/// Through the corners of a triangle that is not flat.
Circle circumcircle(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  const double d = 2.0 * cross(u, v);
  const double uu = u.squaredNorm(), vv = v.squaredNorm();
  const Vec2 offset((v.y() * uu - u.y() * vv) / d, (u.x() * vv - v.x() * uu) / d);
  return {a + offset, offset.norm()};
}

double angleBetween(const Vec2& u, const Vec2& v) { return std::atan2(std::abs(cross(u, v)), u.dot(v)); }

/// Pieces of about a spacing that a length is cut into.
double piecesOf(double length, double spacing) { return std::max(1.0, std::ceil(length / spacing - 0.25)); }

/// A piece of the outline between two points.
struct Piece {
  std::uint32_t a, b;
};

class Mesher {
 public:
  Mesher(const Polygon& polygon, double spacing) : polygon_(polygon), spacing_(spacing), lattice_(polygon.bounds()) {}

  TriangleMesh run() {
    cutOutline();
    fill();
    triangulate();
    for (int round = 0; round < kMostRounds && refine(); ++round) triangulate();
    checkAngles();
    return inOrder();
  }

 private:
  const Vec2& at(std::uint32_t i) const { return points_[i]; }
  double lengthOf(const Piece& piece) const { return (at(piece.b) - at(piece.a)).norm(); }

  std::uint32_t add(const Vec2& p) {
    points_.push_back(p);
    nodes_.push_back(lattice_.snap(p));
    sharp_.push_back(false);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }

  void cutOutline() {
    for (const Vec2& vertex : polygon_.vertices()) add(vertex);
    for (std::uint32_t i = 0; i < polygon_.edgeCount(); ++i) {
      const Vec2& here = polygon_.edgeStart(i);
      sharp_[i] =
          angleBetween(polygon_.edgeEnd(i) - here, polygon_.edgeStart(polygon_.previous(i)) - here) < kSharp * kDegree;
    }
    for (std::uint32_t i = 0; i < polygon_.edgeCount(); ++i) {
      const Vec2 from = polygon_.edgeStart(i), to = polygon_.edgeEnd(i);
      const double pieces = piecesOf((to - from).norm(), spacing_);
      std::uint32_t last = i;
      for (double k = 1.0; k < pieces; ++k) {
        const std::uint32_t next = add(from + (k / pieces) * (to - from));
        pieces_.push_back({last, next});
        last = next;
      }
      pieces_.push_back({last, polygon_.next(i)});
    }
  }

  /// Rows of equilateral triangles, squeezed a little so that an even number of them fits the box.
  void fill() {
    const Box& box = polygon_.bounds();
    const double fitting = box.size().y() / (spacing_ * std::sqrt(0.75));
    const double rows = fitting < 1.5 ? 1.0 : 2.0 * std::round(0.5 * fitting);
    const double columns = piecesOf(box.size().x(), spacing_);
    const Vec2 step(box.size().x() / columns, box.size().y() / rows);
    const DistanceField field(polygon_, spacing_);
    for (double row = 1.0; row < rows; ++row)
      for (double column = 0.0; column <= columns; ++column) {
        const Vec2 p = box.min + step.cwiseProduct(Vec2(column + (std::fmod(row, 2.0) == 0.0 ? 0.0 : 0.5), row));
        if (field.sample(p).distance < -kFreeOfOutline * std::min(step.x(), spacing_)) add(p);
      }
  }

  /// The triangulation of all points, the outline cut until all of its pieces are edges there; then what lies outside
  /// is dropped.
  void triangulate() {
    std::vector<TriangleCorners> all;
    for (;;) {
      refuseEqualPoints();
      all = detail::delaunay(nodes_);
      edgeOf_.clear();
      for (std::uint32_t t = 0; t < all.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) edgeOf_.push_back({key(all[t][k], all[t][(k + 1) % 3]), t});
      std::sort(edgeOf_.begin(), edgeOf_.end());
      const std::vector<Piece> before = pieces_;
      pieces_.clear();
      for (const Piece& piece : before)
        if (triangleAt(piece.a, piece.b))
          pieces_.push_back(piece);
        else
          cut(piece);
      if (pieces_.size() == before.size()) break;
    }
    keepSolid(all);
  }

  static std::uint64_t key(std::uint32_t a, std::uint32_t b) { return (std::uint64_t{a} << 32) | b; }

  /// The triangle on the left of the edge from a to b.
  std::optional<std::uint32_t> triangleAt(std::uint32_t a, std::uint32_t b) const {
    const auto found = std::lower_bound(edgeOf_.begin(), edgeOf_.end(), std::pair{key(a, b), std::uint32_t{0}});
    if (found == edgeOf_.end() || found->first != key(a, b)) return std::nullopt;
    return found->second;
  }

  /// In the middle; on a circle about a sharp corner, where both sides get their points at the same distances and no
  /// longer cut each other's pieces.
  void cut(const Piece& piece) {
    const double length = lengthOf(piece);
    if (0.5 * length < kFinest * spacing_)
      throw MeshError(at(piece.a), printed("the outline comes too close to itself near (%.6g, %.6g) m for triangles of "
                                           "%.6g m, right is a smaller spacing or a wider gap",
                                           at(piece.a).x(), at(piece.a).y(), spacing_, 0.0));
    double share = 0.5;
    if (sharp_[piece.a] != sharp_[piece.b]) {
      const double distance = spacing_ * std::exp2(std::round(std::log2(0.5 * length / spacing_)));
      share = std::clamp(distance / length, 0.25, 0.75);
      if (sharp_[piece.b]) share = 1.0 - share;
    }
    const std::uint32_t middle = add(at(piece.a) + share * (at(piece.b) - at(piece.a)));
    pieces_.push_back({piece.a, middle});
    pieces_.push_back({middle, piece.b});
  }

  /// From the outline's left inwards, never across it: no point is asked on which side it lies.
  void keepSolid(const std::vector<TriangleCorners>& all) {
    std::vector<std::uint64_t> walls;
    std::vector<std::uint32_t> open;
    std::vector<bool> solid(all.size());
    const auto enter = [&](std::uint32_t t) {
      if (solid[t]) return;
      solid[t] = true;
      open.push_back(t);
    };
    for (const Piece& piece : pieces_) {
      walls.push_back(key(piece.a, piece.b));
      enter(*triangleAt(piece.a, piece.b));
    }
    std::sort(walls.begin(), walls.end());
    while (!open.empty()) {
      const TriangleCorners& corners = all[open.back()];
      open.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
        if (std::binary_search(walls.begin(), walls.end(), key(a, b))) continue;
        if (const auto next = triangleAt(b, a)) enter(*next);
      }
    }
    triangles_.clear();
    for (std::uint32_t t = 0; t < all.size(); ++t)
      if (solid[t]) triangles_.push_back(all[t]);
  }

  void refuseEqualPoints() const {
    std::vector<std::pair<detail::PointLattice::Node, std::uint32_t>> sorted;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) sorted.emplace_back(nodes_[i], i);
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first)
        throw MeshError(at(sorted[i].second), printed("two points of the outline near (%.6g, %.6g) m are within a "
                                                      "billionth of its size (%.6g m), right is coarser detail",
                                                      at(sorted[i].second).x(), at(sorted[i].second).y(),
                                                      polygon_.bounds().size().maxCoeff(), 0.0));
  }

  double smallestAngle(const TriangleCorners& t, std::size_t* where = nullptr) const {
    double least = kPi;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2& here = at(t[k]);
      const double angle = angleBetween(at(t[(k + 1) % 3]) - here, at(t[(k + 2) % 3]) - here);
      if (angle < least && where != nullptr) *where = k;
      least = std::min(least, angle);
    }
    return least;
  }

  /// A triangle to be refined: too large, or with an angle that no sharp corner of the outline asks for.
  bool bad(const TriangleCorners& t, double radius) const {
    if (radius > kLargestRadius * spacing_) return true;
    std::size_t where = 0;
    if (smallestAngle(t, &where) >= kWantedAngle * kDegree) return false;
    // The shortest edge is opposite to the smallest angle; between two sides of a sharp corner it is left alone.
    const double shortest = (at(t[(where + 1) % 3]) - at(t[(where + 2) % 3])).norm();
    return !sharp_[t[where]] && shortest > 2.0 * kFinest * spacing_;
  }

  /// Puts a point into the middle of the circle of each bad triangle, or, where that would be too close to a piece of
  /// the outline, cuts the piece. Circles that a new point lies in wait for the next round. False: nothing was to do.
  bool refine() {
    struct Candidate {
      double angle;
      Circle circle;
    };
    std::vector<Candidate> candidates;
    for (const TriangleCorners& t : triangles_) {
      const Circle circle = circumcircle(at(t[0]), at(t[1]), at(t[2]));
      if (bad(t, circle.radius)) candidates.push_back({smallestAngle(t), circle});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.angle < b.angle; });
    std::vector<bool> toCut(pieces_.size());
    std::vector<Vec2> added;
    for (const Candidate& candidate : candidates) {
      const auto& [center, radius] = candidate.circle;
      const bool taken = std::any_of(added.begin(), added.end(), [&, c = center, r = radius](const Vec2& p) {
        return (p - c).squaredNorm() < r * r;
      });
      if (taken) continue;
      bool close = false;
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const Vec2 middle = 0.5 * (at(pieces_[i].a) + at(pieces_[i].b));
        const double half = 0.5 * lengthOf(pieces_[i]);
        if ((center - middle).squaredNorm() >= half * half) continue;
        close = true;
        if (half >= 2.0 * kFinest * spacing_) toCut[i] = true;
      }
      if (!close && polygon_.contains(center)) added.push_back(center);
    }
    const std::vector<Piece> before = pieces_;
    pieces_.clear();
    for (std::size_t i = 0; i < before.size(); ++i)
      if (toCut[i])
        cut(before[i]);
      else
        pieces_.push_back(before[i]);
    for (const Vec2& p : added) add(p);
    return pieces_.size() != before.size() || !added.empty();
  }

  void checkAngles() const {
    const TriangleCorners* worst = nullptr;
    double least = kPi;
    for (const TriangleCorners& t : triangles_) {
      const double angle = smallestAngle(t);
      if (angle < least) worst = &t;
      least = std::min(least, angle);
    }
    if (least >= kLeastMeshAngle) return;
    const Vec2 place = (at((*worst)[0]) + at((*worst)[1]) + at((*worst)[2])) / 3.0;
    throw MeshError(place,
                    printed("a triangle near (%.6g, %.6g) m would have an angle of %.3g degrees, right are corners and "
                            "detail of the outline that allow %g degrees, or a smaller spacing",
                            place.x(), place.y(), least / kDegree, kLeastMeshAngle / kDegree));
  }

  /// Points of the outline in its order, then the used ones of the filling.
  TriangleMesh inOrder() const {
    TriangleMesh mesh;
    std::vector<std::uint32_t> numberOf(points_.size(), ~0u);
    const auto take = [&](std::uint32_t i) {
      if (numberOf[i] != ~0u) return;
      numberOf[i] = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(at(i));
    };
    std::vector<bool> used(points_.size());
    for (const TriangleCorners& t : triangles_)
      for (const std::uint32_t corner : t) used[corner] = true;
    for (const Piece& piece : pieces_) take(piece.a);
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      if (used[i]) take(i);
    for (const Piece& piece : pieces_) mesh.outline.push_back({numberOf[piece.a], numberOf[piece.b]});
    for (const TriangleCorners& t : triangles_)
      mesh.triangles.push_back({numberOf[t[0]], numberOf[t[1]], numberOf[t[2]]});
    return mesh;
  }

  const Polygon& polygon_;
  double spacing_;
  detail::PointLattice lattice_;
  std::vector<Vec2> points_;
  std::vector<detail::PointLattice::Node> nodes_;
  std::vector<bool> sharp_;
  std::vector<Piece> pieces_;
  std::vector<TriangleCorners> triangles_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edgeOf_;
};

}  // namespace

TriangleMesh triangleMesh(const Polygon& polygon, double spacing) {
  const Vec2 start = polygon.vertices()[0];
  if (!(spacing > 0.0) || !std::isfinite(spacing))
    throw MeshError(start, printed("the spacing is %g m, right is a length above 0", spacing, 0, 0, 0));
  const double points = polygon.area() / (spacing * spacing * std::sqrt(0.75));
  if (points > kMostPoints)
    throw MeshError(start, printed("a spacing of %g m makes %.3g points, right is a larger one (at most %.0e points)",
                                   spacing, points, kMostPoints, 0));
  return Mesher(polygon, spacing).run();
}

}  // namespace froude
