#include <froude/base/transform.h>
#include <gtest/gtest.h>

#include <complex>

#include <froude/base/random.h>

namespace {

using namespace froude;

// Oracle: complex numbers, in which a rotation is a multiplication.
TEST(Transform, agrees_with_complex_arithmetic_and_undoes_itself) {
  RandomStream random(3, 1);
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.uniform(-10.0, 10.0);
    const std::complex<double> p(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    const std::complex<double> t(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    const Transform transform = Transform::of({t.real(), t.imag()}, angle);
    const std::complex<double> expected = t + std::polar(1.0, angle) * p;
    const Vec2 world = transform.toWorld({p.real(), p.imag()});
    EXPECT_NEAR(world.x(), expected.real(), 1e-14 * 20.0);
    EXPECT_NEAR(world.y(), expected.imag(), 1e-14 * 20.0);
    EXPECT_LT((transform.toLocal(world) - Vec2(p.real(), p.imag())).norm(), 1e-14 * 20.0);
  }
}

TEST(Normals, left_and_right_are_a_quarter_turn_each_way) {
  const Vec2 v{3.0, 4.0};
  EXPECT_GT(cross(v, leftNormal(v)), 0.0);
  EXPECT_LT(cross(v, rightNormal(v)), 0.0);
  EXPECT_EQ(leftNormal(v).dot(v), 0.0);
  EXPECT_EQ(leftNormal(v), -rightNormal(v));
  EXPECT_EQ(cross(2.0, v), Vec2(-8.0, 6.0));
}

TEST(Box, an_empty_box_is_the_neutral_element_of_include) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_FALSE(box.contains({0.0, 0.0}));
  box.include(Vec2{1.0, 2.0});
  EXPECT_FALSE(box.empty());
  EXPECT_TRUE(box.contains({1.0, 2.0}));
  box.include(Box{});
  EXPECT_EQ(box.min, box.max);
  box.include(Vec2{3.0, 0.0});
  EXPECT_EQ(box.size(), Vec2(2.0, 2.0));
  EXPECT_EQ(box.center(), Vec2(2.0, 1.0));
  EXPECT_TRUE(box.overlaps(Box{{3.0, 2.0}, {4.0, 4.0}}));
  EXPECT_FALSE(box.overlaps(Box{{3.1, 2.0}, {4.0, 4.0}}));
  EXPECT_EQ(box.grown(1.0).min, Vec2(0.0, -1.0));
}

}  // namespace
