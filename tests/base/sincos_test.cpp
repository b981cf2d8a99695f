#include <froude/base/sincos.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include <froude/base/random.h>

namespace froude {
namespace {

TEST(SinCos, is_as_near_as_it_promises_on_every_target) {
  std::vector<double> angle;
  RandomStream random(5, 1);
  for (const double range : {1e-300, 1e-3, 1.0, 4.0, 100.0, 1e5}) {
    for (int k = 0; k < 20001; ++k) angle.push_back(random.uniform(-range, range));
  }
  for (int k = -40000; k <= 40000; ++k) {  // where an octant ends, and where a result is almost 0
    angle.push_back(0.78539816339744830962 * k);
  }
  for (const SimdTarget target : supportedSimdTargets()) {
    std::vector<double> sine(angle.size()), cosine(angle.size());
    sinCos(angle, sine, cosine, target);
    long double worst = 0.0L;
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const auto a = static_cast<long double>(angle[i]);
      worst = std::max({worst, std::abs(static_cast<long double>(sine[i]) - std::sin(a)),
                        std::abs(static_cast<long double>(cosine[i]) - std::cos(a))});
    }
    EXPECT_LE(static_cast<double>(worst), 1.5e-16) << name(target);
  }
}

TEST(SinCos, takes_the_standard_functions_beyond_its_range_and_works_in_place) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const SimdTarget target : supportedSimdTargets()) {
    std::vector<double> angle{0.5, 1e9, -inf, std::nan(""), -2e5, 0.25, 3.0, 1e5, 7.0, -0.0, 1e300};
    const std::vector<double> before = angle;
    std::vector<double> cosine(angle.size());
    sinCos(angle, angle, cosine, target);
    for (std::size_t i = 0; i < angle.size(); ++i) {
      if (!std::isfinite(before[i])) {
        EXPECT_TRUE(std::isnan(angle[i]) && std::isnan(cosine[i]));
      } else {
        EXPECT_NEAR(angle[i], std::sin(before[i]), 2.6e-16) << name(target) << i;
        EXPECT_NEAR(cosine[i], std::cos(before[i]), 2.6e-16) << name(target) << i;
      }
    }
  }
}

TEST(SinCos, does_not_depend_on_where_an_angle_stands) {
  for (const SimdTarget target : supportedSimdTargets()) {
    const std::vector<double> angle{0.1, 1.2, 2.3, 3.4, 4.5, 5.6, 6.7, 7.8, 8.9, 9.0, 10.1};
    std::vector<double> sine(angle.size()), cosine(angle.size());
    sinCos(angle, sine, cosine, target);
    for (std::size_t i = 0; i < angle.size(); ++i) {
      double s = 0.0, c = 0.0;
      sinCos({&angle[i], 1}, {&s, 1}, {&c, 1}, target);
      EXPECT_EQ(s, sine[i]);
      EXPECT_EQ(c, cosine[i]);
    }
    sinCos({}, {}, {}, target);
  }
}

}  // namespace
}  // namespace froude
