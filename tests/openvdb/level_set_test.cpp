// The level set against closed forms, and what it refuses.
#include <froude/base/random.h>
#include <froude/fields/openvdb/level_set.h>
#include <gtest/gtest.h>

#include <cmath>

namespace froude::vdb {
namespace {

constexpr double kVoxel = 0.02;
const Box kBox{{-0.5, -0.25}, {0.5, 0.25}};

TEST(LevelSet, of_a_box_is_its_distance_and_its_normal) {
  const LevelSet set(Polygon::box(kBox), kVoxel, 5.0);
  EXPECT_DOUBLE_EQ(set.voxelSize(), kVoxel);
  EXPECT_NEAR(set.halfBand(), 5.0 * kVoxel, 1e-7);
  for (const double d : {-0.05, -0.013, 0.013, 0.05}) {
    EXPECT_NEAR(set.distance({0.1, 0.25 + d}), d, 1e-6);
    EXPECT_NEAR(set.distance({-0.5 - d, 0.1}), d, 1e-6);
    EXPECT_NEAR((set.normal({0.1, 0.25 + d}) - Vec2(0.0, 1.0)).norm(), 0.0, 1e-5);
    EXPECT_NEAR((set.normal({-0.5 - d, 0.1}) - Vec2(-1.0, 0.0)).norm(), 0.0, 1e-5);
  }
  // Around a corner distance is round; the interpolant of a circle is off by h²/8r at most.
  const Vec2 out = Vec2(0.6, 0.8) * 0.06;
  EXPECT_NEAR(set.distance(kBox.max + out), 0.06, kVoxel * kVoxel / (8.0 * 0.03));
  // Beyond the band.
  EXPECT_EQ(set.distance({0.0, 0.0}), -set.halfBand());
  EXPECT_EQ(set.distance({3.0, 0.0}), set.halfBand());
  EXPECT_EQ(set.normal({3.0, 0.0}), Vec2(0.0, 0.0));
}

TEST(LevelSet, samples_many_points_as_it_samples_one) {
  const LevelSet set(Polygon::regular(7, 0.5), kVoxel);
  RandomStream random(3, 1);
  std::vector<Vec2> points, normals(500);
  std::vector<double> distances(500);
  for (int i = 0; i < 500; ++i) points.emplace_back(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7));
  set.sample(points, distances);
  set.normals(points, normals);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(distances[i], set.distance(points[i]));
    ASSERT_EQ(normals[i], set.normal(points[i]));
  }
  EXPECT_GT(set.activeVoxels(), 1000u);
  EXPECT_GT(set.memoryBytes(), 4 * set.activeVoxels() / 2);
}

TEST(LevelSet, is_as_right_far_from_the_origin) {
  const Vec2 far(1e6, -2e6);
  const LevelSet set(Polygon::box({far + kBox.min, far + kBox.max}), kVoxel, 5.0);
  for (const double d : {-0.05, 0.013, 0.05}) EXPECT_NEAR(set.distance(far + Vec2(0.1, 0.25 + d)), d, 1e-6);
}

TEST(LevelSet, of_two_polygons_is_the_nearer_one) {
  const std::vector<Polygon> two{Polygon::box(kBox), Polygon::box({{1.0, -0.25}, {2.0, 0.25}})};
  const LevelSet set(two, kVoxel, 5.0);
  EXPECT_NEAR(set.distance({0.53, 0.0}), 0.03, 1e-6);
  EXPECT_NEAR(set.distance({0.97, 0.0}), 0.03, 1e-6);
  EXPECT_NEAR(set.distance({1.03, 0.0}), -0.03, 1e-6);
}

TEST(LevelSet, refuses_what_it_cannot_be_made_of) {
  const Polygon box = Polygon::box(kBox);
  for (const double voxel : {0.0, -1.0, std::nan(""), kInfinity, 1e-5}) EXPECT_THROW(LevelSet(box, voxel), Error);
  for (const double band : {0.5, 101.0, std::nan("")}) EXPECT_THROW(LevelSet(box, kVoxel, band), Error);
  EXPECT_THROW(LevelSet(std::span<const Polygon>(), kVoxel), Error);
}

}  // namespace
}  // namespace froude::vdb
