// Cut cells step by step: moving outlines over fixed ones, periodic sides, threads, ranges.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <froude/base/random.h>
#include <froude/fields/cut_cells.h>

#include "support/polygon_generator.h"

namespace froude {
namespace {

constexpr std::array<std::int32_t, 4> kRange{-2, -2, 30, 30};
const CutGrid kGrid{{0.0, 0.0}, 1.0 / 24.0, 0, 0};
const CutWalls kTank{{{0.0, 0.0}, {1.0, 1.0}}, {true, true, true, true}};

std::vector<Polygon> randomPolygons(RandomStream& random, std::size_t count) {
  std::vector<Polygon> all;
  for (std::size_t k = 0; k < count; ++k) {
    const auto shape = static_cast<test::Shape>(random.below(test::kShapeCount));
    all.push_back(test::placed(test::makeOutline(shape, random), 0.5, {}));
  }
  return all;
}

std::vector<CutOutline> placedAt(const std::vector<Polygon>& polygons, double time) {
  std::vector<CutOutline> all;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const double k = static_cast<double>(p);
    const Vec2 at(0.5 + 0.3 * std::cos(1.7 * k + time), 0.5 + 0.3 * std::sin(2.3 * k - 0.7 * time));
    all.push_back({&polygons[p], Transform::of(at, k + time), at, static_cast<std::int32_t>(p)});
  }
  return all;
}

/// In the cells 0 … n − 1 of both axes: the same parts, walls and joints, within `tolerance`.
void expectSame(const CutCells& a, const CutCells& b, std::int32_t n, double tolerance) {
  for (std::int32_t j = 0; j < n; ++j) {
    for (std::int32_t i = 0; i < n; ++i) {
      const std::int32_t ca = a.find(i, j), cb = b.find(i, j);
      // What is listed as wholly solid, or as open as can be, may be left out in the other.
      auto areaOf = [&](const CutCells& cut, std::int32_t c) {
        if (c < 0) return cut.solid(i, j) ? 0.0 : 1.0;
        double sum = 0.0;
        const CutCell& cell = cut.cells()[static_cast<std::size_t>(c)];
        for (const CutPart& part : cut.parts().subspan(cell.part, cell.partCount)) sum += part.area;
        return sum;
      };
      ASSERT_NEAR(areaOf(a, ca), areaOf(b, cb), tolerance) << i << ' ' << j;
      if (ca < 0 || cb < 0) continue;
      const CutCell &p = a.cells()[static_cast<std::size_t>(ca)], &q = b.cells()[static_cast<std::size_t>(cb)];
      ASSERT_EQ(p.partCount, q.partCount) << i << ' ' << j;
      for (std::size_t side = 0; side < 4; ++side) ASSERT_NEAR(p.open[side], q.open[side], tolerance);
      for (std::uint32_t k = 0; k < p.partCount; ++k) {
        const CutPart &x = a.parts()[p.part + k], &y = b.parts()[q.part + k];
        ASSERT_NEAR(x.area, y.area, tolerance);
        ASSERT_EQ(x.jointCount, y.jointCount);
        ASSERT_EQ(x.wallCount, y.wallCount);
        for (std::uint32_t w = 0; w < x.wallCount; ++w) {
          const CutWall &v = a.walls()[x.wall + w], &u = b.walls()[y.wall + w];
          ASSERT_EQ(v.body, u.body);
          ASSERT_LE((v.normal - u.normal).norm(), tolerance);
          ASSERT_NEAR(v.moment, u.moment, tolerance);
          ASSERT_NEAR(v.length, u.length, tolerance);
        }
      }
    }
  }
}

TEST(CutCellsInMotion, are_those_of_the_same_outlines_at_rest) {
  RandomStream random(21, 3);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    const std::vector<Polygon> polygons = randomPolygons(random, 5);
    CutCells moving;
    const std::vector<CutOutline> start = placedAt(polygons, 0.0);
    moving.setFixed(kGrid, std::span(start).first(2), kTank);
    for (const double time : {0.0, 0.1, 0.5, 2.0}) {
      std::vector<CutOutline> outlines = placedAt(polygons, time);
      std::copy_n(start.begin(), 2, outlines.begin());
      moving.update(kRange, std::span(outlines).subspan(2));
      CutCells fixed;
      fixed.setFixed(kGrid, outlines, kTank);
      fixed.update(kRange, {});
      expectSame(moving, fixed, 24, 1e-9);
      if (HasFatalFailure()) return;
    }
    moving.update(kRange, {});
    CutCells alone;
    alone.setFixed(kGrid, std::span(start).first(2), kTank);
    alone.update(kRange, {});
    expectSame(moving, alone, 24, 0.0);
  }
}

TEST(CutCellsInMotion, a_moving_body_swallows_the_cells_of_a_fixed_one) {
  const Polygon small = Polygon::regular(7, 0.1), large = Polygon::regular(5, 0.4);
  const CutOutline fixed{&small, Transform::of({0.5, 0.5}, 0.3), {0.5, 0.5}, 0};
  const CutOutline moving{&large, Transform::of({0.51, 0.48}, 1.0), {0.51, 0.48}, 1};
  CutCells cut;
  cut.setFixed(kGrid, {&fixed, 1}, kTank);
  cut.update(kRange, {&moving, 1});
  std::size_t swallowed = 0;
  for (const CutCell& cell : cut.cells()) {
    if (std::abs(cell.i - 12) > 3 || std::abs(cell.j - 12) > 3) continue;
    EXPECT_EQ(cell.partCount, 0u);
    ++swallowed;
  }
  EXPECT_GT(swallowed, 12u);
  for (const CutWall& wall : cut.walls()) EXPECT_NE(wall.body, 0);
  EXPECT_TRUE(cut.solid(12, 12));
  EXPECT_FALSE(cut.solid(1, 1));
}

TEST(CutCellsInMotion, across_periodic_sides_are_those_of_copies_on_both_sides) {
  RandomStream random(22, 3);
  for (const auto& [x, y] : {std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
    for (int round = 0; round < 10; ++round) {
      SCOPED_TRACE(round);
      const std::vector<Polygon> polygons = randomPolygons(random, 2);
      CutGrid periodic = kGrid;
      periodic.periodX = x ? 24 : 0;
      periodic.periodY = y ? 24 : 0;
      CutWalls walls = kTank;
      walls.closed = {!x, !x, !y, !y};
      const Vec2 at[2] = {{0.03, 0.96}, {0.99, 0.4}};
      const double farAway = 3.0 * round - 9.0;  // whole periods
      std::vector<CutOutline> once, copies;
      for (std::size_t p = 0; p < 2; ++p) {
        const Vec2 away = at[p] + Vec2(x ? farAway : 0.0, y ? -farAway : 0.0);
        once.push_back({&polygons[p], Transform::of(away, 0.4 * round), away, static_cast<std::int32_t>(p)});
        for (int dx = x ? -1 : 0; dx <= (x ? 1 : 0); ++dx) {
          for (int dy = y ? -1 : 0; dy <= (y ? 1 : 0); ++dy) {
            const Vec2 copy = at[p] + Vec2(dx, dy);
            copies.push_back({&polygons[p], Transform::of(copy, 0.4 * round), copy, static_cast<std::int32_t>(p)});
          }
        }
      }
      CutCells wrapped, plain;
      wrapped.setFixed(periodic, {}, walls);
      wrapped.update(kRange, once);
      plain.setFixed(kGrid, copies, walls);
      plain.update(kRange, {});
      expectSame(wrapped, plain, 24, 1e-9);
      for (const CutCell& cell : wrapped.cells()) {
        EXPECT_TRUE(!x || (cell.i >= 0 && cell.i < 24));
        EXPECT_TRUE(!y || (cell.j >= 0 && cell.j < 24));
      }
      if (HasFailure()) return;
    }
  }
}

/// Every number of every list.
std::vector<double> listed(const CutCells& cut) {
  std::vector<double> all;
  for (const CutCell& c : cut.cells()) {
    all.insert(all.end(), {double(c.i), double(c.j), double(c.part), double(c.partCount)});
    all.insert(all.end(), c.open.begin(), c.open.end());
  }
  for (const CutPart& p : cut.parts()) all.insert(all.end(), {p.area, double(p.joint), double(p.wall)});
  for (const CutJoint& j : cut.joints()) all.insert(all.end(), {double(j.part), j.length, double(j.side)});
  for (const CutWall& w : cut.walls()) {
    all.insert(all.end(), {double(w.body), w.normal.x(), w.normal.y(), w.moment, w.length});
  }
  for (const CutEdge& e : cut.edges()) all.insert(all.end(), {double(e.a), double(e.b), e.length, double(e.vertical)});
  return all;
}

TEST(CutCellsInMotion, are_the_same_bits_on_any_number_of_threads_and_after_other_steps) {
  RandomStream random(23, 3);
  const std::vector<Polygon> polygons = randomPolygons(random, 8);
  const std::vector<CutOutline> start = placedAt(polygons, 0.0);
  std::vector<double> first;
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena(threads).execute([&] {
      for (const bool straight : {true, false}) {
        CutCells cut;
        cut.setFixed(kGrid, std::span(start).first(3), kTank);
        cut.update(kRange, {});
        for (const double time : {0.3, 0.7, 1.0}) {
          if (straight && time < 1.0) continue;
          const std::vector<CutOutline> now = placedAt(polygons, time);
          cut.update(kRange, std::span(now).subspan(3));
        }
        const std::vector<double> found = listed(cut);
        ASSERT_GT(found.size(), 5000u);
        if (first.empty()) first = found;
        EXPECT_EQ(found, first);
      }
    });
  }
}

TEST(CutCellsInMotion, walls_of_a_hall_are_listed_where_they_are_asked_for) {
  const CutWalls hall{{{0.0, 0.0}, {1000.0, 500.0}}, {true, true, true, true}};
  CutCells cut;
  cut.setFixed({{0.0, 0.0}, 0.01, 0, 0}, {}, hall);
  cut.update({-2, -2, 100, 60}, {});
  EXPECT_LT(cut.cells().size(), 2u * (102u + 62u));
  ASSERT_GE(cut.find(99, 0), 0);
  EXPECT_EQ(cut.cells()[static_cast<std::size_t>(cut.find(99, 0))].open, (std::array{1.0, 1.0, 0.0, 1.0}));
  EXPECT_TRUE(cut.solid(50, -1));
  EXPECT_TRUE(cut.solid(100000, 10));
  EXPECT_FALSE(cut.solid(99999, 10));
  const std::uint64_t version = cut.version();
  cut.update({0, 0, 90, 50}, {});
  EXPECT_EQ(cut.version(), version);
  cut.update({0, 0, 1000, 50}, {});
  EXPECT_GT(cut.version(), version);
  ASSERT_GE(cut.find(999, 0), 0);
  CutCells corner;
  corner.setFixed({{0.0, 0.0}, 0.01, 0, 0}, {}, hall);
  corner.update({99900, 0, 100002, 50}, {});
  ASSERT_GE(corner.find(99999, 0), 0);
  EXPECT_EQ(corner.cells()[static_cast<std::size_t>(corner.find(99999, 0))].open, (std::array{1.0, 0.0, 0.0, 1.0}));
}

TEST(CutCellsInMotion, without_outlines_and_walls_there_are_none) {
  CutCells cut;
  cut.setFixed(kGrid, {}, {});
  cut.update(kRange, {});
  EXPECT_TRUE(cut.cells().empty());
  EXPECT_EQ(cut.find(3, 4), -1);
  EXPECT_FALSE(cut.solid(3, 4));
  EXPECT_EQ(cut.tileBegin(0, 0), 0u);
}

}  // namespace
}  // namespace froude
