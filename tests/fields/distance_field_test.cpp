#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

/// A point that is hard for `polygon`: anywhere, on or within rounding of a vertex or an edge, or on the normal of a
/// vertex.
Vec2 hardPoint(const Polygon& polygon, double band, RandomStream& random) {
  const std::uint32_t i = random.below(polygon.edgeCount());
  const Vec2 a = polygon.edgeStart(i);
  const Vec2 b = polygon.edgeEnd(i);
  const double size = polygon.bounds().size().maxCoeff();
  switch (random.below(6)) {
    case 0: {
      const Box box = polygon.bounds().grown(2.0 * band);
      return box.min + Vec2(random.uniform() * box.size().x(), random.uniform() * box.size().y());
    }
    case 1:
      return a;
    case 2:
      return a + random.uniform() * (b - a);
    case 3:
      return a + random.uniform(-1.5, 1.5) * band *
                     (random.below(2) == 0 ? rightNormal(b - a) : leftNormal(b - a)).normalized();
    case 4: {
      const double off = size * std::pow(10.0, random.uniform(-16.0, -1.0));
      return a + random.uniform() * (b - a) + off * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    }
    default: {
      const double off = size * std::pow(10.0, random.uniform(-16.0, -1.0));
      return a + off * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    }
  }
}

/// Everything a sample promises, against the oracle. `unit`: the largest coordinate in play.
void expectSound(const DistanceField& field, const Vec2& p, const FieldSample& s, bool mustBeExact) {
  const std::vector<test::OracleEdge> edges = test::oracleEdges(field.polygon());
  const auto d = static_cast<double>(test::signedDistance(edges, p));
  const Box all = field.polygon().bounds();
  const double unit = std::max({all.min.cwiseAbs().maxCoeff(), all.max.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff()});
  const double rounding = 1e-15 * unit;
  if (!s.exact) {
    ASSERT_FALSE(mustBeExact && std::abs(d) <= field.band());
    ASSERT_LE(std::abs(s.distance), std::abs(d) * (1.0 + 1e-12));
    ASSERT_EQ(s.distance > 0.0, d > 0.0);
    return;
  }
  ASSERT_NEAR(s.distance, d, rounding);
  if (d != 0.0 && s.distance != 0.0) {
    ASSERT_EQ(s.distance > 0.0, d > 0.0) << d;
  }
  ASSERT_NEAR(s.normal.norm(), 1.0, 1e-14);
  ASSERT_NEAR((p - s.distance * s.normal - s.closest).norm(), 0.0, 2.0 * rounding);
  ASSERT_LE(static_cast<double>(test::boundaryDistance(edges, s.closest)), rounding);
  const auto e = static_cast<std::uint32_t>(s.edge);
  ASSERT_LT(e, field.polygon().edgeCount());
  ASSERT_LE(static_cast<double>(test::segmentDistance(edges[e], s.closest)), rounding);
  if (std::abs(d) > 1e4 * rounding) {
    ASSERT_NEAR((s.normal - (p - s.closest) / d).norm(), 0.0, 3.0 * rounding / std::abs(d));
  }
}

TEST(DistanceField, equals_the_golden_distances) {
  std::ifstream file(std::string(FROUDE_TEST_DATA) + "/geometry_polygons.json");
  const nlohmann::json polygons = nlohmann::json::parse(file).at("polygons");
  int checked = 0;
  for (const auto& [name, entry] : polygons.items()) {
    std::vector<std::vector<Vec2>> rings;
    for (const auto& loop : entry.at("loops")) {
      rings.emplace_back();
      for (const auto& v : loop) rings.back().emplace_back(v[0].get<double>(), v[1].get<double>());
    }
    const std::vector<Vec2> outer = rings.front();
    rings.erase(rings.begin());
    const DistanceField field(Polygon::make(outer, rings), 0.1);
    for (const auto& row : entry.at("signed_distance")) {
      const Vec2 p(row[0].get<double>(), row[1].get<double>());
      const double d = row[2].get<double>();
      EXPECT_NEAR(field.sampleExact(p).distance, d, 1e-15) << name;
      EXPECT_EQ(field.sampleExact(p).distance > 0.0, d > 0.0) << name << d;
      if (std::abs(d) <= 0.1) {
        EXPECT_TRUE(field.sample(p).exact) << name;
      }
      ++checked;
    }
  }
  EXPECT_EQ(checked, 17 * 28);
}

TEST(DistanceField, vertices_of_a_shape_of_a_few_units_in_the_last_place_are_on_it) {
  // 8 units in the last place of its coordinates, much less than what rounding can do to a distance there.
  constexpr double kFar = 9e8, kSide = 9.5367431640625e-07;
  const Polygon polygon = Polygon::make({{kFar, kFar}, {kFar + kSide, kFar}, {kFar + kSide, kFar + kSide}});
  const DistanceField field(polygon, kSide);
  for (const Vec2& v : polygon.vertices()) {
    EXPECT_EQ(field.sampleExact(v).distance, 0.0);
    EXPECT_EQ(field.sampleExact(v).closest, v);
  }
  EXPECT_NEAR(field.sampleExact(Vec2(kFar - kSide, kFar)).distance, kSide, 1e-20);
}

TEST(DistanceField, is_exact_in_the_band_and_bounded_beyond_for_every_shape_place_and_scale) {
  RandomStream random(5, 0);
  int exactCount = 0;
  for (int k = 0; k < 160; ++k) {
    const auto shape = static_cast<test::Shape>(k % test::kShapeCount);
    const test::Outline outline = test::makeOutline(shape, random);
    const double scale = k % 4 == 3 ? 1.0 : std::pow(10.0, random.uniform(-3.0, 3.0));
    const Vec2 offset = k % 4 == 3 ? Vec2(1e6, -1e6) : Vec2(0.0, 0.0);
    const Polygon polygon = test::placed(outline, scale, Transform::of(offset, random.uniform(0.0, 6.3)));
    const double band = scale * std::pow(10.0, random.uniform(-2.5, -0.3));
    const DistanceField field(polygon, band);
    for (int i = 0; i < 150; ++i) {
      const Vec2 p = hardPoint(polygon, band, random);
      SCOPED_TRACE(outline.name + " " + std::to_string(k) + " point " + std::to_string(i));
      const FieldSample s = field.sample(p);
      exactCount += s.exact;
      expectSound(field, p, s, true);
      expectSound(field, p, field.sampleExact(p), true);
      ASSERT_TRUE(field.sampleExact(p).exact);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(exactCount, 10000);
}

TEST(DistanceField, the_cell_size_changes_nothing) {
  RandomStream random(6, 0);
  for (int s = 0; s < test::kShapeCount; ++s) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(s), random);
    const DistanceField fine(polygon, 0.05, 0.003);
    const DistanceField coarse(polygon, 0.05, 0.31);
    EXPECT_NEAR(fine.cellSize(), 0.003, 1e-15);
    for (int i = 0; i < 2000; ++i) {
      const Vec2 p = hardPoint(polygon, 0.05, random);
      const FieldSample a = fine.sample(p);
      if (!a.exact) continue;
      const FieldSample b = coarse.sample(p);
      if (std::abs(a.distance) > 0.05 && !b.exact) continue;
      ASSERT_NEAR(a.distance, b.distance, 1e-15);
    }
  }
}

TEST(DistanceField, lower_bound_never_exceeds_the_distance) {
  RandomStream random(8, 0);
  for (int k = 0; k < 40; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    const DistanceField field(polygon, 0.02);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    double best = 0.0;
    for (int i = 0; i < 500; ++i) {
      const Vec2 p(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
      const auto d = static_cast<double>(test::signedDistance(edges, p));
      const double bound = field.lowerBound(p);
      ASSERT_LE(bound, std::max(d, 0.0) * (1.0 + 1e-12));
      if (d > 0.2) best = std::max(best, bound / d);
    }
    EXPECT_GT(best, 0.6) << "a bound that is worth having";
  }
}

TEST(DistanceField, the_tip_of_a_needle_of_aspect_a_million_is_right_on_both_sides) {
  const Polygon needle = Polygon::make({{0.0, 0.0}, {1e-6, 0.0}, {0.5e-6, 1.0}});
  const DistanceField field(needle, 0.1);
  const Vec2 tip = needle.vertices()[2];
  for (const double off : {1e-12, 1e-9, 1e-6, 1e-3, 0.05}) {
    const FieldSample above = field.sample(tip + Vec2(0.0, off));
    EXPECT_NEAR(above.distance, off, 1e-15);
    EXPECT_NEAR(above.normal.y(), 1.0, 1e-9);
    const FieldSample left = field.sample(tip + Vec2(-off, -1e-12));
    EXPECT_GT(left.distance, 0.0);
    EXPECT_LT(left.normal.x(), -0.99);
    const FieldSample right = field.sample(tip + Vec2(off, 0.0));
    EXPECT_NEAR(right.distance, off, 1e-15 + 2e-13 * off);
    EXPECT_GT(right.normal.x(), 0.99);
  }
  EXPECT_NEAR(field.sample({0.5e-6, 0.5}).distance, -0.25e-6, 1e-12);
}

TEST(DistanceField, a_point_on_a_vertex_or_edge_has_distance_zero_and_a_unit_outward_normal) {
  RandomStream random(9, 0);
  for (int k = 0; k < 40; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    const DistanceField field(polygon, 0.05);
    for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
      const FieldSample s = field.sample(polygon.edgeStart(i));
      EXPECT_EQ(s.distance, 0.0);
      EXPECT_NEAR(s.normal.norm(), 1.0, 1e-14);
      const Vec2 before = rightNormal(polygon.edgeStart(i) - polygon.edgeStart(polygon.previous(i))).normalized();
      const Vec2 after = rightNormal(polygon.edgeEnd(i) - polygon.edgeStart(i)).normalized();
      EXPECT_GE(std::max(s.normal.dot(before), s.normal.dot(after)), 0.0);
    }
  }
  const DistanceField square(Polygon::box({{0, 0}, {1, 1}}), 0.1);
  EXPECT_EQ(square.sample({0.5, 0.0}).distance, 0.0);
  EXPECT_EQ(square.sample({0.5, 0.0}).normal, Vec2(0.0, -1.0));
  EXPECT_NEAR((square.sample({1.0, 1.0}).normal - Vec2(1, 1).normalized()).norm(), 0.0, 1e-15);
}

TEST(DistanceField, edges_near_a_point_are_all_found_once_and_in_order) {
  RandomStream random(10, 0);
  std::size_t found = 0;
  for (int k = 0; k < 80; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    const double band = std::pow(10.0, random.uniform(-2.5, 0.0));
    const DistanceField field(polygon, band, k % 3 == 0 ? 0.02 : 0.0);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    for (int i = 0; i < 100; ++i) {
      const Vec2 p = hardPoint(polygon, band, random);
      const double radius = random.uniform(0.0, band);
      std::vector<std::uint32_t> seen;
      field.forEachEdgeNear(p, radius, [&](std::uint32_t e) { seen.push_back(e); });
      ASSERT_TRUE(std::is_sorted(seen.begin(), seen.end()));
      ASSERT_EQ(std::set<std::uint32_t>(seen.begin(), seen.end()).size(), seen.size());
      for (std::uint32_t e = 0; e < edges.size(); ++e) {
        const auto d = static_cast<double>(test::segmentDistance(edges[e], p));
        if (std::abs(d - radius) < 1e-13) continue;
        ASSERT_EQ(std::binary_search(seen.begin(), seen.end(), e), d < radius) << d << ' ' << radius;
      }
      found += seen.size();
    }
  }
  EXPECT_GT(found, 5000u);
}

TEST(DistanceField, a_band_or_cell_size_that_makes_no_sense_is_refused) {
  const Polygon polygon = Polygon::regular(5, 1.0);
  EXPECT_THROW(DistanceField(polygon, 0.0), Error);
  EXPECT_THROW(DistanceField(polygon, -1.0), Error);
  EXPECT_THROW(DistanceField(polygon, kInfinity), Error);
  EXPECT_THROW(DistanceField(polygon, 0.1, -1.0), Error);
  EXPECT_THROW(DistanceField(polygon, 0.1, std::nan("")), Error);
}

TEST(DistanceField, a_point_that_is_not_finite_gets_an_answer_that_is_not_exact) {
  const DistanceField field(Polygon::regular(5, 1.0), 0.1);
  EXPECT_FALSE(field.sample({std::nan(""), 0.0}).exact);
  EXPECT_FALSE(field.sample({kInfinity, 0.0}).exact);
}

TEST(DistanceField, memory_stays_in_proportion) {
  EXPECT_LT(DistanceField(Polygon::box({{0, 0}, {1, 1}}), 0.05).memoryBytes(), 100u * 1024u);
  std::vector<Vec2> circle;
  for (int i = 0; i < 10000; ++i) circle.emplace_back(std::cos(2 * kPi * i / 10000), std::sin(2 * kPi * i / 10000));
  EXPECT_LT(DistanceField(Polygon::make(circle), 0.05).memoryBytes(), 32u * 1024u * 1024u);
}

}  // namespace
}  // namespace froude
