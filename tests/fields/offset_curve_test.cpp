// Offset curves against closed forms, and against the distance to every edge in long double.
#include <gtest/gtest.h>

#include <froude/fields/offset_curve.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

double lengthOf(const std::vector<OffsetPiece>& pieces, double offset) {
  double length = 0.0;
  for (const OffsetPiece& p : pieces)
    length += p.feature == FeatureKind::Edge ? (p.to - p.from).norm() : std::abs(offset * p.sweep);
  return length;
}

TEST(OffsetCurve, round_a_convex_shape_is_longer_by_a_circle) {
  for (const int sides : {3, 4, 7, 100}) {
    const Polygon polygon = Polygon::regular(sides, 0.7);
    const double perimeter = 2.0 * 0.7 * sides * std::sin(kPi / sides);
    for (const double offset : {1e-6, 0.1, 5.0}) {
      const std::vector<OffsetPiece> pieces = offsetCurve(polygon, offset);
      EXPECT_EQ(pieces.size(), 2u * static_cast<std::size_t>(sides));
      EXPECT_NEAR(lengthOf(pieces, offset), perimeter + 2.0 * kPi * offset, 1e-13 * (1.0 + offset) * sides);
    }
  }
}

TEST(OffsetCurve, within_a_box_is_a_smaller_box_and_then_nothing) {
  const Polygon polygon = Polygon::box({{0.0, 0.0}, {3.0, 1.0}});
  const std::vector<OffsetPiece> pieces = offsetCurve(polygon, -0.25);
  ASSERT_EQ(pieces.size(), 4u);
  EXPECT_NEAR(lengthOf(pieces, -0.25), 2.0 * (2.5 + 0.5), 1e-14);
  EXPECT_TRUE(offsetCurve(polygon, -0.5000001).empty());
}

// Outside an L, the notch is cut where its two sides' parallels meet; inside, its reflex corner has an arc.
TEST(OffsetCurve, of_an_L_has_its_mitre_outside_and_its_arc_inside) {
  const Polygon polygon = Polygon::make({{0, 0}, {2, 0}, {2, 0.5}, {0.5, 0.5}, {0.5, 2}, {0, 2}});
  const double r = 0.1;
  EXPECT_NEAR(lengthOf(offsetCurve(polygon, r), r), 8.0 - 2.0 * r + 5.0 * 0.5 * kPi * r, 1e-14);
  const std::vector<OffsetPiece> inside = offsetCurve(polygon, -r);
  EXPECT_NEAR(lengthOf(inside, r), 8.0 - 5.0 * 2.0 * r + 0.5 * kPi * r, 1e-14);
  int arcs = 0;
  for (const OffsetPiece& piece : inside) arcs += piece.feature == FeatureKind::StartVertex ? 1 : 0;
  EXPECT_EQ(arcs, 1);
}

TEST(OffsetCurve, at_zero_is_the_outline_and_a_number_that_is_none_is_refused) {
  const Polygon polygon = Polygon::make({{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}});
  const std::vector<OffsetPiece> pieces = offsetCurve(polygon, 0.0);
  ASSERT_EQ(pieces.size(), 4u);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(pieces[i].from, polygon.edgeStart(i));
    EXPECT_NEAR((pieces[i].to - polygon.edgeEnd(i)).norm(), 0.0, 1e-15);
  }
  EXPECT_THROW(offsetCurve(polygon, std::nan("")), Error);
  EXPECT_THROW(offsetCurve(polygon, kInfinity), Error);
}

/// Least distance from p to points of the curve.
double distanceToCurve(const std::vector<OffsetPiece>& pieces, const Polygon& polygon, double offset, const Vec2& p) {
  double best = kInfinity;
  for (const OffsetPiece& piece : pieces) {
    best = std::min({best, (p - piece.from).norm(), (p - piece.to).norm()});
    if (piece.feature == FeatureKind::Edge) {
      const auto d = static_cast<double>(test::segmentDistance({piece.from, piece.to}, p));
      best = std::min(best, d);
      continue;
    }
    const Vec2 arm = p - polygon.edgeStart(piece.edge);
    const double sense = piece.sweep > 0.0 ? 1.0 : -1.0;
    const double turned = std::remainder(sense * (std::atan2(arm.y(), arm.x()) - piece.startAngle), 2.0 * kPi);
    if (turned >= 0.0 && turned <= std::abs(piece.sweep))
      best = std::min(best, std::abs(arm.norm() - std::abs(offset)));
  }
  return best;
}

class OffsetCurveOfAnyShape : public ::testing::TestWithParam<int> {};

TEST_P(OffsetCurveOfAnyShape, has_its_distance_everywhere) {
  RandomStream random(911, static_cast<std::uint64_t>(GetParam()));
  for (int round = 0; round < 60; ++round) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(GetParam()), random);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    const double offset = (random.below(2) == 0 ? 1.0 : -1.0) * std::pow(10.0, random.uniform(-5.0, -0.3));
    const double rounding = 2e-14 * (1.0 + std::abs(offset));
    for (const OffsetPiece& piece : offsetCurve(polygon, offset)) {
      ASSERT_EQ(piece.at(0.0, polygon, offset).isApprox(piece.from, 1e-12), true);
      ASSERT_LT(std::abs(piece.sweep), kPi + 1e-9);
      for (const double u : {0.0, 1e-9, 0.3, random.uniform(), 1.0})
        ASSERT_NEAR(static_cast<double>(test::signedDistance(edges, piece.at(u, polygon, offset))), offset, rounding)
            << "round " << round << ", offset " << offset << ", edge " << piece.edge;
    }
  }
}

// On a way from nearer to farther there is a point at the offset; the curve passes there.
TEST_P(OffsetCurveOfAnyShape, misses_no_point) {
  RandomStream random(912, static_cast<std::uint64_t>(GetParam()));
  int found = 0;
  for (int round = 0; round < 40; ++round) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(GetParam()), random);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    const double offset = (random.below(4) != 0 ? 1.0 : -1.0) * std::pow(10.0, random.uniform(-5.0, -0.3));
    const std::vector<OffsetPiece> pieces = offsetCurve(polygon, offset);
    for (int k = 0; k < 30; ++k) {
      const std::uint32_t e = random.below(polygon.edgeCount());
      const Vec2 on = polygon.edgeStart(e) + random.uniform() * (polygon.edgeEnd(e) - polygon.edgeStart(e));
      const Vec2 away = on + random.uniform(0.5, 3.0) * std::abs(offset) *
                                 test::generator::polar(1.0, random.uniform(0.0, 2.0 * kPi));
      const auto d = [&](double t) { return static_cast<double>(test::signedDistance(edges, on + t * (away - on))); };
      double low = 0.0, high = 1.0;
      if ((d(low) < offset) == (d(high) < offset)) continue;
      const bool rising = d(low) < offset;
      for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        ((d(middle) < offset) == rising ? low : high) = middle;
      }
      ++found;
      ASSERT_LT(distanceToCurve(pieces, polygon, offset, on + low * (away - on)), 1e-6 * std::abs(offset) + 1e-9)
          << "round " << round << ", offset " << offset;
    }
  }
  EXPECT_GT(found, 100);
}

INSTANTIATE_TEST_SUITE_P(Shapes, OffsetCurveOfAnyShape, ::testing::Range(0, test::kShapeCount));

}  // namespace
}  // namespace froude
