#include <froude/solver/fluid/fluid_query.h>

#include <array>

#include <froude/solver/fluid/fluid_cells.h>
#include <froude/solver/fluid/wall_integral.h>

namespace froude {

void FluidQuery::update(const ParticlePool& pool, const DomainDef& domain, double spacing, std::uint64_t version) {
  if (version == version_) return;
  version_ = version;
  spacing_ = spacing;
  empty_ = pool.empty();
  if (empty_) return;
  const auto x = pool.x(), y = pool.y();
  grid_.build(x, y, fluidFrame(domain, x, y, kernel::kSupport * spacing));
  x_.resize(pool.size());
  y_.resize(pool.size());
  for (std::size_t k = 0; k < pool.size(); ++k) {
    x_[k] = x[grid_.order()[k]];
    y_[k] = y[grid_.order()[k]];
  }
}

double FluidQuery::filledFraction(const Obstacles& obstacles, const CollisionFilter& filter, const Vec2& x) const {
  double phi = 0.0;
  const double support = kernel::kSupport * spacing_;
  if (obstacles.clearance(x) >= support) {
    forEachNear(x, [&](std::uint32_t, const Vec2&, double w) { phi += w; });
    return phi;
  }
  if (obstacles.distance(x, filter).distance < 0.0) return std::nan("");
  std::array<WallEdge, kMaxWallEdges> buffer;
  std::array<WallShare, kMaxWallEdges> shares;
  const std::size_t n = obstacles.edgesNear(x, support, spacing_, filter, {buffer.data(), buffer.size()});
  const std::span<const WallEdge> edges(buffer.data(), n);
  const std::size_t owners = integrateWalls(edges, shares);
  for (std::size_t k = 0; k < owners; ++k) phi += shares[k].lambda;
  forEachNear(x, [&](std::uint32_t, const Vec2& p, double w) {
    for (const WallEdge& e : edges) {
      if (hidesPoint(e, p)) return;
    }
    phi += w;
  });
  return phi;
}

}  // namespace froude
