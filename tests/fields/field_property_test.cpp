// Distance, side and closest feature at a million random points over ten thousand random polygons, against every edge
// in long double and exact predicates.
#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>

#include <froude/base/parallel.h>
#include <froude/base/random.h>
#include <froude/fields/distance_field.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

struct Drawn {
  Polygon polygon;
  double band;
};

/// A random shape, turned, scaled by 10⁻³ … 10³, and sometimes far from the origin.
Drawn draw(RandomStream& random) {
  const auto shape = static_cast<test::Shape>(random.below(test::kShapeCount));
  const double scale = std::pow(10.0, random.uniform(-3.0, 3.0));
  const double far = random.below(4) == 0 ? 1e6 * scale : scale;
  const Vec2 offset(random.uniform(-far, far), random.uniform(-far, far));
  // Far away thin shapes can collapse onto the lattice of doubles: those are refused, and drawn again.
  while (true) {
    try {
      const test::Outline outline = test::makeOutline(shape, random);
      return {test::placed(outline, scale, Transform::of(offset, random.uniform(0.0, 6.3))),
              scale * std::pow(10.0, random.uniform(-2.0, -0.5))};
    } catch (const PolygonError&) {
    }
  }
}

/// Half of the points anywhere round the polygon, half near its outline, some of these within a few roundings.
Vec2 pointFor(const Polygon& polygon, double band, RandomStream& random) {
  if (random.below(2) == 0) {
    const Box box = polygon.bounds().grown(band);
    return box.min + Vec2(random.uniform() * box.size().x(), random.uniform() * box.size().y());
  }
  const std::uint32_t e = random.below(polygon.edgeCount());
  const Vec2 on = polygon.edgeStart(e) + random.uniform() * (polygon.edgeEnd(e) - polygon.edgeStart(e));
  const double off = band * std::pow(10.0, random.uniform(-14.0, 0.0));
  return on + off * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
}

struct Worst {
  long points = 0;
  long inBand = 0;
  long wrongSides = 0;
  long wrongFeatures = 0;
  long wrongBounds = 0;
  double error = 0.0;  // of a distance [units in the last place of the largest coordinate]

  void include(const Worst& w) {
    points += w.points;
    inBand += w.inBand;
    wrongSides += w.wrongSides;
    wrongFeatures += w.wrongFeatures;
    wrongBounds += w.wrongBounds;
    error = std::max(error, w.error);
  }
};

Worst judge(std::uint64_t stream, int points) {
  RandomStream random(41, stream);
  const Drawn drawn = draw(random);
  const DistanceField field(drawn.polygon, drawn.band);
  const std::vector<test::OracleEdge> edges = test::oracleEdges(drawn.polygon);
  const Box all = drawn.polygon.bounds();
  Worst worst;
  for (int i = 0; i < points; ++i) {
    const Vec2 p = pointFor(drawn.polygon, drawn.band, random);
    const double largest =
        std::max({all.min.cwiseAbs().maxCoeff(), all.max.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff()});
    const double ulp = std::nextafter(largest, kInfinity) - largest;
    const FieldSample s = field.sample(p);
    const long double exact = test::boundaryDistance(edges, p);
    const int where = test::whereIs(edges, p);
    ++worst.points;
    const bool inBand = exact <= static_cast<long double>(drawn.band);
    worst.inBand += inBand;
    if (!s.exact) {
      worst.wrongBounds += inBand || static_cast<long double>(std::abs(s.distance)) > exact * (1.0L + 1e-12L);
      worst.wrongSides += where == 0 || (s.distance > 0.0) != (where < 0);
      continue;
    }
    const auto error = static_cast<double>(std::abs(static_cast<long double>(std::abs(s.distance)) - exact));
    worst.error = std::max(worst.error, error / ulp);
    // On the boundary the distance is 0; where it underflows to 0 beside it, there is no side to be wrong about.
    worst.wrongSides += where == 0 ? s.distance != 0.0 : s.distance != 0.0 && (s.distance > 0.0) != (where < 0);
    // The feature that is named holds a point as near as any.
    const long double named = test::segmentDistance(edges[static_cast<std::size_t>(s.edge)], p);
    worst.wrongFeatures += named > exact + 4.0L * static_cast<long double>(ulp);
  }
  return worst;
}

TEST(LongFieldProperty, no_wrong_side_and_no_error_above_four_units_in_the_last_place) {
  constexpr std::size_t kPolygons = 10000;
  const int points = std::getenv("FROUDE_LONG") != nullptr ? 1000 : 100;
  std::mutex mutex;
  Worst all;
  parallelFor(kPolygons, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Worst worst = judge(k, points);
      const std::lock_guard lock(mutex);
      all.include(worst);
      if (worst.wrongSides + worst.wrongFeatures + worst.wrongBounds > 0 || worst.error > 4.0) {
        ADD_FAILURE() << "polygon " << k << ": " << worst.wrongSides << " wrong sides, " << worst.wrongFeatures
                      << " wrong features, " << worst.wrongBounds << " wrong bounds, error " << worst.error << " ulp";
      }
    }
  });
  EXPECT_EQ(all.points, static_cast<long>(kPolygons) * points);
  EXPECT_GT(all.inBand, all.points / 2);
  RecordProperty("largest_error_ulp", std::to_string(all.error));
}

}  // namespace
}  // namespace froude
