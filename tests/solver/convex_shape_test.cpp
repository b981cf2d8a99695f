// Convex shapes: what is refused, what is measured, and which vertices of a piece can be touched.
#include <froude/solver/contact/convex_shape.h>

#include <gtest/gtest.h>

#include <froude/base/error.h>
#include <froude/solver/contact/pair_frame.h>

#include "support/convex_pairs.h"

namespace froude {
namespace {

using namespace test;

TEST(ConvexShape, what_is_not_convex_is_refused_in_words) {
  EXPECT_THROW(ConvexShape({{0, 0}, {1, 0}}), Error);
  EXPECT_THROW(ConvexShape({{0, 0}, {1, 1}, {1, 0}}), Error);          // clockwise
  EXPECT_THROW(ConvexShape({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), Error);  // twice
  EXPECT_THROW(ConvexShape({{0, 0}, {1, 0}, {2, 0}}), Error);          // no area
  EXPECT_THROW(ConvexShape({{0, 0}, {1, 0}, {kInfinity, 1}}), Error);  // not finite
  std::vector<Vec2> star;
  for (int k = 0; k < 5; ++k) star.push_back(unit(4.0 * kPi * k / 5.0));
  EXPECT_THROW(ConvexShape{star}, Error);  // only left turns, but twice around
}

TEST(ConvexShape, radii_of_a_rectangle) {
  const ConvexShape shape(rectangle(3, 4, {1e6, 0}));
  EXPECT_DOUBLE_EQ(shape.outerRadius(), 5.0);
  EXPECT_DOUBLE_EQ(shape.innerRadius(), 3.0);
  EXPECT_EQ(shape.centroid(), Vec2(1e6, 0));
}

TEST(ConvexShape, the_pieces_of_an_l_know_their_cut) {
  const Polygon l = Polygon::make({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});
  int cuts = 0, edges = 0;
  for (const ConvexShape& piece : ConvexShape::piecesOf(l)) {
    EXPECT_FALSE(piece.isWhole());
    for (std::uint32_t k = 0; k < piece.size(); ++k) {
      ++edges;
      cuts += piece.isOutline(k) ? 0 : 1;
      if (piece.vertex(k) == Vec2(1, 1)) {
        EXPECT_FALSE(piece.allows(k, Vec2(1, 1).normalized()));
      }
      if (piece.vertex(k) == Vec2(3, 1)) {
        EXPECT_TRUE(piece.allows(k, Vec2(1, 1).normalized()));
        EXPECT_FALSE(piece.allows(k, Vec2(-0.6, 0.8)));
      }
    }
  }
  EXPECT_EQ(cuts, 2);
  EXPECT_EQ(edges, 8);
}

TEST(ConvexShape, the_farthest_vertex_is_found_from_nowhere_and_climbed_to_from_any_hint) {
  RandomStream random(7, 3);
  for (const std::vector<Vec2>& ring : {straightRun(9), straightRun(60), roundRing(random, 40), rectangle(1, 1e-6)}) {
    const ConvexShape shape(ring);
    for (int k = 0; k < 64; ++k) {
      const Vec2 d = unit(k * kPi / 32.0);
      double farthest = -kInfinity;
      for (const Vec2& v : ring) farthest = std::max(farthest, v.dot(d));
      ASSERT_NEAR(shape.vertex(shape.farthest(d)).dot(d), farthest, 1e-14) << k;
      for (std::uint32_t hint = 0; hint < shape.size(); ++hint)
        ASSERT_NEAR(shape.vertex(climb(shape, d, hint)).dot(d), farthest, 1e-14) << k << ' ' << hint;
    }
  }
}

}  // namespace
}  // namespace froude
