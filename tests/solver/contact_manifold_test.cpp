// Manifolds: where the points stand, what they are called, and what does not happen at seams.
#include <froude/solver/contact/contact_manifold.h>

#include <gtest/gtest.h>

#include "support/convex_pairs.h"

namespace froude {
namespace {

using namespace test;

TEST(ContactManifold, a_box_on_a_floor_stands_on_two_points) {
  const ConvexShape floor(rectangle(5, 0.5)), box(rectangle(0.5, 0.5));
  PairCache cache;
  for (const double gap : {0.01, 0.0, -0.01}) {
    const ContactManifold m = contactManifold(floor, box, {{1.0, 1.0 + gap}, {}}, 0.02, cache);
    ASSERT_EQ(m.count, 2u) << gap;
    EXPECT_NEAR((m.normal - Vec2(0, 1)).norm(), 0.0, 1e-15);
    EXPECT_NEAR(std::abs(m.points[0].at.x() - m.points[1].at.x()), 1.0, 1e-14);
    for (const ManifoldPoint& p : m.points) EXPECT_NEAR(p.separation, gap, 1e-15);
  }
}

TEST(ContactManifold, a_box_that_slides_over_a_seam_is_never_pushed_sideways) {
  // A dent too small to feel, but not to make two pieces of the floor.
  const Polygon floor = Polygon::make({{-5, -1}, {5, -1}, {5, 0}, {0, -1e-7}, {-5, 0}});
  const std::vector<ConvexShape> pieces = ConvexShape::piecesOf(floor);
  ASSERT_EQ(pieces.size(), 2u);
  const ConvexShape box(rectangle(0.5, 0.5));
  for (const double height : {0.01, 0.001, 0.0, -0.001, -0.01})
    for (double x = -2.0; x <= 2.0; x += 0.00390625) {
      std::uint32_t points = 0;
      for (const ConvexShape& piece : pieces) {
        PairCache cache;
        const ContactManifold m = contactManifold(piece, box, {{x, 0.5 + height}, {}}, 0.02, cache);
        points += m.count;
        if (m.count == 0) continue;
        ASSERT_LT(std::abs(m.normal.x()), 1e-3) << x << ' ' << height;
        ASSERT_GT(m.normal.y(), 0.0) << x << ' ' << height;
      }
      ASSERT_GE(points, 2u) << x << ' ' << height;
    }
}

TEST(ContactManifold, names_stay_while_a_box_slides_and_rocks) {
  const ConvexShape floor(rectangle(5, 0.5)), box(rectangle(0.5, 0.5));
  PairCache cache;
  std::uint32_t low = 0, high = 0;
  for (int k = 0; k < 400; ++k) {
    // Tilts to both sides, above and below the floor: the reference changes between the shapes, the names do not.
    const Transform pose = Transform::of({-1.0 + 0.005 * k, 1.0 + 1e-3 * std::sin(0.3 * k)}, 1e-3 * std::sin(0.7 * k));
    const ContactManifold m = contactManifold(floor, box, pose, 0.02, cache);
    ASSERT_EQ(m.count, 2u) << k;
    const bool swapped = m.points[0].at.x() > m.points[1].at.x();
    const std::uint32_t left = m.points[swapped ? 1 : 0].id, right = m.points[swapped ? 0 : 1].id;
    if (k == 0) {
      low = left;
      high = right;
    }
    ASSERT_EQ(left, low) << k;
    ASSERT_EQ(right, high) << k;
  }
  EXPECT_NE(low, high);
}

TEST(ContactManifold, the_other_order_gives_the_mirrored_points) {
  RandomStream random(9, 1);
  const ConvexShape a(rectangle(1, 0.7)), b(roundRing(random, 7));
  for (int k = 0; k < 20000; ++k) {
    const Transform bInA = Transform::of(random.uniform(0.5, 2.0) * unit(turnAtRandom(random)), turnAtRandom(random));
    const Transform aInB = poseIn(bInA, {});
    PairCache one, two;
    const ContactManifold m = contactManifold(a, b, bInA, 0.1, one), n = contactManifold(b, a, aInB, 0.1, two);
    ASSERT_EQ(m.status, n.status) << k;
    ASSERT_EQ(m.count, n.count) << k;
    ASSERT_NEAR((m.normal + bInA.rotation.apply(n.normal)).norm(), 0.0, m.count > 0 ? 1e-12 : 2.0) << k;
    for (std::uint32_t p = 0; p < m.count; ++p) {
      double nearest = kInfinity;
      for (std::uint32_t q = 0; q < n.count; ++q)
        nearest = std::min(nearest, (m.points[p].at - bInA.toWorld(n.points[q].at)).norm() +
                                        std::abs(m.points[p].separation - n.points[q].separation));
      ASSERT_LT(nearest, 1e-9) << k;
    }
  }
}

TEST(ContactManifold, a_corner_at_a_corner_makes_one_point_between_them) {
  const ConvexShape a(rectangle(1, 1)), b(rectangle(1, 1));
  PairCache cache;
  const ContactManifold m = contactManifold(a, b, {{2.03, 2.04}, {}}, 0.1, cache);
  ASSERT_EQ(m.count, 1u);
  EXPECT_EQ(m.status, PairStatus::Near);
  EXPECT_NEAR(m.points[0].separation, 0.05, 1e-15);
  EXPECT_NEAR((m.points[0].at - Vec2(1.015, 1.02)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((m.normal - Vec2(0.6, 0.8)).norm(), 0.0, 1e-13);
}

TEST(ContactManifold, beyond_the_margin_there_are_no_points) {
  const ConvexShape a(rectangle(1, 1));
  PairCache cache;
  const ContactManifold m = contactManifold(a, a, {{2.2, 0}, {}}, 0.1, cache);
  EXPECT_EQ(m.status, PairStatus::Apart);
  EXPECT_EQ(m.count, 0u);
}

TEST(ContactManifold, the_inner_corner_of_an_l_pushes_out_of_its_two_sides_only) {
  const Polygon l = Polygon::make({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});
  const ConvexShape box(rectangle(0.25, 0.25));
  int sideways = 0, up = 0;
  for (const double gap : {0.005, 0.0, -0.005})
    for (const ConvexShape& piece : ConvexShape::piecesOf(l)) {
      PairCache cache;
      const ContactManifold m = contactManifold(piece, box, {{1.25 + gap, 1.25 + gap}, {}}, 0.02, cache);
      if (m.count == 0) continue;
      const double alignment = std::max(m.normal.x(), m.normal.y());
      EXPECT_NEAR(alignment, 1.0, 1e-12) << gap;
      (m.normal.x() > 0.5 ? sideways : up) += 1;
    }
  EXPECT_EQ(sideways, 3);
  EXPECT_EQ(up, 3);
}

}  // namespace
}  // namespace froude
