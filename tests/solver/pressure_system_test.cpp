// The pressure solve against Eigen's direct factorisation, exact solutions, and itself on other threads and lanes.
#include <froude/solver/fluid/grid/pressure_system.h>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>

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

}  // namespace
}  // namespace froude
