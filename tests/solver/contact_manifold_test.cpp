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

}  // namespace
}  // namespace froude
