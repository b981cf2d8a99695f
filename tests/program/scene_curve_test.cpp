// Straight pieces instead of curves: never farther off than the tolerance, and hardly more of them than that takes. The
// curves are computed anew here, by trigonometry and by de Casteljau's construction.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include <froude/base/random.h>

#include "scene/curve.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

using scene::Curve;
using Points = std::vector<Vec2>;

Points flattened(const Curve& curve, double tolerance) {
  Points points{curve.start()};
  scene::flatten(curve, tolerance, 100'000, &points);
  return points;
}

/// The largest distance from the curve, at many of its points, to the nearest piece. `window`: how many pieces on
/// either side of the point's share of the parameter may be the nearest; all of them unless the pieces are even.
double farthest(const std::function<Vec2(double)>& curve, const Points& points, int samples = 1500,
                std::size_t window = 1'000'000) {
  double worst = 0.0;
  const std::size_t pieces = points.size() - 1;
  for (int i = 0; i <= samples; ++i) {
    const double t = static_cast<double>(i) / samples;
    const Vec2 p = curve(t);
    double best = kInfinity;
    const auto here = static_cast<std::size_t>(t * static_cast<double>(pieces));
    for (std::size_t k = here > window ? here - window : 0; k < std::min(pieces, here + window); ++k) {
      best = std::min(best, (p - points[k]).norm());
      if (points[k] != points[k + 1])
        best = std::min(best, static_cast<double>(test::segmentDistance({points[k], points[k + 1]}, p)));
    }
    worst = std::max(worst, best);
  }
  return worst;
}

Vec2 casteljau(std::vector<Vec2> p, double t) {
  for (std::size_t n = p.size() - 1; n > 0; --n)
    for (std::size_t i = 0; i < n; ++i) p[i] += t * (p[i + 1] - p[i]);
  return p[0];
}

/// The least number of pieces for a small tolerance ε: ∫ √(κ / 8ε) ds, since a chord s long leaves κ s²/8.
double optimum(const std::function<Vec2(double)>& curve, double tolerance) {
  constexpr int kSteps = 20000;
  constexpr double h = 1.0 / kSteps;
  double sum = 0.0;
  for (int i = 1; i < kSteps; ++i) {
    const Vec2 before = curve((i - 1) * h), here = curve(i * h), after = curve((i + 1) * h);
    const Vec2 velocity = (after - before) / (2 * h), acceleration = (after - 2 * here + before) / (h * h);
    const double speed = velocity.norm();
    if (speed > 0.0) sum += std::sqrt(std::abs(cross(velocity, acceleration)) / speed / (8.0 * tolerance)) * h;
  }
  return sum;
}

TEST(Curve, a_circle_gets_as_many_pieces_as_its_tolerance_takes_and_all_alike) {
  for (const double radius : {1e-3, 1.0, 1e4})
    for (const double ratio : {0.3, 1e-2, 1e-3, 1e-5, 1e-7}) {
      const Vec2 c(3 * radius, -radius);
      const Curve circle =
          Curve::ellipse(c, {0.0, radius}, {-radius, 0.0}, 0.0, 2 * kPi, c + Vec2(0, radius), c + Vec2(0, radius));
      const Points points = flattened(circle, ratio * radius);
      const double least = std::max(3.0, std::ceil(kPi / std::acos(1.0 - ratio)));
      EXPECT_NEAR(static_cast<double>(points.size() - 1), least, ratio < 1e-6 ? 2.0 : 0.0) << ratio;
      const auto exact = [&](double t) {
        return Vec2(c + radius * Vec2(-std::sin(2 * kPi * t), std::cos(2 * kPi * t)));
      };
      const double worst = farthest(exact, points, 20000, 2);
      EXPECT_LE(worst, ratio * radius * (1 + 1e-9) + 1e-15 * radius) << ratio;
      EXPECT_GE(worst, 0.4 * ratio * radius) << ratio;
      for (std::size_t i = 1; i < points.size(); ++i)
        EXPECT_NEAR((points[i] - points[i - 1]).norm(),
                    2 * radius * std::sin(kPi / static_cast<double>(points.size() - 1)), 1e-12 * radius);
    }
}

TEST(Curve, ellipses_of_any_slimness_keep_the_tolerance_with_few_pieces) {
  for (const double slim : {1.5, 10.0, 100.0, 1e4})
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
      SCOPED_TRACE(slim);
      const Vec2 u(0.6, 0.8), v = leftNormal(u) / slim;
      const Curve ellipse = Curve::ellipse({1, 2}, u, v, 0.5, 5.5, Vec2(1, 2) + std::cos(0.5) * u + std::sin(0.5) * v,
                                           Vec2(1, 2) + std::cos(5.5) * u + std::sin(5.5) * v);
      const auto exact = [&](double t) {
        return Vec2(Vec2(1, 2) + std::cos(0.5 + 5 * t) * u + std::sin(0.5 + 5 * t) * v);
      };
      const Points points = flattened(ellipse, tolerance);
      EXPECT_LE(farthest(exact, points), tolerance * (1 + 1e-9));
      EXPECT_LE(static_cast<double>(points.size() - 1), 2.0 * optimum(exact, tolerance) + 3.0);
    }
}

TEST(Curve, random_beziers_keep_the_tolerance_with_at_most_twice_the_optimum) {
  RandomStream random(7, 0);
  double pieces = 0.0, best = 0.0;
  for (int k = 0; k < 60; ++k) {
    std::vector<Vec2> p;
    for (int i = 0; i < (k % 2 == 0 ? 4 : 3); ++i) p.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1));
    const double tolerance = std::pow(10.0, random.uniform(-5.0, -2.0));
    const Curve curve = p.size() == 4 ? Curve::cubic(p[0], p[1], p[2], p[3]) : Curve::quadratic(p[0], p[1], p[2]);
    const auto exact = [&](double t) { return casteljau(p, t); };
    const Points points = flattened(curve, tolerance);
    EXPECT_EQ(points.back(), p.back());
    const double worst = farthest(exact, points);
    EXPECT_LE(worst, tolerance * (1 + 1e-9)) << k;
    const double least = optimum(exact, tolerance);
    EXPECT_LE(static_cast<double>(points.size() - 1), 2.0 * least + 3.0) << k;
    if (points.size() > 12) {
      EXPECT_GE(worst, 0.5 * tolerance) << k;
    }
    pieces += static_cast<double>(points.size() - 1);
    best += least;
  }
  EXPECT_LE(pieces, 1.2 * best);
}

TEST(Curve, curves_that_fold_stop_or_turn_back_keep_the_tolerance) {
  const std::vector<std::vector<Vec2>> folds{
      {{0, 0}, {3, 0}, {-2, 0}, {1, 0}},         // to and fro on a line
      {{0, 0}, {1, 1}, {0, 1}, {1, 0}},          // a cusp
      {{0, 0}, {2, 1}, {-1, 1}, {1, 0}},         // a loop
      {{0, 0}, {0, 0}, {1, 1}, {1, 1}},          // a straight line that starts and ends at rest
      {{0, 0}, {1, 1}, {1, 1}, {0, 0}},          // out and back to its beginning
      {{0, 0}, {2, 0}, {-1, 1e-9}, {1, 1e-9}},   // nearly folded flat
      {{5, 5}, {5, 5}, {5, 5}, {5, 5}},          // a point
      {{0, 0}, {1e6, 1e-6}, {-1e6, 0}, {0, 1}},  // a very long fold
  };
  for (const std::vector<Vec2>& p : folds)
    for (const double tolerance : {1e-1, 1e-4}) {
      const Points points = flattened(Curve::cubic(p[0], p[1], p[2], p[3]), tolerance);
      const double worst = farthest([&](double t) { return casteljau(p, t); }, points);
      EXPECT_LE(worst, tolerance * (1 + 1e-9)) << p[1].transpose() << " " << p[2].transpose();
      EXPECT_LE(points.size(), 30000u);
    }
}

TEST(Curve, bounds_are_those_of_the_extremes) {
  const Box box = Curve::cubic({0, 0}, {0, 4}, {6, 4}, {6, 0}).bounds();
  EXPECT_NEAR(box.max.y(), 3.0, 1e-15);  // 4 · ¾ at t = ½
  EXPECT_EQ(box.min, Vec2(0, 0));
  EXPECT_EQ(box.max.x(), 6.0);
  const Box half = Curve::ellipse({1, 1}, {2, 0}, {0, 3}, -0.1, kPi, {3, 0.7}, {-1, 1}).bounds();
  EXPECT_NEAR(half.max.x(), 3.0, 1e-15);
  EXPECT_NEAR(half.max.y(), 4.0, 1e-15);
}

TEST(Curve, more_pieces_than_allowed_are_refused) {
  std::vector<Vec2> points;
  EXPECT_THROW(scene::flatten(Curve::quadratic({0, 0}, {1, 1}, {2, 0}), 1e-6, 100, &points), scene::TooManyPieces);
  EXPECT_THROW(scene::flatten(Curve::ellipse({0, 0}, {1, 0}, {0, 1}, 0, 6, {1, 0}, {1, 0}), 1e-9, 100, &points),
               scene::TooManyPieces);
}

}  // namespace
}  // namespace froude
