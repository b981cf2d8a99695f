// Cavity, standing wave, moving square and dam against a wall: their tables, their scenes, and measures on exact
// states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "validation/curve.h"
#include "validation/exact.h"
#include "validation/stage.h"

namespace froude::validation {
namespace {

TEST(ExactFlows, standing_waves_are_those_of_the_table) {
  for (const auto& row : table("fluid_standing_wave.csv"))
    EXPECT_NEAR(standingWavePeriod(row[0], row[1], row[4]), row[7], 1e-8);
}

TEST(Curves, a_smooth_one_is_right_between_its_points_too) {
  const std::string file = std::string(FROUDE_TEST_DATA) + "/fluid_cavity_reference_fd.csv";
  for (const std::size_t column : {1u, 2u, 3u, 4u}) {
    const Curve all = readCurve(file, 0, column);
    ASSERT_EQ(all.t.size(), 65u);
    Curve half;  // every second point: errors of the fourth order are sixteen times as large
    for (std::size_t i = 0; i < all.t.size(); i += 2) half.add(all.t[i], all.z[i]);
    double worst = 0.0;
    for (std::size_t i = 0; i < all.t.size(); ++i) {
      EXPECT_NEAR(all.smoothAt(all.t[i]), all.z[i], 1e-12);
      worst = std::max(worst, std::abs(half.smoothAt(all.t[i]) - all.z[i]));
    }
    EXPECT_LT(worst, 0.012) << "column " << column;  // so below 0.001 with all points
  }
  Curve cubic;
  for (const double t : {0.0, 0.3, 0.5, 1.1, 1.2, 2.0}) cubic.add(t, t * t * t - 2.0 * t);
  for (const double t : {0.0, 0.1, 0.7, 1.9, 2.0}) EXPECT_NEAR(cubic.smoothAt(t), t * t * t - 2.0 * t, 1e-12);
}

TEST(Curves, means_and_first_arrivals_are_those_of_straight_pieces) {
  Curve roof;
  roof.add(0.0, 0.0), roof.add(1.0, 2.0), roof.add(3.0, 0.0);
  EXPECT_NEAR(roof.mean(0.0, 3.0), 1.0, 1e-15);
  EXPECT_NEAR(roof.mean(0.5, 2.0), (0.5 * 1.5 + 1.0 * 1.5) / 1.5, 1e-15);
  EXPECT_NEAR(roof.mean(1.5, 2.5), 1.0, 1e-15);
  EXPECT_NEAR(roof.reaches(1.5), 0.75, 1e-15);
  EXPECT_TRUE(std::isnan(roof.reaches(2.5)));
  EXPECT_EQ(roof.reaches(-1.0), 0.0);
}

TEST(Curves, a_median_takes_spikes_and_leaves_steps) {
  Curve signal;
  for (int k = 0; k <= 100; ++k) signal.add(0.01 * k, k == 20 ? 50.0 : k < 50 ? 1.0 : 3.0);
  const Curve quiet = medianFiltered(signal, 0.1);
  ASSERT_EQ(quiet.t, signal.t);
  for (int k = 0; k <= 100; ++k) EXPECT_EQ(quiet.z[static_cast<std::size_t>(k)], k < 50 ? 1.0 : 3.0) << k;
  Curve pair;
  pair.add(0.0, 1.0), pair.add(0.01, 4.0);
  EXPECT_EQ(medianFiltered(pair, 0.1).z[0], 2.5);
}

TEST(Curves, windows_take_their_share_of_each_piece) {
  WindowMeans means(0.5);
  means.add(0.0, 0.3, 2.0);
  means.add(0.3, 1.25, 4.0);
  means.add(1.25, 1.5, 0.0);
  ASSERT_EQ(means.count(), 3u);
  EXPECT_NEAR(means.mean(0), (0.3 * 2.0 + 0.2 * 4.0) / 0.5, 1e-12);
  EXPECT_NEAR(means.mean(1), 4.0, 1e-12);
  EXPECT_NEAR(means.mean(2), 2.0, 1e-12);
  EXPECT_NEAR(means.variance(1), 0.0, 1e-12);
  EXPECT_NEAR(means.variance(2), 4.0, 1e-12);
  EXPECT_EQ(means.from(2), 1.0);
}

TEST(Measures, an_exact_cavity_has_no_error_and_an_offset_is_seen_whole) {
  const std::pair<const char*, std::size_t> cases[] = {{"cavity", 1}, {"cavity_400", 3}};
  for (const auto& [name, column] : cases) {
    Stage stage(name);
    const std::string file = std::string(FROUDE_TEST_DATA) + "/fluid_cavity_reference_fd.csv";
    const Curve u = readCurve(file, 0, column), v = readCurve(file, 0, column + 1);
    const auto exact = [&](const Vec2& x, double) { return Vec2(u.smoothAt(x.y()), v.smoothAt(x.x())); };
    const double end = stage.scene.duration;
    stage.showField(0.1 * end, [](const Vec2&, double) { return Vec2(7.0, 7.0); });  // before it is steady
    stage.showField(end, exact);
    for (const char* metric : {"u_rms", "v_rms", "u_largest", "v_largest"})
      EXPECT_NEAR(stage.error(metric), 0.0, 1e-12) << metric;
    stage.showField(end,
                    [&](const Vec2& x, double t) { return Vec2(exact(x, t) + Vec2(0.06, x.x() < 0.5 ? 0.1 : 0)); });
    EXPECT_NEAR(stage.error("u_rms"), 0.03, 1e-12) << "half of the readings are off by twice that";
    EXPECT_NEAR(stage.error("u_largest"), 0.03, 1e-12);
    EXPECT_NEAR(stage.error("v_largest"), 0.05, 1e-12);
    EXPECT_NEAR(stage.error("v_rms"), 0.05 * std::sqrt(12.0 / 25.0), 0.001);  // the cell in the middle has both halves
  }
}

/// Particles of a standing wave, moved as linear theory has them, that fades by `viscosity` and is `slow` times as
/// slow.
class Swing {
 public:
  Swing(double viscosity, double slow)
      : omega_(2.0 * kPi / (slow * standingWavePeriod(1.0, 0.5, 9.81))), viscosity_(viscosity) {}
  std::pair<Vec2, Vec2> operator()(const Vec2& x, double t) const {
    const double k = 2.0 * kPi, a = 0.01 * std::exp(-2.0 * viscosity_ * k * k * t) / std::sinh(0.5 * k);
    const Vec2 mode(a * std::sin(k * x.x()) * std::cosh(k * x.y()), -a * std::cos(k * x.x()) * std::sinh(k * x.y()));
    return {Vec2(x + std::sin(omega_ * t) * mode), Vec2(omega_ * std::cos(omega_ * t) * mode)};
  }

 private:
  double omega_, viscosity_;
};

TEST(Measures, an_exact_standing_wave_has_its_period_and_its_viscosity) {
  const Swing exact(0.001, 1.0), slow(0.003, 1.05);
  Stage stage("standing_wave"), other("standing_wave");
  const ParticlePool& pool = *stage.world.fluid();
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const Vec2 v = exact(stage.start[i], 0.0).second;
    ASSERT_NEAR(pool.vx()[i], v.x(), 1e-9) << "the scene starts as the formula says";
    ASSERT_NEAR(pool.vy()[i], v.y(), 1e-9);
  }
  for (double t = 0.0; t < 8.6; t += 0.004) stage.show(t, exact), other.show(t, slow);
  EXPECT_NEAR(stage.error("period"), 0.0, 1e-4);
  EXPECT_NEAR(stage.error("extra_viscosity"), 0.0, 2e-5);
  EXPECT_NEAR(other.error("period"), 0.05, 1e-4);
  EXPECT_NEAR(other.error("extra_viscosity"), 0.002, 4e-5);
}

TEST(Measures, the_square_moves_as_in_the_table) {
  const Stage stage("moving_square");
  const BodyDef& square = stage.scene.world.bodies.at(0);
  EXPECT_EQ(square.position, Vec2(1.5, 2.5));
  ASSERT_EQ(square.script.size(), 1u);
  double x = 1.5, before = 0.0;
  for (const auto& row : table("fluid_moving_square_motion.csv")) {
    const double t = row[0], middle = 0.5 * (before + t);
    const auto v = [&](double time) { return square.script[0].velocityX(time); };
    EXPECT_NEAR(v(t), row[2], 2e-6);
    x += (t - before) / 6.0 * (v(before) + 4.0 * v(middle) + v(t));
    EXPECT_NEAR(x, row[3], 1e-3);  // their integration is of first order
    before = t;
  }
}

TEST(Measures, water_that_comes_and_presses_as_in_the_experiment_is_right) {
  Stage stage("dam_pressure");
  const double unit = std::sqrt(0.3 / 9.81), plateau = 0.59;  // t / t*; p/(ρ g H)
  const auto pressure = stage.world.fluid()->findColumn<float>("pressure");
  ASSERT_TRUE(pressure);
  const auto show = [&](int step) {
    const double t = 0.01 * step;
    const bool come = t > 2.425;
    for (float& p : stage.world.fluid()->column(*pressure))
      p = static_cast<float>((step == 300 ? 50.0 : plateau) * 9.81 * 0.3);
    stage.show(t * unit, [&](const Vec2& x, double) {
      return std::pair(Vec2(x + Vec2(come ? 1.01 : 0.0, 0.0)), Vec2(0.0, 0.0));
    });
  };
  for (int step = 0; step <= 560; ++step) show(step);
  // Means of the digitised points themselves, which lie densely.
  double sum[5] = {}, count[5] = {};
  for (const auto& row : table("fluid_dambreak_lobovsky_H300_pressure.csv")) {
    if (row[1] < 3.5 || row[1] > 5.5) continue;
    sum[static_cast<int>(row[0])] += row[2];
    count[static_cast<int>(row[0])] += 1.0;
  }
  EXPECT_NEAR(stage.error("arrival"), 0.0, 0.005);
  EXPECT_NEAR(stage.error("plateau_p1"), plateau / (sum[1] / count[1]) - 1.0, 0.02);
  EXPECT_NEAR(stage.error("plateau_p3"), plateau / (sum[3] / count[3]) - 1.0, 0.02);
  EXPECT_NEAR(stage.error("plateau_p4"), plateau / (sum[4] / count[4]) - 1.0, 0.02);
  EXPECT_NEAR(stage.error("peak_p1"), plateau / 3.1164 - 1.0, 1e-4) << "a spike of one step is noise";
  EXPECT_NEAR(stage.error("peak_p2"), plateau / 1.9593 - 1.0, 1e-4);
  EXPECT_NEAR(stage.error("noise_p4"), (50.0 - plateau) / std::sqrt(561.0), 1e-3);
}

}  // namespace
}  // namespace froude::validation
