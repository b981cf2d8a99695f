#include <gtest/gtest.h>

#include <froude/base/random.h>
#include <froude/fields/predicates.h>

#include "support/polygon_oracle.h"

namespace froude {
namespace {

double ulpsUp(double x, int n) {
  for (; n > 0; --n) x = std::nextafter(x, kInfinity);
  for (; n < 0; ++n) x = std::nextafter(x, -kInfinity);
  return x;
}

TEST(Orientation, is_exact_on_a_grid_of_neighbouring_doubles) {
  // Kettner et al., "Classroom examples of robustness problems": points within ulps of the diagonal.
  const Vec2 b(12.0, 12.0);
  const Vec2 c(24.0, 24.0);
  int zeros = 0;
  int wrongIfNaive = 0;
  for (int i = 0; i < 128; ++i) {
    for (int j = 0; j < 128; ++j) {
      const Vec2 a(ulpsUp(0.5, i), ulpsUp(0.5, j));
      const int expected = (j > i) - (j < i);
      // b → c points along the diagonal: above it is left.
      ASSERT_EQ(orientation(b, c, a), expected) << i << ' ' << j;
      const double naive = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
      zeros += expected == 0;
      wrongIfNaive += ((naive > 0) - (naive < 0)) != expected;
    }
  }
  EXPECT_EQ(zeros, 128);
  EXPECT_GT(wrongIfNaive, 0) << "the grid must be hard enough to need exactness";
}

TEST(Orientation, agrees_with_113_bits_and_changes_sign_with_order) {
  RandomStream random(7, 0);
  for (int k = 0; k < 200000; ++k) {
    const double offset = k % 3 == 0 ? 1e6 : 0.0;
    const Vec2 a(offset + random.uniform(), offset + random.uniform());
    const Vec2 b(offset + random.uniform(), offset + random.uniform());
    Vec2 c(offset + random.uniform(), offset + random.uniform());
    if (k % 2 == 0) {
      const double t = random.uniform(-1.0, 2.0);
      c = a + t * (b - a);
      c.x() = ulpsUp(c.x(), static_cast<int>(random.below(5)) - 2);
    }
    const int expected = test::side(a, b, c);
    ASSERT_EQ(orientation(a, b, c), expected);
    ASSERT_EQ(orientation(b, c, a), expected);
    ASSERT_EQ(orientation(b, a, c), -expected);
  }
}

TEST(Orientation, of_equal_and_collinear_points_is_zero) {
  const Vec2 a(0.1, 0.7);
  const Vec2 b(0.3, -0.2);
  EXPECT_EQ(orientation(a, a, b), 0);
  EXPECT_EQ(orientation(a, b, b), 0);
  EXPECT_EQ(orientation({0.25, 0.5}, {0.5, 1.0}, {1.25, 2.5}), 0);
}

TEST(SegmentContact, tells_crossing_touching_and_apart) {
  EXPECT_EQ(segmentContact({0, 0}, {2, 2}, {0, 2}, {2, 0}), SegmentContact::Crossing);
  EXPECT_EQ(segmentContact({0, 0}, {2, 0}, {1, 0}, {1, 1}), SegmentContact::Touching);
  EXPECT_EQ(segmentContact({0, 0}, {2, 0}, {2, 0}, {3, 1}), SegmentContact::Touching);
  EXPECT_EQ(segmentContact({0, 0}, {2, 0}, {1, 0}, {3, 0}), SegmentContact::Touching);
  EXPECT_EQ(segmentContact({0, 0}, {1, 0}, {2, 0}, {3, 0}), SegmentContact::None);
  EXPECT_EQ(segmentContact({0, 0}, {1, 1}, {0, 1e-300}, {-1, 1}), SegmentContact::None);
  EXPECT_EQ(segmentContact({0, 0}, {2, 0}, {1, 1e-16}, {1, 1}), SegmentContact::None);
}

}  // namespace
}  // namespace froude
