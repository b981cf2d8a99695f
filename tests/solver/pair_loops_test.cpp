// The pair loops: the wide ones against the scalar ones, and those against sums over all pairs in double.
#include <froude/solver/fluid/pair_loops.h>

#include <gtest/gtest.h>

#include <vector>

#include <froude/base/random.h>
#include <froude/solver/fluid/fluid_cells.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

// Particles in a box of 20 × 12 spacings whose corner is far from the origin, sorted by cell.
struct Cloud {
  explicit Cloud(std::size_t n, bool periodic = false) {
    domain.box = {origin, origin + Vec2(20.0, 12.0)};
    domain.periodicX = domain.periodicY = periodic;
    RandomStream random(3, n);
    std::vector<double> px(n), py(n);
    for (std::size_t i = 0; i < n; ++i) {
      px[i] = origin.x() + random.uniform(0.0, 20.0);
      py[i] = origin.y() + random.uniform(0.0, 12.0);
    }
    grid.build(px, py, fluidFrame(domain, px, py, 2.1));
    for (AlignedArray<double>* a : {&x, &y}) a->resize(n);
    for (AlignedArray<std::int32_t>* a : {&latticeX, &latticeY}) a->resize(n);
    for (AlignedArray<float>* a : {&lambda, &wallX, &wallY, &tangent, &shiftX, &shiftY, &value, &ux, &uy, &gain, &least,
                                   &matrixXX, &matrixXY, &matrixYY}) {
      a->resize(n);
    }
    for (std::size_t k = 0; k < n; ++k) {
      x[k] = px[grid.order()[k]];
      y[k] = py[grid.order()[k]];
      latticeX[k] = lattice::coordinate(x[k] - origin.x());
      latticeY[k] = lattice::coordinate(y[k] - origin.y());
      value[k] = static_cast<float>(random.uniform(0.0, 0.1));
      if (k % 3 == 0) {
        lambda[k] = 0.2f;
        wallX[k] = 0.1f;
        wallY[k] = -0.4f;
        tangent[k] = 0.2f / (0.8f * 0.17f);
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
      ux[k] = number(-0.1, 0.1);
      uy[k] = number(-0.1, 0.1);
      gain[k] = k % 3 == 0 ? number(-0.01, 0.01) : 0.0f;
      least[k] = k % 2 == 0 ? -1e30f : 0.0f;
      matrixXX[k] = number(0.8, 1.3);
      matrixXY[k] = number(-0.3, 0.3);
      matrixYY[k] = number(0.8, 1.3);
    }
    findOccupiedCells(grid, cells);
    findCellRuns(grid, cells, {}, runs);
  }
  PairFrame frame() const {
    const Vec2 period = domain.box.size();
    return {&grid,
            cells,
            runs.data(),
            latticeX.data(),
            latticeY.data(),
            domain.periodicX ? lattice::coordinate(period.x()) : 0,
            domain.periodicY ? lattice::coordinate(period.y()) : 0,
            {}};
  }
  Vec2 origin{12345.0, -777.0};
  DomainDef domain;
  CellGrid grid;
  AlignedArray<double> x, y;
  AlignedArray<std::int32_t> latticeX, latticeY;
  AlignedArray<float> lambda, wallX, wallY, tangent, shiftX, shiftY, value;
  AlignedArray<float> ux, uy, gain, least, matrixXX, matrixXY, matrixYY;
  std::vector<std::uint32_t> cells;
  AlignedArray<CellRuns> runs;
};

struct Outputs {
  explicit Outputs(std::size_t n)
      : density(n),
        diagonal(n),
        target(n),
        kappa(n),
        change(n),
        shiftX(n),
        shiftY(n),
        changeX(n),
        changeY(n),
        newX(n),
        newY(n) {}
  AlignedArray<float> density, diagonal, target, kappa, change, shiftX, shiftY, changeX, changeY;
  AlignedArray<std::int32_t> newX, newY;
  double excess = 0.0;
};

Outputs runAll(const Cloud& c, const PairLoops& loops, const HiddenPairs& hidden = {}) {
  Outputs out(c.x.size());
  PairFrame frame = c.frame();
  frame.hidden = hidden;
  AlignedArray<CellRuns> runs;
  findCellRuns(c.grid, c.cells, hidden, runs);
  frame.runs = runs.data();
  for (std::size_t i = 0; i < c.x.size(); ++i) {
    out.target[i] = i % 7 == 0 ? 0.0f : 1.0f;
    out.kappa[i] = c.value[i];
  }
  const PressureUpdate update{out.target.data(), nullptr, out.kappa.data(), out.change.data(), 0.6f};
  out.excess = loops.density(frame,
                             {c.lambda.data(), c.wallX.data(), c.wallY.data(), c.shiftX.data(), c.shiftY.data(),
                              out.density.data(), out.diagonal.data(), update},
                             0, c.cells.size());
  loops.displace(frame,
                 {c.value.data(), c.wallX.data(), c.wallY.data(), c.tangent.data(), out.shiftX.data(),
                  out.shiftY.data(), out.newX.data(), out.newY.data(), out.kappa.data()},
                 0, c.cells.size());
  loops.viscosity(frame, {c.value.data(), c.lambda.data(), 0.05f, 0.02f, out.changeX.data(), out.changeY.data()}, 0,
                  c.cells.size());
  return out;
}

// What the loops with corrected gradients write.
struct Corrected {
  explicit Corrected(std::size_t n)
      : density(n),
        skewX(n),
        skewY(n),
        squares(n),
        xx(n),
        xy(n),
        yy(n),
        diagonal(n),
        target(n),
        kappa(n),
        change(n),
        shiftX(n),
        shiftY(n),
        totalX(n),
        totalY(n) {}
  AlignedArray<float> density, skewX, skewY, squares, xx, xy, yy;  // moments
  AlignedArray<float> diagonal, target, kappa, change;             // divergence
  AlignedArray<float> shiftX, shiftY, totalX, totalY;              // push
  double excess = 0.0;
};

Corrected runCorrected(const Cloud& c, const PairLoops& loops, const HiddenPairs& hidden = {}) {
  const std::size_t n = c.x.size();
  Corrected out(n);
  PairFrame frame = c.frame();
  frame.hidden = hidden;
  AlignedArray<CellRuns> runs;
  findCellRuns(c.grid, c.cells, hidden, runs);
  frame.runs = runs.data();
  for (std::size_t i = 0; i < n; ++i) {
    out.diagonal[i] = i % 11 == 0 ? 0.5f * kSmallestDiagonal : 0.5f + c.value[i];
    out.target[i] = 0.1f * c.uy[i];
    out.kappa[i] = c.value[i];
    out.totalX[i] = c.ux[i];
  }
  const Matrices<const float> matrices{c.matrixXX.data(), c.matrixXY.data(), c.matrixYY.data()};
  loops.moments(frame,
                {c.lambda.data(),
                 out.density.data(),
                 out.skewX.data(),
                 out.skewY.data(),
                 out.squares.data(),
                 {out.xx.data(), out.xy.data(), out.yy.data()}},
                0, c.cells.size());
  const PressureUpdate update{out.target.data(), out.diagonal.data(), out.kappa.data(), out.change.data(), 0.6f,
                              c.least.data()};
  out.excess = loops.divergence(
      frame, {c.ux.data(), c.uy.data(), matrices, c.wallX.data(), c.wallY.data(), c.gain.data(), update}, 0,
      c.cells.size());
  // The loop is linear in the matrices, whatever they are: those of the divergence serve as κB.
  loops.push(
      frame,
      {c.value.data(), matrices, out.skewX.data(), out.skewY.data(), c.wallX.data(), c.wallY.data(), c.tangent.data(),
       out.shiftX.data(), out.shiftY.data(), out.totalX.data(), out.totalY.data(), out.kappa.data()},
      0, c.cells.size());
  return out;
}

TEST(PairLoops, the_scalar_loops_equal_sums_over_all_pairs) {
  for (const bool periodic : {false, true}) {
    const Cloud c(300, periodic);
    const Outputs out = runAll(c, scalarPairLoops());
    const GridFrame& frame = c.grid.frame();
    for (std::size_t i = 0; i < c.x.size(); ++i) {
      double density = c.lambda[i], own = c.value[i], squares = 0.0, changeX = 0.0;
      Vec2 sum(0.0, 0.0), move(0.0, 0.0);
      const Vec2 g(c.wallX[i], c.wallY[i]);
      for (std::size_t j = 0; j < c.x.size(); ++j) {
        const Vec2 d = frame.minimumImage(Vec2(c.x[i] - c.x[j], c.y[i] - c.y[j]));
        const double q2 = d.squaredNorm();
        density += kernel::value(q2);
        const Vec2 gradient = kernel::gradientFactor(q2) * d;
        sum += gradient;
        squares += gradient.squaredNorm();
        move -= (own + c.value[j]) * gradient;
        changeX += (0.05 * kernel::value(q2) - 0.02 * kernel::gradientFactor(q2)) * (c.value[j] - own);
      }
      move -= 2.0 * own * g;
      const Vec2 along = leftNormal(g);
      move += static_cast<double>(c.tangent[i]) * along.dot(move) * along;
      EXPECT_NEAR(out.density[i], density, 3e-6 * density);
      EXPECT_NEAR(out.diagonal[i], (sum + g).dot(sum + 2.0 * g) + squares, 2e-5);
      EXPECT_NEAR(out.shiftX[i], move.x(), 3e-6);
      EXPECT_NEAR(out.shiftY[i], move.y(), 3e-6);
      EXPECT_NEAR(out.changeX[i], changeX, 1e-6);
      const double moved =
          static_cast<double>(lattice::difference(out.newX[i], c.latticeX[i])) / lattice::kUnitsPerSpacing;
      EXPECT_NEAR(moved, out.shiftX[i], 2e-7);
    }
  }
}

TEST(PairLoops, the_scalar_loops_with_corrected_gradients_equal_sums_over_all_pairs) {
  for (const bool periodic : {false, true}) {
    const Cloud c(300, periodic);
    const std::size_t n = c.x.size();
    const Corrected out = runCorrected(c, scalarPairLoops());
    auto matrix = [&](std::size_t i) {
      Eigen::Matrix2d m;
      m << c.matrixXX[i], c.matrixXY[i], c.matrixXY[i], c.matrixYY[i];
      return m;
    };
    double excess = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 u(c.ux[i], c.uy[i]), g(c.wallX[i], c.wallY[i]);
      double density = c.lambda[i], squares = 0.0, divergence = u.dot(g) + static_cast<double>(c.gain[i]);
      Vec2 skew(0.0, 0.0), move = -2.0 * static_cast<double>(c.value[i]) * g;
      Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
      for (std::size_t j = 0; j < n; ++j) {
        const Vec2 d = c.grid.frame().minimumImage(Vec2(c.x[i] - c.x[j], c.y[i] - c.y[j]));
        const Vec2 gradient = kernel::gradientFactor(d.squaredNorm()) * d;
        density += kernel::value(d.squaredNorm());
        skew += gradient;
        squares += gradient.squaredNorm();
        moment -= d * gradient.transpose();
        divergence += (u - Vec2(c.ux[j], c.uy[j])).dot(matrix(i) * gradient);
        move -= (matrix(i) + matrix(j)) * gradient;
      }
      const Vec2 along = leftNormal(g);
      move += static_cast<double>(c.tangent[i]) * along.dot(move) * along;
      EXPECT_NEAR(out.density[i], density, 3e-6 * density);
      EXPECT_NEAR(out.skewX[i], skew.x(), 3e-6);
      EXPECT_NEAR(out.skewY[i], skew.y(), 3e-6);
      EXPECT_NEAR(out.squares[i], squares, 3e-6 * (1.0 + squares));
      EXPECT_NEAR(out.xx[i], moment(0, 0), 5e-6);
      EXPECT_NEAR(out.xy[i], moment(0, 1), 5e-6);
      EXPECT_NEAR(out.yy[i], moment(1, 1), 5e-6);
      EXPECT_NEAR(out.shiftX[i], move.x(), 1e-5);
      EXPECT_NEAR(out.shiftY[i], move.y(), 1e-5);
      EXPECT_NEAR(out.totalX[i], u.x() + move.x(), 1e-5);
      EXPECT_NEAR(out.totalY[i], move.y(), 1e-5);
      EXPECT_FLOAT_EQ(out.kappa[i], 2.0f * c.value[i]);
      const double gain = divergence - static_cast<double>(out.target[i]);
      const double step = 0.6 * gain / static_cast<double>(std::max(out.diagonal[i], kSmallestDiagonal));
      EXPECT_NEAR(out.change[i], std::max(static_cast<double>(c.least[i] - c.value[i]), step), 5e-5);
      excess += c.least[i] < 0.0f ? std::abs(gain) : std::max(0.0, gain);
    }
    EXPECT_NEAR(out.excess, excess, 1e-5 * excess);
  }
}

void compareCorrected(const Corrected& out, const Corrected& expected, SimdTarget target) {
  for (std::size_t i = 0; i < out.density.size(); ++i) {
    const double scale = 1.0 + static_cast<double>(expected.density[i]);  // of the terms of the sums
    ASSERT_NEAR(out.density[i], expected.density[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.skewX[i], expected.skewX[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.skewY[i], expected.skewY[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.squares[i], expected.squares[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.xx[i], expected.xx[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.xy[i], expected.xy[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.yy[i], expected.yy[i], 4e-6 * scale) << name(target);
    ASSERT_NEAR(out.change[i], expected.change[i], 4e-5 * scale) << name(target);
    ASSERT_NEAR(out.shiftX[i], expected.shiftX[i], 1e-5 * scale) << name(target);
    ASSERT_NEAR(out.shiftY[i], expected.shiftY[i], 1e-5 * scale) << name(target);
    ASSERT_NEAR(out.totalX[i], expected.totalX[i], 1e-5 * scale) << name(target);
    ASSERT_NEAR(out.totalY[i], expected.totalY[i], 1e-5 * scale) << name(target);
    ASSERT_EQ(out.kappa[i], expected.kappa[i]) << name(target);
  }
  ASSERT_NEAR(out.excess, expected.excess, 1e-5 * expected.excess) << name(target);
}

// Clouds of a fluid's density, whose cells are mostly usual, and far denser ones, with and without seams.
void compareTargets(std::size_t count, bool periodic) {
  const Cloud c(count, periodic);
  // Every seventh particle sees every second candidate only.
  AlignedArray<std::int32_t> offset(c.x.size());
  AlignedArray<std::uint64_t> words;
  for (std::uint32_t cell : c.cells) {
    for (std::uint32_t i = c.grid.cellStart()[cell]; i < c.grid.cellStart()[cell + 1]; ++i) {
      offset[i] = -1;
      if (i % 7 != 0) continue;
      offset[i] = static_cast<std::int32_t>(words.size());
      c.grid.forEachRun(cell, [&](const CellRun& run) {
        for (std::uint32_t k = run.begin; k < run.end; k += 64) words.push_back(0x5555555555555555ull);
      });
    }
  }
  const HiddenPairs hidden{offset.data(), words.data()};
  const Outputs expected = runAll(c, scalarPairLoops(), hidden);
  for (const SimdTarget target : supportedSimdTargets()) {
    const Outputs out = runAll(c, pairLoops(target), hidden);
    for (std::size_t i = 0; i < c.x.size(); ++i) {
      ASSERT_NEAR(out.density[i], expected.density[i], 4e-6 * expected.density[i]) << name(target);
      ASSERT_NEAR(out.diagonal[i], expected.diagonal[i], 1e-5 * (1.0 + expected.diagonal[i])) << name(target);
      ASSERT_NEAR(out.shiftX[i], expected.shiftX[i], 4e-6) << name(target);
      ASSERT_NEAR(out.shiftY[i], expected.shiftY[i], 4e-6) << name(target);
      ASSERT_NEAR(out.changeY[i], expected.changeY[i], 4e-6) << name(target);
      ASSERT_LE(std::abs(lattice::difference(out.newY[i], expected.newY[i])), 32) << name(target);
      ASSERT_NEAR(out.change[i], expected.change[i], 2e-5 * (1.0 + std::abs(expected.change[i]))) << name(target);
      ASSERT_EQ(out.target[i] == 1.0f, expected.target[i] == 1.0f) << name(target);
      ASSERT_FLOAT_EQ(out.kappa[i], 2.0f * c.value[i]) << name(target);
    }
    ASSERT_NEAR(out.excess, expected.excess, 1e-5 * expected.excess) << name(target);
    compareCorrected(runCorrected(c, pairLoops(target), hidden), runCorrected(c, scalarPairLoops(), hidden), target);
  }
}

TEST(PairLoops, every_instruction_set_agrees_with_the_scalar_loops) {
  for (const std::size_t count : {240u, 2000u}) {
    for (const bool periodic : {false, true}) compareTargets(count, periodic);
  }
}

TEST(PairLoops, a_change_of_pressure_is_a_jacobi_step_that_leaves_none_below_zero) {
  const Cloud c(240);
  const Outputs out = runAll(c, scalarPairLoops());
  for (std::size_t i = 0; i < c.x.size(); ++i) {
    const float target = i % 7 == 0 ? std::max(out.density[i], 1.0f) : 1.0f;
    const float step = 0.6f * (out.density[i] - target) / std::max(out.diagonal[i], kSmallestDiagonal);
    EXPECT_FLOAT_EQ(out.change[i], std::max(step, -c.value[i]));
    EXPECT_EQ(out.target[i], target);
  }
}

TEST(PairLoops, lattice_coordinates_keep_differences_far_from_the_origin) {
  for (const double origin : {0.0, 1e4, 1e9}) {
    const std::int32_t a = lattice::coordinate(origin + 0.25), b = lattice::coordinate(origin + 1.5);
    EXPECT_NEAR(static_cast<double>(lattice::difference(b, a)) / lattice::kUnitsPerSpacing, 1.25, 2.4e-7);
  }
}

TEST(PairLoops, the_kernel_integrates_to_one_and_its_lattice_sums_agree) {
  double integral = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double q = 2.0 * (k + 0.5) / 20000;
    integral += kernel::value(q * q) * kernel::kLatticeSum * 2.0 * kPi * q * 2.0 / 20000;
  }
  EXPECT_NEAR(integral, 1.0, 1e-8);
  double square = 0.0, hexagonal = 0.0;
  const double a = std::sqrt(2.0 / std::sqrt(3.0));
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) {
      square += kernel::value(i * i + j * j);
      hexagonal += kernel::value(a * a * (i * i + i * j + j * j));
    }
  }
  EXPECT_NEAR(square, 1.0, 1.5e-3);
  EXPECT_NEAR(hexagonal, 1.0, 1.5e-3);
}

}  // namespace
}  // namespace froude
