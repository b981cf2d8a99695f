#include <froude/solver/fluid/fluid_extent.h>

#include <algorithm>

#include <froude/base/parallel.h>

namespace froude {
namespace {

double extent(std::span<const double> at, double spacing, double whole) {
  struct Range {
    double low, high;
  };
  const auto all = reduceBlocks<Range>(
      at.size(), {kInfinity, -kInfinity},
      [&](std::size_t begin, std::size_t end) {
        Range part{kInfinity, -kInfinity};
        for (std::size_t i = begin; i < end; ++i) part = {std::min(part.low, at[i]), std::max(part.high, at[i])};
        return part;
      },
      [](const Range& a, const Range& b) {
        return Range{std::min(a.low, b.low), std::max(a.high, b.high)};
      });
  return at.empty() ? whole : all.high - all.low + spacing;
}

}  // namespace

double smallerExtent(const ParticlePool& pool, const DomainDef& domain, double spacing) {
  const Vec2 whole = domain.box.size();
  if (domain.periodicX && domain.periodicY) return 0.5 * whole.minCoeff();
  if (domain.periodicX) return extent(pool.y(), spacing, whole.y());
  if (domain.periodicY) return extent(pool.x(), spacing, whole.x());
  return std::min(extent(pool.x(), spacing, whole.x()), extent(pool.y(), spacing, whole.y()));
}

}  // namespace froude
