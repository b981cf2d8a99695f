// Entries of straight pieces into polygons: by hand, against all edges, and against exact midpoints on a lattice.
#include <froude/fields/crossing.h>

#include <gtest/gtest.h>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/world_field.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

bool enters(const Polygon& polygon, const Vec2& from, const Vec2& to) {
  return enteredEdge(DistanceField(polygon, 0.05), from, to) >= 0;
}

TEST(Crossing, a_piece_through_a_thin_plate_enters_it_from_both_sides) {
  const Polygon plate = Polygon::box({{-0.5, -0.5e-4}, {0.5, 0.5e-4}});
  EXPECT_TRUE(enters(plate, {0.0, 5.0}, {0.1, -5.0}));
  EXPECT_TRUE(enters(plate, {0.0, -5.0}, {0.1, 5.0}));
  EXPECT_TRUE(enters(plate, {0.0, 1e-4}, {0.0, -1e-4}));
  EXPECT_TRUE(enters(plate, {-9.0, 0.0}, {9.0, 0.0})) << "lengthwise";
  EXPECT_TRUE(enters(plate, {0.0, 1e-4}, {0.0, 0.0})) << "and stays";
  EXPECT_FALSE(enters(plate, {0.0, 5.0}, {0.0, 1e-4}));
  EXPECT_FALSE(enters(plate, {0.6, 5.0}, {0.6, -5.0})) << "past its end";
  EXPECT_FALSE(enters(plate, {0.2, 0.3}, {0.2, 0.3})) << "at rest";
}

TEST(Crossing, along_an_edge_and_onto_it_is_no_entry) {
  const Polygon box = Polygon::box({{0.0, 0.0}, {1.0, 1.0}});
  EXPECT_FALSE(enters(box, {0.2, 1.0}, {0.8, 1.0}));
  EXPECT_FALSE(enters(box, {-1.0, 1.0}, {2.0, 1.0})) << "the whole edge and on";
  EXPECT_FALSE(enters(box, {0.5, 2.0}, {0.5, 1.0})) << "ends on it";
  EXPECT_FALSE(enters(box, {2.0, 2.0}, {1.0, 1.0})) << "ends on a vertex";
}

TEST(Crossing, a_start_on_the_boundary_enters_only_inwards) {
  const Polygon box = Polygon::box({{0.0, 0.0}, {1.0, 1.0}});
  EXPECT_TRUE(enters(box, {0.5, 1.0}, {0.6, 0.9}));
  EXPECT_TRUE(enters(box, {0.5, 1.0}, {0.5, -1.0})) << "and out again";
  EXPECT_TRUE(enters(box, {1.0, 1.0}, {0.5, 0.5})) << "from a vertex";
  EXPECT_FALSE(enters(box, {0.5, 1.0}, {0.6, 1.5}));
  EXPECT_FALSE(enters(box, {1.0, 1.0}, {1.5, 0.5}));
  EXPECT_FALSE(enters(box, {1.0, 1.0}, {1.0, 0.0})) << "from vertex to vertex";
}

TEST(Crossing, a_vertex_that_is_touched_is_not_crossed_and_one_that_is_crossed_counts) {
  const Polygon box = Polygon::box({{0.0, 0.0}, {1.0, 1.0}});
  EXPECT_FALSE(enters(box, {0.5, 1.5}, {1.5, 0.5})) << "past the corner";
  EXPECT_TRUE(enters(box, {1.5, 1.5}, {0.5, 0.5})) << "through it";
  EXPECT_TRUE(enters(box, {2.0, 2.0}, {-1.0, -1.0})) << "from corner to corner";
  EXPECT_FALSE(enters(box, {0.5, 0.5}, {1.5, 1.5})) << "out";
  // The notch of an L at (1, 1): the solid is all round it but for one quarter.
  const Polygon l = Polygon::make({{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}, {0.0, 2.0}});
  EXPECT_TRUE(enters(l, {2.0, 1.0}, {0.5, 1.0})) << "along an edge, then in";
  EXPECT_TRUE(enters(l, {1.5, 1.5}, {0.5, 0.5}));
  EXPECT_FALSE(enters(l, {1.5, 1.5}, {1.0, 1.0}));
  EXPECT_FALSE(enters(l, {0.5, 1.0}, {1.8, 1.0})) << "from inside onto an edge";
}

TEST(Crossing, around_a_corner_neither_of_two_pieces_enters_but_the_short_cut_does) {
  const Polygon box = Polygon::box({{0.0, 0.0}, {1.0, 1.0}});
  EXPECT_FALSE(enters(box, {0.5, 1.1}, {1.1, 1.1}));
  EXPECT_FALSE(enters(box, {1.1, 1.1}, {1.1, 0.5}));
  EXPECT_TRUE(enters(box, {0.5, 1.1}, {1.1, 0.5}));
}

TEST(Crossing, agrees_with_all_edges_on_random_pieces_and_polygons) {
  RandomStream random(71, 0);
  long entered = 0;
  for (int k = 0; k < 80; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    const DistanceField field(polygon, std::pow(10.0, random.uniform(-2.0, -0.5)));
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    for (int piece = 0; piece < 1500; ++piece) {
      const test::OracleEdge& e = edges[random.below(static_cast<std::uint32_t>(edges.size()))];
      const double size = std::pow(10.0, random.uniform(-6.0, 1.0));
      const auto somewhere = [&]() -> Vec2 {
        return size * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      };
      const Vec2 on = e.a + random.uniform(0.0, 1.0) * (e.b - e.a);
      const Vec2 from = on + somewhere(), to = on + somewhere();
      const bool found = enteredEdge(field, from, to) >= 0;
      ASSERT_EQ(found, test::crosses(edges, from, to)) << "polygon " << k << ", piece " << piece;
      entered += found ? 1 : 0;
    }
  }
  EXPECT_GT(entered, 20000);
  EXPECT_LT(entered, 100000);
}

enum class Side { Inside, Boundary, Outside };

Side sideOf(std::span<const test::OracleEdge> edges, const Vec2& p) {
  if (test::boundaryDistance(edges, p) < 1e-9L) return Side::Boundary;
  return test::whereIs(edges, p) > 0 ? Side::Inside : Side::Outside;
}

// The piece is cut at all edges' lines. On a lattice of whole numbers its parts are long, and their middles lie well
// inside, well outside, or along an edge: rounding decides nothing.
bool entersByMiddles(std::span<const test::OracleEdge> edges, const Vec2& from, const Vec2& to) {
  const Vec2 way = to - from;
  std::vector<double> cuts{0.0, 1.0};
  for (const test::OracleEdge& e : edges) {
    const double slope = cross(way, e.b - e.a);
    if (slope != 0.0) cuts.push_back(cross(e.a - from, e.b - e.a) / slope);
    cuts.push_back((e.a - from).dot(way) / way.squaredNorm());
  }
  std::sort(cuts.begin(), cuts.end());
  Side before = sideOf(edges, from);
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (cuts[k] < -1e-12 || cuts[k + 1] > 1.0 + 1e-12 || cuts[k + 1] - cuts[k] < 1e-9) continue;
    const Side now = sideOf(edges, from + 0.5 * (cuts[k] + cuts[k + 1]) * way);
    // What touches the boundary from inside has not come from outside; a cut tells.
    if (now == Side::Inside && before != Side::Inside) return true;
    before = now;
  }
  return false;
}

TEST(Crossing, agrees_with_the_middles_of_its_parts_where_all_is_degenerate) {
  std::vector<Polygon> polygons;
  polygons.push_back(Polygon::make({{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}}));
  polygons.push_back(Polygon::make({{0, 0}, {7, 0}, {7, 5}, {6, 5}, {6, 1}, {4, 1}, {4, 5}, {3, 5}, {3, 1}, {0, 1}}));
  polygons.push_back(Polygon::make({{3, 0}, {6, 3}, {3, 6}, {0, 3}}));
  polygons.push_back(Polygon::make({{0, 0}, {6, 0}, {6, 6}, {3, 2}, {0, 6}}));
  polygons.push_back(Polygon::make({{0, 0}, {6, 0}, {6, 6}, {0, 6}}, {{{2, 2}, {2, 4}, {4, 4}, {4, 2}}}));
  RandomStream random(72, 0);
  long entered = 0, pieces = 0;
  for (const Polygon& polygon : polygons) {
    const DistanceField field(polygon, 0.7);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    for (int k = 0; k < 20000; ++k) {
      const auto node = [&] { return Vec2(static_cast<double>(random.below(11)) - 2.0, random.below(11) - 2.0); };
      const Vec2 from = node(), to = node();
      if (from == to) continue;
      const bool found = enteredEdge(field, from, to) >= 0;
      ASSERT_EQ(found, entersByMiddles(edges, from, to)) << from.transpose() << " to " << to.transpose();
      entered += found ? 1 : 0;
      ++pieces;
    }
  }
  EXPECT_GT(entered, pieces / 10);
  EXPECT_LT(entered, pieces * 9 / 10);
}

TEST(Crossing, of_a_world_knows_body_filter_and_where_a_wall_ends) {
  const Polygon plate = Polygon::box({{-0.5, -0.5e-4}, {0.5, 0.5e-4}});
  const std::vector<PlacedPolygon> placed{{&plate, Transform::of({1.0, 0.5}, 0.0), 4, 1, ~0u},
                                          {&plate, Transform::of({1.0, 1.5}, 0.3), 7, 2, ~0u}};
  const WorldField world(placed, {{{0.0, 0.0}, {2.0, 2.0}}, {true, true, true, false}}, 0.05);
  const auto body = [&](const Vec2& from, const Vec2& to, const CollisionFilter& filter) {
    const std::int32_t edge = world.enteredEdge(from, to, filter);
    return edge < 0 ? -2 : world.edges()[static_cast<std::size_t>(edge)].body;
  };
  EXPECT_EQ(body({1.0, 1.0}, {1.0, 0.2}, {}), 4);
  EXPECT_EQ(body({1.0, 1.0}, {1.0, 1.9}, {}), 7);
  EXPECT_EQ(body({1.0, 1.0}, {1.0, 1.9}, {1, 1}), -2) << "may pass";
  EXPECT_EQ(body({1.0, 1.9}, {1.0, 0.2}, {1, 1}), 4) << "may pass the first, not the second";
  EXPECT_EQ(body({0.2, 0.2}, {-0.1, 0.3}, {}), -1);
  EXPECT_EQ(body({0.2, 0.2}, {-7.0, 0.3}, {}), -1) << "far beyond the grid";
  EXPECT_EQ(body({0.2, 1.9}, {0.3, 9.0}, {}), -2) << "the open side";
  EXPECT_EQ(body({0.02, 1.98}, {-1.0, 8.0}, {}), -2) << "out by the open side first, then past the wall's line";
}

}  // namespace
}  // namespace froude
