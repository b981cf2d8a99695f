// The wall integral against a polar quadrature that casts rays, and against its own half-plane limit.
#include <froude/solver/fluid/wall_integral.h>

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <vector>

#include <froude/base/random.h>

namespace froude {
namespace {

// w = m⁴ (1 + 0.55 m⁶)/π, written out again from its definition.
double kernelValue(double r) {
  const double m = 1.0 - 0.25 * r * r;
  return m > 0.0 ? std::pow(m, 4) * (1.0 + 0.55 * std::pow(m, 6)) / kPi : 0.0;
}

struct Reference {
  double lambda = 0.0;
  Vec2 gradient{0.0, 0.0};
};

// Where a ray from the origin first enters a solid; the solid is left of a → b.
double firstEntry(const std::vector<WallEdge>& edges, const Vec2& u) {
  double nearest = 2.0;
  for (const WallEdge& e : edges) {
    const Vec2 along = e.b - e.a;
    const double denominator = cross(u, along);
    if (denominator == 0.0) continue;
    const double r = cross(e.a, along) / denominator;
    const double s = cross(e.a, u) / denominator;
    if (r > 0.0 && s >= 0.0 && s <= 1.0 && r < nearest) nearest = r;
  }
  return nearest;
}

// Midpoint rule over angle and radius: first order at the jumps of the first entry, 2π/40,000 of the kernel's slope
// there.
Reference byRays(const std::vector<WallEdge>& edges, int rays, int radii) {
  Reference sum;
  for (int i = 0; i < rays; ++i) {
    const double theta = 2.0 * kPi * (i + 0.5) / rays;
    const Vec2 u(std::cos(theta), std::sin(theta));
    const double from = firstEntry(edges, u);
    const double dr = (2.0 - from) / radii;
    for (int k = 0; k < radii && dr > 0.0; ++k) {
      const double r = from + (k + 0.5) * dr;
      const double area = r * dr * 2.0 * kPi / rays;
      const double slope = (kernelValue(r + 1e-5) - kernelValue(r - 1e-5)) / 2e-5;
      sum.lambda += kernelValue(r) * area;
      sum.gradient -= slope * area * u;  // ∇ₓ W(|x − y|) = −W'·u
    }
  }
  return sum;
}

Reference integrate(const std::vector<WallEdge>& edges) {
  std::array<WallShare, kMaxWallEdges> shares;
  Reference sum;
  const std::size_t n = integrateWalls(edges, shares);
  for (std::size_t k = 0; k < n; ++k) {
    sum.lambda += shares[k].lambda;
    sum.gradient += shares[k].gradient;
  }
  return sum;
}

std::vector<WallEdge> ring(const std::vector<Vec2>& vertices, const Vec2& at) {
  std::vector<WallEdge> edges;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    edges.push_back({vertices[i] - at, vertices[(i + 1) % vertices.size()] - at, 0});
  }
  return edges;
}

void expectLikeRays(const std::vector<WallEdge>& edges, double tolerance) {
  const Reference exact = integrate(edges);
  const Reference rays = byRays(edges, 40000, 60);
  EXPECT_NEAR(exact.lambda, rays.lambda, tolerance);
  EXPECT_NEAR(exact.gradient.x(), rays.gradient.x(), 3.0 * tolerance);
  EXPECT_NEAR(exact.gradient.y(), rays.gradient.y(), 3.0 * tolerance);
}

TEST(WallIntegral, a_wall_at_distance_zero_fills_half_of_the_kernel) {
  EXPECT_NEAR(halfPlane(0.0).lambda, 0.5, 1e-9);
  EXPECT_EQ(halfPlane(2.5).lambda, 0.0);
  EXPECT_EQ(halfPlane(-2.5).lambda, 1.0);
}

TEST(WallIntegral, a_flat_wall_agrees_with_its_table_at_every_distance) {
  for (double d = 0.003; d < 2.0; d += 0.0137) {
    const Reference wall = integrate({{{3.0, -d}, {-3.0, -d}, -1}});
    EXPECT_NEAR(wall.lambda, halfPlane(d).lambda, 1e-9) << d;
    EXPECT_NEAR(-wall.gradient.y(), halfPlane(d).slope, 2e-5) << d;
  }
}

TEST(WallIntegral, corners_of_all_angles_agree_with_rays) {
  for (const double degrees : {0.5, 45.0, 90.0, 135.0}) {
    const double half = 0.5 * degrees * kPi / 180.0;
    // a wedge of solid with its tip at the origin, pointing up
    const std::vector<Vec2> wedge{
        {0.0, 0.0}, {-5.0 * std::sin(half), -5.0 * std::cos(half)}, {5.0 * std::sin(half), -5.0 * std::cos(half)}};
    for (const Vec2& at : {Vec2(0.0, 0.6), Vec2(0.4, 0.3), Vec2(0.3 + 0.7 * std::tan(half), -0.7),
                           Vec2(0.05 + 1.01 * std::tan(half), -1.0)}) {
      expectLikeRays(ring(wedge, at), 1e-4);
    }
  }
}

// Wendland's kernel, from its definition, over the strip or disc behind a flat wall: midpoint rule in two dimensions.
TEST(WallIntegral, of_wendlands_kernel_a_flat_wall_a_corner_and_a_plate_agree_with_sums_over_the_solid) {
  auto value = [](double r) {
    return r < 2.0 ? 7.0 / (4.0 * kPi) * std::pow(1.0 - 0.5 * r, 4) * (1.0 + 2.0 * r) : 0.0;
  };
  auto slope = [](double r) { return r < 2.0 ? -35.0 / (4.0 * kPi) * r * std::pow(1.0 - 0.5 * r, 3) : 0.0; };
  struct Solid {
    std::vector<WallEdge> edges;
    std::function<bool(const Vec2&)> inside;
  };
  const std::vector<Solid> solids{{{{{5.0, -0.3}, {-5.0, -0.3}, 0}}, [](const Vec2& p) { return p.y() < -0.3; }},
                                  {{{{5.0, -1.2}, {-5.0, -1.2}, 0}}, [](const Vec2& p) { return p.y() < -1.2; }},
                                  {ring({{0.0, 0.0}, {0.0, 9.0}, {9.0, 9.0}, {9.0, 0.0}}, {0.4, 0.7}),
                                   [](const Vec2& p) { return p.x() < -0.4 || p.y() < -0.7; }}};
  for (const Solid& solid : solids) {
    Reference sum;
    constexpr int kSide = 2000;
    constexpr double kCell = 4.0 / kSide;
    for (int a = 0; a < kSide; ++a) {
      for (int b = 0; b < kSide; ++b) {
        const Vec2 p(-2.0 + (a + 0.5) * kCell, -2.0 + (b + 0.5) * kCell);
        if (!solid.inside(p)) continue;
        sum.lambda += value(p.norm()) * kCell * kCell;
        sum.gradient -= slope(p.norm()) * kCell * kCell * p.normalized();
      }
    }
    std::array<WallShare, kMaxWallEdges> shares;
    const std::size_t n = integrateWalls(solid.edges, shares, kernel::Kind::WendlandC2);
    Reference exact;
    for (std::size_t k = 0; k < n; ++k) {
      exact.lambda += shares[k].lambda;
      exact.gradient += shares[k].gradient;
    }
    EXPECT_NEAR(exact.lambda, sum.lambda, 1e-3);
    EXPECT_NEAR(exact.gradient.x(), sum.gradient.x(), 1e-3);
    EXPECT_NEAR(exact.gradient.y(), sum.gradient.y(), 1e-3);
  }
  EXPECT_NEAR(halfPlaneShare(0.0, kernel::Kind::WendlandC2), 0.5, 1e-9);
}

TEST(WallIntegral, inside_a_corner_both_walls_count_and_no_more) {
  // the inside of a box: solid outside it, so its ring runs clockwise
  expectLikeRays(ring({{0.0, 0.0}, {0.0, 9.0}, {9.0, 9.0}, {9.0, 0.0}}, {0.4, 0.3}), 3e-5);
}

TEST(WallIntegral, a_thin_plate_hides_all_that_is_behind_it) {
  const std::vector<Vec2> plate{{-5.0, -0.0025}, {5.0, -0.0025}, {5.0, 0.0025}, {-5.0, 0.0025}};
  const Reference beside = integrate(ring(plate, {0.0, 0.5025}));
  EXPECT_NEAR(beside.lambda, halfPlane(0.5).lambda, 1e-8);
  EXPECT_NEAR(-beside.gradient.y(), halfPlane(0.5).slope, 2e-5);
}

TEST(WallIntegral, bodies_that_hide_one_another_agree_with_rays) {
  RandomStream random(7, 1);
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<WallEdge> edges;
    for (int body = 0; body < 3; ++body) {
      const double angle = random.uniform(0.0, 2.0 * kPi), distance = random.uniform(0.5, 1.6);
      const Vec2 center = distance * Vec2(std::cos(angle), std::sin(angle));
      const double radius = random.uniform(0.1, 0.4) * distance;
      std::vector<Vec2> vertices;
      for (int k = 0; k < 5; ++k) {
        const double a = 2.0 * kPi * k / 5 + angle;
        vertices.push_back(center + radius * Vec2(std::cos(a), std::sin(a)));
      }
      for (WallEdge e : ring(vertices, {0.0, 0.0})) {
        e.owner = body;
        edges.push_back(e);
      }
    }
    expectLikeRays(edges, 2e-4);
  }
}

TEST(WallIntegral, each_owner_gets_its_own_share) {
  std::array<WallShare, 4> shares;
  const std::vector<WallEdge> edges{{{3.0, -0.5}, {-3.0, -0.5}, 4}, {{-3.0, 0.7}, {3.0, 0.7}, 9}};
  ASSERT_EQ(integrateWalls(edges, shares), 2u);
  EXPECT_EQ(shares[0].owner, 4);
  EXPECT_EQ(shares[1].owner, 9);
  EXPECT_NEAR(shares[0].lambda, halfPlane(0.5).lambda, 1e-8);
  EXPECT_NEAR(shares[1].lambda, halfPlane(0.7).lambda, 1e-8);
}

TEST(WallIntegral, a_segment_through_an_edge_is_hidden_and_one_beside_it_is_not) {
  const WallEdge e{{-1.0, 0.5}, {1.0, 0.5}, 0};
  EXPECT_TRUE(hidesPoint(e, {0.3, 1.0}));
  EXPECT_FALSE(hidesPoint(e, {0.3, 0.4}));
  EXPECT_FALSE(hidesPoint(e, {1.9, 0.6}));
}

}  // namespace
}  // namespace froude
