// The gradients of dfsph: lattices whose moments are known, means summed up by hand, same bits.
#include <froude/solver/fluid/gradient_correction.h>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <vector>

#include <froude/base/random.h>
#include <froude/solver/fluid/fluid_cells.h>
#include <froude/solver/fluid/lattice.h>

namespace froude {
namespace {

using Place = GradientCorrection::Place;

// Particles sorted into cells of 2.1 spacings, with their moments and gradients corrected by them. Those nearer than
// `rim` to the border of a box that is not periodic are at the surface.
struct Sample {
  Sample(const Box& box, const std::vector<Vec2>& points, bool periodic, double rim = 2.0) : count(points.size()) {
    DomainDef domain;
    domain.box = box;
    domain.periodicX = domain.periodicY = periodic;
    std::vector<double> px, py;
    for (const Vec2& p : points) {
      px.push_back(p.x());
      py.push_back(p.y());
    }
    grid.build(px, py, fluidFrame(domain, px, py, 2.1));
    findOccupiedCells(grid, cells);
    findCellRuns(grid, cells, {}, runs);
    for (AlignedArray<std::int32_t>* a : {&latticeX, &latticeY}) a->resize(count);
    for (AlignedArray<float>* a : {&density, &skewX, &skewY, &squares, &xx, &xy, &yy}) a->resize(count);
    for (const std::uint32_t k : grid.order()) {
      const std::size_t i = at.size();
      at.push_back(points[k]);
      latticeX[i] = lattice::coordinate(points[k].x() - box.min.x());
      latticeY[i] = lattice::coordinate(points[k].y() - box.min.y());
      const double edge = std::min((points[k] - box.min).minCoeff(), (box.max - points[k]).minCoeff());
      place.push_back(periodic || edge > rim ? Place::Inside : Place::AtSurface);
    }
    pairs = {&grid, cells, runs.data(), latticeX.data(), latticeY.data(), 0, 0, {}};
    if (periodic) {
      pairs.periodX = lattice::coordinate(box.size().x());
      pairs.periodY = lattice::coordinate(box.size().y());
    }
    const MomentLoop loop{nullptr,      density.data(), skewX.data(),
                          skewY.data(), squares.data(), {xx.data(), xy.data(), yy.data()}};
    scalarPairLoops().moments(pairs, loop, 0, cells.size());
    build();
  }
  void build() { correction.build(grid, cells, {xx.data(), xy.data(), yy.data()}, place.data()); }
  Eigen::Matrix2d moment(std::size_t i) const { return (Eigen::Matrix2d() << xx[i], xy[i], xy[i], yy[i]).finished(); }
  Eigen::Matrix2d matrix(std::size_t i) const {
    const Matrices<const float> b = correction.matrices();
    return (Eigen::Matrix2d() << b.xx[i], b.xy[i], b.xy[i], b.yy[i]).finished();
  }

  std::size_t count;
  CellGrid grid;
  std::vector<std::uint32_t> cells;
  AlignedArray<CellRuns> runs;
  AlignedArray<std::int32_t> latticeX, latticeY;
  AlignedArray<float> density, skewX, skewY, squares, xx, xy, yy;
  std::vector<Vec2> at;
  std::vector<Place> place;
  PairFrame pairs;
  GradientCorrection correction;
};

const Box kBox{{100.0, -50.0}, {140.0, -20.0}};

// A square lattice pulled out by 1.35 along a direction and pressed by as much across it.
Sample strained(double degrees) {
  const double angle = degrees * kPi / 180.0;
  Eigen::Matrix2d turn, pull;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  pull << 1.35, 0.0, 0.0, 1.0 / 1.35;
  const Eigen::Matrix2d strain = turn * pull * turn.transpose();
  std::vector<Vec2> points;
  for (int i = -60; i <= 60; ++i) {
    for (int j = -60; j <= 60; ++j) {
      const Vec2 p = 0.5 * (kBox.min + kBox.max) + strain * Vec2(i, j);
      if ((p - kBox.min).minCoeff() > 0.0 && (kBox.max - p).minCoeff() > 0.0) points.push_back(p);
    }
  }
  return {kBox, points, false};
}

// Lattice points each up to 0.3 spacings from their place, in a box that closes upon itself.
Sample disordered(double width, double height) {
  RandomStream random(7, 1);
  std::vector<Vec2> points;
  for (double y = 0.5; y < height; y += 1.0) {
    for (double x = 0.5; x < width; x += 1.0) {
      const double right = random.uniform(-0.3, 0.3), up = random.uniform(-0.3, 0.3);
      points.emplace_back(x + right, y + up);
    }
  }
  return {{{0.0, 0.0}, {width, height}}, points, true};
}

TEST(GradientCorrection, makes_the_moment_of_a_strained_lattice_the_unit_matrix) {
  for (const double degrees : {0.0, 20.0, 45.0}) {
    const Sample s = strained(degrees);
    double uncorrected = 0.0;
    std::size_t inside = 0;
    for (std::size_t i = 0; i < s.count; ++i) {
      if (s.place[i] != Place::Inside) continue;
      ++inside;
      uncorrected = std::max(uncorrected, (s.moment(i) - Eigen::Matrix2d::Identity()).norm());
      EXPECT_LT((s.matrix(i) * s.moment(i) - Eigen::Matrix2d::Identity()).norm(), 1e-3) << degrees;
    }
    EXPECT_GT(inside, 500u);
    EXPECT_GT(uncorrected, 0.08) << "there is something to correct";
  }
}

TEST(GradientCorrection, is_a_multiple_of_the_unit_matrix_at_surfaces_and_walls) {
  Sample s = strained(20.0);
  for (std::size_t i = 0; i < s.count; ++i) {
    if (s.place[i] == Place::AtSurface && s.at[i].x() < 120.0) s.place[i] = Place::AtWall;
  }
  s.build();
  const Matrices<const float> b = s.correction.matrices();
  float usual = 0.0f;
  for (std::size_t i = 0; i < s.count; ++i) {
    if (s.place[i] == Place::Inside) {
      EXPECT_NE(b.xy[i], 0.0f);
      continue;
    }
    if (usual == 0.0f) usual = b.xx[i];
    EXPECT_EQ(b.xx[i], usual);
    EXPECT_EQ(b.yy[i], usual);
    EXPECT_EQ(b.xy[i], 0.0f);
  }
  EXPECT_NEAR(usual, 1.0, 0.1);
}

TEST(GradientCorrection, makes_the_divergence_of_a_linear_velocity_field_exact) {
  const Sample s = strained(20.0);
  const Vec2 middle = 0.5 * (kBox.min + kBox.max);
  for (const std::array<double, 4>& rates :
       {std::array{0.01, 0.02, -0.03, 0.005}, std::array{0.01, 0.03, 0.02, -0.01}}) {
    const Eigen::Matrix2d gradient = (Eigen::Matrix2d() << rates[0], rates[1], rates[2], rates[3]).finished();
    AlignedArray<float> ux(s.count), uy(s.count), target(s.count), diagonal(s.count), kappa(s.count), change(s.count),
        least(s.count);
    for (std::size_t i = 0; i < s.count; ++i) {
      const Vec2 u = gradient * (s.at[i] - middle);
      ux[i] = static_cast<float>(u.x());
      uy[i] = static_cast<float>(u.y());
      diagonal[i] = 1.0f;
      least[i] = -1e30f;
    }
    const PressureUpdate update{target.data(), diagonal.data(), kappa.data(), change.data(), 1.0f, least.data()};
    const DivergenceLoop loop{ux.data(), uy.data(), s.correction.matrices(), nullptr, nullptr, nullptr, update};
    scalarPairLoops().divergence(s.pairs, loop, 0, s.cells.size());
    for (std::size_t i = 0; i < s.count; ++i) {
      if (s.place[i] != Place::Inside) continue;
      EXPECT_NEAR(change[i], -gradient.trace(), 2e-6);  // what spreads gets thinner
    }
  }
}

// Eleven cells across, and five, which are all in each window.
TEST(GradientCorrection, inverts_the_mean_moment_of_five_by_five_cells_across_seams_too) {
  for (const double width : {24.0, 11.0}) {
    const Sample s = disordered(width, 24.0);
    const GridFrame& frame = s.grid.frame();
    for (std::size_t i = 0; i < s.count; i += 13) {
      const auto cell = static_cast<std::int32_t>(s.grid.cellOf(s.at[i].x(), s.at[i].y()));
      Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
      double count = 0.0;
      for (std::size_t j = 0; j < s.count; ++j) {
        const auto other = static_cast<std::int32_t>(s.grid.cellOf(s.at[j].x(), s.at[j].y()));
        auto apart = [](std::int32_t a, std::int32_t b, std::int32_t n) {
          const std::int32_t d = std::abs(a - b);
          return std::min(d, n - d);
        };
        if (apart(cell % frame.nx, other % frame.nx, frame.nx) > 2) continue;
        if (apart(cell / frame.nx, other / frame.nx, frame.ny) > 2) continue;
        sum += s.moment(j);
        count += 1.0;
      }
      EXPECT_LT((s.matrix(i) * sum / count - Eigen::Matrix2d::Identity()).norm(), 1e-5) << width;
      EXPECT_TRUE(s.correction.deep(i));
    }
  }
}

TEST(GradientCorrection, is_deep_only_away_from_surfaces_and_walls) {
  const Sample s = strained(0.0);
  const double support = 2.0, cell = 2.1;
  std::size_t deep = 0;
  for (std::size_t i = 0; i < s.count; ++i) {
    const double edge = std::min((s.at[i] - kBox.min).minCoeff(), (kBox.max - s.at[i]).minCoeff());
    if (edge < support + 2.0 * cell) {
      EXPECT_FALSE(s.correction.deep(i)) << s.at[i].transpose();
    }
    if (edge > support + 3.0 * cell) {
      EXPECT_TRUE(s.correction.deep(i)) << s.at[i].transpose();
    }
    deep += s.correction.deep(i) ? 1 : 0;
  }
  EXPECT_GT(deep, 200u);
}

TEST(GradientCorrection, a_few_particles_that_hang_together_by_little_are_left_alone) {
  // Called inside, but their moment is far from that of a fluid.
  Sample s(kBox, {{120.0, -35.0}, {121.8, -35.0}, {120.0, -33.2}}, false);
  const Matrices<const float> b = s.correction.matrices();
  for (std::size_t i = 0; i < s.count; ++i) {
    EXPECT_EQ(s.place[i], Place::Inside);
    EXPECT_EQ(b.xx[i], b.yy[i]);
    EXPECT_EQ(b.xy[i], 0.0f);
    EXPECT_FALSE(s.correction.deep(i));
  }
}

TEST(GradientCorrection, has_the_same_bits_on_any_number_of_threads) {
  Sample s = disordered(80.0, 64.0);
  std::vector<float> first;
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena(threads).execute([&] { s.build(); });
    const Matrices<const float> b = s.correction.matrices();
    std::vector<float> bits;
    for (std::size_t i = 0; i < s.count; ++i) bits.insert(bits.end(), {b.xx[i], b.xy[i], b.yy[i]});
    if (first.empty()) first = bits;
    EXPECT_TRUE(bits == first) << threads << " threads";
  }
}

}  // namespace
}  // namespace froude
