// Closest features against all feature pairs in long double, from good and bad starts.
#include <froude/solver/contact/closest_features.h>

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

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
    auto [a, b, pose, cache] = randomPair(random, 4.0);
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

TEST(ClosestFeatures, resting_at_exactly_no_distance_is_near) {
  const ConvexShape a = box(2, 2), b = box(1, 1);
  for (const Vec2& at : {Vec2(1.5, 0.0), Vec2(0.25, -1.5), Vec2(1.5, 1.5), Vec2(-1.5, 0.75)}) {
    PairCache cache;
    const ClosestFeatures c = closestFeatures(a, b, {at, {}}, cache);
    EXPECT_EQ(c.status, PairStatus::Near) << at.transpose();
    EXPECT_EQ(c.distance, 0.0);
    EXPECT_NEAR(c.normal.norm(), 1.0, 1e-15);
    EXPECT_GT(c.normal.dot(at), 0.0);
    EXPECT_EQ(c.onA, c.onB);
  }
}

TEST(ClosestFeatures, numbers_that_are_not_finite_fail) {
  const ConvexShape a = box(1, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Transform& pose : {Transform{{nan, 0}, {}}, Transform{{0, kInfinity}, {}}, Transform{{3, 0}, {nan, 0}},
                                Transform{{3, 0}, {1, -kInfinity}}}) {
    PairCache cache;
    EXPECT_EQ(closestFeatures(a, a, pose, cache).status, PairStatus::Failed);
  }
}

TEST(ClosestFeatures, a_spinning_pair_crosses_features_at_every_step_and_warm_is_cold) {
  RandomStream random(7, 4);
  const ConvexShape a(roundRing(random, 31)), b(roundRing(random, 17));
  PairCache warm;
  int steps = 0;
  for (int k = 0; k < 5000; ++k) {
    const Transform pose = Transform::of(2.1 * unit(0.21 * k), -0.37 * k);
    PairCache cold;
    const ClosestFeatures c = closestFeatures(a, b, pose, warm), d = closestFeatures(a, b, pose, cold);
    ASSERT_EQ(c.status, d.status) << k;
    ASSERT_NEAR(c.distance, d.distance, 1e-14) << k;
    ASSERT_NEAR((c.normal - d.normal).norm(), 0.0, 1e-13) << k;
    steps += c.steps;
  }
  EXPECT_LT(steps, 5000 * 12);
}

TEST(ClosestFeatures, a_pair_that_moved_a_little_takes_one_or_two_steps) {
  RandomStream random(7, 5);
  const ConvexShape a(roundRing(random, 1000)), b(roundRing(random, 1000));
  PairCache warm;
  closestFeatures(a, b, Transform::of({2.3, 0}, 0.0), warm);
  int steps = 0;
  for (int k = 1; k <= 100; ++k) steps += closestFeatures(a, b, Transform::of({2.3, 1e-4 * k}, 1e-4 * k), warm).steps;
  EXPECT_LE(steps, 200);
}

Polygon polygonOf(const nlohmann::json& rings) {
  std::vector<Vec2> outer;
  for (const auto& p : rings.at(0)) outer.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
  return Polygon::make(outer);
}

TEST(ClosestFeatures, golden_pairs_have_their_distances_concave_ones_by_their_pieces) {
  std::ifstream file(std::string(FROUDE_TEST_DATA) + "/geometry_pairs.json");
  const nlohmann::json golden = nlohmann::json::parse(file);
  int tried = 0;
  for (const auto& pair : golden.at("pairs")) {
    double least = kInfinity;
    for (const ConvexShape& a : ConvexShape::piecesOf(polygonOf(pair.at("A"))))
      for (const ConvexShape& b : ConvexShape::piecesOf(polygonOf(pair.at("B")))) {
        PairCache cache;
        const ClosestFeatures c = closestFeatures(a, b, {}, cache);
        ASSERT_NE(c.status, PairStatus::Failed);
        least = std::min(least, c.distance);
      }
    const bool apart = pair.at("state") == "separate";
    EXPECT_NEAR(least, apart ? pair.at("distance").get<double>() : 0.0, 1e-14) << pair.at("name");
    ++tried;
  }
  EXPECT_EQ(tried, 12);
}

}  // namespace
}  // namespace froude
