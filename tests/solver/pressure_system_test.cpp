// The pressure solve against Eigen's direct factorisation, exact solutions, and itself on other threads and lanes.
#include <froude/solver/fluid/grid/pressure_system.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <string>

#include <froude/base/types.h>

#include "support/pressure_scene.h"

namespace froude {
namespace {

using test::PressureScene;
using test::Tank;
using test::WrittenOut;

struct Solution {
  PressureReport report;
  AlignedArray<float> kappa;
};

Solution solved(const TileGrid& grid, const PressureCoefficients& coefficients, const AlignedArray<float>& b,
                float tolerance, std::span<const PressureBody> bodies = {}, SimdTarget target = bestSimdTarget()) {
  PressureSystem system(target);
  system.prepare(grid, coefficients, bodies);
  Solution s;
  s.kappa.resize(coefficients.ground.size());
  s.report = system.solve(b.data(), s.kappa.data(), {tolerance, 200});
  return s;
}

Solution solved(const PressureScene& scene, float tolerance, SimdTarget target = bestSimdTarget()) {
  return solved(scene.grid, scene.coefficients, scene.b, tolerance, {}, target);
}

TEST(PressureSystem, agrees_with_a_direct_factorisation_in_tanks_with_surfaces_and_discs) {
  for (const Tank tank : {Tank::Surface, Tank::Splash, Tank::Discs}) {
    for (const int n : {37, 64, 100}) {
      const PressureScene scene(tank, n);
      const WrittenOut out(scene.grid, scene.coefficients);
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(out.matrix);
      const Eigen::VectorXd exact = direct.solve(out.gather(scene.b.data()));
      const Solution s = solved(scene, 1e-5f);
      EXPECT_TRUE(s.report.converged);
      EXPECT_FALSE(s.report.fallback);
      const Eigen::VectorXd kappa = out.gather(s.kappa.data());
      EXPECT_LT((kappa - exact).cwiseAbs().maxCoeff(), 2e-4 * exact.cwiseAbs().maxCoeff());
      // What it reports is what it left.
      const Eigen::VectorXd rest = out.gather(scene.b.data()) - out.matrix * kappa;
      EXPECT_LT(rest.cwiseAbs().maxCoeff(), 2e-5 + 2e-6 * exact.cwiseAbs().maxCoeff());
    }
  }
}

TEST(PressureSystem, gives_the_same_bits_on_any_number_of_threads) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 8);
  for (const Tank tank : {Tank::Full, Tank::Discs}) {
    const PressureScene scene(tank, 200);
    const Solution one = solved(scene, 1e-4f);
    for (const int threads : {1, 2, 3, 7}) {
      tbb::task_arena arena(threads);
      arena.execute([&] {
        const Solution s = solved(scene, 1e-4f);
        ASSERT_EQ(s.report.iterations, one.report.iterations);
        EXPECT_EQ(std::memcmp(s.kappa.data(), one.kappa.data(), s.kappa.size() * sizeof(float)), 0) << threads;
      });
    }
  }
}

TEST(PressureSystem, finds_the_same_on_every_set_of_instructions) {
  for (const Tank tank : {Tank::Surface, Tank::Discs}) {
    const PressureScene scene(tank, 75);
    const WrittenOut out(scene.grid, scene.coefficients);
    const Eigen::VectorXd plain = out.gather(solved(scene, 1e-5f, SimdTarget::Scalar).kappa.data());
    for (const SimdTarget target : supportedSimdTargets()) {
      const Eigen::VectorXd wide = out.gather(solved(scene, 1e-5f, target).kappa.data());
      EXPECT_LT((wide - plain).cwiseAbs().maxCoeff(), 2e-4 * plain.cwiseAbs().maxCoeff()) << name(target);
    }
  }
}

TEST(PressureSystem, a_closed_tank_has_mean_zero_and_says_what_it_could_not_take_in) {
  PressureScene scene(Tank::Full, 50);
  for (int k = 0; k < 2500; ++k) scene.b[scene.grid.place(k % 50, k / 50)] += 0.25f;
  const Solution s = solved(scene, 1e-4f);
  EXPECT_TRUE(s.report.converged);
  EXPECT_EQ(s.report.closedRegions, 1);
  const WrittenOut out(scene.grid, scene.coefficients);
  const Eigen::VectorXd b = out.gather(scene.b.data()), kappa = out.gather(s.kappa.data());
  EXPECT_NEAR(static_cast<double>(s.report.closedSource), b.mean(), 1e-5);
  EXPECT_NEAR(kappa.mean(), 0.0, 1e-5);
  EXPECT_LT((b.array() - b.mean() - (out.matrix * kappa).array()).abs().maxCoeff(), 1.2e-4);
}

TEST(PressureSystem, starts_from_what_it_is_given) {
  const PressureScene scene(Tank::Surface, 64);
  PressureSystem system;
  system.prepare(scene.grid, scene.coefficients);
  AlignedArray<float> kappa;
  scene.grid.clear(kappa);
  EXPECT_GT(system.solve(scene.b.data(), kappa.data(), {1e-3f, 60}).iterations, 3);
  EXPECT_EQ(system.solve(scene.b.data(), kappa.data(), {1e-3f, 60}).iterations, 0);
}

// Iterations from nothing to 1e-4: beyond, single precision ends in the largest tank.
int iterationsOf(Tank tank, int n) {
  const Solution s = solved(PressureScene(tank, n), 1e-4f);
  EXPECT_TRUE(s.report.converged && !s.report.fallback);
  return s.report.iterations;
}

TEST(LongPressureSystem, iterations_grow_by_less_than_a_half_from_64_to_1024_cells_a_side) {
  for (const Tank tank : {Tank::Full, Tank::Surface, Tank::Splash, Tank::Discs}) {
    const int few = iterationsOf(tank, 64), many = iterationsOf(tank, 1024);
    RecordProperty("tank" + std::to_string(static_cast<int>(tank)),
                   std::to_string(few) + " to " + std::to_string(many));
    EXPECT_LT(many, 1.5 * few) << static_cast<int>(tank);
    EXPECT_LE(many, 9);
  }
}

// A tank of n × n cells that a plate without thickness divides in the middle of the cells of one column: these have a
// left part, which stays in the grid, and a right part, an extra unknown each. Fluid up to `left` and `right` cells.
struct DividedTank {
  TileGrid grid;
  PressureCoefficients coefficients;
  AlignedArray<float> b;
  int n, column;

  DividedTank(int cells, int left, int right) : n(cells), column(cells / 2) {
    std::vector<TileIndex> tiles;
    for (int y = 0; y <= n / 16; ++y) {
      for (int x = 0; x <= n / 16; ++x) tiles.push_back({x, y});
    }
    grid.build(tiles);
    std::vector<GridCell> kind(grid.values(), GridCell::Air);
    AlignedArray<float> wx, wy;
    grid.clear(wx);
    grid.clear(wy);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const std::size_t k = grid.place(i, j);
        if (j < (i <= column ? left : right)) kind[k] = GridCell::Fluid;
        wx[k] = i == 0 || i == column + 1 ? 0.0f : 1.0f;
        wy[k] = j == 0 ? 0.0f : (i == column ? 0.5f : 1.0f);
      }
    }
    const auto extra = static_cast<std::size_t>(right);
    coefficients.fromWeights(grid, kind.data(), wx.data(), wy.data(), extra);
    b.resize(grid.values() + extra);
    for (std::size_t e = 0; e < extra; ++e) {
      const std::size_t own = grid.values() + e;
      coefficients.addEdge(own, grid.place(column + 1, static_cast<int>(e)), 1.0);
      if (e + 1 < extra) coefficients.addEdge(own, own + 1, 0.5);
    }
    if (extra > 0) coefficients.addGround(grid.values() + extra - 1, 0.5);
  }
};

TEST(PressureSystem, two_sides_of_a_plate_within_a_cell_keep_their_own_levels) {
  // At rest under gravity g the fluxes that a step of free fall would make are zero in every cell but the lowest, from
  // which g·dt²/h cells of height fall: κ is the height of the surface above the cell's centre, times that.
  DividedTank tank(40, 30, 12);
  const float fall = 0.05f;
  for (int i = 0; i < 40; ++i) tank.b[tank.grid.place(i, 0)] = i == tank.column ? 0.5f * fall : fall;
  tank.b[tank.grid.values()] = 0.5f * fall;
  const Solution s = solved(tank.grid, tank.coefficients, tank.b, 1e-6f);
  ASSERT_TRUE(s.report.converged);
  EXPECT_FALSE(s.report.fallback);
  EXPECT_LE(s.report.iterations, 20);
  for (int j = 0; j < 30; ++j) {
    for (const int i : {0, 11, tank.column}) EXPECT_NEAR(s.kappa[tank.grid.place(i, j)], fall * (30 - j), 1e-4) << j;
  }
  for (int j = 0; j < 12; ++j) {
    EXPECT_NEAR(s.kappa[tank.grid.place(tank.column + 1, j)], fall * (12 - j), 1e-4);
    EXPECT_NEAR(s.kappa[tank.grid.values() + static_cast<std::size_t>(j)], fall * (12 - j), 1e-4);
  }
}

TEST(PressureSystem, edges_between_any_unknowns_are_solved_as_a_direct_factorisation_does) {
  PressureScene scene(Tank::Surface, 48);
  const std::size_t base = scene.grid.values(), extra = 60;
  scene.coefficients.fromWeights(scene.grid, scene.kind.data(), scene.wx.data(), scene.wy.data(), extra);
  RandomStream random(5, 0);
  scene.b.resize(base + extra);
  for (std::size_t e = 0; e < extra; ++e) {
    scene.b[base + e] = static_cast<float>(random.uniform(-0.3, 0.3));
    const auto i = static_cast<int>(random.uniform(1, 47)), j = static_cast<int>(random.uniform(1, 15));
    if (e % 3 != 2) scene.coefficients.addEdge(base + e, scene.grid.place(i, j), random.uniform(0.05, 1.0));
    if (e % 3 == 2) scene.coefficients.addEdge(base + e, base + e - 1, random.uniform(1e-4, 1.0));
    if (e % 7 == 0) scene.coefficients.addEdge(base + e, scene.grid.place(i + 1, j), random.uniform(0.0, 1.0));
  }
  const WrittenOut out(scene.grid, scene.coefficients);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(out.matrix);
  const Eigen::VectorXd exact = direct.solve(out.gather(scene.b.data()));
  const Solution s = solved(scene, 1e-6f);
  EXPECT_TRUE(s.report.converged && !s.report.fallback);
  EXPECT_LT((out.gather(s.kappa.data()) - exact).cwiseAbs().maxCoeff(), 2e-4 * exact.cwiseAbs().maxCoeff());
}

TEST(PressureSystem, a_cell_that_hangs_on_an_edge_alone_is_an_unknown) {
  PressureScene scene(Tank::Surface, 20);
  const std::size_t alone = scene.grid.place(7, 19);  // far above the surface
  scene.coefficients.addEdge(alone, scene.grid.place(7, 3), 0.5);
  scene.b[alone] = 1.0f;
  const Solution s = solved(scene, 1e-6f);
  EXPECT_TRUE(s.report.converged && !s.report.fallback);
  EXPECT_NEAR(s.kappa[alone] - s.kappa[scene.grid.place(7, 3)], 2.0f, 1e-4f);
}

TEST(PressureSystem, every_closed_part_of_a_divided_tank_is_a_region_of_its_own) {
  PressureScene scene(Tank::Full, 33);
  for (int j = 0; j < 33; ++j) scene.wx[scene.grid.place(13, j)] = 0.0f;
  for (int i = 0; i < 13; ++i) scene.wy[scene.grid.place(i, 17)] = 0.0f;
  scene.coefficients.fromWeights(scene.grid, scene.kind.data(), scene.wx.data(), scene.wy.data());
  const Solution s = solved(scene, 1e-4f);
  EXPECT_TRUE(s.report.converged && !s.report.fallback);
  EXPECT_EQ(s.report.closedRegions, 3);
  double sums[3] = {0.0, 0.0, 0.0};
  for (int j = 0; j < 33; ++j) {
    for (int i = 0; i < 33; ++i)
      sums[i >= 13 ? 2 : (j >= 17 ? 1 : 0)] += static_cast<double>(s.kappa[scene.grid.place(i, j)]);
  }
  for (const double sum : sums) EXPECT_NEAR(sum, 0.0, 1e-3);
}

TEST(PressureSystem, a_periodic_plane_has_the_exact_solution_of_its_difference_equation) {
  for (const TilePeriod period : {TilePeriod{48, 32}, TilePeriod{37, 21}, TilePeriod{5, 3}}) {
    std::vector<TileIndex> tiles;
    for (int y = 0; y < (period.y + 15) / 16; ++y) {
      for (int x = 0; x < (period.x + 15) / 16; ++x) tiles.push_back({x, y});
    }
    TileGrid grid;
    grid.build(tiles, period);
    std::vector<GridCell> kind(grid.values(), GridCell::Air);
    AlignedArray<float> w, b;
    grid.clear(w);
    grid.clear(b);
    const auto phase = [&](int i, int j) {
      return 2.0 * kPi * (static_cast<double>(i) / period.x + static_cast<double>(j) / period.y);
    };
    const double eigenvalue = 4.0 - 2.0 * std::cos(2.0 * kPi / period.x) - 2.0 * std::cos(2.0 * kPi / period.y);
    for (int j = 0; j < period.y; ++j) {
      for (int i = 0; i < period.x; ++i) {
        kind[grid.place(i, j)] = GridCell::Fluid;
        w[grid.place(i, j)] = 1.0f;
        b[grid.place(i, j)] = static_cast<float>(eigenvalue * std::sin(phase(i, j)));
      }
    }
    PressureCoefficients coefficients;
    coefficients.fromWeights(grid, kind.data(), w.data(), w.data());
    const Solution s = solved(grid, coefficients, b, 1e-6f);
    EXPECT_TRUE(s.report.converged && !s.report.fallback);
    EXPECT_EQ(s.report.closedRegions, 1);
    for (int j = 0; j < period.y; ++j) {
      for (int i = 0; i < period.x; ++i) EXPECT_NEAR(s.kappa[grid.place(i, j)], std::sin(phase(i, j)), 2e-4);
    }
  }
}

TEST(PressureSystem, is_of_second_order_in_the_size_of_a_cell) {
  // −Δκ = 2π² sin(πx) cos(πy) on the unit square, κ = 0 on the left and right, closed below and above.
  double before = 0.0;
  for (const int n : {16, 32, 64}) {
    PressureScene scene(Tank::Full, n);
    for (int j = 0; j < n; ++j) {  // κ = 0 on the side itself: half a cell from the centre
      scene.coefficients.addGround(scene.grid.place(0, j), 2.0);
      scene.coefficients.addGround(scene.grid.place(n - 1, j), 2.0);
    }
    const auto exact = [&](int i, int j) { return std::sin(kPi * (i + 0.5) / n) * std::cos(kPi * (j + 0.5) / n); };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        scene.b[scene.grid.place(i, j)] = static_cast<float>(2.0 * kPi * kPi / (n * n) * exact(i, j));
    }
    const Solution s = solved(scene, 1e-7f);
    double error = 0.0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        error = std::max(error, std::abs(static_cast<double>(s.kappa[scene.grid.place(i, j)]) - exact(i, j)));
      }
    }
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.5);
    }
    before = error;
  }
}

TEST(PressureSystem, free_bodies_take_part_with_their_inertia) {
  for (const float mobility : {1e-3f, 1.0f, 1e3f}) {
    const PressureScene scene(Tank::Surface, 64);
    std::vector<PressureBody::Entry> entries[2];
    for (int body = 0; body < 2; ++body) {
      for (int k = 0; k < 24; ++k) {
        const double angle = 2.0 * kPi * k / 24.0;
        const auto i = static_cast<int>(20 + 24 * body + 6.0 * std::cos(angle)),
                   j = static_cast<int>(12 + 6.0 * std::sin(angle));
        const auto x = static_cast<float>(std::cos(angle)), y = static_cast<float>(std::sin(angle));
        entries[body].push_back({static_cast<std::uint32_t>(scene.grid.place(i, j)), {x, y, 0.1f * x * y}});
      }
    }
    const std::vector<PressureBody> bodies{{{mobility, mobility, mobility}, entries[0]},
                                           {{mobility, mobility, 0.0f}, entries[1]}};
    const WrittenOut out(scene.grid, scene.coefficients, bodies);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(out.matrix);
    const Eigen::VectorXd exact = direct.solve(out.gather(scene.b.data()));
    const Solution s = solved(scene.grid, scene.coefficients, scene.b, 1e-4f, bodies);
    EXPECT_TRUE(s.report.converged && !s.report.fallback) << mobility << ' ' << s.report.iterations;
    EXPECT_LE(s.report.iterations, 30) << mobility;
    EXPECT_LT((out.gather(s.kappa.data()) - exact).cwiseAbs().maxCoeff(), 2e-3 * exact.cwiseAbs().maxCoeff())
        << mobility;
  }
}

TEST(PressureSystem, what_does_not_converge_goes_to_the_fallback) {
  for (const Tank tank : {Tank::Full, Tank::Discs}) {
    const PressureScene scene(tank, 48);
    const WrittenOut out(scene.grid, scene.coefficients);
    PressureSystem system;
    system.prepare(scene.grid, scene.coefficients);
    AlignedArray<float> kappa;
    scene.grid.clear(kappa);
    const PressureReport report = system.solve(scene.b.data(), kappa.data(), {1e-4f, 1});
    EXPECT_TRUE(report.fallback && report.converged);
    const Eigen::VectorXd b = out.gather(scene.b.data());
    const double mean = tank == Tank::Full ? b.mean() : 0.0;
    EXPECT_LT((b.array() - mean - (out.matrix * out.gather(kappa.data())).array()).abs().maxCoeff(), 2e-4);
  }
}

TEST(PressureSystem, nothing_to_solve_is_solved) {
  TileGrid grid;
  grid.build({});
  PressureCoefficients coefficients;
  coefficients.fromWeights(grid, nullptr, nullptr, nullptr);
  AlignedArray<float> b;
  grid.clear(b);
  EXPECT_TRUE(solved(grid, coefficients, b, 1e-3f).report.converged);
  const TileIndex tile{3, -2};
  grid.build({&tile, 1});
  std::vector<GridCell> kind(grid.values(), GridCell::Air);
  AlignedArray<float> w;
  grid.clear(w);
  kind[grid.place(50, -30)] = GridCell::Fluid;  // one cell of fluid, its left face open
  w[grid.place(50, -30)] = 0.25f;
  grid.clear(b);
  b[grid.place(50, -30)] = 1.0f;
  AlignedArray<float> closed;
  grid.clear(closed);
  coefficients.fromWeights(grid, kind.data(), w.data(), closed.data());
  EXPECT_NEAR(solved(grid, coefficients, b, 1e-3f).kappa[grid.place(50, -30)], 4.0f, 1e-5f);
}

}  // namespace
}  // namespace froude
