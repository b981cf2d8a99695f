// The outline that questions about fields are asked of: wavy, of any number of edges, within the unit square.
#pragma once

#include <cmath>
#include <vector>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>

namespace froude::bench {

/// About 0.8 m across. Fewer than 100 edges cannot follow the waves: those get a single lobe.
inline Polygon wavyOutline(int edges) {
  std::vector<Vec2> ring;
  for (int i = 0; i < edges; ++i) {
    const double f = 2.0 * kPi * i / edges;
    const double r = edges < 100 ? 0.3 + 0.1 * std::sin(f) : 0.3 + 0.1 * std::sin(7.0 * f) + 0.02 * std::sin(61.0 * f);
    ring.push_back(Vec2(0.5, 0.5) + r * Vec2(std::cos(f), std::sin(f)));
  }
  return Polygon::make(std::move(ring));
}

/// Points as columns.
struct Points {
  std::vector<double> x, y;
  void add(const Vec2& p) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
};

enum class Where {
  Coherent,  ///< in the band, in the order of cells of half a band, as particles lie in memory
  Band,      ///< in the band, in no order
  Box        ///< anywhere in the unit square, in no order
};

inline Points pointsFor(const DistanceField& field, Where where, std::size_t count) {
  RandomStream random(1, 1);
  std::vector<Vec2> points;
  while (points.size() < count) {
    const Vec2 p(random.uniform(), random.uniform());
    if (where != Where::Box && std::abs(field.sampleExact(p).distance) > field.band()) continue;
    points.push_back(p);
  }
  if (where == Where::Coherent) {
    const double cell = 0.5 * field.band();
    const auto row = [&](const Vec2& p) { return std::floor(p.y() / cell); };
    const auto column = [&](const Vec2& p) { return std::floor(p.x() / cell); };
    std::stable_sort(points.begin(), points.end(), [&](const Vec2& a, const Vec2& b) {
      return row(a) != row(b) ? row(a) < row(b) : column(a) < column(b);
    });
  }
  Points columns;
  for (const Vec2& p : points) columns.add(p);
  return columns;
}

}  // namespace froude::bench
