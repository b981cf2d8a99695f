// Closest features against all feature pairs in long double, from good and bad starts.
#include <froude/solver/contact/closest_features.h>

#include <gtest/gtest.h>

#include "support/convex_pairs.h"
#include "support/pair_oracle.h"

namespace froude {
namespace {

using namespace test;

ConvexShape box(double w, double h) { return ConvexShape(rectangle(0.5 * w, 0.5 * h)); }

TEST(ClosestFeatures, two_boxes_side_by_side_name_both_edges) {
  const ConvexShape a = box(1, 1), b = box(1, 2);
  PairCache cache;
  const ClosestFeatures c = closestFeatures(a, b, {{1.5, 0.25}, {}}, cache);
  ASSERT_EQ(c.status, PairStatus::Apart);
  EXPECT_DOUBLE_EQ(c.distance, 0.5);
  EXPECT_TRUE(isEdge(c.a) && isEdge(c.b));
  EXPECT_EQ(c.normal, Vec2(1, 0));
  EXPECT_DOUBLE_EQ(c.onA.y(), 0.0);
}

TEST(ClosestFeatures, two_corners_name_both_vertices) {
  const ConvexShape a = box(2, 2), b = box(2, 2);
  PairCache cache;
  const ClosestFeatures c = closestFeatures(a, b, {{5, 6}, {}}, cache);
  ASSERT_EQ(c.status, PairStatus::Apart);
  EXPECT_DOUBLE_EQ(c.distance, 5.0);
  EXPECT_EQ(c.a, 4u);
  EXPECT_EQ(c.b, 0u);
  EXPECT_NEAR((c.normal - Vec2(0.6, 0.8)).norm(), 0.0, 1e-15);
}

TEST(ClosestFeatures, random_pairs_agree_with_all_pairs_of_features) {
  RandomStream random(7, 1);
  for (int k = 0; k < 100000; ++k) {
    const ConvexShape a(roundRing(random, 3 + random.below(12), random.uniform(0.1, 1.0)));
    const ConvexShape b(roundRing(random, 3 + random.below(12), random.uniform(0.1, 1.0)));
    const Transform pose = Transform::of(random.uniform(0.0, 4.0) * unit(turnAtRandom(random)), turnAtRandom(random));
    PairCache cache{random.below(40), random.below(40)};
    const ClosestFeatures c = closestFeatures(a, b, pose, cache);
    const RealRing ringA = placed(a.vertices(), {}), ringB = placed(b.vertices(), pose);
    const Real separation = oracleAxis(ringA, ringB).separation;
    if (separation < 0) {
      ASSERT_EQ(c.status, PairStatus::Overlapping) << k;
    } else {
      ASSERT_EQ(c.status, PairStatus::Apart) << k;
      const Real distance = oracleDistance(ringA, ringB);
      ASSERT_NEAR(c.distance, static_cast<double>(distance), 1e-12) << k;
      ASSERT_NEAR((c.onB - c.onA - c.distance * c.normal).norm(), 0.0, 1e-12) << k;
    }
  }
}

}  // namespace
}  // namespace froude
