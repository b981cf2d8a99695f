// Outlines without detail finer than a mesh's triangles.
#include <algorithm>

#include <froude/fields/triangle_mesh.h>

namespace froude {

namespace {

constexpr double kShort = 0.75;       // an edge, in spacings
constexpr double kMost = 1.0 / 16.0;  // that the outline may move, in spacings

double distanceToSegment(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0.0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

/// One ring, whose vertices are left out one by one, the least noticed first.
class Ring {
 public:
  Ring(std::vector<Vec2> vertices, double spacing) : points_(std::move(vertices)), spacing_(spacing) {
    const std::size_t n = points_.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_.push_back((i + 1) % n);
      previous_.push_back((i + n - 1) % n);
    }
    cost_.resize(n);
    for (std::size_t i = 0; i < n; ++i) cost_[i] = costOf(i);
  }

  std::vector<Vec2> coarse() {
    std::size_t left = points_.size(), first = 0;
    while (left > 3) {
      const auto least = static_cast<std::size_t>(std::min_element(cost_.begin(), cost_.end()) - cost_.begin());
      if (cost_[least] > kMost * spacing_) break;
      const std::size_t a = previous_[least], b = next_[least];
      next_[a] = b;
      previous_[b] = a;
      cost_[least] = kInfinity;
      cost_[a] = costOf(a);
      cost_[b] = costOf(b);
      first = b;
      --left;
    }
    std::vector<Vec2> ring;
    while (previous_[first] < first) first = previous_[first];  // the lowest number first
    for (std::size_t i = first, k = 0; k < left; ++k, i = next_[i]) ring.push_back(points_[i]);
    return ring;
  }

 private:
  /// How far the outline moves where vertex i goes; infinite where both of its edges are long enough.
  double costOf(std::size_t i) const {
    const std::size_t a = previous_[i], b = next_[i];
    const double shorter = std::min((points_[i] - points_[a]).norm(), (points_[b] - points_[i]).norm());
    if (shorter >= kShort * spacing_) return kInfinity;
    double most = 0.0;
    for (std::size_t k = (a + 1) % points_.size(); k != b; k = (k + 1) % points_.size())
      most = std::max(most, distanceToSegment(points_[a], points_[b], points_[k]));
    return most;
  }

  std::vector<Vec2> points_;
  double spacing_;
  std::vector<std::size_t> next_, previous_;
  std::vector<double> cost_;
};

}  // namespace

Polygon coarseOutline(const Polygon& polygon, double spacing) {
  std::vector<std::vector<Vec2>> rings;
  std::size_t left = 0;
  for (std::size_t r = 0; r + 1 < polygon.ringStarts().size(); ++r) {
    const auto begin = polygon.vertices().begin();
    const std::vector<Vec2> ring(begin + polygon.ringStarts()[r], begin + polygon.ringStarts()[r + 1]);
    rings.push_back(Ring(ring, spacing).coarse());
    left += rings.back().size();
  }
  if (left == polygon.edgeCount()) return polygon;
  try {
    std::vector<Vec2> outer = std::move(rings.front());
    rings.erase(rings.begin());
    return Polygon::make(std::move(outer), std::move(rings));
  } catch (const PolygonError&) {  // close sides have crossed: all detail is needed
    return polygon;
  }
}

}  // namespace froude
