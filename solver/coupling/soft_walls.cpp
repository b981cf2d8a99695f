#include <froude/solver/coupling/soft_walls.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace froude {
namespace {

double distanceToSegment(const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double share = std::clamp(-a.dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return Vec2(a + share * along).norm();
}

// Along an edge a → b as seen from the origin: the integral of (1 − r²/R²)², and of that times the share of b, by
// Gauss' rule of three on what lies within R.
std::array<double, 2> weigh(const Vec2& a, const Vec2& b, double radius) {
  const Vec2 along = b - a;
  const double length = along.norm();
  if (!(length > 0.0)) return {0.0, 0.0};
  const double foot = -a.dot(along) / length, height = cross(a, along) / length;
  const double square = radius * radius - height * height;
  if (!(square > 0.0)) return {0.0, 0.0};
  const double from = std::max(0.0, foot - std::sqrt(square)), to = std::min(length, foot + std::sqrt(square));
  if (!(from < to)) return {0.0, 0.0};
  constexpr std::array<double, 3> kAt = {-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  std::array<double, 2> sum{0.0, 0.0};
  for (std::size_t k = 0; k < 3; ++k) {
    const double s = 0.5 * (from + to) + 0.5 * (to - from) * kAt[k];
    const double falls = 1.0 - Vec2(a + s / length * along).squaredNorm() / (radius * radius);
    const double weight = kWeight[k] * (to - from) * falls * falls;
    sum[0] += weight;
    sum[1] += weight * s / length;
  }
  return sum;
}

}  // namespace

void SoftWalls::sort(double reach) {
  double longest = 0.0;
  ends_.resize(2 * edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    ends_[2 * e] = nodes_[edges_[e].a].end;
    ends_[2 * e + 1] = nodes_[edges_[e].b].end;
    longest = std::max(longest, (ends_[2 * e + 1] - ends_[2 * e]).norm());
  }
  cells_.build(ends_, 0.5 * longest);
  around_ = cells_.box().grown(reach);
}

std::size_t SoftWalls::edgesNear(const Vec2& x, double radius, double unit, const CollisionFilter& filter,
                                 std::span<WallEdge> edges, std::size_t count) const {
  const double scale = 1.0 / unit;
  const std::size_t room = std::min(edges.size(), kMaxWallEdges);
  cells_.forEachNear(x, radius, [&](std::uint32_t e) {
    const Edge& edge = edges_[e];
    if (count == room || !filter.accepts(edge.filter.group, edge.filter.collidesWith)) return;
    const Vec2 a = ends_[2 * e] - x, b = ends_[2 * e + 1] - x;
    if (distanceToSegment(a, b) < radius) edges[count++] = {a * scale, b * scale, edge.owner};
  });
  return count;
}

void SoftWalls::share(int owner, const Vec2& x, double radius, std::vector<Share>& shares) const {
  const std::size_t begin = shares.size();
  double total = 0.0;
  // From within the solid no edge looks at it; then all count.
  for (const bool facing : {true, false}) {
    cells_.forEachNear(x, radius, [&](std::uint32_t e) {
      const Edge& edge = edges_[e];
      if (edge.owner != owner) return;
      const Vec2 a = ends_[2 * e] - x, b = ends_[2 * e + 1] - x;
      if (facing && cross(a, b) >= 0.0) return;
      const auto [weight, ofB] = weigh(a, b, radius);
      if (weight == 0.0) return;
      total += weight;
      shares.push_back({edge.a, weight - ofB});
      shares.push_back({edge.b, ofB});
    });
    if (total > 0.0) break;
  }
  for (std::size_t k = begin; k < shares.size(); ++k) shares[k].weight /= total;
}

}  // namespace froude
