// The distance field and OpenVDB's level set, shape by shape. Either is code of its own; where they agree both are
// right.
#include <froude/fields/openvdb/cross_check.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "openvdb/shapes.h"

namespace froude::vdb {
namespace {

// Voxels enough for a slope, few enough for a test; `froude field --check` goes to 256.
const std::vector<int> kDivisions{24, 48, 96};
constexpr std::size_t kPoints = 5000;

class Shapes : public testing::TestWithParam<std::string> {
 protected:
  static CrossCheck check() {
    CrossCheckOptions options;
    options.divisions = kDivisions;
    options.points = kPoints;
    return crossCheck(test::goldenShapes().at(GetParam()), options);
  }
};

// Parts of these are thinner than about two voxels, at least at the first size: OpenVDB puts nodes there on the wrong
// side. That costs up to the part's own thickness on top of the bound: twice the depth of a node that should have been
// inside.
const std::set<std::string> kThin{"koch2", "koch3", "koch4", "gear12", "spiral2", "comb4"};

TEST_P(Shapes, agree_with_openvdb) {
  const CrossCheck found = check();
  ASSERT_EQ(found.rows.size(), kDivisions.size());
  for (const CrossCheckRow& row : found.rows) {
    EXPECT_EQ(row.distance.count, kPoints);
    // Away from corners distance is linear, which a trilinear interpolant keeps: only single precision is left.
    EXPECT_LE(row.clearDistance.max, row.rounding) << row.voxelSize;
    // The difference over one voxel of two values with that error; its direction turns by no more than twice that.
    EXPECT_LE(row.clearNormal.max, 2.0 * row.rounding) << row.voxelSize;
    EXPECT_GT(row.rounding, 0.0);
    EXPECT_LT(row.rounding, 1e-4);
    // Anywhere else: a weighted mean of distances at most √2/2 voxels away on average, where every node is right.
    if (!kThin.contains(GetParam())) {
      EXPECT_LE(row.distance.max, kLipschitzBound + row.rounding) << row.voxelSize;
    } else {
      EXPECT_LE(row.distance.max, 2.0) << row.voxelSize;
    }
    // Sides differ next to the boundary only, where the interpolant rounds a corner off.
    EXPECT_LE(row.deepestWrong, row.distance.max + 1e-12);
    EXPECT_LT(row.wrongSides, row.distance.count / 5);
  }
  // Kinks are as large as the voxel, and no more of the points lie near them the smaller it is: at least in proportion.
  // (The largest error has the bound above; its slope is that of single nodes that OpenVDB puts on the wrong side.) The
  // edges of koch4 are shorter than the voxels of every size here: it has no slope yet.
  if (GetParam() != "koch4") {
    EXPECT_GE(found.slopeRms, 0.9);
  }
}

INSTANTIATE_TEST_SUITE_P(Golden, Shapes,
                         testing::Values("unit_square", "tri_345", "hexagon", "gon17", "star5", "lshape", "comb4",
                                         "gear12", "spiral2", "plate_1_1024", "needle", "holed_square", "koch0",
                                         "koch1", "koch2", "koch3", "koch4"),
                         [](const auto& shape) { return shape.param; });

TEST(CrossCheck, knows_every_golden_shape) { EXPECT_EQ(test::goldenShapes().size(), 17u); }

// Half of the plate's inside is between two rows of nodes at every size: OpenVDB has no node inside it and calls it
// empty.
TEST(CrossCheck, a_plate_thinner_than_a_voxel_is_lost_and_counted) {
  CrossCheckOptions options;
  options.divisions = {64, 128};
  const CrossCheck found = crossCheck(test::goldenShapes().at("plate_1_1024"), options);
  for (const CrossCheckRow& row : found.rows) {
    EXPECT_EQ(row.clearDistance.count, 0u);
    EXPECT_GT(row.wrongSides, 100u);
    // All of them inside the plate: no deeper than half its thickness.
    EXPECT_LE(row.deepestWrong * row.voxelSize, 0.5 / 1024.0 * (1.0 + 1e-9));
  }
}

TEST(CrossCheck, asks_for_sizes_and_bands_that_make_sense) {
  const Polygon box = Polygon::box({{0.0, 0.0}, {1.0, 1.0}});
  CrossCheckOptions options;
  options.divisions = {};
  EXPECT_THROW(crossCheck(box, options), Error);
  options.divisions = {4};
  EXPECT_THROW(crossCheck(box, options), Error);
  options.divisions = {16};
  options.halfBand = 0.0;
  EXPECT_THROW(crossCheck(box, options), Error);
  options.halfBand = 3.0;
  const CrossCheck one = crossCheck(box, options);
  EXPECT_TRUE(std::isnan(one.slopeMax));
  EXPECT_TRUE(one.clearAgrees());
}

TEST(CrossCheck, gives_the_same_every_time) {
  CrossCheckOptions options;
  options.divisions = {32};
  options.points = 1000;
  const Polygon star = test::goldenShapes().at("star5");
  const CrossCheck first = crossCheck(star, options), second = crossCheck(star, options);
  EXPECT_EQ(first.rows[0].distance.rms, second.rows[0].distance.rms);
  EXPECT_EQ(first.rows[0].clearNormal.rms, second.rows[0].clearNormal.rms);
  EXPECT_EQ(first.rows[0].wrongSides, second.rows[0].wrongSides);
}

}  // namespace
}  // namespace froude::vdb
