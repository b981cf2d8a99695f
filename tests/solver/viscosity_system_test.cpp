// Viscosity on the grid against a matrix written out from the sums it minimises, and exact flows.
#include <froude/solver/fluid/grid/viscosity_system.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <Eigen/SparseCholesky>
#include <cstring>
#include <vector>

#include <froude/base/random.h>

namespace froude {
namespace {

// A box of `wide` × `high` cells; fluid where `wet` says so, closed all round, or periodic.
struct Box2 {
  TileGrid grid;
  std::vector<GridCell> kind;
  AlignedArray<float> area, openX, openY, u, v;
  ViscosityCoefficients coefficients;
  int wide, high;

  template <typename Wet>
  Box2(int w, int h, TilePeriod period, Wet&& wet) : wide(w), high(h) {
    const int extraX = period.x > 0 ? 0 : 1, extraY = period.y > 0 ? 0 : 1;
    std::vector<TileIndex> tiles;
    for (int y = 0; y < (h + extraY + 15) / 16; ++y) {
      for (int x = 0; x < (w + extraX + 15) / 16; ++x) tiles.push_back({x, y});
    }
    grid.build(tiles, period);
    kind.assign(grid.values(), GridCell::Air);
    for (AlignedArray<float>* a : {&area, &openX, &openY, &u, &v}) grid.clear(*a);
    for (int j = 0; j < h; ++j) {
      for (int i = 0; i < w; ++i) {
        const std::size_t k = grid.place(i, j);
        kind[k] = wet(i, j) ? GridCell::Fluid : GridCell::Air;
        area[k] = 1.0f;
        openX[k] = i > 0 || period.x > 0 ? 1.0f : 0.0f;
        openY[k] = j > 0 || period.y > 0 ? 1.0f : 0.0f;
      }
    }
    refresh();
  }
  void refresh() { coefficients.fromCells(grid, kind.data(), area.data(), openX.data(), openY.data()); }
  // Both walls across y, at rest and at `speed`.
  void addFloorAndLid(double speed) {
    for (int i = 0; i < wide; ++i) {
      coefficients.addWall(grid, {grid.place(i, 0), 1.0, {0.0, 1.0}, {0.5, 0.0}, {0.0, 0.0}});
      coefficients.addWall(grid, {grid.place(i, high - 1), 1.0, {0.0, -1.0}, {0.5, 1.0}, {speed, 0.0}});
    }
  }
};

const auto everywhere = [](int, int) { return true; };

TEST(ViscositySystem, agrees_with_a_direct_factorisation_of_the_sums_written_out) {
  RandomStream random(3, 0);
  Box2 box(37, 23, {}, [](int i, int j) { return j < 14 + i / 6 && (i + 3 * j) % 29 != 0; });
  for (float& a : box.area) a *= static_cast<float>(random.uniform(0.05, 1.0));
  for (AlignedArray<float>* open : {&box.openX, &box.openY}) {
    for (float& o : *open) o = random.uniform(0.0, 1.0) < 0.03 ? 0.0f : o;
  }
  box.refresh();
  for (int k = 0; k < 40; ++k) {
    const double angle = random.uniform(0.0, 6.28);
    box.coefficients.addWall(
        box.grid, {box.grid.place(static_cast<int>(random.uniform(0, 36)), static_cast<int>(random.uniform(0, 13))),
                   random.uniform(0.1, 1.2),
                   {std::cos(angle), std::sin(angle)},
                   {random.uniform(0, 1), random.uniform(0, 1)},
                   {0.7, -0.4}});
  }
  const ViscosityCoefficients& c = box.coefficients;
  for (std::size_t at = TileGrid::kCells; at < box.grid.values(); ++at) {
    box.u[at] = static_cast<float>(random.uniform(-1.0, 1.0));
    box.v[at] = static_cast<float>(random.uniform(-1.0, 1.0));
  }
  // The sums as rows of differences: √weight·(Σ coefficient·velocity), velocities u then v, all places.
  const double k = 3.0;
  const auto n = static_cast<int>(box.grid.values());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n), start(2 * n);
  for (int at = 0; at < n; ++at) {
    start[at] = static_cast<double>(box.u[static_cast<std::size_t>(at)]);
    start[n + at] = static_cast<double>(box.v[static_cast<std::size_t>(at)]);
  }
  using Term = std::vector<std::pair<int, double>>;
  const auto square = [&](double weight, const Term& term) {
    for (const auto& [a, x] : term) {
      for (const auto& [b, y] : term) entries.emplace_back(a, b, weight * x * y);
    }
  };
  for (std::size_t at = TileGrid::kCells; at < box.grid.values(); ++at) {
    const auto [i, j] = box.grid.cell(at);
    const auto u = [&](int x, int y) { return static_cast<int>(box.grid.place(x, y)); };
    const auto v = [&](int x, int y) { return n + static_cast<int>(box.grid.place(x, y)); };
    if (c.cell[at] > 0.0f) {
      square(2.0 * k * static_cast<double>(c.cell[at]), {{u(i + 1, j), 1.0}, {u(i, j), -1.0}});
      square(2.0 * k * static_cast<double>(c.cell[at]), {{v(i, j + 1), 1.0}, {v(i, j), -1.0}});
    }
    if (c.node[at] > 0.0f) {
      square(k * static_cast<double>(c.node[at]),
             {{u(i, j), 1.0}, {u(i, j - 1), -1.0}, {v(i, j), 1.0}, {v(i - 1, j), -1.0}});
    }
    const auto place = static_cast<int>(at);
    square(static_cast<double>(c.massX[at]) + k * static_cast<double>(c.groundX[at]), {{place, 1.0}});
    square(static_cast<double>(c.massY[at]) + k * static_cast<double>(c.groundY[at]), {{n + place, 1.0}});
    right[place] = static_cast<double>(c.massX[at]) * start[place] + k * static_cast<double>(c.wallX[at]);
    right[n + place] = static_cast<double>(c.massY[at]) * start[n + place] + k * static_cast<double>(c.wallY[at]);
  }
  Eigen::SparseMatrix<double> all(2 * n, 2 * n);
  all.setFromTriplets(entries.begin(), entries.end());
  // Faces without mass keep their velocity.
  std::vector<int> number(static_cast<std::size_t>(2 * n), -1), unknowns;
  for (int f = 0; f < 2 * n; ++f) {
    const float mass = f < n ? c.massX[static_cast<std::size_t>(f)] : c.massY[static_cast<std::size_t>(f - n)];
    if (mass <= 0.0f) continue;
    number[static_cast<std::size_t>(f)] = static_cast<int>(unknowns.size());
    unknowns.push_back(f);
  }
  std::vector<Eigen::Triplet<double>> kept;
  Eigen::VectorXd b(static_cast<int>(unknowns.size()));
  for (std::size_t x = 0; x < unknowns.size(); ++x) b[static_cast<int>(x)] = right[unknowns[x]];
  for (int f = 0; f < 2 * n; ++f) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(all, f); it; ++it) {
      const int row = number[static_cast<std::size_t>(it.row())], column = number[static_cast<std::size_t>(f)];
      if (row < 0) continue;
      if (column < 0) {
        b[row] -= it.value() * start[f];
      } else {
        kept.emplace_back(row, column, it.value());
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(b.size(), b.size());
  matrix.setFromTriplets(kept.begin(), kept.end());
  const Eigen::VectorXd exact = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(b);
  ViscositySystem system;
  EXPECT_TRUE(system.solve(box.grid, c, k, box.u.data(), box.v.data(), 1e-6f).converged);
  for (int f = 0; f < 2 * n; ++f) {
    const double value =
        static_cast<double>(f < n ? box.u[static_cast<std::size_t>(f)] : box.v[static_cast<std::size_t>(f - n)]);
    const int x = number[static_cast<std::size_t>(f)];
    EXPECT_NEAR(value, x < 0 ? start[f] : exact[x], x < 0 ? 0.0 : 1e-4);
  }
}

TEST(ViscositySystem, a_drop_that_flies_and_turns_as_a_whole_feels_no_viscosity) {
  Box2 drop(48, 48, {}, [](int i, int j) { return std::hypot(i - 23.5, j - 23.5) < 14.0; });
  for (int j = 0; j < 48; ++j) {
    for (int i = 0; i < 48; ++i) {
      const std::size_t k = drop.grid.place(i, j);
      drop.u[k] = static_cast<float>(0.5 - 0.1 * (j + 0.5 - 24.0));
      drop.v[k] = static_cast<float>(-0.3 + 0.1 * (i + 0.5 - 24.0));
    }
  }
  const AlignedArray<float> u = drop.u, v = drop.v;
  ViscositySystem system;
  const ViscosityReport report = system.solve(drop.grid, drop.coefficients, 100.0, drop.u.data(), drop.v.data(), 1e-3f);
  EXPECT_EQ(report.iterations, 0) << report.residual;
  EXPECT_EQ(std::memcmp(u.data(), drop.u.data(), u.size() * sizeof(float)), 0);
  EXPECT_EQ(std::memcmp(v.data(), drop.v.data(), v.size() * sizeof(float)), 0);
}

TEST(ViscositySystem, couette_flow_is_exact_and_sheared_flow_decays_at_its_rate) {
  Box2 channel(19, 24, {19, 0}, everywhere);
  channel.addFloorAndLid(2.0);
  ViscositySystem system;
  EXPECT_TRUE(
      system.solve(channel.grid, channel.coefficients, 1e5, channel.u.data(), channel.v.data(), 1e-4f, 2000).converged);
  for (int j = 0; j < 24; ++j) EXPECT_NEAR(channel.u[channel.grid.place(3, j)], 2.0 * (j + 0.5) / 24.0, 2e-3) << j;
  // With slip, cos(πy/L) is an eigenvector: one step multiplies it by 1/(1 + k·(2 − 2 cos(π/n))).
  Box2 slip(19, 24, {19, 0}, everywhere);
  for (int j = 0; j < 24; ++j) {
    for (int i = 0; i < 19; ++i) slip.u[slip.grid.place(i, j)] = static_cast<float>(std::cos(kPi * (j + 0.5) / 24.0));
  }
  const double k = 7.0, factor = 1.0 / (1.0 + k * (2.0 - 2.0 * std::cos(kPi / 24.0)));
  system.solve(slip.grid, slip.coefficients, k, slip.u.data(), slip.v.data(), 1e-6f);
  for (int j = 0; j < 24; ++j) {
    EXPECT_NEAR(slip.u[slip.grid.place(18, j)], factor * std::cos(kPi * (j + 0.5) / 24.0), 1e-5);
    EXPECT_NEAR(slip.v[slip.grid.place(18, j)], 0.0, 1e-6);
  }
}

TEST(ViscositySystem, poiseuille_flow_between_sticking_walls_is_of_second_order) {
  double before = 0.0;
  for (const int n : {8, 16, 32}) {
    Box2 channel(5, n, {5, 0}, everywhere);
    channel.addFloorAndLid(0.0);
    // A force f for a long time: u → f y(1 − y)/(2ν). Steps of k = 4000 cells² leave nothing of what was.
    const double k = 4000.0, kick = 8.0 * k / (n * n);  // of a flow whose greatest speed is 1
    ViscositySystem system;
    for (int step = 0; step < 3; ++step) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < 5; ++i) channel.u[channel.grid.place(i, j)] += static_cast<float>(kick);
      }
      EXPECT_TRUE(system.solve(channel.grid, channel.coefficients, k, channel.u.data(), channel.v.data(), 1e-4f, 2000)
                      .converged);
    }
    double error = 0.0;
    for (int j = 0; j < n; ++j) {
      const double y = (j + 0.5) / n;
      error = std::max(error, std::abs(static_cast<double>(channel.u[channel.grid.place(2, j)]) - 4.0 * y * (1.0 - y)));
    }
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.6);
    }
    before = error;
  }
}

TEST(ViscositySystem, gives_the_same_bits_on_any_number_of_threads) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 8);
  Box2 box(120, 90, {}, [](int i, int j) { return j < 40 + i / 4; });
  RandomStream random(9, 0);
  for (AlignedArray<float>* a : {&box.u, &box.v}) {
    for (std::size_t at = TileGrid::kCells; at < box.grid.values(); ++at)
      (*a)[at] = static_cast<float>(random.uniform(-1.0, 1.0));
  }
  const AlignedArray<float> u = box.u, v = box.v;
  AlignedArray<float> first;
  for (const int threads : {1, 2, 3, 7}) {
    box.u = u;
    box.v = v;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      ViscositySystem system;
      EXPECT_TRUE(system.solve(box.grid, box.coefficients, 5.0, box.u.data(), box.v.data(), 1e-5f).converged);
    });
    if (threads == 1) first = box.u;
    EXPECT_EQ(std::memcmp(first.data(), box.u.data(), first.size() * sizeof(float)), 0) << threads;
  }
}

}  // namespace
}  // namespace froude
