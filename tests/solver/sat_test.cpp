// Separating axes against all edge normals in long double.
#include <froude/solver/contact/sat.h>

#include <gtest/gtest.h>

#include "support/convex_pairs.h"
#include "support/pair_oracle.h"

namespace froude {
namespace {

using namespace test;

TEST(Sat, a_small_box_in_a_large_one_leaves_by_the_nearest_side) {
  const ConvexShape a(rectangle(2, 2)), b(rectangle(0.5, 0.5));
  PairCache cache;
  const SeparatingAxis axis = sat(a, b, {{1.0, 0.5}, {}}, cache);
  EXPECT_EQ(axis.status, PairStatus::Overlapping);
  EXPECT_DOUBLE_EQ(axis.separation, -1.5);
  EXPECT_EQ(axis.normal, Vec2(1, 0));
}

TEST(Sat, depth_and_axis_of_random_pairs_are_those_of_all_edge_normals) {
  RandomStream random(7, 2);
  for (int k = 0; k < 100000; ++k) {
    const ConvexShape a(roundRing(random, 3 + random.below(12), random.uniform(0.1, 1.0)));
    const ConvexShape b(roundRing(random, 3 + random.below(12), random.uniform(0.1, 1.0)));
    const Transform pose = Transform::of(random.uniform(0.0, 2.5) * unit(turnAtRandom(random)), turnAtRandom(random));
    PairCache cache{random.below(40), random.below(40)};
    const SeparatingAxis axis = sat(a, b, pose, cache);
    const OracleAxis truth = oracleAxis(placed(a.vertices(), {}), placed(b.vertices(), pose));
    if (truth.separation < 0) {
      ASSERT_EQ(axis.status, PairStatus::Overlapping) << k;
      ASSERT_NEAR(axis.separation, static_cast<double>(truth.separation), 1e-12) << k;
    } else {
      ASSERT_EQ(axis.status, PairStatus::Apart) << k;
      ASSERT_LE(axis.separation, static_cast<double>(truth.separation) + 1e-12) << k;
      ASSERT_GT(axis.separation, 0.0) << k;
    }
  }
}

}  // namespace
}  // namespace froude
