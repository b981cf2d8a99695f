// What the validation measures: exact formulas against published numbers, and measures on states that are exact.
#include <gtest/gtest.h>

#include <cmath>

#include "validation/curve.h"
#include "validation/dam_curve.h"
#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/stage.h"

namespace froude::validation {
namespace {

TEST(ExactFlows, channels_are_those_of_the_tables) {
  for (const auto& row : table("fluid_poiseuille_startup.csv"))
    EXPECT_NEAR(poiseuilleStart(row[1], row[0], 1e-3, 1e-6, 1e-4), row[2], 1e-14);
  for (const auto& row : table("fluid_couette_startup.csv"))
    EXPECT_NEAR(couetteStart(row[1], row[0], 1e-3, 1e-6, 1.25e-5), row[2], 1e-14);
}

TEST(ExactFlows, drops_are_those_of_the_tables) {
  for (const auto& row : table("fluid_elliptic_drop_monaghan.csv")) {
    const Drop drop = dropAt(row[0], -100.0, 0.0, 1e-6);
    EXPECT_NEAR(drop.a, row[2], 1e-9);
    EXPECT_NEAR(1.0 / drop.a, row[3], 1e-9);
    EXPECT_NEAR(kinetic(drop), row[5], 1e-6 * row[5]);
  }
  for (const auto& row : table("fluid_oscillating_drop_central.csv")) {
    const Drop drop = dropAt(row[0], 1.0, 1.0, 1e-3);
    EXPECT_NEAR(drop.a, row[1], 2e-8);
    EXPECT_NEAR(kinetic(drop), row[3], 2e-8);
  }
  EXPECT_NEAR(dropPeriod(1.0, 1.0, 1e-3), 4.82734301, 1e-6);
}

TEST(ExactFlows, vortices_decay_as_in_the_table_and_do_not_cross_the_box) {
  for (const auto& row : table("fluid_taylor_green.csv")) {
    const double viscosity = 1.0 / row[0];
    EXPECT_NEAR(taylorGreen({0.0, 0.25}, row[1], viscosity).norm(), row[2], 1e-9);
    double mean = 0.0;
    constexpr int kPoints = 20;
    for (int i = 0; i < kPoints * kPoints; ++i)
      mean +=
          0.5 *
          taylorGreen({(i % kPoints + 0.5) / kPoints, (i / kPoints + 0.5) / kPoints}, row[1], viscosity).squaredNorm() /
          (kPoints * kPoints);
    EXPECT_NEAR(mean, row[3], 1e-9);
  }
  for (const double s : {0.0, 0.1, 0.37, 0.5}) {
    EXPECT_NEAR(taylorGreenBox({0.0, s}, 0.0, 0.01).x(), 0.0, 1e-15);
    EXPECT_NEAR(taylorGreenBox({0.5, s}, 0.0, 0.01).x(), 0.0, 1e-15);
    EXPECT_NEAR(taylorGreenBox({s, 0.0}, 0.0, 0.01).y(), 0.0, 1e-15);
    EXPECT_NEAR(taylorGreenBox({s, 0.5}, 0.0, 0.01).y(), 0.0, 1e-15);
    // Shear along the wall x = 0, by a difference.
    const double shear = taylorGreenBox({1e-6, s}, 0.0, 0.01).y() - taylorGreenBox({-1e-6, s}, 0.0, 0.01).y();
    EXPECT_NEAR(shear, 0.0, 1e-12);
  }
}

TEST(ExactFlows, the_ring_turns_with_its_walls_and_carries_the_same_torque_everywhere) {
  EXPECT_NEAR(couetteRing(0.5, 0.5, 1.0, 0.2), 0.1, 1e-15);
  EXPECT_NEAR(couetteRing(1.0, 0.5, 1.0, 0.2), 0.0, 1e-15);
  const auto torque = [](double r) {  // r³ d(v/r)/dr, up to a factor
    const double h = 1e-5;
    const auto rate = [](double s) { return couetteRing(s, 0.5, 1.0, 0.2) / s; };
    return r * r * r * (rate(r + h) - rate(r - h)) / (2.0 * h);
  };
  EXPECT_NEAR(torque(0.6), torque(0.9), 1e-8);
}

/// The affine motion of a drop from the start to t, solved once for all particles.
auto affine(double t, double rate, double B, double dt) {
  return [d = dropAt(t, rate, B, dt)](const Vec2& x, double) {
    return std::pair(Vec2(d.a * x.x(), x.y() / d.a), Vec2(d.da * x.x(), -d.da / (d.a * d.a) * x.y()));
  };
}

TEST(Measures, exact_vortices_have_no_error_and_weaker_ones_a_known_one) {
  using Vortices = Vec2 (*)(const Vec2&, double, double);
  const std::pair<const char*, Vortices> cases[] = {{"taylor_green", taylorGreen},
                                                    {"taylor_green_box", taylorGreenBox}};
  for (const auto& [caseName, field] : cases) {
    const Vortices exact = field;
    Stage stage(caseName);
    stage.measure->read(stage.world, 0.0);
    EXPECT_NEAR(stage.error("velocity"), 0.0, 1e-12) << "the scene starts as the formula says";
    stage.showField(0.0, [&](const Vec2& x, double t) { return exact(x, t, 0.01); });
    stage.showField(1.4, [&](const Vec2& x, double t) { return exact(x, t, 0.01); });
    EXPECT_NEAR(stage.error("velocity"), 0.0, 1e-12);
    EXPECT_NEAR(stage.error("decay_rate"), 0.0, 1e-12);
    stage.showField(1.4, [&](const Vec2& x, double t) { return Vec2(0.9 * exact(x, t, 0.01)); });
    EXPECT_NEAR(stage.error("velocity"), 0.1, 1e-12);
    EXPECT_NEAR(stage.error("decay_rate"), -2.0 * std::log(0.9) / (16.0 * kPi * kPi * 0.01 * 1.4), 1e-12);
  }
}

TEST(Measures, exact_channels_have_no_error_and_a_fluid_at_rest_has_all_of_it) {
  const auto poiseuille = [](const Vec2& x, double t) { return Vec2(poiseuilleStart(x.y(), t, 1.0, 0.1, 0.08), 0.0); };
  const auto couette = [](const Vec2& x, double t) { return Vec2(couetteStart(x.y(), t, 1.0, 0.1, 0.1), 0.0); };
  Stage channel("poiseuille"), belt("couette_start");
  for (const double t : {0.0, 0.25, 1.0, 5.0}) {
    channel.showField(t, poiseuille);
    belt.showField(t, couette);
  }
  EXPECT_NEAR(channel.error("profile"), 0.0, 1e-12);
  EXPECT_NEAR(belt.error("profile"), 0.0, 1e-12);
  const auto rest = [](const Vec2&, double) { return Vec2(0.0, 0.0); };
  channel.showField(1e3, rest);
  belt.showField(1e3, rest);
  EXPECT_NEAR(channel.error("profile"), 1.0, 1e-3);  // the middle of the parabola
  EXPECT_NEAR(belt.error("profile"), 0.98, 1e-3);    // half a spacing of 1/25 below the belt
}

TEST(Measures, an_exact_ring_has_no_error_and_is_full) {
  Stage stage("couette");
  const auto exact = [](const Vec2& x, double) {
    return Vec2(Vec2(-x.y(), x.x()) / x.norm() * couetteRing(x.norm(), 0.5, 1.0, 0.2));
  };
  stage.showField(4.0, exact);
  EXPECT_NEAR(stage.error("profile"), 0.0, 1e-12);
  const double area = static_cast<double>(stage.start.size()) * std::pow(stage.scene.world.fluid->spacing, 2);
  EXPECT_NEAR(area, 0.75 * kPi, 0.002 * 0.75 * kPi);
}

TEST(Measures, hydrostatic_pressure_has_no_error_and_bodies_that_bear_nothing_have_all_of_it) {
  Stage stage("hydrostatic");
  ParticlePool& pool = *stage.world.fluid();
  const double g = 9.81, level = 0.5 + static_cast<double>(pool.size()) * 0.025 * 0.025 - 0.425;
  const auto pressure = pool.findColumn<float>("pressure");
  ASSERT_TRUE(pressure);
  for (std::size_t i = 0; i < pool.size(); ++i)
    pool.column(*pressure)[i] = static_cast<float>(g * (level - pool.y()[i]));
  const auto drift = [](const Vec2&, double) { return Vec2(0.006, -0.008); };
  stage.showField(0.0, drift);
  stage.showField(6.0, drift);
  for (const char* metric : {"pressure_deep", "pressure_over_step", "pressure_under_lip"})
    EXPECT_NEAR(stage.error(metric), 0.0, 1e-5) << metric;
  EXPECT_NEAR(stage.error("mean_speed"), 0.01 / std::sqrt(g * level), 1e-9);
  EXPECT_NEAR(stage.error("force"), -1.0, 1e-12);
  EXPECT_EQ(stage.error("volume"), 0.0);
}

TEST(Measures, a_particle_that_is_gone_from_the_tank_is_missed) {
  Stage stage("sloshing");
  stage.measure->read(stage.world, 0.0);
  stage.measure->read(stage.world, 0.1);
  EXPECT_EQ(stage.error("lost"), 0.0);
  stage.world.kill(Species::Fluid, stage.world.fluid()->handleAt(7));
  stage.measure->read(stage.world, 0.2);
  EXPECT_NEAR(stage.error("lost"), 1.0 / 480.0, 1e-12);
  EXPECT_LT(stage.error("volume"), 0.01);
}

TEST(Measures, an_exact_drop_has_no_error) {
  Stage stage("drop");
  stage.measure->read(stage.world, 0.0);
  EXPECT_NEAR(stage.error("axis_x"), 0.0, 1e-12);
  EXPECT_NEAR(stage.error("energy"), 0.0, 1e-9) << "the scene starts as the formula says";
  for (const double t : {0.002, 0.0076}) {
    stage.show(t, affine(t, -100.0, 0.0, 1e-6));
    EXPECT_NEAR(stage.error("axis_x"), 0.0, 1e-9);
    EXPECT_NEAR(stage.error("axis_y"), 0.0, 1e-9);
    EXPECT_NEAR(stage.error("energy"), 0.0, 1e-9);
  }
}

TEST(Measures, an_exact_swinging_drop_has_its_period_and_loses_nothing) {
  Stage stage("central_drop");
  for (int k = 0; k <= 970; ++k) {
    stage.show(0.02 * k, affine(0.02 * k, 1.0, 1.0, 1e-2));
  }
  EXPECT_NEAR(stage.error("period"), 0.0, 1e-5);
  EXPECT_NEAR(stage.error("energy_loss_a_period"), 0.0, 1e-4);
  EXPECT_NEAR(stage.error("axis_rms"), 0.0, 1e-5);
}

TEST(Measures, a_patch_in_rigid_rotation_keeps_all_and_free_flight_tears_it) {
  Stage stage("rotating_patch");
  const auto turn = [](const Vec2& x, double t) {
    const Vec2 at(std::cos(t) * x.x() + std::sin(t) * x.y(), std::cos(t) * x.y() - std::sin(t) * x.x());
    return std::pair(at, Vec2(at.y(), -at.x()));
  };
  stage.show(0.0, turn);
  stage.show(2.0, turn);
  EXPECT_NEAR(stage.error("angular_momentum"), 0.0, 1e-12);
  EXPECT_NEAR(stage.error("kinetic_energy"), 0.0, 1e-12);
  EXPECT_NEAR(stage.error("area"), 0.0, 0.05);  // cells of half a spacing, against slanted edges
  EXPECT_NEAR(stage.error("nearest_pair"), 0.0, 1e-9);
  EXPECT_EQ(stage.error("clumped"), 0.0);
  EXPECT_EQ(stage.error("torn_off"), 0.0);
  stage.show(2.0,
             [](const Vec2& x, double t) { return std::pair(Vec2(x + t * Vec2(x.y(), -x.x())), Vec2(x.y(), -x.x())); });
  EXPECT_NEAR(stage.error("angular_momentum"), 0.0, 1e-12);
  EXPECT_EQ(stage.error("torn_off"), 624.0);  // √5 spacings apart
}

TEST(Measures, clumps_and_pieces_are_counted) {
  ParticlePool pool{PoolSettings{}};
  const auto put = [&](double x, double y) {
    pool.create();
    pool.x()[pool.size() - 1] = x;
    pool.y()[pool.size() - 1] = y;
  };
  for (int i = 0; i < 100; ++i) put(i % 10, i / 10);
  put(0.3, 0.0);   // beside the first one
  put(20.0, 0.0);  // alone
  put(21.5, 0.0);  // two that are linked
  put(40.0, 3.0);
  const Clumping clumps = clumping(pool, 0.5, 2.0);
  EXPECT_NEAR(clumps.leastDistance, 0.3, 1e-12);
  EXPECT_NEAR(clumps.closeShare, 2.0 / 104.0, 1e-12);
  EXPECT_EQ(clumps.components, 3u);
}

TEST(Measures, a_curve_that_comes_late_and_runs_ahead_is_told_apart) {
  Curve reference, late;
  for (int k = 0; k <= 300; ++k) reference.add(0.01 * k, 1.0 + 0.01 * k * 0.01 * k);
  for (int k = 0; k <= 300; ++k) late.add(0.01 * k - 0.17, 1.03 * (1.0 + 0.01 * k * 0.01 * k));
  const Distance off = bestShift(late, reference, 0.84, 2.5, 0.3);
  EXPECT_LT(off.rms, 0.03);  // a shift can hide a part of it
  for (double& z : late.z) z /= 1.03;
  const Distance shifted = bestShift(late, reference, 0.84, 2.5, 0.3);
  EXPECT_NEAR(shifted.rms, 0.0, 1e-4);
  EXPECT_NEAR(shifted.shift, 0.17, 1e-9);
  for (std::size_t k = 0; k < late.z.size(); ++k) late.z[k] = 1.03 * reference.z[k], late.t[k] = reference.t[k];
  EXPECT_NEAR(bestShift(late, reference, 0.84, 2.5, 0.0).rms, 0.03, 1e-12);
}

TEST(Measures, a_curve_is_compared_where_it_reaches) {
  Curve reference, lower;
  for (int k = 0; k <= 10; ++k) reference.add(k, 2.0 * k);
  for (int k = 0; k <= 6; ++k) lower.add(k - 0.5, 2.0 * k - 0.1);
  EXPECT_NEAR(rmsDifference(lower, reference, 0.5), 0.1, 1e-12);
  EXPECT_NEAR(rmsDifference(lower, reference, 0.0), 0.9, 1e-12);
}

TEST(Measures, two_courses_of_the_dam_are_as_far_apart_as_they_were_made) {
  DamCurve a, b;
  for (int k = 0; k <= 20; ++k) {
    a.toe.add(0.1 * k, 1.0 + 0.1 * k), b.toe.add(0.1 * k, 1.0 + 0.1 * k + 0.02);
    a.centreX.add(0.1 * k, 0.5), b.centreX.add(0.1 * k, 0.503);
    a.centreY.add(0.1 * k, 0.5), b.centreY.add(0.1 * k, 0.504);
  }
  EXPECT_NEAR(distance(a, b).toe, 0.02, 1e-12);
  EXPECT_NEAR(distance(a, b).centre, 0.005, 1e-12);
  const std::string file = ::testing::TempDir() + "froude_dam_curve.csv";
  writeDamCurve(a, "a test", file);
  EXPECT_NEAR(distance(a, readDamCurve(file)).toe, 0.0, 1e-6);
  std::remove(file.c_str());
}

TEST(Order, is_the_slope_of_the_errors) {
  std::vector<Outcome> outcomes(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double dx = 0.1 / static_cast<double>(1u << i);
    outcomes[i].spacing = dx;
    outcomes[i].metrics = {{"e", "1", -3.0 * std::pow(dx, 1.5), 0.1}, {"zero", "1", 1e-16, 0.1}};
  }
  EXPECT_NEAR(order(outcomes, "e"), 1.5, 1e-9);
  EXPECT_TRUE(std::isnan(order(outcomes, "zero")));
  EXPECT_TRUE(std::isnan(order({outcomes[0]}, "e")));
}

}  // namespace
}  // namespace froude::validation
