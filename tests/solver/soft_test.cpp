// Soft bodies of elastic triangles: statics and motion against beams, published finite elements and exact laws.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <froude/solver/world.h>

#include "support/soft_meshes.h"

namespace froude {
namespace {

using testing::lattice;
using testing::pinnedWhere;
using testing::softWorld;
using testing::tipOf;

// A strip of length L and height h, clamped on the left, n points to the height.
SoftDef cantilever(double length, double height, int across, double young, double poisson) {
  SoftDef def;
  def.name = "strip";
  def.spacing = height / across;
  def.mesh = lattice(length, height, static_cast<int>(std::lround(length / def.spacing)), across);
  def.young = young;
  def.poisson = poisson;
  def.pinned = pinnedWhere(*def.mesh, [](const Vec2& p) { return p.x() < 1e-9; });
  return def;
}

Vec2 settledTip(const SoftDef& def, double gravity, double length, double height, double duration) {
  World world(softWorld({def}, Vec2(0.0, -gravity)));
  EXPECT_TRUE(world.step(duration).ok());
  return tipOf(world, 0, Vec2(length, 0.5 * height));
}

// Quadratic finite elements: soft_cantilever_linear.csv's README row, L = 1, h = 0.1, E = 1e6, ν = 0.3: 0.13741 g.
TEST(SoftCantilever, four_points_across_bend_within_2_percent_and_the_error_falls_fourfold) {
  std::array<double, 2> error{};
  for (const int across : {4, 8}) {
    SoftDef def = cantilever(1.0, 0.1, across, 1.0e6, 0.3);
    def.damping = 6.7;  // twice the lowest frequency: critical
    const double tip = -settledTip(def, 0.1, 1.0, 0.1, 4.0).y();
    error[across == 8] = std::abs(tip / 0.013741 - 1.0);
  }
  EXPECT_LT(error[0], 0.02);
  EXPECT_GT(std::log2(error[0] / error[1]), 1.4);
}

TEST(LongSoftCantilever, turek_and_hron_csm1_and_csm2_within_3_percent) {
  struct Case {
    double young, ux, uy;
  };
  for (const Case& c : {Case{1.4e6, -7.187e-3, -66.10e-3}, Case{5.6e6, -0.4690e-3, -16.97e-3}}) {
    SoftDef def = cantilever(0.35, 0.02, 6, c.young, 0.4);
    def.model = SoftModel::StVenantKirchhoff;
    def.damping = c.young > 2e6 ? 28.0 : 14.0;
    const Vec2 tip = settledTip(def, 2.0, 0.35, 0.02, c.young > 2e6 ? 0.7 : 1.4);
    EXPECT_NEAR(tip.y(), c.uy, 0.03 * std::abs(c.uy));
    EXPECT_NEAR(tip.x(), c.ux, 0.06 * std::abs(c.ux));
  }
}

// Plane strain: σ = E/(1 − ν²) ε for a strip that is free to narrow, to first order.
TEST(SoftCantilever, a_hanging_strip_stretches_by_its_weight_over_its_stiffness) {
  for (const double poisson : {0.0, 0.3, 0.45}) {
    SoftDef def = cantilever(1.0, 0.1, 6, 1.0e6, poisson);
    def.damping = 60.0;
    World world(softWorld({def}, Vec2(1.0, 0.0)));
    ASSERT_TRUE(world.step(0.5).ok());
    const double exact = 1000.0 * 1.0 / 2.0 * (1.0 - poisson * poisson) / 1.0e6;
    EXPECT_NEAR(tipOf(world, 0, Vec2(1.0, 0.05)).x(), exact, 0.03 * exact) << poisson;
  }
}

// Times at which the tip goes up through a height, and its lowest place.
struct Swing {
  std::vector<double> up;
  double lowest = 0.0;
};

Swing swing(World& world, const Vec2& tip, double mean, double duration) {
  Swing s;
  double before = 0.0, timeBefore = 0.0;
  while (world.time() < duration) {
    EXPECT_TRUE(world.substep(1.0 / 240.0).ok());
    const double y = tipOf(world, 0, tip).y();
    s.lowest = std::min(s.lowest, y);
    if (before < mean && y >= mean) {
      s.up.push_back(timeBefore + (mean - before) / (y - before) * (world.time() - timeBefore));
    }
    before = y;
    timeBefore = world.time();
  }
  return s;
}

// soft_cantilever_linear.csv: the thin beam's period is 1.8674 s.
TEST(SoftMotion, a_clamped_strip_swings_at_its_period_and_gains_no_energy) {
  World world(softWorld({cantilever(1.0, 0.1, 4, 1.0e6, 0.3)}, Vec2(0.0, -0.1)));
  const Swing s = swing(world, Vec2(1.0, 0.05), -0.0137, 5.4);
  ASSERT_GE(s.up.size(), 3u);
  EXPECT_NEAR((s.up.back() - s.up.front()) / static_cast<double>(s.up.size() - 1), 1.8674, 0.02 * 1.8674);
  EXPECT_LT(world.ledger().energyDrift, 1e-3);
  EXPECT_LT(world.ledger().dissipation, 0.05 * world.ledger().maxKinetic);
}

// soft_turek_hron_csm3_codes.csv: mean period 0.9151 s, lowest −0.12973; particle methods reach 0.90 and −0.125.
TEST(LongSoftMotion, turek_and_hron_csm3_within_5_percent) {
  SoftDef def = cantilever(0.35, 0.02, 6, 1.4e6, 0.4);
  def.model = SoftModel::StVenantKirchhoff;
  World world(softWorld({def}, Vec2(0.0, -2.0)));
  const Swing s = swing(world, Vec2(0.35, 0.01), -0.065, 3.0);
  ASSERT_EQ(s.up.size(), 3u);
  EXPECT_NEAR(0.5 * (s.up[2] - s.up[0]), 0.9151, 0.05 * 0.9151);
  EXPECT_NEAR(s.lowest, -0.12973, 0.05 * 0.12973);
}

TEST(SoftMotion, a_free_body_keeps_momentum_and_angular_momentum) {
  for (const SoftModel model : {SoftModel::NeoHookean, SoftModel::StVenantKirchhoff}) {
    SoftDef def;
    def.mesh = lattice(0.4, 0.4, 8, 8);
    def.model = model;
    def.position = {0.3, 0.3};
    def.velocity = {0.3, 0.1};
    def.spin = 3.0;
    World world(softWorld({def}, Vec2(0.0, 0.0)));
    const Totals before = world.totals();
    ASSERT_TRUE(world.step(0.5).ok());
    const Totals after = world.totals();
    EXPECT_LT((after.momentum - before.momentum).norm(), 1e-10 * before.momentum.norm());
    EXPECT_NEAR(after.angular, before.angular, 1e-4 * std::abs(before.angular));
    EXPECT_NEAR(after.kinetic + after.strain, before.kinetic + before.strain, 0.01 * before.kinetic);
  }
}

TEST(SoftMotion, a_block_falls_on_the_floor_and_the_books_close) {
  SoftDef def;
  def.mesh = lattice(0.4, 0.4, 8, 8);
  def.young = 2.0e4;
  def.position = {0.8, 0.3};
  def.angle = 0.3;
  World world(softWorld({def}, Vec2(0.0, -9.81)));
  ASSERT_TRUE(world.step(3.0).ok());
  const Ledger& l = world.ledger();
  const Totals t = world.totals();
  EXPECT_LT((t.momentum - l.momentum0 - l.impulse).norm(), 1e-9 * t.mass);
  EXPECT_LT(l.energyDrift, 0.01);
  for (std::size_t i = 0; i < world.soft()->size(); ++i) EXPECT_GT(world.soft()->y()[i], -1e-9);
  EXPECT_NEAR(world.softState(0).center.y(), 0.19, 0.02);
}

TEST(SoftMotion, no_particle_goes_through_a_thin_plate) {
  WorldDef def = softWorld({}, Vec2(0.0, 0.0));
  BodyDef plate;
  plate.name = "plate";
  plate.shape = std::make_shared<Polygon>(Polygon::box({{1.5, 0.0}, {1.501, 2.0}}));
  def.bodies.push_back(plate);
  SoftDef soft;
  soft.mesh = lattice(0.2, 0.2, 8, 8);
  soft.position = {0.5, 0.9};
  soft.velocity = {60.0, 0.0};
  def.soft.push_back(soft);
  World world(def);
  ASSERT_TRUE(world.step(0.05).ok());
  for (std::size_t i = 0; i < world.soft()->size(); ++i) EXPECT_LE(world.soft()->x()[i], 1.5 + 1e-9);
}

WorldDef twoBlocks() {
  SoftDef def;
  def.mesh = lattice(0.4, 0.3, 8, 6);
  def.young = 3.0e4;
  def.damping = 1.0;
  def.position = {0.3, 0.2};
  def.angle = 0.2;
  SoftDef other = def;
  other.model = SoftModel::StVenantKirchhoff;
  other.position = {1.2, 0.1};
  return softWorld({def, other}, Vec2(0.5, -9.81));
}

TEST(SoftState, the_state_hash_is_the_same_on_1_2_3_and_7_threads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      World world(twoBlocks());
      ASSERT_TRUE(world.step(0.3).ok());
      hashes.push_back(world.stateHash());
    });
  }
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes.front());
}

TEST(SoftState, a_loaded_world_goes_on_to_the_same_bits) {
  World whole(twoBlocks()), first(twoBlocks()), second(twoBlocks());
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(whole.substep().ok());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(first.substep().ok());
  MemorySnapshot saved;
  saved.save([&](Archive& a) { first.archive(a); });
  saved.load([&](Archive& a) { second.archive(a); });
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(second.substep().ok());
  EXPECT_EQ(whole.stateHash(), second.stateHash());
}

TEST(SoftState, every_target_gives_the_same_bits) {
  std::vector<std::string> hashes;
  for (const SimdTarget target : supportedSimdTargets()) {
    WorldDef def = twoBlocks();
    def.simd = target;
    World world(def);
    ASSERT_TRUE(world.step(0.1).ok());
    hashes.push_back(world.stateHash());
  }
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes.front());
}

TEST(SoftDefinition, what_cannot_work_is_refused_in_words) {
  SoftDef def;
  def.name = "jelly";
  def.mesh = lattice(0.4, 0.4, 2, 2);
  def.position = {0.5, 0.5};
  def.poisson = 0.5;
  EXPECT_THROW(World(softWorld({def}, Vec2(0.0, 0.0))), Error);
  def.poisson = 0.3;
  def.position = {2.9, 0.5};  // sticks out
  EXPECT_THROW(World(softWorld({def}, Vec2(0.0, 0.0))), Error);
}

}  // namespace
}  // namespace froude
