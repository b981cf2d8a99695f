#include "validation/read_off.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <froude/particles/cell_grid.h>

namespace froude::validation {

double velocityError(const ParticlePool& pool, const Flow& exact) {
  double difference = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const Vec2 right = exact({pool.x()[i], pool.y()[i]});
    difference += (Vec2(pool.vx()[i], pool.vy()[i]) - right).squaredNorm();
    scale += right.squaredNorm();
  }
  return std::sqrt(difference / scale);
}

std::vector<double> stripMeans(std::size_t count, double from, double to, int bins,
                               const std::function<double(std::size_t)>& position,
                               const std::function<double(std::size_t)>& difference) {
  std::vector<double> sums(static_cast<std::size_t>(bins)), counts(sums.size());
  for (std::size_t i = 0; i < count; ++i) {
    const double place = (position(i) - from) / (to - from) * bins;
    const auto k = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, bins - 1.0));
    sums[k] += difference(i);
    counts[k] += 1.0;
  }
  std::vector<double> means;
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (counts[k] > 0.0) means.push_back(sums[k] / counts[k]);
  return means;
}

double Moments::axisX() const { return 2.0 * std::sqrt(xx); }
double Moments::axisY() const { return 2.0 * std::sqrt(yy); }

Moments moments(const ParticlePool& pool) {
  Moments m;
  const auto n = static_cast<double>(pool.size());
  for (std::size_t i = 0; i < pool.size(); ++i) m.centre += Vec2(pool.x()[i], pool.y()[i]) / n;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const double x = pool.x()[i], y = pool.y()[i], u = pool.vx()[i], v = pool.vy()[i];
    const double dx = x - m.centre.x(), dy = y - m.centre.y();
    m.xx += dx * dx / n;
    m.yy += dy * dy / n;
    m.xy += dx * dy / n;
    m.kinetic += 0.5 * (u * u + v * v) / n;
    m.angular += (x * v - y * u) / n;
  }
  return m;
}

Clumping clumping(const ParticlePool& pool, double close, double link) {
  Clumping result;
  result.leastDistance = kInfinity;
  const std::size_t n = pool.size();
  if (n == 0) return result;
  Box box;
  for (std::size_t i = 0; i < n; ++i) box.include({pool.x()[i], pool.y()[i]});
  CellGrid grid;
  grid.build(pool.x(), pool.y(), GridFrame::cover(box, link));
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::size_t crowded = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double nearest = kInfinity;
    grid.forEachRun(grid.cellOf(pool.x()[i], pool.y()[i]), [&](const CellRun& run) {
      for (std::uint32_t k = run.begin; k < run.end; ++k) {
        const std::size_t j = grid.order()[k];
        if (j == i) continue;
        const double d = std::hypot(pool.x()[i] - pool.x()[j], pool.y()[i] - pool.y()[j]);
        nearest = std::min(nearest, d);
        if (d < link) parent[root(i)] = root(j);
      }
    });
    result.leastDistance = std::min(result.leastDistance, nearest);
    if (nearest < close) ++crowded;
  }
  for (std::size_t i = 0; i < n; ++i) result.components += parent[i] == i ? 1 : 0;
  result.closeShare = static_cast<double>(crowded) / static_cast<double>(n);
  return result;
}

}  // namespace froude::validation
