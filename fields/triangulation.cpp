#include <froude/fields/triangulation.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include <froude/base/assert.h>
#include <froude/fields/predicates.h>

namespace froude::detail {
namespace {

constexpr int kNone = -1;

/// True if d lies within the circle through a, b, c (counter-clockwise), and rounding cannot have decided that. So
/// every flip is one of exact arithmetic too, and flipping comes to an end. Source: Shewchuk 1997, incircle, filter A.
bool surelyInCircle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  constexpr double kFilter = 1.1102230246251577e-15;  // (10 + 96ε)ε with ε = 2⁻⁵³
  const Vec2 u = a - d, v = b - d, w = c - d;
  const double vw = v.x() * w.y(), wv = w.x() * v.y();
  const double wu = w.x() * u.y(), uw = u.x() * w.y();
  const double uv = u.x() * v.y(), vu = v.x() * u.y();
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), ww = w.squaredNorm();
  const double determinant = uu * (vw - wv) + vv * (wu - uw) + ww * (uv - vu);
  const double size =
      uu * (std::abs(vw) + std::abs(wv)) + vv * (std::abs(wu) + std::abs(uw)) + ww * (std::abs(uv) + std::abs(vu));
  return determinant > kFilter * size;
}

/// Corner k is opposite to edge k, which runs from corner k+1 to corner k+2; solid or not, triangles lie on its left.
struct Triangle {
  std::array<int, 3> corner{};
  std::array<int, 3> neighbour{kNone, kNone, kNone};
  std::array<bool, 3> fixed{};  // edges of the polygon
};

struct EdgeOf {
  int triangle = kNone;
  int k = 0;
};

constexpr int after(int k) { return (k + 1) % 3; }
constexpr int before(int k) { return (k + 2) % 3; }

class Triangulator {
 public:
  explicit Triangulator(const Polygon& polygon) : polygon_(polygon) {
    points_.assign(polygon.vertices().begin(), polygon.vertices().end());
    const Box& bounds = polygon.bounds();
    const Box box = bounds.grown(bounds.size().maxCoeff());
    const int n = static_cast<int>(points_.size());
    points_.insert(points_.end(), {box.min, {box.max.x(), box.min.y()}, box.max, {box.min.x(), box.max.y()}});
    triangles_.push_back({{n, n + 1, n + 2}, {kNone, 1, kNone}, {}});
    triangles_.push_back({{n, n + 2, n + 3}, {kNone, kNone, 0}, {}});
    triangleOf_.assign(points_.size(), 0);
    triangleOf_.back() = 1;
  }

  std::vector<TriangleCorners> run() {
    for (const std::uint32_t v : orderOfInsertion()) insert(static_cast<int>(v));
    for (std::uint32_t e = 0; e < polygon_.edgeCount(); ++e)
      constrain(static_cast<int>(e), static_cast<int>(polygon_.next(e)));
    for (const Triangle& t : triangles_)
      for (int k = 0; k < 3; ++k) doubtful_.emplace_back(t.corner[after(k)], t.corner[before(k)]);
    legalize();
    return solid();
  }

 private:
  const Vec2& point(int v) const { return points_[static_cast<std::size_t>(v)]; }
  Triangle& at(int t) { return triangles_[static_cast<std::size_t>(t)]; }
  int side(int a, int b, int c) const { return orientation(point(a), point(b), point(c)); }

  /// Row by row to and fro over a coarse grid: the next vertex is near the last one, so walks are short.
  std::vector<std::uint32_t> orderOfInsertion() const {
    const std::uint32_t n = polygon_.edgeCount();
    const Box& box = polygon_.bounds();
    const double cells = std::max(1.0, std::floor(std::sqrt(n / 2.0)));
    struct Key {
      double row, column;
      std::uint32_t vertex;
      bool operator<(const Key& o) const {
        return row != o.row ? row < o.row : column != o.column ? column < o.column : vertex < o.vertex;
      }
    };
    std::vector<Key> keys;
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec2 place = (polygon_.vertices()[i] - box.min).cwiseQuotient(box.size()) * cells;
      const double row = std::floor(place.y()), column = std::floor(place.x());
      keys.push_back({row, std::fmod(row, 2.0) == 0.0 ? column : -column, i});
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::uint32_t> order;
    for (const Key& key : keys) order.push_back(key.vertex);
    return order;
  }

  /// The triangle that holds the point: a walk towards it, and if that runs in circles a look at all of them.
  int locate(const Vec2& p) {
    int t = last_;
    for (std::size_t step = 0; step < 4 * triangles_.size(); ++step) {
      int next = kNone;
      for (int j = 0; j < 3 && next == kNone; ++j) {
        const int k = (j + static_cast<int>(step % 3)) % 3;
        const Triangle& here = at(t);
        if (orientation(point(here.corner[after(k)]), point(here.corner[before(k)]), p) < 0) next = here.neighbour[k];
      }
      if (next == kNone) return t;
      t = next;
    }
    for (t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      bool holds = true;
      for (int k = 0; k < 3; ++k)
        holds = holds && orientation(point(at(t).corner[after(k)]), point(at(t).corner[before(k)]), p) >= 0;
      if (holds) break;
    }
    return t;
  }

  void insert(int v) {
    const int t = locate(point(v));
    int on = kNone;
    for (int k = 0; k < 3; ++k)
      if (side(at(t).corner[after(k)], at(t).corner[before(k)], v) == 0) on = k;
    const std::array<int, 3> corner = at(t).corner;
    splitInThree(t, v);
    if (on != kNone) {
      // On an edge: of the three triangles one is flat, and a flip across that edge makes four sound ones of it.
      const EdgeOf flat = find(corner[after(on)], corner[before(on)]);
      flip(flat.triangle, flat.k);
    }
    last_ = triangleOf_[static_cast<std::size_t>(v)];
    pushRing(v);
    legalize();
  }

  void splitInThree(int t, int v) {
    const Triangle old = at(t);
    const int second = static_cast<int>(triangles_.size()), third = second + 1;
    const auto [a, b, c] = old.corner;
    at(t) = {{v, b, c}, {old.neighbour[0], second, third}, {old.fixed[0], false, false}};
    triangles_.push_back({{v, c, a}, {old.neighbour[1], third, t}, {old.fixed[1], false, false}});
    triangles_.push_back({{v, a, b}, {old.neighbour[2], t, second}, {old.fixed[2], false, false}});
    relink(old.neighbour[1], t, second);
    relink(old.neighbour[2], t, third);
    triangleOf_[static_cast<std::size_t>(v)] = triangleOf_[static_cast<std::size_t>(b)] = t;
    triangleOf_[static_cast<std::size_t>(c)] = t;
    triangleOf_[static_cast<std::size_t>(a)] = second;
  }

  void relink(int t, int old, int fresh) {
    if (t == kNone) return;
    for (int& neighbour : at(t).neighbour)
      if (neighbour == old) {
        neighbour = fresh;
        return;
      }
  }

  /// Replaces edge k of t by the other diagonal of the quadrilateral around it.
  void flip(int t, int k) {
    const Triangle one = at(t);
    const int u = one.neighbour[k];
    const Triangle two = at(u);
    int j = 0;
    while (two.neighbour[j] != t) ++j;
    const int p = one.corner[k], a = one.corner[after(k)], b = one.corner[before(k)], q = two.corner[j];
    at(t) = {{p, a, q},
             {two.neighbour[after(j)], u, one.neighbour[before(k)]},
             {two.fixed[after(j)], false, one.fixed[before(k)]}};
    at(u) = {{q, b, p},
             {one.neighbour[after(k)], t, two.neighbour[before(j)]},
             {one.fixed[after(k)], false, two.fixed[before(j)]}};
    relink(two.neighbour[after(j)], u, t);
    relink(one.neighbour[after(k)], t, u);
    triangleOf_[static_cast<std::size_t>(p)] = triangleOf_[static_cast<std::size_t>(a)] = t;
    triangleOf_[static_cast<std::size_t>(q)] = triangleOf_[static_cast<std::size_t>(b)] = u;
  }

  int indexIn(int t, int v) {
    int k = 0;
    while (at(t).corner[k] != v) ++k;
    return k;
  }

  /// The triangle on the left of u → v.
  EdgeOf find(int u, int v) {
    const int first = triangleOf_[static_cast<std::size_t>(u)];
    int t = first;
    do {
      const int k = indexIn(t, u);
      if (at(t).corner[after(k)] == v) return {t, before(k)};
      t = at(t).neighbour[after(k)];
    } while (t != first && t != kNone);
    if (t == first) return {};
    for (t = first; t != kNone;) {  // u is a corner of the box
      const int k = indexIn(t, u);
      if (at(t).corner[after(k)] == v) return {t, before(k)};
      t = at(t).neighbour[before(k)];
    }
    return {};
  }

  void pushRing(int v) {
    const int first = triangleOf_[static_cast<std::size_t>(v)];
    int t = first;
    do {
      const int k = indexIn(t, v);
      doubtful_.emplace_back(at(t).corner[after(k)], at(t).corner[before(k)]);
      t = at(t).neighbour[after(k)];
    } while (t != first);
  }

  /// Flips what is not Delaunay, until nothing is.
  void legalize() {
    while (!doubtful_.empty()) {
      const auto [u, v] = doubtful_.back();
      doubtful_.pop_back();
      const EdgeOf edge = find(u, v);
      if (edge.triangle == kNone || at(edge.triangle).fixed[edge.k]) continue;
      const int other = at(edge.triangle).neighbour[edge.k];
      if (other == kNone) continue;
      const int p = at(edge.triangle).corner[edge.k];
      int j = 0;
      while (at(other).neighbour[j] != edge.triangle) ++j;
      const int q = at(other).corner[j];
      if (!surelyInCircle(point(u), point(v), point(p), point(q))) continue;
      if (side(p, u, q) <= 0 || side(q, v, p) <= 0) continue;
      flip(edge.triangle, edge.k);
      for (const auto& [a, b] : {std::pair{p, u}, {u, q}, {q, v}, {v, p}}) doubtful_.emplace_back(a, b);
    }
  }

  /// Makes a → b an edge: what crosses it is flipped away. No vertex lies on it, as the polygon touches itself nowhere.
  void constrain(int a, int b) {
    std::deque<std::pair<int, int>> crossing = crossedBy(a, b);
    while (!crossing.empty()) {
      const auto [u, v] = crossing.front();
      crossing.pop_front();
      const EdgeOf edge = find(u, v);
      FROUDE_ASSERT(edge.triangle != kNone);
      const int other = at(edge.triangle).neighbour[edge.k];
      const int p = at(edge.triangle).corner[edge.k];
      int j = 0;
      while (at(other).neighbour[j] != edge.triangle) ++j;
      const int q = at(other).corner[j];
      if (side(p, u, q) <= 0 || side(q, v, p) <= 0) {
        crossing.emplace_back(u, v);  // not convex yet; its neighbours go first
        continue;
      }
      flip(edge.triangle, edge.k);
      const bool shared = p == a || p == b || q == a || q == b;
      if (!shared && side(a, b, p) * side(a, b, q) < 0) crossing.emplace_back(p, q);
    }
    for (const auto& [u, v] : {std::pair{a, b}, {b, a}}) {
      const EdgeOf edge = find(u, v);
      FROUDE_ASSERT(edge.triangle != kNone);
      at(edge.triangle).fixed[edge.k] = true;
    }
  }

  /// Edges that the segment a b crosses, from a on; empty if it is an edge.
  std::deque<std::pair<int, int>> crossedBy(int a, int b) {
    std::deque<std::pair<int, int>> crossing;
    if (find(a, b).triangle != kNone) return crossing;
    int t = triangleOf_[static_cast<std::size_t>(a)], k = indexIn(t, a);
    while (side(a, at(t).corner[after(k)], b) <= 0 || side(a, at(t).corner[before(k)], b) >= 0) {
      t = at(t).neighbour[after(k)];
      k = indexIn(t, a);
    }
    while (true) {
      const int u = at(t).corner[after(k)], v = at(t).corner[before(k)];
      crossing.emplace_back(u, v);
      const int next = at(t).neighbour[k];
      int j = 0;
      while (at(next).neighbour[j] != t) ++j;
      const int apex = at(next).corner[j];
      if (apex == b) return crossing;
      // u is on the right of a → b, v on its left. The segment leaves through the edge whose ends it separates.
      t = next;
      k = side(a, b, apex) > 0 ? indexIn(t, v) : indexIn(t, u);
    }
  }

  /// From the left of every edge of the polygon to whatever no edge of it parts from there.
  std::vector<TriangleCorners> solid() {
    std::vector<bool> inside(triangles_.size(), false);
    std::vector<int> open;
    for (std::uint32_t e = 0; e < polygon_.edgeCount(); ++e)
      open.push_back(find(static_cast<int>(e), static_cast<int>(polygon_.next(e))).triangle);
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      if (inside[static_cast<std::size_t>(t)]) continue;
      inside[static_cast<std::size_t>(t)] = true;
      for (int k = 0; k < 3; ++k)
        if (!at(t).fixed[k]) open.push_back(at(t).neighbour[k]);
    }
    std::vector<TriangleCorners> result;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (!inside[t]) continue;
      TriangleCorners corners{};
      std::copy(triangles_[t].corner.begin(), triangles_[t].corner.end(), corners.begin());
      result.push_back(corners);
    }
    return result;
  }

  const Polygon& polygon_;
  std::vector<Vec2> points_;  // the polygon's vertices, and four corners of a box around them
  std::vector<Triangle> triangles_;
  std::vector<int> triangleOf_;  // one that has the vertex as a corner
  std::vector<std::pair<int, int>> doubtful_;
  int last_ = 0;
};

}  // namespace

std::vector<TriangleCorners> triangulate(const Polygon& polygon) { return Triangulator(polygon).run(); }

}  // namespace froude::detail
