// Separating axes against all edge normals in long double.
#include <froude/solver/contact/sat.h>

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

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
    auto [a, b, pose, cache] = randomPair(random, 2.5);
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

TEST(Sat, the_last_axis_parts_the_pair_again_at_once) {
  const ConvexShape a(rectangle(1, 1)), b(rectangle(1, 1));
  PairCache cache;
  sat(a, b, {{2.5, 2.2}, {}}, cache);
  const PairCache first = cache;
  const SeparatingAxis again = sat(a, b, {{2.4, 2.3}, {}}, cache);
  EXPECT_EQ(again.status, PairStatus::Apart);
  EXPECT_EQ(cache, first);
}

TEST(Sat, of_two_equal_depths_the_cached_one_stays) {
  const ConvexShape a(rectangle(1, 1)), b(rectangle(0.5, 0.5));
  for (std::uint32_t edge = 0; edge < 4; ++edge) {
    PairCache cache{2 * edge + 1, 0};
    const SeparatingAxis axis = sat(a, b, {{0, 0}, {}}, cache);
    EXPECT_DOUBLE_EQ(axis.separation, -1.5);
    EXPECT_EQ(axis.edge, 2 * edge + 1);
    EXPECT_TRUE(axis.ofA);
  }
}

TEST(Sat, a_pair_of_pieces_without_a_free_axis_is_no_contact) {
  // Three flared arms round a hub whose edges are all cuts: nothing outside the polygon can touch the hub.
  std::vector<Vec2> outline;
  for (int arm = 0; arm < 3; ++arm) {
    const double middle = 2.0 * kPi * arm / 3.0;
    const Vec2 out = unit(middle), side = leftNormal(out);
    const Vec2 first = unit(middle - kPi / 3.0), last = unit(middle + kPi / 3.0);
    outline.insert(outline.end(), {first, first + 0.2 * out - 0.2 * side, last + 0.2 * out + 0.2 * side});
  }
  const Polygon wheel = Polygon::make(outline);
  const std::vector<ConvexShape> pieces = ConvexShape::piecesOf(wheel);
  int without = 0;
  for (const ConvexShape& a : pieces) {
    bool touchable = false;
    for (std::uint32_t k = 0; k < a.size(); ++k) touchable = touchable || a.isOutline(k);
    PairCache cache;
    const SeparatingAxis axis = sat(a, a, {}, cache);
    if (touchable) continue;
    ++without;
    EXPECT_EQ(axis.status, PairStatus::Apart);
    EXPECT_EQ(axis.separation, kInfinity);
  }
  EXPECT_EQ(without, 1);
}

TEST(Sat, golden_pairs_have_their_depths_and_translation_vectors) {
  std::ifstream file(std::string(FROUDE_TEST_DATA) + "/geometry_pairs.json");
  const auto shapeOf = [](const nlohmann::json& rings) {
    std::vector<Vec2> outer;
    for (const auto& p : rings.at(0)) outer.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
    return ConvexShape(outer);
  };
  const nlohmann::json golden = nlohmann::json::parse(file);
  int overlapping = 0;
  for (const auto& pair : golden.at("pairs")) {
    if (pair.at("state") != "overlap") continue;
    ++overlapping;
    PairCache cache;
    const SeparatingAxis axis = sat(shapeOf(pair.at("A")), shapeOf(pair.at("B")), {}, cache);
    EXPECT_EQ(axis.status, PairStatus::Overlapping);
    EXPECT_NEAR(-axis.separation, pair.at("penetration").get<double>(), 1e-15) << pair.at("name");
    const Vec2 normal(pair.at("normal_A_to_B").at(0).get<double>(), pair.at("normal_A_to_B").at(1).get<double>());
    EXPECT_NEAR((axis.normal - normal).norm(), 0.0, 1e-12) << pair.at("name");
  }
  EXPECT_EQ(overlapping, 5);
}

}  // namespace
}  // namespace froude
