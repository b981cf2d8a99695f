#include <froude/fields/sampled_field.h>
#include <gtest/gtest.h>

#include <froude/base/random.h>

#include "support/polygon_generator.h"

namespace froude {
namespace {

TEST(SampledField, is_exact_along_straight_walls) {
  const DistanceField exact(Polygon::box({Vec2(0.0, 0.0), Vec2(1.0, 1.0)}), 0.1);
  const SampledField field(exact, 0.02);
  // Linear in the cell: single precision alone is lost.
  const SampledValue v = field.sample(Vec2(0.5031, 1.0377));
  EXPECT_TRUE(v.inBand);
  EXPECT_NEAR(v.distance, 0.0377, 1e-8);
  EXPECT_NEAR(v.normal.y(), 1.0, 1e-6);
  EXPECT_NEAR(v.normal.x(), 0.0, 1e-6);
}

TEST(SampledField, is_wrong_at_a_right_corner_by_what_the_closed_form_says) {
  // Inside near a corner on a node the distance is min(x, y): the bilinear interpolation x·y/h is wrong most in the
  // middle of the diagonal, by h/4. Outside it is the circle's: less.
  // The grid begins a band and a cell off the box, four cells in all.
  const DistanceField exact(Polygon::box({Vec2(0.0, 0.0), Vec2(1.0, 1.0)}), 0.1875);
  const SampledField field(exact, 0.0625);
  EXPECT_GE(field.errorBound(), 0.0625 / 4.0 * (1.0 - 1e-6));
  EXPECT_LE(field.errorBound(), 0.0625 / 4.0 * 1.06);
}

TEST(SampledField, is_nowhere_worse_than_its_bound_which_is_nearly_reached) {
  RandomStream random(21, 0);
  for (int k = 0; k < test::kShapeCount; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k), random);
    const DistanceField exact(polygon, 0.06);
    const SampledField field(exact, 0.01);
    const Box box = polygon.bounds().grown(0.06);
    double worst = 0.0;
    int inBand = 0;
    for (int i = 0; i < 200000; ++i) {
      const Vec2 p = box.min + Vec2(random.uniform() * box.size().x(), random.uniform() * box.size().y());
      const FieldSample truth = exact.sample(p);
      const SampledValue value = field.sample(p);
      if (!value.inBand) {
        ASSERT_EQ(value.distance > 0.0, truth.distance > 0.0);
        ASSERT_EQ(std::abs(value.distance), 0.06);
        continue;
      }
      ASSERT_LE(std::abs(value.distance), 0.06);
      if (!truth.exact || std::abs(truth.distance) > 0.06) continue;
      ++inBand;
      worst = std::max(worst, std::abs(value.distance - truth.distance));
    }
    EXPECT_GT(inBand, 1000);
    EXPECT_LE(worst, field.errorBound()) << k;
    // 200,000 points do not find the very worst place, but come near.
    EXPECT_GE(worst, 0.75 * field.errorBound()) << k;
  }
}

TEST(SampledField, loses_error_with_its_cells_in_first_order_at_kinks) {
  RandomStream random(22, 0);
  const DistanceField exact(test::randomPolygon(test::Shape::Star, random), 0.05);
  double before = 0.0;
  for (const double cell : {0.02, 0.01, 0.005}) {
    const double bound = SampledField(exact, cell).errorBound();
    if (before > 0.0) {
      EXPECT_NEAR(before / bound, 2.0, 0.7);
    }
    before = bound;
  }
}

TEST(SampledField, says_the_same_in_batches_on_every_target) {
  RandomStream random(23, 0);
  const Polygon polygon = test::randomPolygon(test::Shape::Star, random);
  const SampledField field(DistanceField(polygon, 0.1), 0.015);
  std::vector<double> x, y;
  for (int i = 0; i < 3003; ++i) {
    x.push_back(random.uniform(-1.0, 1.0));
    y.push_back(random.uniform(-1.0, 1.0));
  }
  x[17] = std::nan("");
  for (const SimdTarget target : supportedSimdTargets()) {
    std::vector<double> distance(x.size()), nx(x.size()), ny(x.size()), cx(x.size()), cy(x.size());
    std::vector<std::int32_t> edge(x.size());
    FieldBatch batch{x, y};
    batch.distance = distance;
    batch.normalX = nx;
    batch.normalY = ny;
    batch.closestX = cx;
    batch.closestY = cy;
    batch.edge = edge;
    sampleBatch(field, Transform(), batch, target);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const SampledValue v = field.sample(Vec2(x[i], y[i]));
      ASSERT_EQ(distance[i], v.distance) << i << name(target);
      ASSERT_EQ(nx[i], v.normal.x());
      ASSERT_EQ(ny[i], v.normal.y());
      if (v.inBand) {
        ASSERT_EQ(cx[i], x[i] - v.distance * v.normal.x());
      }
      ASSERT_EQ(edge[i], -1);
    }
  }
}

TEST(SampledField, refuses_cells_that_make_no_sense) {
  const DistanceField exact(Polygon::box({Vec2(0.0, 0.0), Vec2(1.0, 1.0)}), 0.1);
  EXPECT_THROW(SampledField(exact, -1.0), Error);
  EXPECT_THROW(SampledField(exact, std::nan("")), Error);
  EXPECT_THROW(SampledField(exact, 1e-6), Error);
}

}  // namespace
}  // namespace froude
