// Meshes of triangles against what they promise: areas, the outline, angles, empty circles by brute force.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <set>

#include <froude/base/random.h>
#include <froude/fields/delaunay.h>
#include <froude/fields/triangle_mesh.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

double angleAt(const Vec2& p, const Vec2& a, const Vec2& b) {
  return std::acos(std::clamp((a - p).normalized().dot((b - p).normalized()), -1.0, 1.0));
}

double smallestAngle(const TriangleMesh& mesh) {
  double least = kPi;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      least = std::min(least, angleAt(mesh.points[t[k]], mesh.points[t[(k + 1) % 3]], mesh.points[t[(k + 2) % 3]]));
  return least;
}

/// How far d lies within the circle through a, b, c, scaled by its size; in 113 bits.
double depthInCircle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  using Real = long double;
  const Real ax = a.x() - Real(d.x()), ay = a.y() - Real(d.y());
  const Real bx = b.x() - Real(d.x()), by = b.y() - Real(d.y());
  const Real cx = c.x() - Real(d.x()), cy = c.y() - Real(d.y());
  const Real determinant = (ax * ax + ay * ay) * (bx * cy - cx * by) - (bx * bx + by * by) * (ax * cy - cx * ay) +
                           (cx * cx + cy * cy) * (ax * by - bx * ay);
  const Real scale = (b - a).norm() * (c - b).norm() * (a - c).norm();
  return static_cast<double>(determinant / (scale * scale) * std::cbrt(scale) * std::cbrt(scale));
}

/// Everything that a mesh promises but its angles and circles.
void expectMesh(const Polygon& polygon, const TriangleMesh& mesh) {
  long double area = 0.0L;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::set<std::uint32_t> used;
  for (const auto& t : mesh.triangles) {
    ASSERT_GT(test::side(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]), 0);
    area += 0.5L * cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    used.insert(t.begin(), t.end());
  }
  EXPECT_NEAR(static_cast<double>(area), polygon.area(), 1e-11 * polygon.area());
  EXPECT_EQ(used.size(), mesh.points.size()) << "points without a triangle";
  for (const auto& edge : mesh.outline) {
    ASSERT_EQ((edges[{edge[0], edge[1]}]), 1);
    ASSERT_EQ(edges.count({edge[1], edge[0]}), 0u) << "a triangle on both sides of the outline";
  }
  for (const auto& [ends, times] : edges) ASSERT_EQ(times, 1);
  std::size_t single = 0;
  for (const auto& [ends, times] : edges) single += edges.count({ends.second, ends.first}) == 0 ? 1 : 0;
  EXPECT_EQ(single, mesh.outline.size()) << "triangles end where the outline does not";
  // The outline's pieces follow the polygon's edges, in their order.
  std::size_t at = 0;
  const double rounding = 1e-14 * polygon.bounds().size().maxCoeff();
  for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
    ASSERT_EQ(mesh.points[mesh.outline[at][0]], polygon.edgeStart(i));
    for (;; ++at) {
      const Vec2& end = mesh.points[mesh.outline[at][1]];
      if (end == polygon.edgeEnd(i)) break;
      const Vec2 along = (polygon.edgeEnd(i) - polygon.edgeStart(i)).normalized();
      ASSERT_NEAR(cross(along, end - polygon.edgeStart(i)), 0.0, rounding);
    }
    ++at;
  }
  EXPECT_EQ(at, mesh.outline.size());
}

/// No point lies in a triangle's circle: brute force over all points.
void expectEmptyCircles(const TriangleMesh& mesh) {
  double deepest = -1.0;
  for (const auto& t : mesh.triangles)
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      if (p == t[0] || p == t[1] || p == t[2]) continue;
      deepest =
          std::max(deepest, depthInCircle(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[p]));
    }
  EXPECT_LT(deepest, 1e-6) << "points are snapped to a billionth of the box";
}

Polygon frame() {
  return Polygon::make({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{{0.3, 0.3}, {0.7, 0.3}, {0.7, 0.7}, {0.3, 0.7}}});
}

TEST(TriangleMesh, covers_shapes_exactly_with_every_edge_of_the_outline) {
  const std::vector<std::pair<Polygon, double>> shapes{
      {Polygon::box({{0, 0}, {0.5, 0.5}}), 0.05},
      {Polygon::box({{0, 0}, {1, 0.1}}), 0.1 / 12},
      {Polygon::box({{0, 0}, {1, 0.1}}), 0.1},
      {Polygon::box({{1000, -3000}, {1001, -2999.9}}), 0.02},
      {Polygon::regular(64, 0.5), 0.06},
      {Polygon::regular(400, 0.5), 0.06},
      {Polygon::make({{0, 0}, {1, 0}, {1, 0.3}, {0.3, 0.3}, {0.3, 1}, {0, 1}}), 0.07},
      {frame(), 0.07},
      {Polygon::make({{0, 0}, {1, 0}, {1, 0.577}}), 0.07}};
  for (const auto& [shape, spacing] : shapes) {
    SCOPED_TRACE(testing::Message() << shape.edgeCount() << " edges, spacing " << spacing);
    const TriangleMesh mesh = triangleMesh(shape, spacing);
    expectMesh(shape, mesh);
    expectEmptyCircles(mesh);
    EXPECT_GT(smallestAngle(mesh), 25.0 * kPi / 180.0);
    for (const auto& edge : mesh.outline)
      EXPECT_LE((mesh.points[edge[1]] - mesh.points[edge[0]]).norm(), 1.25 * spacing + 1e-12);
  }
}

TEST(TriangleMesh, has_about_the_points_that_the_spacing_asks_for) {
  const Polygon box = Polygon::box({{0, 0}, {1, 1}});
  for (const double spacing : {0.1, 0.05, 0.02}) {
    const TriangleMesh mesh = triangleMesh(box, spacing);
    const double triangles = box.area() / (spacing * spacing * std::sqrt(0.75) / 2.0);
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), triangles, 0.12 * triangles);
  }
}

TEST(TriangleMesh, a_beam_has_rows_of_equal_triangles_along_its_sides) {
  const TriangleMesh mesh = triangleMesh(Polygon::box({{0, 0}, {1, 0.1}}), 0.1 / 12);
  EXPECT_GT(smallestAngle(mesh), 35.0 * kPi / 180.0);
  std::size_t onAxis = 0;
  for (const Vec2& p : mesh.points) onAxis += std::abs(p.y() - 0.05) < 1e-3 && p.x() > 0.1 && p.x() < 0.9 ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(onAxis), 0.8 / (0.1 / 12), 2.0);
}

TEST(TriangleMesh, of_hard_outlines_is_whole_or_refused_in_words) {
  RandomStream random(11, 0);
  int meshed = 0, refused = 0;
  for (int i = 0; i < 240; ++i) {
    const test::Outline outline = test::makeOutline(static_cast<test::Shape>(i % test::kShapeCount), random);
    SCOPED_TRACE(outline.name + " " + std::to_string(i));
    std::optional<Polygon> polygon;
    try {
      polygon = Polygon::make(outline.outer, outline.holes);
    } catch (const PolygonError&) {
      continue;
    }
    try {
      const TriangleMesh mesh = triangleMesh(*polygon, 0.08);
      expectMesh(*polygon, mesh);
      if (testing::Test::HasFatalFailure()) return;
      EXPECT_GE(smallestAngle(mesh), kLeastMeshAngle);
      ++meshed;
    } catch (const MeshError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("right"), std::string::npos) << text;
      EXPECT_TRUE(polygon->bounds().grown(1e-9).contains(error.place())) << text;
      ++refused;
    }
  }
  EXPECT_GT(meshed, 90);
  EXPECT_GT(refused, 6);
}

TEST(TriangleMesh, is_the_same_each_time) {
  const Polygon polygon = frame();
  const TriangleMesh a = triangleMesh(polygon, 0.03), b = triangleMesh(polygon, 0.03);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.outline, b.outline);
}

TEST(TriangleMesh, of_a_thin_strip_takes_triangles_of_its_thickness) {
  const Polygon strip = Polygon::box({{0, 0}, {1, 0.01}});
  const TriangleMesh mesh = triangleMesh(strip, 0.1);
  expectMesh(strip, mesh);
  EXPECT_GT(smallestAngle(mesh), 25.0 * kPi / 180.0);
}

TEST(TriangleMesh, refuses_what_it_cannot_fill) {
  const Polygon box = Polygon::box({{0, 0}, {1, 1}});
  for (const double spacing : {0.0, -1.0, std::nan(""), kInfinity}) EXPECT_THROW(triangleMesh(box, spacing), MeshError);
  try {
    triangleMesh(box, 1e-6);
    FAIL();
  } catch (const MeshError& error) {
    EXPECT_NE(std::string(error.what()).find("right is a larger one"), std::string::npos) << error.what();
  }
  try {
    triangleMesh(Polygon::make({{0, 0}, {1, 0}, {1, 0.05}}), 0.05);
    FAIL();
  } catch (const MeshError& error) {
    EXPECT_NE(std::string(error.what()).find("2.86 degrees"), std::string::npos) << error.what();
    EXPECT_LT(error.place().x(), 0.2);
  }
}

TEST(CoarseOutline, leaves_out_what_is_finer_than_the_triangles) {
  const Polygon disc = Polygon::regular(400, 0.5);
  const Polygon coarse = coarseOutline(disc, 0.06);
  EXPECT_LT(coarse.edgeCount(), 80u);
  EXPECT_NEAR(coarse.area(), disc.area(), 0.01 * disc.area());
  const auto edges = test::oracleEdges(coarse);
  for (const Vec2& p : disc.vertices()) EXPECT_LE(test::boundaryDistance(edges, p), 0.06L / 16 + 1e-12L);
  const std::size_t triangles = triangleMesh(coarse, 0.06).triangles.size();
  EXPECT_LT(triangles, 650u) << "of equal size, not graded towards fine edges";
}

TEST(CoarseOutline, leaves_shapes_alone_whose_edges_are_long) {
  const Polygon polygon = frame();
  const Polygon same = coarseOutline(polygon, 0.1);
  EXPECT_TRUE(std::ranges::equal(same.vertices(), polygon.vertices()));
}

TEST(Delaunay, of_points_on_a_grid_covers_the_hull_once) {
  std::vector<detail::PointLattice::Node> nodes;
  for (std::int32_t x = 0; x < 20; ++x)
    for (std::int32_t y = 0; y < 20; ++y) nodes.push_back({x * 1000, y * 1000});
  std::int64_t twice = 0;
  for (const auto& t : detail::delaunay(nodes)) {
    const auto &a = nodes[t[0]], &b = nodes[t[1]], &c = nodes[t[2]];
    twice += std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
  }
  EXPECT_EQ(twice, 2 * 19000LL * 19000);
}

}  // namespace
}  // namespace froude
