#include <froude/particles/fill.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <froude/fields/polygon.h>

namespace {

using namespace froude;

bool sameSet(std::vector<Vec2> a, std::vector<Vec2> b) {
  const auto less = [](const Vec2& p, const Vec2& q) { return p.y() != q.y() ? p.y() < q.y() : p.x() < q.x(); };
  std::sort(a.begin(), a.end(), less);
  std::sort(b.begin(), b.end(), less);
  return a == b;
}

// Oracle: every place of the lattice, asked one by one.
std::vector<Vec2> everyPlace(const Polygon& shape, double dx) {
  std::vector<Vec2> points;
  const Box& box = shape.bounds();
  for (int j = 0; box.min.y() + (j + 0.5) * dx < box.max.y(); ++j) {
    for (int i = 0; box.min.x() + (i + 0.5) * dx < box.max.x(); ++i) {
      const Vec2 p{box.min.x() + (i + 0.5) * dx, box.min.y() + (j + 0.5) * dx};
      if (shape.contains(p)) points.push_back(p);
    }
  }
  return points;
}

TEST(FillLattice, a_box_of_whole_spacings_holds_as_many_particles_as_its_area_says) {
  for (int n = 1; n < 300; n += 7) {
    for (const double dx : {0.01, 0.1, 1.0 / 3.0}) {
      const FillResult r = fillLattice(Polygon::box({{0.7, -0.2}, {0.7 + n * dx, -0.2 + 3 * dx}}), dx);
      ASSERT_EQ(r.points.size(), static_cast<std::size_t>(3 * n)) << n << " at " << dx;
      EXPECT_EQ(r.cut, 0u);
    }
  }
}

TEST(FillLattice, starts_half_a_spacing_from_the_corner_and_goes_row_by_row) {
  const FillResult r = fillLattice(Polygon::box({{1.0, 2.0}, {1.3, 2.2}}), 0.1);
  ASSERT_EQ(r.points.size(), 6u);
  EXPECT_LT((r.points[0] - Vec2(1.05, 2.05)).norm(), 1e-15);
  EXPECT_LT((r.points[1] - Vec2(1.15, 2.05)).norm(), 1e-15);
  EXPECT_LT((r.points[3] - Vec2(1.05, 2.15)).norm(), 1e-15);
}

TEST(FillLattice, agrees_with_asking_every_place_in_concave_shapes_with_holes) {
  const std::vector<Polygon> shapes{
      Polygon::regular(7, 0.9), Polygon::make({{0, 0}, {2, 0.1}, {1.1, 0.5}, {2.2, 1.3}, {0.9, 0.8}, {0.1, 1.7}}),
      Polygon::make({{0, 0}, {3, 0}, {3, 3}, {0, 3}}, {{{1.03, 1}, {1, 2.04}, {2, 2}, {2, 1}}}),
      Polygon::regular(5, 1.0).transformed(Transform::of({1000.3, -2000.7}, 0.3))};
  for (const Polygon& shape : shapes) {
    for (const double dx : {0.0173, 0.0513, 0.307}) {
      EXPECT_TRUE(sameSet(fillLattice(shape, dx).points, everyPlace(shape, dx))) << dx;
    }
  }
}

TEST(FillLattice, places_on_the_boundary_are_outside_whatever_the_rounding) {
  // Places lie on the slope, (i + j + 1) dx = 1, and on the step at y = 0.5 (odd multiples of dx/2).
  const Polygon slope = Polygon::make({{0, 0}, {1, 0}, {0, 1}});
  EXPECT_EQ(fillLattice(slope, 0.1).points.size(), 45u);
  EXPECT_EQ(fillLattice(slope, 0.02).points.size(), 49u * 50u / 2u);
  const Polygon step = Polygon::make({{0, 0}, {1, 0}, {1, 0.25}, {0.5, 0.25}, {0.5, 1}, {0, 1}});
  EXPECT_EQ(fillLattice(step, 0.1).points.size(), 5u * 10u + 5u * 2u);  // the row at y = 0.25 is on the step
}

TEST(FillLattice, cuts_out_what_is_blocked_and_says_how_much) {
  const Polygon shape = Polygon::box({{0, 0}, {1, 1}});
  const auto blocked = [](const Vec2& p) { return p.x() < 0.5; };
  const FillResult r = fillLattice(shape, 0.1, blocked);
  EXPECT_EQ(r.points.size(), 50u);
  EXPECT_EQ(r.cut, 50u);
  for (const Vec2& p : r.points) EXPECT_FALSE(blocked(p));
  const FillResult none = fillLattice(shape, 0.1, [](const Vec2&) { return true; });
  EXPECT_TRUE(none.points.empty());
  EXPECT_EQ(none.cut, 100u);
}

TEST(FillLattice, a_shape_smaller_than_a_spacing_may_hold_nothing) {
  EXPECT_TRUE(fillLattice(Polygon::box({{0, 0}, {0.04, 1}}), 0.1).points.empty());
  EXPECT_EQ(fillLattice(Polygon::box({{0, 0}, {0.06, 1}}), 0.1).points.size(), 10u);
}

TEST(FillLattice, absurd_spacings_are_refused_with_the_number_of_places) {
  const Polygon shape = Polygon::box({{0, 0}, {1000, 1000}});
  for (const double bad : {0.0, -0.1, std::nan(""), kInfinity}) EXPECT_THROW(fillLattice(shape, bad), FillError);
  const auto never = [](const Vec2&) { return false; };
  EXPECT_THROW(fillLattice(shape, 1e-6), FillError);
  EXPECT_THROW(fillLattice(shape, 1.0, never, 999999), FillError);
  EXPECT_EQ(fillLattice(shape, 1.0, never, 1000000).points.size(), 1000000u);
}

TEST(FillRandom, fills_all_of_the_shape_and_nothing_else_evenly) {
  // An L of three unit squares.
  const Polygon shape = Polygon::make({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  RandomStream random(3, 3);
  const std::vector<Vec2> points = fillRandom(shape, 30000, random);
  ASSERT_EQ(points.size(), 30000u);
  double hits[3] = {};
  for (const Vec2& p : points) {
    ASSERT_TRUE(shape.contains(p));
    hits[p.y() > 1.0 ? 2 : p.x() > 1.0 ? 1 : 0] += 1.0;
  }
  double chiSquare = 0.0;
  for (const double h : hits) chiSquare += (h - 1e4) * (h - 1e4) / 1e4;
  EXPECT_LT(chiSquare, 13.8);  // 2 degrees of freedom, one in a thousand
}

TEST(FillRandom, is_the_same_again_and_goes_on_where_its_stream_stands) {
  const Polygon shape = Polygon::regular(5, 1.0);
  RandomStream a(1, 2), b(1, 2);
  const auto first = fillRandom(shape, 100, a);
  EXPECT_EQ(first, fillRandom(shape, 100, b));
  EXPECT_NE(first, fillRandom(shape, 100, b));
}

TEST(FillRandom, no_free_place_is_an_error_and_not_an_endless_search) {
  RandomStream random(1, 1);
  const Polygon shape = Polygon::regular(4, 1.0);
  EXPECT_THROW(fillRandom(shape, 1, random, [](const Vec2&) { return true; }), FillError);
  EXPECT_TRUE(fillRandom(shape, 0, random, [](const Vec2&) { return true; }).empty());
}

TEST(PlacedPoints, agrees_with_asking_all_of_them) {
  RandomStream random(5, 1);
  for (const Vec2& offset : {Vec2(0, 0), Vec2(-1e6, 3e5), Vec2(1e9, 0)}) {
    PlacedPoints placed(0.1);
    std::vector<Vec2> all;
    for (int i = 0; i < 300; ++i) {
      all.push_back(offset + Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)));
      placed.add(all.back());
    }
    EXPECT_EQ(placed.size(), 300u);
    for (int i = 0; i < 2000; ++i) {
      const Vec2 p = offset + Vec2(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
      const bool expected =
          std::any_of(all.begin(), all.end(), [&](const Vec2& q) { return (p - q).squaredNorm() < 0.1 * 0.1; });
      ASSERT_EQ(placed.isTaken(p), expected);
    }
  }
  EXPECT_THROW(PlacedPoints(0.0), FillError);
  EXPECT_THROW(PlacedPoints(std::nan("")), FillError);
}

TEST(PlacedPoints, blocks_that_abut_at_a_whole_spacing_keep_all_their_particles) {
  PlacedPoints placed(0.9 * 0.01);
  placed.add(fillLattice(Polygon::box({{0, 0}, {0.5, 0.5}}), 0.01).points);
  const auto taken = [&](const Vec2& p) { return placed.isTaken(p); };
  EXPECT_EQ(fillLattice(Polygon::box({{0.5, 0}, {1, 0.5}}), 0.01, taken).cut, 0u);
  const FillResult overlapping = fillLattice(Polygon::box({{0.25, 0}, {0.75, 0.5}}), 0.01, taken);
  EXPECT_EQ(overlapping.cut, 25u * 50u);
  EXPECT_EQ(overlapping.points.size(), 25u * 50u);
}

}  // namespace
