#include <froude/particles/cell_grid.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <froude/base/random.h>
#include <froude/particles/neighbour_list.h>

namespace {

using namespace froude;

struct Points {
  std::vector<double> x, y;
};

Points randomPoints(std::size_t count, const Box& box, std::uint64_t seed) {
  RandomStream random(seed, 1);
  Points p;
  for (std::size_t i = 0; i < count; ++i) {
    p.x.push_back(random.uniform(box.min.x(), box.max.x()));
    p.y.push_back(random.uniform(box.min.y(), box.max.y()));
  }
  return p;
}

Points sorted(const Points& p, const CellGrid& grid) {
  Points s;
  for (const std::uint32_t i : grid.order()) {
    s.x.push_back(p.x[i]);
    s.y.push_back(p.y[i]);
  }
  return s;
}

// Oracle: a stable sort of the standard library by the cell of each particle.
void expectStableSort(const Points& p, const CellGrid& grid) {
  std::vector<std::uint32_t> expected(p.x.size());
  std::iota(expected.begin(), expected.end(), 0u);
  std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
    return grid.cellOf(p.x[a], p.y[a]) < grid.cellOf(p.x[b], p.y[b]);
  });
  EXPECT_EQ(std::vector<std::uint32_t>(grid.order().begin(), grid.order().end()), expected);
  EXPECT_EQ(grid.sorted(), std::is_sorted(expected.begin(), expected.end()));
  ASSERT_EQ(grid.cellStart().size(), grid.frame().cellCount() + 1);
  std::size_t start = 0;
  for (std::uint32_t c = 0; c < grid.frame().cellCount(); ++c) {
    ASSERT_EQ(grid.cellStart()[c], start) << c;
    while (start < expected.size() && grid.cellOf(p.x[expected[start]], p.y[expected[start]]) == c) ++start;
  }
  EXPECT_EQ(grid.cellStart().back(), p.x.size());
}

TEST(CellGrid, is_a_stable_sort_by_cell_on_any_number_of_threads) {
  const Box box{{-1.0, 2.0}, {3.0, 5.0}};
  for (const std::size_t count : {0u, 1u, 2u, 1000u, 20000u, 60000u}) {
    const Points p = randomPoints(count, box, count);
    for (const double cell : {0.05, 0.1, 10.0}) {
      for (const int threads : {1, 2, 3, 7}) {
        CellGrid grid;
        tbb::task_arena(threads).execute([&] { grid.build(p.x, p.y, GridFrame::cover(box, cell)); });
        expectStableSort(p, grid);
      }
    }
  }
}

TEST(CellGrid, knows_when_there_is_nothing_to_sort) {
  const Box box{{0.0, 0.0}, {1.0, 1.0}};
  for (const std::size_t count : {300u, 50000u}) {
    for (const int threads : {1, 3}) {
      tbb::task_arena(threads).execute([&] {
        const GridFrame frame = GridFrame::cover(box, 0.05);
        CellGrid grid;
        const Points p = randomPoints(count, box, 3);
        grid.build(p.x, p.y, frame);
        EXPECT_FALSE(grid.sorted());
        Points s = sorted(p, grid);
        grid.build(s.x, s.y, frame);
        EXPECT_TRUE(grid.sorted());
        expectStableSort(s, grid);
        std::swap(s.x.front(), s.x.back());
        std::swap(s.y.front(), s.y.back());
        grid.build(s.x, s.y, frame);
        EXPECT_FALSE(grid.sorted());
        expectStableSort(s, grid);
      });
    }
  }
}

TEST(CellGrid, particles_outside_the_frame_count_into_the_nearest_border_cell) {
  const GridFrame frame = GridFrame::cover({{0.0, 0.0}, {4.0, 3.0}}, 1.0);
  CellGrid grid;
  const std::vector<double> x{-5.0, 9.0, 1.5, 1.5, -1e300, 1e300, kInfinity, -kInfinity};
  const std::vector<double> y{1.5, 1.5, -7.0, 50.0, -1e300, 1e300, 0.5, 0.5};
  grid.build(x, y, frame);
  const std::vector<std::uint32_t> expected{4, 7, 1, 9, 0, 11, 3, 0};
  EXPECT_EQ(std::vector<std::uint32_t>(grid.cells().begin(), grid.cells().end()), expected);
}

TEST(CellGrid, a_position_that_is_no_number_goes_to_a_border_cell) {
  const GridFrame frame = GridFrame::cover({{0.0, 0.0}, {4.0, 3.0}}, 1.0);
  CellGrid grid;
  const std::vector<double> x{std::nan(""), 2.5}, y{2.5, std::nan("")};
  grid.build(x, y, frame);
  EXPECT_EQ(grid.cells()[0], 8u);
  EXPECT_EQ(grid.cells()[1], 2u);
}

TEST(GridFrame, covers_the_box_with_cells_of_at_least_the_size_asked_for) {
  RandomStream random(1, 8);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 corner{random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0)};
    const Vec2 extent{random.uniform(0.4, 5.0), random.uniform(0.4, 5.0)};
    const double cell = random.uniform(0.02, 0.13);
    const bool periodicX = random.below(2) == 0, periodicY = random.below(2) == 0;
    const GridFrame f = GridFrame::cover({corner, corner + extent}, cell, periodicX, periodicY);
    EXPECT_GE(f.cellExtent().x(), cell * (1.0 - 1e-9));
    EXPECT_GE(f.cellExtent().y(), cell * (1.0 - 1e-9));
    EXPECT_LT(f.cellExtent().x(), cell * 1.5);
    EXPECT_GE(f.nx * f.cellExtent().x(), extent.x() * (1.0 - 1e-12));
    EXPECT_GE(f.ny * f.cellExtent().y(), extent.y() * (1.0 - 1e-12));
    EXPECT_TRUE(!periodicX || f.nx * f.cellExtent().x() <= extent.x() * (1.0 + 1e-12));
  }
}

TEST(GridFrame, a_period_of_a_whole_number_of_cells_keeps_that_number) {
  for (int n = 3; n < 2000; ++n) {
    const GridFrame f = GridFrame::cover({{0.0, 0.0}, {n * 0.1, 1.0}}, 0.1, true, false);
    EXPECT_EQ(f.nx, n);
  }
}

TEST(GridFrame, what_cannot_be_covered_is_refused_in_words) {
  const Box box{{0.0, 0.0}, {1.0, 1.0}};
  const auto message = [](const Box& b, double cell, bool periodic) -> std::string {
    try {
      GridFrame::cover(b, cell, periodic, false);
    } catch (const Error& e) {
      return e.what();
    }
    return "nothing was thrown";
  };
  EXPECT_NE(message(Box{}, 0.1, false).find("empty"), std::string::npos);
  EXPECT_NE(message({{0.0, 0.0}, {kInfinity, 1.0}}, 0.1, false).find("finite"), std::string::npos);
  for (const double bad : {0.0, -1.0, std::nan(""), kInfinity}) {
    EXPECT_NE(message(box, bad, false).find("positive"), std::string::npos) << bad;
  }
  EXPECT_NE(message(box, 0.4, true).find("3 cells"), std::string::npos);
  EXPECT_NE(message({{0.0, 0.0}, {1e6, 1e6}}, 0.01, false).find("2^30"), std::string::npos);
}

TEST(GridFrame, the_minimum_image_is_the_shortest_of_all_images) {
  const GridFrame f = GridFrame::cover({{0.0, 0.0}, {3.0, 5.0}}, 0.5, true, true);
  RandomStream random(1, 4);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 d{random.uniform(-3.0, 3.0), random.uniform(-5.0, 5.0)};
    double shortest = 1e9;
    for (int a = -2; a <= 2; ++a) {
      for (int b = -2; b <= 2; ++b) shortest = std::min(shortest, (d + Vec2(3.0 * a, 5.0 * b)).norm());
    }
    EXPECT_NEAR(f.minimumImage(d).norm(), shortest, 1e-14);
  }
}

// Oracle for runs and lists: all pairs and all images.
std::vector<std::set<std::uint32_t>> bruteForce(const Points& p, const GridFrame& f, double radius) {
  std::vector<std::set<std::uint32_t>> near(p.x.size());
  const Vec2 period = f.periodLength();
  for (std::uint32_t i = 0; i < p.x.size(); ++i) {
    for (std::uint32_t j = 0; j < p.x.size(); ++j) {
      for (int a = f.periodicX ? -1 : 0; a <= (f.periodicX ? 1 : 0); ++a) {
        for (int b = f.periodicY ? -1 : 0; b <= (f.periodicY ? 1 : 0); ++b) {
          const double dx = p.x[j] + a * period.x() - p.x[i], dy = p.y[j] + b * period.y() - p.y[i];
          if (i != j && dx * dx + dy * dy < radius * radius) near[i].insert(j);
        }
      }
    }
  }
  return near;
}

struct Case {
  bool periodicX, periodicY;
  Vec2 extent;
};

const std::vector<Case> kCases{{false, false, {1.0, 1.0}}, {true, false, {1.0, 0.8}},  {false, true, {0.8, 1.0}},
                               {true, true, {1.0, 0.7}},   {true, true, {0.301, 0.3}}, {false, false, {0.05, 2.0}},
                               {true, false, {0.35, 0.05}}};

TEST(CellGrid, runs_hold_every_particle_within_one_cell_and_shifts_bring_it_there) {
  constexpr double kRadius = 0.1;
  for (const Case& c : kCases) {
    const Box box{{-0.2, 0.1}, Vec2(-0.2, 0.1) + c.extent};
    const GridFrame frame = GridFrame::cover(box, kRadius, c.periodicX, c.periodicY);
    const Points input = randomPoints(400, box, 11);
    CellGrid grid;
    grid.build(input.x, input.y, frame);
    const Points p = sorted(input, grid);
    const auto expected = bruteForce(p, frame, kRadius);
    for (std::uint32_t i = 0; i < p.x.size(); ++i) {
      std::set<std::uint32_t> found;
      std::size_t hits = 0;
      int runs = 0;
      grid.forEachRun(grid.cellOf(p.x[i], p.y[i]), [&](const CellRun& run) {
        ++runs;
        for (std::uint32_t j = run.begin; j < run.end; ++j) {
          const double dx = p.x[j] + run.shiftX - p.x[i], dy = p.y[j] + run.shiftY - p.y[i];
          if (j == i || dx * dx + dy * dy >= kRadius * kRadius) continue;
          found.insert(j);
          ++hits;
        }
      });
      ASSERT_EQ(found, expected[i]) << i;
      ASSERT_EQ(hits, found.size()) << "a neighbour came twice";
      EXPECT_TRUE(c.periodicX || runs <= 3);
    }
  }
}

TEST(NeighbourList, agrees_with_brute_force_on_any_number_of_threads) {
  constexpr double kRadius = 0.1;
  for (const Case& c : kCases) {
    for (const double skin : {0.0, 0.03}) {
      const Box box{{-0.2, 0.1}, Vec2(-0.2, 0.1) + c.extent};
      if (c.periodicX && c.extent.x() < 3.0 * (kRadius + skin)) continue;
      const GridFrame frame = GridFrame::cover(box, kRadius + skin, c.periodicX, c.periodicY);
      const Points input = randomPoints(1100, box, 12);
      CellGrid grid;
      grid.build(input.x, input.y, frame);
      const Points p = sorted(input, grid);
      const auto expected = bruteForce(p, frame, kRadius + skin);
      NeighbourList list;
      for (const int threads : {7, 1, 2, 3}) {
        NeighbourList own;
        tbb::task_arena(threads).execute([&] { own.build(grid, p.x, p.y, kRadius, skin); });
        std::size_t entries = 0;
        for (std::uint32_t i = 0; i < p.x.size(); ++i) {
          const auto of = own.of(i);
          ASSERT_EQ(std::set<std::uint32_t>(of.begin(), of.end()), expected[i]) << i;
          ASSERT_EQ(of.size(), expected[i].size());
          ASSERT_TRUE(list.size() == 0 || std::equal(of.begin(), of.end(), list.of(i).begin(), list.of(i).end()));
          entries += of.size();
        }
        EXPECT_EQ(own.entryCount(), entries);
        if (list.size() == 0) list.build(grid, p.x, p.y, kRadius, skin);
      }
    }
  }
}

// The columns of the test are vectors without padding: a sanitizer sees what is read beyond them.
TEST(NeighbourList, is_the_same_for_every_target) {
  for (const Case& c : kCases) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{1100}, std::size_t{9000}}) {
      const Box box{{-0.2, 0.1}, Vec2(-0.2, 0.1) + c.extent};
      if (c.periodicX && c.extent.x() < 0.3) continue;
      const GridFrame frame = GridFrame::cover(box, 0.1, c.periodicX, c.periodicY);
      const Points input = randomPoints(count, box, 12);
      CellGrid grid;
      grid.build(input.x, input.y, frame);
      const Points p = sorted(input, grid);
      NeighbourList expected;
      expected.build(grid, p.x, p.y, 0.1, 0.0, SimdTarget::Scalar);
      for (const SimdTarget target : supportedSimdTargets()) {
        NeighbourList list;
        list.build(grid, p.x, p.y, 0.1, 0.0, target);
        for (std::size_t i = 0; i < count; ++i) {
          ASSERT_TRUE(std::ranges::equal(list.of(i), expected.of(i))) << name(target) << ", particle " << i;
        }
      }
    }
  }
}

TEST(NeighbourList, particles_beyond_the_frame_still_find_each_other) {
  const Box box{{0.0, 0.0}, {1.0, 1.0}};
  const GridFrame frame = GridFrame::cover(box, 0.1);
  const Points input = randomPoints(600, {{-0.5, -0.3}, {1.4, 1.2}}, 5);
  CellGrid grid;
  grid.build(input.x, input.y, frame);
  const Points p = sorted(input, grid);
  const auto expected = bruteForce(p, frame, 0.1);
  NeighbourList list;
  list.build(grid, p.x, p.y, 0.1);
  for (std::uint32_t i = 0; i < p.x.size(); ++i) {
    ASSERT_EQ(std::set<std::uint32_t>(list.of(i).begin(), list.of(i).end()), expected[i]);
  }
}

TEST(NeighbourList, a_skin_holds_until_a_particle_has_moved_by_half_of_it) {
  const Box box{{0.0, 0.0}, {1.0, 1.0}};
  const GridFrame frame = GridFrame::cover(box, 0.12, true, false);
  const Points input = randomPoints(3000, box, 6);
  CellGrid grid;
  grid.build(input.x, input.y, frame);
  Points p = sorted(input, grid);
  NeighbourList list;
  list.build(grid, p.x, p.y, 0.1, 0.02);
  EXPECT_TRUE(list.stillHolds(p.x, p.y));
  p.x[1234] = std::fmod(p.x[1234] + 0.0099 + 1.0, 1.0);
  EXPECT_TRUE(list.stillHolds(p.x, p.y)) << "a step across the seam is short";
  p.y[17] += 0.0101;
  EXPECT_FALSE(list.stillHolds(p.x, p.y));
  p.y[17] = std::nan("");
  EXPECT_FALSE(list.stillHolds(p.x, p.y));
  list.build(grid, p.x, p.y, 0.1);
  EXPECT_FALSE(list.stillHolds(p.x, p.y)) << "without a skin nothing may move";
}

TEST(NeighbourList, is_empty_for_no_particles_and_for_one) {
  const GridFrame frame = GridFrame::cover({{0.0, 0.0}, {1.0, 1.0}}, 0.1);
  CellGrid grid;
  NeighbourList list;
  grid.build({}, {}, frame);
  list.build(grid, {}, {}, 0.1);
  EXPECT_EQ(list.size() + list.entryCount(), 0u);
  const std::vector<double> one{0.5};
  grid.build(one, one, frame);
  list.build(grid, one, one, 0.1);
  EXPECT_EQ(list.of(0).size(), 0u);
}

TEST(NeighbourList, coinciding_particles_are_neighbours) {
  const GridFrame frame = GridFrame::cover({{0.0, 0.0}, {1.0, 1.0}}, 0.1);
  const std::vector<double> x(500, 0.5);
  CellGrid grid;
  grid.build(x, x, frame);
  NeighbourList list;
  list.build(grid, x, x, 0.1);
  for (std::size_t i = 0; i < x.size(); ++i) ASSERT_EQ(list.of(i).size(), 499u);
}

}  // namespace
