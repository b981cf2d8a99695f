// The loops of an acoustic step and those of Wendland's kernel: against sums over all pairs in double, and the
// instruction sets against the scalar ones.
#include <froude/solver/fluid/pair_loops.h>

#include <gtest/gtest.h>

#include <vector>

#include <froude/base/random.h>
#include <froude/solver/fluid/fluid_cells.h>
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/lattice_sums.h>
#include <froude/solver/fluid/wall_integral.h>

namespace froude {
namespace {

constexpr std::size_t kCount = 900;
const Vec2 kDense(10.0, 6.0);   // kernel units: fifteen particles a unit², whose cells are not usual ones
const Vec2 kUsual(36.0, 25.0);  // one a unit²: cells of all kinds, some particles with more than sixteen neighbours

struct Cloud {
  explicit Cloud(const Vec2& size = kDense) {
    DomainDef domain;
    domain.box = {{0.0, 0.0}, size};
    RandomStream random(5, kCount);
    std::vector<double> px(kCount), py(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      px[i] = random.uniform(0.0, size.x());
      py[i] = random.uniform(0.0, size.y());
    }
    grid.build(px, py, fluidFrame(domain, px, py, 2.1));
    for (AlignedArray<std::int32_t>* a : {&latticeX, &latticeY}) a->resize(kCount);
    for (AlignedArray<float>* a :
         {&pressure, &sign, &xx, &xy, &yy, &wallX, &wallY, &tangent, &gain, &ux, &uy, &excess, &ax, &ay, &share}) {
      a->resize(kCount);
    }
    auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    for (std::size_t k = 0; k < kCount; ++k) {
      x.push_back(px[grid.order()[k]]);
      y.push_back(py[grid.order()[k]]);
      latticeX[k] = lattice::coordinate(x[k]);
      latticeY[k] = lattice::coordinate(y[k]);
      pressure[k] = number(-0.1, 0.1);
      sign[k] = k % 5 == 0 ? -1.0f : 1.0f;
      xx[k] = number(0.01, 0.02);
      xy[k] = number(-0.005, 0.005);
      yy[k] = number(0.01, 0.02);
      ux[k] = number(-0.1, 0.1);
      uy[k] = number(-0.1, 0.1);
      excess[k] = number(-0.01, 0.01);
      ax[k] = number(-0.01, 0.01);
      ay[k] = number(-0.01, 0.01);
      share[k] = number(0.5, 1.0);
      if (k % 3 != 0) continue;
      wallX[k] = 0.1f;
      wallY[k] = -0.4f;
      tangent[k] = 0.2f / (0.8f * 0.17f);
      gain[k] = number(-0.01, 0.01);
    }
    findOccupiedCells(grid, cells);
    findCellRuns(grid, cells, {}, runs);
  }
  PairFrame frame() const {
    return {&grid, cells, runs.data(), latticeX.data(), latticeY.data(), 0, 0, {}, kernel::Kind::WendlandC2};
  }
  Eigen::Matrix2d matrix(std::size_t i) const {
    Eigen::Matrix2d m;
    m << xx[i], xy[i], xy[i], yy[i];
    return m;
  }
  CellGrid grid;
  std::vector<double> x, y;
  AlignedArray<std::int32_t> latticeX, latticeY;
  AlignedArray<float> pressure, sign, xx, xy, yy, wallX, wallY, tangent, gain, ux, uy, excess, ax, ay, share;
  std::vector<std::uint32_t> cells;
  AlignedArray<CellRuns> runs;
};

constexpr float kVolume = 0.8f, kSlope = -0.7f, kDiffusion = 0.3f, kWallShare = 0.25f;

struct Outputs {
  AlignedArray<float> shiftX, shiftY, ux, uy, kappa, next, density, skewX, skewY, squares, xx, xy, yy, changeX, changeY;
  std::array<double, 2> total{};
};

Outputs run(const Cloud& c, const PairLoops& loops, bool byRows = false) {
  Outputs out;
  PairFrame frame = c.frame();
  AlignedArray<std::uint8_t> rows;
  if (byRows) {
    rows.resize(kNearRow * kCount);
    loops.near(frame, rows.data(), 0, c.cells.size());
    frame.near = rows.data();
  }
  for (AlignedArray<float>* a :
       {&out.shiftX, &out.shiftY, &out.ux, &out.uy, &out.kappa, &out.next, &out.density, &out.skewX, &out.skewY,
        &out.squares, &out.xx, &out.xy, &out.yy, &out.changeX, &out.changeY}) {
    a->resize(kCount);
  }
  std::copy_n(c.ux.data(), kCount, out.ux.data());
  const Matrices<const float> matrices{c.xx.data(), c.xy.data(), c.yy.data()};
  const std::size_t end = c.cells.size();
  out.total = loops.force(frame,
                          {c.pressure.data(), c.sign.data(), matrices, c.wallX.data(), c.wallY.data(), c.tangent.data(),
                           out.shiftX.data(), out.shiftY.data(), out.ux.data(), out.uy.data(), out.kappa.data()},
                          0, end);
  loops.rate(frame,
             {c.ux.data(), c.uy.data(), c.excess.data(), c.ax.data(), c.ay.data(), matrices, kVolume, kSlope,
              kDiffusion, c.wallX.data(), c.wallY.data(), c.gain.data(), kWallShare, c.share.data(), out.next.data()},
             0, end);
  loops.moments(frame,
                {nullptr,
                 out.density.data(),
                 out.skewX.data(),
                 out.skewY.data(),
                 out.squares.data(),
                 {out.xx.data(), out.xy.data(), out.yy.data()}},
                0, end);
  loops.viscosity(frame, {c.ux.data(), c.uy.data(), 0.02f, 0.01f, out.changeX.data(), out.changeY.data()}, 0, end);
  return out;
}

TEST(AcousticLoops, the_scalar_loops_equal_sums_over_all_pairs) {
  const Cloud c;
  const Outputs out = run(c, scalarPairLoops());
  Vec2 total(0.0, 0.0);
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec2 u(c.ux[i], c.uy[i]), g(c.wallX[i], c.wallY[i]), a(c.ax[i], c.ay[i]);
    Vec2 pairs(0.0, 0.0), skew(0.0, 0.0);
    double gain = 2.0 * (u.dot(g) + static_cast<double>(kWallShare * c.gain[i])), density = 0.0, change = 0.0;
    Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
    for (std::size_t j = 0; j < kCount; ++j) {
      const Vec2 d(c.x[i] - c.x[j], c.y[i] - c.y[j]);
      const double q = d.norm();
      density += kernel::wendland(q);
      // The slope of the kernel over the distance, by its own differences.
      const double f = q > 1e-3 && q < 2.0 ? (kernel::wendland(q + 1e-6) - kernel::wendland(q - 1e-6)) / (2e-6 * q)
                                           : (q < 2.0 ? -5.0 * kernel::kWendland : 0.0);
      const Vec2 gradient = f * d;
      pairs -= (static_cast<double>(c.sign[i]) * c.matrix(i) + c.matrix(j)) * gradient;
      const Vec2 both = a + Vec2(c.ax[j], c.ay[j]);
      const double jump =
          static_cast<double>(c.excess[j] - c.excess[i]) + 0.5 * static_cast<double>(kSlope) * both.dot(d);
      gain += static_cast<double>(kVolume) *
              ((u - Vec2(c.ux[j], c.uy[j])).dot(c.matrix(i) * gradient) - static_cast<double>(kDiffusion) * f * jump);
      skew += gradient;
      moment -= d * gradient.transpose();
      change += (0.02 * kernel::wendland(q) - 0.01 * f) * static_cast<double>(c.ux[j] - c.ux[i]);
    }
    total += pairs;
    Vec2 move = pairs - 2.0 * static_cast<double>(c.pressure[i]) * g;
    const Vec2 along = leftNormal(g);
    move += static_cast<double>(c.tangent[i]) * along.dot(pairs) * along;
    EXPECT_NEAR(out.shiftX[i], move.x(), 2e-5);
    EXPECT_NEAR(out.shiftY[i], move.y(), 2e-5);
    EXPECT_NEAR(out.ux[i], u.x() + move.x(), 2e-5);
    EXPECT_EQ(out.kappa[i], c.pressure[i]);
    EXPECT_NEAR(out.next[i], static_cast<double>(c.excess[i]) + static_cast<double>(c.share[i]) * gain, 2e-5);
    EXPECT_NEAR(out.density[i], density, 5e-6 * density);
    EXPECT_NEAR(out.skewX[i], skew.x(), 1e-4);
    EXPECT_NEAR(out.xy[i], moment(0, 1), 1e-4);
    EXPECT_NEAR(out.yy[i], moment(1, 1), 1e-4);
    EXPECT_NEAR(out.changeX[i], change, 1e-5);
  }
  EXPECT_NEAR(out.total[0], total.x(), 1e-4);
  EXPECT_NEAR(out.total[1], total.y(), 1e-4);
}

void expectAgreement(const Cloud& c, bool byRows) {
  const Outputs expected = run(c, scalarPairLoops());
  for (const SimdTarget target : supportedSimdTargets()) {
    if (byRows && pairLoops(target).near == nullptr) continue;
    const Outputs out = run(c, pairLoops(target), byRows);
    for (std::size_t i = 0; i < kCount; ++i) {
      ASSERT_NEAR(out.shiftX[i], expected.shiftX[i], 1e-5) << name(target);
      ASSERT_NEAR(out.shiftY[i], expected.shiftY[i], 1e-5) << name(target);
      ASSERT_NEAR(out.uy[i], expected.uy[i], 1e-5) << name(target);
      ASSERT_EQ(out.kappa[i], expected.kappa[i]) << name(target);
      ASSERT_NEAR(out.next[i], expected.next[i], 1e-5) << name(target);
      ASSERT_NEAR(out.density[i], expected.density[i], 5e-6 * expected.density[i]) << name(target);
      ASSERT_NEAR(out.skewY[i], expected.skewY[i], 1e-4) << name(target);
      ASSERT_NEAR(out.squares[i], expected.squares[i], 1e-5 * (1.0 + expected.squares[i])) << name(target);
      ASSERT_NEAR(out.xx[i], expected.xx[i], 1e-4) << name(target);
      ASSERT_NEAR(out.changeY[i], expected.changeY[i], 1e-5) << name(target);
    }
    ASSERT_NEAR(out.total[0], expected.total[0], 1e-3) << name(target);
  }
}

TEST(AcousticLoops, every_instruction_set_agrees_with_the_scalar_loops) {
  expectAgreement(Cloud(kDense), false);
  expectAgreement(Cloud(kUsual), false);
}

TEST(AcousticLoops, rows_of_neighbours_hold_all_that_are_near) {
  expectAgreement(Cloud(kUsual), true);
  expectAgreement(Cloud(kDense), true);
}

// What the next acoustic step begins with is made in the same loops.
TEST(AcousticLoops, falls_totals_pressures_and_places_follow_from_what_the_loops_find) {
  const Cloud c(kUsual);
  const Matrices<const float> matrices{c.xx.data(), c.xy.data(), c.yy.data()};
  const std::size_t end = c.cells.size();
  for (const SimdTarget target : supportedSimdTargets()) {
    for (const bool tait : {false, true}) {
      const PairLoops& loops = pairLoops(target);
      Outputs out = run(c, loops);
      AlignedArray<float> shiftX(kCount), shiftY(kCount), ux(kCount), uy(kCount), totalX(kCount), totalY(kCount);
      ForceLoop force{c.pressure.data(), c.sign.data(), matrices,      c.wallX.data(), c.wallY.data(),
                      c.tangent.data(),  shiftX.data(), shiftY.data(), ux.data(),      uy.data()};
      force.fallX = c.ax.data();
      force.fallY = c.ay.data();
      force.totalX = totalX.data();
      force.totalY = totalY.data();
      loops.force(c.frame(), force, 0, end);
      AlignedArray<float> least(kCount), next(kCount), pressure(kCount), xx(kCount), xy(kCount), yy(kCount);
      AlignedArray<std::int32_t> newX(kCount), newY(kCount);
      for (std::size_t i = 0; i < kCount; ++i) least[i] = i % 2 == 0 ? 0.0f : -1e6f;
      RateLoop rate{c.ux.data(),    c.uy.data(),   c.excess.data(), c.ax.data(),    c.ay.data(),
                    matrices,       kVolume,       kSlope,          kDiffusion,     c.wallX.data(),
                    c.wallY.data(), c.gain.data(), kWallShare,      c.share.data(), next.data()};
      rate.state = {least.data(), 0.3f, 0.02f, tait, 0.7f, pressure.data(), {xx.data(), xy.data(), yy.data()}};
      rate.newX = newX.data();
      rate.newY = newY.data();
      loops.rate(c.frame(), rate, 0, end);
      for (std::size_t i = 0; i < kCount; ++i) {
        EXPECT_FLOAT_EQ(ux[i], out.shiftX[i] + c.ax[i]);
        EXPECT_FLOAT_EQ(uy[i], out.shiftY[i] + c.ay[i]);
        EXPECT_FLOAT_EQ(totalX[i], out.shiftX[i]);
        EXPECT_FLOAT_EQ(totalY[i], out.shiftY[i]);
        const double excess = std::max(static_cast<double>(least[i]), static_cast<double>(out.next[i]));
        EXPECT_FLOAT_EQ(next[i], static_cast<float>(excess));
        const double above = tait ? (std::pow(1.0 + excess, 7.0) - 1.0) / 7.0 : excess;
        const double gained = excess - static_cast<double>(c.excess[i]);
        const double kappa = 0.3 * (above + 0.02 + static_cast<double>(0.7f) * gained);
        EXPECT_NEAR(pressure[i], kappa, 1e-6);
        EXPECT_NEAR(xx[i], static_cast<double>(kVolume * c.xx[i]) * kappa, 1e-7);
        EXPECT_NEAR(xy[i], static_cast<double>(kVolume * c.xy[i]) * kappa, 1e-7);
        EXPECT_NEAR(yy[i], static_cast<double>(kVolume * c.yy[i]) * kappa, 1e-7);
        const double moved = static_cast<double>(c.ux[i]) * lattice::kUnitsPerSpacing;
        EXPECT_NEAR(static_cast<double>(lattice::difference(newX[i], c.latticeX[i])), moved, 1.0) << name(target);
      }
    }
  }
}

TEST(AcousticLoops, a_row_half_a_spacing_from_a_receded_wall_finds_density_one) {
  for (const double ratio : {1.0, 0.8, 0.5, 0.4}) {
    const double volume = latticeVolume(ratio, kernel::Kind::WendlandC2);
    double sum = 0.0;
    for (int row = 0; row < 12; ++row) {
      for (int k = -12; k <= 12; ++k) sum += volume * kernel::wendland(ratio * std::hypot(row, k));
    }
    const double recession = latticeRecession(ratio, kernel::Kind::WendlandC2);
    EXPECT_NEAR(sum + halfPlaneShare(0.5 * ratio + recession, kernel::Kind::WendlandC2), 1.0, 1e-6) << ratio;
  }
  EXPECT_EQ(latticeVolume(1.0, kernel::Kind::Blend), 1.0);
  EXPECT_NEAR(latticeRecession(1.0, kernel::Kind::Blend), 0.0856018, 1e-7);
}

}  // namespace
}  // namespace froude
