#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include <froude/base/random.h>
#include <froude/fields/polygon.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

using Reason = PolygonError::Reason;
using Ring = std::vector<Vec2>;

const Ring kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/// The reason for which `make` refuses; fails if it does not, or if the message does not contain `words`.
void expectRefused(Reason reason, const std::string& words, const Ring& outer, const std::vector<Ring>& holes = {}) {
  try {
    Polygon::make(outer, holes);
    ADD_FAILURE() << "accepted, though it should be refused: " << words;
  } catch (const PolygonError& error) {
    EXPECT_EQ(static_cast<int>(error.reason()), static_cast<int>(reason)) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

nlohmann::json golden() {
  std::ifstream file(std::string(FROUDE_TEST_DATA) + "/geometry_polygons.json");
  return nlohmann::json::parse(file).at("polygons");
}

Ring ringOf(const nlohmann::json& loop) {
  Ring ring;
  for (const auto& v : loop) ring.emplace_back(v[0].get<double>(), v[1].get<double>());
  return ring;
}

Polygon polygonOf(const nlohmann::json& entry) {
  std::vector<Ring> holes;
  for (std::size_t i = 1; i < entry.at("loops").size(); ++i) holes.push_back(ringOf(entry.at("loops")[i]));
  return Polygon::make(ringOf(entry.at("loops")[0]), holes);
}

TEST(Polygon, area_centroid_and_second_moment_equal_the_golden_values) {
  const nlohmann::json polygons = golden();
  ASSERT_EQ(polygons.size(), 17u);
  for (const auto& [name, entry] : polygons.items()) {
    std::vector<std::string> notes;
    const Polygon polygon = polygonOf(entry);
    const double size = polygon.bounds().size().maxCoeff();
    EXPECT_EQ(polygon.edgeCount(), entry.at("n").get<std::uint32_t>()) << name;
    EXPECT_NEAR(polygon.area(), entry.at("A").get<double>(), 1e-14 * entry.at("A").get<double>()) << name;
    EXPECT_NEAR(polygon.centroid().x(), entry.at("cx").get<double>(), 1e-14 * size) << name;
    EXPECT_NEAR(polygon.centroid().y(), entry.at("cy").get<double>(), 1e-14 * size) << name;
    EXPECT_NEAR(polygon.secondMoment(), entry.at("Jp_c").get<double>(), 1e-14 * entry.at("Jp_c").get<double>()) << name;
  }
}

TEST(Polygon, contains_agrees_with_the_golden_signs) {
  const nlohmann::json polygons = golden();
  for (const auto& [name, entry] : polygons.items()) {
    const Polygon polygon = polygonOf(entry);
    for (const auto& row : entry.at("signed_distance")) {
      const double d = row[2].get<double>();
      EXPECT_EQ(polygon.contains({row[0].get<double>(), row[1].get<double>()}), d <= 0.0) << name << ' ' << row;
    }
  }
}

TEST(Polygon, moments_are_accurate_far_from_the_origin) {
  const Box box{{1e6 - 0.5, -1e6}, {1e6 + 0.5, -1e6 + 0.25}};
  const Polygon polygon = Polygon::box(box);
  EXPECT_NEAR(polygon.area(), 0.25, 1e-15);
  EXPECT_NEAR(polygon.centroid().x(), 1e6, 1e-9);
  EXPECT_NEAR(polygon.centroid().y(), -1e6 + 0.125, 1e-9);
  EXPECT_NEAR(polygon.secondMoment(), 0.25 * (1.0 + 0.0625) / 12.0, 1e-15);
}

TEST(Polygon, edges_run_round_each_ring_with_the_solid_on_the_left) {
  const Polygon polygon = Polygon::make(kSquare, {{{0.25, 0.25}, {0.75, 0.25}, {0.5, 0.75}}});
  ASSERT_EQ(polygon.edgeCount(), 7u);
  ASSERT_EQ(polygon.ringStarts().size(), 3u);
  EXPECT_EQ(polygon.ringStarts()[1], 4u);
  for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
    EXPECT_EQ(polygon.previous(polygon.next(i)), i);
    EXPECT_EQ(polygon.edgeEnd(i), polygon.edgeStart(polygon.next(i)));
    const Vec2 middle = 0.5 * (polygon.edgeStart(i) + polygon.edgeEnd(i));
    const Vec2 inwards = leftNormal(polygon.edgeEnd(i) - polygon.edgeStart(i)).normalized();
    EXPECT_TRUE(polygon.contains(middle + 1e-6 * inwards)) << i;
    EXPECT_FALSE(polygon.contains(middle - 1e-6 * inwards)) << i;
    EXPECT_EQ(polygon.convexAt(i), i < 4) << i;
  }
  EXPECT_NEAR(polygon.area(), 1.0 - 0.125, 1e-15);
}

TEST(Polygon, boundary_points_count_as_contained) {
  const Polygon polygon = Polygon::make(kSquare, {{{0.25, 0.25}, {0.75, 0.25}, {0.5, 0.75}}});
  for (const Vec2& p : polygon.vertices()) EXPECT_TRUE(polygon.contains(p));
  EXPECT_TRUE(polygon.contains({0.5, 0.0}));
  EXPECT_TRUE(polygon.contains({1.0, 0.5}));
  EXPECT_TRUE(polygon.contains({0.5, 0.25}));
  EXPECT_FALSE(polygon.contains({0.5, 0.25 + 1e-16 * 4}));
  EXPECT_FALSE(polygon.contains({1.0 + 3e-16, 0.5}));
  EXPECT_FALSE(polygon.contains({2.0, 0.0}));
}

TEST(Polygon, a_regular_polygon_is_centred_with_its_first_vertex_at_angle_0) {
  const Polygon polygon = Polygon::regular(6, 2.0);
  EXPECT_EQ(polygon.vertices()[0], Vec2(2.0, 0.0));
  EXPECT_NEAR(polygon.area(), 6.0 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(polygon.centroid().norm(), 0.0, 1e-15);
  EXPECT_GT(polygon.vertices()[1].y(), 0.0);
}

TEST(Polygon, a_transform_keeps_area_and_moment_and_moves_the_centroid) {
  RandomStream random(3, 1);
  for (int s = 0; s < test::kShapeCount; ++s) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(s), random);
    const Transform transform = Transform::of({3.0, -2.0}, 1.1);
    const Polygon moved = polygon.transformed(transform);
    EXPECT_NEAR(moved.area(), polygon.area(), 1e-14);
    EXPECT_NEAR(moved.secondMoment(), polygon.secondMoment(), 1e-13);
    EXPECT_NEAR((moved.centroid() - transform.toWorld(polygon.centroid())).norm(), 0.0, 1e-11);
    EXPECT_EQ(moved.edgeEnd(1), transform.toWorld(polygon.edgeEnd(1)));
  }
}

TEST(Polygon, wrong_winding_is_turned_round_with_a_note) {
  std::vector<std::string> notes;
  const Polygon polygon =
      Polygon::make({{0, 1}, {1, 1}, {1, 0}, {0, 0}}, {{{0.2, 0.2}, {0.4, 0.2}, {0.4, 0.4}}}, &notes);
  EXPECT_NEAR(polygon.area(), 1.0 - 0.02, 1e-15);
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_NE(notes[0].find("clockwise"), std::string::npos) << notes[0];
  EXPECT_NE(notes[1].find("hole 0"), std::string::npos) << notes[1];
}

TEST(Polygon, repeated_vertices_are_left_out_with_a_note) {
  std::vector<std::string> notes;
  const Polygon polygon = Polygon::make({{0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {0, 0}}, {}, &notes);
  EXPECT_EQ(polygon.edgeCount(), 4u);
  ASSERT_EQ(notes.size(), 3u);
  EXPECT_NE(notes[0].find("vertex 2"), std::string::npos) << notes[0];
  EXPECT_NE(notes.back().find("closing"), std::string::npos) << notes.back();
}

TEST(Polygon, vertices_on_a_straight_run_are_left_out_with_a_note) {
  std::vector<std::string> notes;
  const Polygon polygon =
      Polygon::make({{0, 0}, {0.25, 0}, {0.5, 0}, {0.75, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0.5}}, {}, &notes);
  EXPECT_EQ(polygon.edgeCount(), 4u);
  EXPECT_EQ(notes.size(), 4u);
}

TEST(Polygon, a_vertex_one_ulp_off_a_straight_run_stays) {
  std::vector<std::string> notes;
  const double below = std::nextafter(0.0, -1.0) * 0.0 - 1e-16;
  EXPECT_EQ(Polygon::make({{0, 0}, {0.5, below}, {1, 0}, {1, 1}, {0, 1}}, {}, &notes).edgeCount(), 5u);
  EXPECT_TRUE(notes.empty());
}

TEST(Polygon, too_few_vertices_are_refused) {
  expectRefused(Reason::TooFewVertices, "needs at least 3", {});
  expectRefused(Reason::TooFewVertices, "2 different vertices", {{0, 0}, {1, 0}, {0, 0}});
  expectRefused(Reason::TooFewVertices, "hole 0", kSquare, {{{0.5, 0.5}}});
  EXPECT_THROW(Polygon::regular(2, 1.0), PolygonError);
}

TEST(Polygon, coordinates_that_are_not_finite_are_refused) {
  expectRefused(Reason::NonFinite, "vertex 1", {{0, 0}, {std::nan(""), 0}, {1, 1}});
  expectRefused(Reason::NonFinite, "vertex 2", {{0, 0}, {1, 0}, {1, kInfinity}});
  EXPECT_THROW(Polygon::box(Box()), PolygonError);
}

TEST(Polygon, no_area_is_refused) {
  expectRefused(Reason::ZeroArea, "no area", {{0, 0}, {1, 1}, {2, 2}});
  expectRefused(Reason::ZeroArea, "no area", {{0, 0}, {1, 0}, {2, 0}, {1, 0}});
  expectRefused(Reason::ZeroArea, "not a normal number", {{0, 0}, {1e-100, 0}, {0, 1e-100}});
  EXPECT_THROW(Polygon::box({{0, 0}, {1, 0}}), PolygonError);
}

TEST(Polygon, crossing_itself_is_refused) {
  expectRefused(Reason::SelfCrossing, "crosses itself", {{0, 0}, {1, 1}, {1, 0}, {0, 1}});
  expectRefused(Reason::SelfCrossing, "touches itself", {{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}});
  expectRefused(Reason::SelfCrossing, "touches itself", {{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}});
  expectRefused(Reason::SelfCrossing, "turns back", {{0, 0}, {2, 0}, {1, 0}, {1, 2}});
  expectRefused(Reason::SelfCrossing, "touches itself",
                {{0, 0}, {3, 0}, {3, 1}, {2, 1}, {2, 0}, {1, 0}, {1, 1}, {0, 1}});
}

TEST(Polygon, a_hole_outside_is_refused) {
  expectRefused(Reason::HoleOutside, "outside the outer ring", kSquare, {{{2, 2}, {3, 2}, {3, 3}}});
  expectRefused(Reason::HoleOutside, "crosses the outer ring", kSquare, {{{0.5, 0.5}, {1.5, 0.4}, {1.5, 0.7}}});
  expectRefused(Reason::HoleOutside, "outside the outer ring", kSquare, {{{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}});
}

TEST(Polygon, a_hole_that_touches_is_refused) {
  expectRefused(Reason::HoleTouching, "touches the outer ring", kSquare, {{{0.5, 0.0}, {0.75, 0.5}, {0.25, 0.5}}});
  expectRefused(Reason::HoleTouching, "touches hole 0", kSquare,
                {{{0.1, 0.1}, {0.4, 0.1}, {0.4, 0.4}}, {{0.4, 0.2}, {0.8, 0.1}, {0.8, 0.4}}});
}

TEST(Polygon, holes_that_overlap_are_refused) {
  expectRefused(Reason::HolesOverlap, "crosses hole 0", kSquare,
                {{{0.1, 0.1}, {0.5, 0.1}, {0.5, 0.5}}, {{0.4, 0.2}, {0.8, 0.1}, {0.8, 0.4}}});
  expectRefused(Reason::HolesOverlap, "inside hole 0", kSquare,
                {{{0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}}, {{0.4, 0.4}, {0.6, 0.4}, {0.5, 0.6}}});
}

TEST(Polygon, one_crossing_among_ten_thousand_edges_is_found_and_none_is_invented) {
  // A zigzag ribbon; every tooth is a chance for a false alarm. Quadratic work would take 1e8 exact tests.
  const int teeth = 5000;
  Ring ring;
  for (int i = 0; i < teeth; ++i) ring.emplace_back(i, i % 2 == 0 ? 0.0 : 1000.0);
  for (int i = teeth - 1; i >= 0; --i) ring.emplace_back(i, i % 2 == 0 ? 0.9 : 1000.9);
  EXPECT_EQ(Polygon::make(ring).edgeCount(), 2u * teeth);
  ring[1234].y() = 1001.5;
  expectRefused(Reason::SelfCrossing, "crosses itself", ring);
}

TEST(Polygon, random_outlines_of_every_shape_are_accepted_at_every_scale) {
  RandomStream random(11, 0);
  for (int k = 0; k < 400; ++k) {
    const auto shape = static_cast<test::Shape>(k % test::kShapeCount);
    const test::Outline outline = test::makeOutline(shape, random);
    const double scale = std::pow(10.0, random.uniform(-3.0, 3.0));
    const Polygon polygon = test::placed(outline, scale, Transform::of({0, 0}, random.uniform(0.0, 6.3)));
    EXPECT_GT(polygon.area(), 0.0);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    for (int i = 0; i < 50; ++i) {
      const Vec2 size = polygon.bounds().size();
      const Vec2 p =
          polygon.bounds().min + Vec2(random.uniform(-0.1, 1.1) * size.x(), random.uniform(-0.1, 1.1) * size.y());
      ASSERT_EQ(polygon.contains(p), test::whereIs(edges, p) >= 0) << outline.name;
    }
  }
}

}  // namespace
}  // namespace froude
