// Soft bodies in fluids: whose pressure bends and lifts them, and what they hold back.
#include <gtest/gtest.h>

#include <cmath>

#include <froude/solver/world.h>

#include "support/soft_meshes.h"

namespace froude {
namespace {

using testing::lattice;
using testing::pinnedWhere;
using testing::softWorld;
using testing::tipOf;

/// Rows of particles that fill a box, but for another.
void fill(World& world, const Box& box, double dx, const Box& but = {}) {
  std::vector<Vec2> x, v;
  for (double y = box.min.y() + 0.5 * dx; y < box.max.y(); y += dx) {
    for (double at = box.min.x() + 0.5 * dx; at < box.max.x(); at += dx) {
      if (but.empty() || !but.contains({at, y})) x.emplace_back(at, y), v.emplace_back(0.0, 0.0);
    }
  }
  world.addFluid(x, v);
}

double momentumGap(const World& world) {
  const Ledger& l = world.ledger();
  const Totals t = world.totals();
  return (t.momentum - l.momentum0 - l.impulse).norm() / t.mass;
}

// A plate of 1 m × 0.05 m, clamped at both ends, under 2 m of water, as that of Fourey et al. 2017 but of a hundredth
// of its stiffness, so that ten times fewer parts do. Thin plate, plane strain: w = (ρ g d + ρ_s g t) L⁴/(384 D), D = E
// t³/(12 (1 − ν²)); that it is stretched as well makes it 1 % stiffer.
TEST(LongSoftFluid, a_plate_under_two_metres_of_water_bends_as_the_thin_plate) {
  for (const char* model : {"dfsph"}) {
    SoftDef plate;
    plate.mesh = lattice(1.0, 0.05, 80, 4);
    plate.spacing = 0.0125;
    plate.density = 2700.0;
    plate.young = 67.5e7;
    plate.poisson = 0.34;
    plate.damping = 70.0;
    plate.position = {0.0, 0.2};
    plate.pinned = pinnedWhere(*plate.mesh, [](const Vec2& p) { return p.x() < 1e-9 || p.x() > 1.0 - 1e-9; });
    WorldDef def = softWorld({plate}, Vec2(0.0, -9.81));
    def.domain.box = {{0.0, 0.0}, {1.0, 3.0}};
    def.fluid = FluidDef{};
    def.fluid->model = model;
    def.fluid->spacing = 0.05;
    World world(def);
    fill(world, {{0.0, 0.25}, {1.0, 2.25}}, 0.05);
    ASSERT_TRUE(world.step(0.3).ok()) << model;
    double mean = 0.0;
    for (int k = 0; k < 30; ++k) {
      ASSERT_TRUE(world.step(0.01).ok()) << model;
      mean += tipOf(world, 0, Vec2(0.5, 0.025)).y() / 30.0;
    }
    const double rigidity = 67.5e7 * std::pow(0.05, 3) / (12.0 * (1.0 - 0.34 * 0.34));
    const double exact = -(1000.0 * 9.81 * 2.0 + 2700.0 * 9.81 * 0.05) / (384.0 * rigidity);
    EXPECT_NEAR(mean / exact, 1.0, 0.1) << model;
    EXPECT_LT(momentumGap(world), 1e-6) << model;
    EXPECT_LT(world.ledger().energyDrift, 0.05) << model;
  }
}

// Archimedes: of a bar of 600 kg/m² six tenths are under water. It settles in a tank of 0.8 m, whose level it raises.
TEST(LongSoftFluid, a_bar_floats_at_its_draft) {
  for (const char* model : {"pbf", "dfsph"}) {
    SoftDef bar;
    bar.mesh = lattice(0.4, 0.1, 20, 5);
    bar.spacing = 0.02;
    bar.density = 600.0;
    bar.young = 1.0e5;
    bar.poisson = 0.3;
    bar.damping = 2.0;
    bar.position = {0.2, 0.28};
    WorldDef def = softWorld({bar}, Vec2(0.0, -9.81));
    def.domain.box = {{0.0, 0.0}, {0.8, 1.0}};
    def.fluid = FluidDef{};
    def.fluid->model = model;
    def.fluid->spacing = 0.02;
    World world(def);
    fill(world, {{0.0, 0.0}, {0.8, 0.32}}, 0.02, {{0.2, 0.28}, {0.6, 0.4}});
    const double water = world.totals(Species::Fluid).mass / 1000.0;
    ASSERT_TRUE(world.step(2.0).ok()) << model;
    double mean = 0.0, level = (water + 0.024) / 0.8;
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(world.step(0.05).ok()) << model;
      mean += world.softState(0).center.y() / 20.0;
    }
    EXPECT_NEAR(level - mean + 0.05, 0.06, 0.01) << model;
    EXPECT_LT(momentumGap(world), 1e-6) << model;
    EXPECT_LT(world.ledger().energyDrift, 0.05) << model;
  }
}

TEST(SoftFluid, water_does_not_pass_a_sheet_and_momentum_closes) {
  for (const char* model : {"pbf", "dfsph", "wcsph"}) {
    SoftDef sheet;
    sheet.mesh = lattice(0.6, 0.04, 30, 2);
    sheet.spacing = 0.02;
    sheet.young = 2.0e7;
    sheet.poisson = 0.3;
    sheet.position = {0.2, 0.3};
    sheet.pinned = pinnedWhere(*sheet.mesh, [](const Vec2& p) { return p.x() < 1e-9 || p.x() > 0.6 - 1e-9; });
    WorldDef def = softWorld({sheet}, Vec2(0.0, -9.81));
    def.domain.box = {{0.2, 0.0}, {0.8, 1.0}};
    def.fluid = FluidDef{};
    def.fluid->model = model;
    def.fluid->spacing = 0.02;
    World world(def);
    fill(world, {{0.2, 0.35}, {0.8, 0.5}}, 0.02);
    ASSERT_TRUE(world.step(0.5).ok()) << model;
    for (const double y : world.fluid()->y()) EXPECT_GT(y, 0.32) << model;
    // The fluids' own loops are in single precision.
    EXPECT_LT(momentumGap(world), 1e-6) << model;
    EXPECT_LT(tipOf(world, 0, Vec2(0.3, 0.02)).y(), -1e-4) << model;
  }
}

}  // namespace
}  // namespace froude
