// Cut cells against Clipper, and against what must hold whatever the polygons are.
#include <froude/fields/cut_cells.h>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <froude/base/hash.h>
#include <froude/base/random.h>

#include "support/cut_oracle.h"
#include "support/polygon_generator.h"

namespace froude {
namespace {

using test::connectedAreas;
using test::CutOracle;

constexpr std::array<std::int32_t, 4> kRange{-2, -2, 40, 40};
constexpr std::array<bool, 4> kClosed{true, true, true, true};

/// Polygons, where they are, and the walls of a tank of 1 m.
struct Scene {
  CutGrid grid{{0.0, 0.0}, 1.0 / 24.0, 0, 0};
  CutWalls walls{{{0.0, 0.0}, {1.0, 1.0}}, kClosed};
  std::vector<Polygon> polygons;
  std::vector<Transform> places;

  void add(const Polygon& polygon, const Transform& place = {}) {
    polygons.push_back(polygon);
    places.push_back(place);
  }
  std::vector<CutOutline> outlines() const {
    std::vector<CutOutline> all;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
      all.push_back({&polygons[p], places[p], places[p].toWorld(polygons[p].centroid()), static_cast<std::int32_t>(p)});
    }
    return all;
  }
  CutCells cut() const {
    CutCells cells;
    cells.setFixed(grid, outlines(), walls);
    cells.update(kRange, {});
    return cells;
  }
  CutOracle oracle() const {
    CutOracle oracle(grid);
    for (const CutOutline& outline : outlines()) oracle.add(outline);
    oracle.addWalls(walls);
    return oracle;
  }
};

Scene randomScene(RandomStream& random, std::size_t count, double size) {
  Scene scene;
  for (std::size_t k = 0; k < count; ++k) {
    const auto shape = static_cast<test::Shape>(random.below(test::kShapeCount));
    const Transform place = Transform::of({random.uniform(0.1, 0.9), random.uniform(0.1, 0.9)}, random.uniform(0, 7));
    scene.add(test::placed(test::makeOutline(shape, random), size, {}), place);
  }
  return scene;
}

std::span<const CutPart> partsOf(const CutCells& cut, const CutCell& cell) {
  return cut.parts().subspan(cell.part, cell.partCount);
}

Vec2 outward(CutSide side) {
  switch (side) {
    case CutSide::Left:
      return {-1.0, 0.0};
    case CutSide::Right:
      return {1.0, 0.0};
    case CutSide::Bottom:
      return {0.0, -1.0};
    default:
      return {0.0, 1.0};
  }
}

/// A constant pressure must push no part, joints must be mutual, and the lists must point at each other.
void expectSound(const CutCells& cut, double tolerance = 1e-9) {
  for (std::size_t c = 0; c < cut.cells().size(); ++c) {
    const CutCell& cell = cut.cells()[c];
    if (cell.i < -1 || cell.i > 38 || cell.j < -1 || cell.j > 38) continue;
    ASSERT_EQ(cut.find(cell.i, cell.j), static_cast<std::int32_t>(c));
    double last = kInfinity;
    for (std::size_t p = cell.part; p < cell.part + cell.partCount; ++p) {
      const CutPart& part = cut.parts()[p];
      ASSERT_EQ(part.cell, c);
      ASSERT_LE(part.area, last);
      ASSERT_GE(part.area, 0.0);
      last = part.area;
      Vec2 sum(0.0, 0.0);
      for (const CutJoint& joint : cut.joints().subspan(part.joint, part.jointCount)) {
        ASSERT_GT(joint.length, 0.0);
        ASSERT_LE(joint.length, 1.0 + 1e-12);
        sum += joint.length * outward(joint.side);
        if (joint.part < 0) continue;
        const CutPart& other = cut.parts()[static_cast<std::size_t>(joint.part)];
        bool mutual = false;
        for (const CutJoint& back : cut.joints().subspan(other.joint, other.jointCount)) {
          mutual |= back.part == static_cast<std::int32_t>(p) && back.length == joint.length &&
                    outward(back.side) == -outward(joint.side);
        }
        ASSERT_TRUE(mutual) << cell.i << ' ' << cell.j;
      }
      for (const CutWall& wall : cut.walls().subspan(part.wall, part.wallCount)) sum -= wall.normal;
      ASSERT_LT(sum.norm(), tolerance) << cell.i << ' ' << cell.j << " part " << p - cell.part << " area " << part.area;
    }
  }
}

/// Every cell's parts have the areas that Clipper finds, and what hangs together does so for Clipper too.
void expectAsClipper(const Scene& scene, const CutCells& cut) {
  CutOracle oracle = scene.oracle();
  constexpr double kSpeck = 1e-7;
  for (std::int32_t j = 0; j < 24; ++j) {
    for (std::int32_t i = 0; i < 24; ++i) {
      const auto regions = oracle.open({i, j}, {i + 1, j + 1}, kSpeck);
      const std::int32_t c = cut.find(i, j);
      if (c < 0) {
        ASSERT_EQ(regions.size(), cut.solid(i, j) ? 0u : 1u) << i << ' ' << j;
        if (!regions.empty()) {
          ASSERT_NEAR(regions[0].area, 1.0, 1e-8) << i << ' ' << j;
        }
        continue;
      }
      const CutCell& cell = cut.cells()[static_cast<std::size_t>(c)];
      std::size_t large = 0;
      for (const CutPart& part : partsOf(cut, cell)) large += part.area > kSpeck ? 1u : 0u;
      ASSERT_EQ(large, regions.size()) << i << ' ' << j;
      for (std::size_t p = 0; p < large; ++p) {
        ASSERT_NEAR(cut.parts()[cell.part + p].area, regions[p].area, 1e-8) << i << ' ' << j;
      }
    }
  }
  const auto whole = oracle.open({0, 0}, {24, 24}, 1e-4);
  const std::vector<double> areas = connectedAreas(cut, 24, 24);
  ASSERT_GE(areas.size(), whole.size());
  for (std::size_t r = 0; r < whole.size(); ++r) ASSERT_NEAR(areas[r], whole[r].area, 1e-6) << r;
  if (areas.size() > whole.size()) {
    ASSERT_LT(areas[whole.size()], 1.001e-4);
  }
}

TEST(CutCells, areas_parts_and_what_hangs_together_are_those_of_clipper) {
  RandomStream random(11, 3);
  for (int round = 0; round < 24; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = randomScene(random, 1, 0.7);
    const CutCells cut = scene.cut();
    expectSound(cut);
    expectAsClipper(scene, cut);
    if (HasFatalFailure()) return;
  }
}

TEST(CutCells, polygons_that_overlap_are_solid_once) {
  RandomStream random(12, 3);
  for (int round = 0; round < 24; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = randomScene(random, 4, 0.5);
    const CutCells cut = scene.cut();
    expectSound(cut);
    expectAsClipper(scene, cut);
    if (HasFatalFailure()) return;
  }
}

TEST(CutCells, what_is_open_and_the_polygons_fill_the_tank) {
  RandomStream random(13, 3);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    const auto shape = static_cast<test::Shape>(random.below(test::kShapeCount));
    scene.add(test::placed(test::makeOutline(shape, random), 0.4, {}),
              Transform::of({random.uniform(0.45, 0.55), random.uniform(0.45, 0.55)}, random.uniform(0, 7)));
    const CutCells cut = scene.cut();
    expectSound(cut);
    double open = 0.0;
    for (std::int32_t j = 0; j < 24; ++j) {
      for (std::int32_t i = 0; i < 24; ++i) {
        const std::int32_t c = cut.find(i, j);
        if (c < 0)
          open += cut.solid(i, j) ? 0.0 : 1.0;
        else
          for (const CutPart& part : partsOf(cut, cut.cells()[static_cast<std::size_t>(c)])) open += part.area;
      }
    }
    ASSERT_NEAR(open / 576.0 + scene.polygons[0].area(), 1.0, 1e-12);
    if (HasFatalFailure()) return;
  }
}

TEST(CutCells, a_body_in_the_open_feels_no_constant_pressure_and_has_its_outline_for_wall) {
  RandomStream random(14, 3);
  for (int round = 0; round < 100; ++round) {
    Scene scene;
    const auto shape = static_cast<test::Shape>(random.below(test::kShapeCount));
    scene.add(test::placed(test::makeOutline(shape, random), 0.4, {}),
              Transform::of({0.52, 0.47}, random.uniform(0, 7)));
    const CutCells cut = scene.cut();
    Vec2 normal(0.0, 0.0);
    double moment = 0.0, length = 0.0, outline = 0.0;
    for (const CutWall& wall : cut.walls()) {
      if (wall.body < 0) continue;
      normal += wall.normal;
      moment += wall.moment;
      length += wall.length;
    }
    const Polygon& polygon = scene.polygons[0];
    for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e)
      outline += (polygon.edgeEnd(e) - polygon.edgeStart(e)).norm();
    EXPECT_LT(normal.norm(), 1e-11);
    EXPECT_LT(std::abs(moment), 1e-11);
    EXPECT_NEAR(length * scene.grid.size, outline, 1e-11);
  }
}

TEST(CutCells, boxes_on_grid_lines_close_whole_faces_and_leave_no_part_without_area) {
  for (const double angle : {0.0, 0.5 * kPi, kPi, 1.5 * kPi}) {
    Scene scene;
    scene.grid.size = 0.0625;
    scene.add(Polygon::box({{-0.125, -0.1875}, {0.125, 0.1875}}), Transform::of({0.5, 0.5}, angle));
    const CutCells cut = scene.cut();
    expectSound(cut);
    double open = 0.0;
    for (const CutCell& cell : cut.cells()) {
      if (cell.i < 0 || cell.i > 15 || cell.j < 0 || cell.j > 15) continue;
      ASSERT_LE(cell.partCount, 1u);
      if (cell.partCount == 0) continue;
      EXPECT_DOUBLE_EQ(cut.parts()[cell.part].area, 1.0);
      for (const double side : cell.open) EXPECT_TRUE(side == 0.0 || side == 1.0) << side;
    }
    EXPECT_TRUE(cut.edges().empty());
    for (const double area : connectedAreas(cut, 16, 16)) open += area;
    EXPECT_DOUBLE_EQ(open, 256.0 - 24.0);
  }
}

TEST(CutCells, vertices_on_nodes_and_edges_through_nodes_are_cut_as_clipper_does) {
  RandomStream random(15, 3);
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    scene.grid.size = 1.0 / 24.0;
    std::vector<Vec2> ring;
    const int n = 3 + static_cast<int>(random.below(6));
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * kPi * k / n, radius = random.uniform(2.0, 9.0);
      // On whole cells, so that edges at 45 degrees run through nodes.
      ring.emplace_back(std::nearbyint(radius * std::cos(angle)) / 24.0,
                        std::nearbyint(radius * std::sin(angle)) / 24.0);
    }
    try {
      scene.add(Polygon::make(ring), Transform::of({0.5, 0.5}, 0.0));
    } catch (const PolygonError&) {
      continue;
    }
    const CutCells cut = scene.cut();
    expectSound(cut);
    expectAsClipper(scene, cut);
    if (HasFatalFailure()) return;
  }
}

TEST(CutCells, a_plate_of_a_tenth_of_a_millimetre_keeps_its_sides_apart) {
  for (const double angle : {0.0, 0.3, 0.5 * kPi, 2.0}) {
    SCOPED_TRACE(angle);
    Scene scene;
    scene.add(Polygon::box({{-1.5, -0.00005}, {1.5, 0.00005}}), Transform::of({0.503, 0.497}, angle));
    const CutCells cut = scene.cut();
    expectSound(cut);
    const std::vector<double> areas = connectedAreas(cut, 24, 24);
    ASSERT_EQ(areas.size(), 2u);
    expectAsClipper(scene, cut);
    EXPECT_FALSE(cut.edges().empty());
    for (const CutEdge& edge : cut.edges()) {
      auto main = [&](std::int32_t p) {
        return p < 0 ||
               cut.cells()[cut.parts()[static_cast<std::size_t>(p)].cell].part == static_cast<std::uint32_t>(p);
      };
      EXPECT_FALSE(main(edge.a) && main(edge.b));
    }
  }
}

TEST(CutCells, a_gap_of_a_hundredth_of_a_cell_is_a_channel_of_its_own) {
  Scene scene;
  const double gap = 0.01 * scene.grid.size;
  scene.add(Polygon::box({{0.0, -0.2}, {0.3, 0.2}}), Transform::of({0.5 + 0.5 * gap, 0.5}, 0.0));
  scene.add(Polygon::box({{-0.3, -0.2}, {0.0, 0.2}}), Transform::of({0.5 - 0.5 * gap, 0.5}, 0.0));
  const CutCells cut = scene.cut();
  expectSound(cut);
  expectAsClipper(scene, cut);
  EXPECT_EQ(connectedAreas(cut, 24, 24).size(), 1u);
}

TEST(CutCells, bodies_that_touch_have_nothing_between_them) {
  for (const double angle : {0.0, 0.2, 0.7, 1.0, 1.3}) {
    SCOPED_TRACE(angle);
    Scene scene;
    scene.add(Polygon::box({{0.0, -0.2}, {0.3, 0.2}}), Transform::of({0.5, 0.5}, angle));
    scene.add(Polygon::box({{-0.3, -0.15}, {0.0, 0.15}}), Transform::of({0.5, 0.5}, angle));
    const CutCells cut = scene.cut();
    expectSound(cut);
    expectAsClipper(scene, cut);
    double length = 0.0;
    for (const CutWall& wall : cut.walls()) length += wall.body >= 0 ? wall.length : 0.0;
    EXPECT_NEAR(length * scene.grid.size, 1.4 + 1.2 - 0.6, 1e-8);
    EXPECT_EQ(connectedAreas(cut, 24, 24).size(), 1u);
  }
}

TEST(CutCells, a_point_belongs_to_the_part_in_which_clipper_finds_it) {
  RandomStream random(16, 3);
  std::size_t asked = 0;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = randomScene(random, 3, 0.6);
    const CutCells cut = scene.cut();
    CutOracle oracle = scene.oracle();
    for (std::uint32_t c = 0; c < cut.cells().size(); ++c) {
      const CutCell& cell = cut.cells()[c];
      if (cell.partCount < 2 || cell.i < 0 || cell.i > 23 || cell.j < 0 || cell.j > 23) continue;
      const auto regions = oracle.open({cell.i, cell.j}, {cell.i + 1, cell.j + 1}, 1e-7);
      for (int k = 0; k < 20; ++k) {
        const Vec2 x(cell.i + random.uniform(0, 1), cell.j + random.uniform(0, 1));
        for (std::size_t r = 0; r < regions.size(); ++r) {
          if (!regions[r].contains(x, oracle)) continue;
          ASSERT_EQ(cut.partAt(c, scene.grid.origin + scene.grid.size * x), cell.part + r);
          ++asked;
        }
      }
    }
  }
  EXPECT_GT(asked, 1000u);
}

TEST(CutCells, a_moving_body_pushes_out_of_each_part_what_its_area_loses) {
  RandomStream random(17, 3);
  constexpr double kTime = 1e-5;
  std::size_t compared = 0;
  for (int round = 0; round < 20; ++round) {
    Scene scene;
    scene.add(test::placed(test::makeOutline(test::Shape::Convex, random), 0.5, {}));
    const double angle = random.uniform(0, 7), spin = random.uniform(-2, 2);
    const Vec2 at(0.5, 0.5), velocity(random.uniform(-1, 1), random.uniform(-1, 1));
    auto cutAt = [&](double t) {
      const CutOutline moving{&scene.polygons[0], Transform::of(at + t * velocity, angle + t * spin), at, 0};
      CutCells cut;
      cut.setFixed(scene.grid, {}, scene.walls);
      cut.update(kRange, {&moving, 1});
      return cut;
    };
    const CutCells before = cutAt(-kTime), now = cutAt(0.0), after = cutAt(kTime);
    for (const CutCell& cell : now.cells()) {
      const std::int32_t b = before.find(cell.i, cell.j), a = after.find(cell.i, cell.j);
      if (cell.partCount != 1 || a < 0 || b < 0) continue;
      const CutCell &ca = after.cells()[static_cast<std::size_t>(a)], &cb = before.cells()[static_cast<std::size_t>(b)];
      if (ca.partCount != 1 || cb.partCount != 1) continue;
      double pushed = 0.0;
      bool own = false;
      for (const CutWall& wall : now.walls().subspan(now.parts()[cell.part].wall, now.parts()[cell.part].wallCount)) {
        if (wall.body != 0) continue;
        own = true;
        pushed += scene.grid.size * (velocity.dot(wall.normal) + spin * wall.moment);
      }
      if (!own) continue;
      const double lost = (before.parts()[cb.part].area - after.parts()[ca.part].area) / (2.0 * kTime) *
                          scene.grid.size * scene.grid.size;
      ASSERT_NEAR(pushed, lost, 2e-5) << cell.i << ' ' << cell.j;
      ++compared;
    }
  }
  EXPECT_GT(compared, 300u);
}

}  // namespace
}  // namespace froude
