// Weakly compressible SPH: vortices, momentum, a start at rest, its keys, the same bits.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <froude/base/archive.h>
#include <froude/base/error.h>

#include "support/fluid_methods.h"

namespace froude {
namespace {

using testing::fill;
using testing::momentumError;
using testing::runTo;

WorldDef wcsphWorld(const Box& domain, double dx) {
  WorldDef def = testing::fluidWorld(domain, dx);
  def.fluid->model = "wcsph";
  return def;
}

// Taylor & Green 1937: in a periodic square the vortices keep their shape, and their energy falls by exp(−16π²νt).
World vortices(double dx, const CompressibleDef& compressible = {}) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {1.0, 1.0}}, dx);
  def.domain.periodicX = def.domain.periodicY = true;
  def.gravity = {0.0, 0.0};
  def.fluid->viscosity = 0.01;
  def.fluid->compressible = compressible;
  World world(def);
  const std::vector<Vec2> points = testing::latticePoints(def.domain.box, dx);
  std::vector<Vec2> velocities;
  for (const Vec2& p : points) {
    const Vec2 k = 2.0 * kPi * p;
    velocities.push_back({-std::cos(k.x()) * std::sin(k.y()), std::sin(k.x()) * std::cos(k.y())});
  }
  world.addFluid(points, velocities);
  return world;
}

double velocityError(const World& world) {
  const ParticlePool& pool = *world.fluid();
  const double share = std::exp(-8.0 * kPi * kPi * 0.01 * world.time());
  double wrong = 0.0, all = 0.0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    const Vec2 k = 2.0 * kPi * Vec2(pool.x()[i], pool.y()[i]);
    const Vec2 exact = share * Vec2(-std::cos(k.x()) * std::sin(k.y()), std::sin(k.x()) * std::cos(k.y()));
    wrong += (Vec2(pool.vx()[i], pool.vy()[i]) - exact).squaredNorm();
    all += exact.squaredNorm();
  }
  return std::sqrt(wrong / all);
}

TEST(Wcsph, vortices_decay_as_they_should_and_twice_the_spacings_have_less_than_two_thirds_of_the_error) {
  std::vector<double> errors;
  for (const double dx : {0.04, 0.02}) {
    World world = vortices(dx);
    runTo(world, 1.0);
    errors.push_back(velocityError(world));
  }
  EXPECT_LT(errors[1], 0.12);
  EXPECT_LT(errors[1], 0.67 * errors[0]);
}

TEST(Wcsph, taits_equation_and_a_background_pressure_give_the_same_vortices) {
  CompressibleDef tait, pressed;
  tait.equation = EquationOfState::Tait;
  pressed.backgroundPressure = 200.0;
  for (const CompressibleDef& def : {tait, pressed}) {
    World world = vortices(0.04, def);
    runTo(world, 0.3);
    EXPECT_LT(velocityError(world), 0.15);
  }
}

TEST(Wcsph, artificial_viscosity_takes_the_energy_that_its_kinematic_viscosity_says) {
  CompressibleDef def;
  def.artificialViscosity = 0.04;
  def.soundSpeed = 10.0;
  World plain = vortices(0.04), viscous = vortices(0.04, def);
  runTo(plain, 0.1);
  runTo(viscous, 0.1);
  const double added = 0.04 * 10.0 * (1.5 * 0.04) / 8.0;  // α c h/8, h = half of three spacings
  const double ratio = viscous.totals().kinetic / plain.totals().kinetic;
  EXPECT_NEAR(std::log(ratio), -16.0 * kPi * kPi * added * 0.1, 0.15 * 16.0 * kPi * kPi * added * 0.1);
}

TEST(Wcsph, what_a_blob_gives_to_a_wall_is_in_the_books) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {2.0, 1.0}}, 0.02);
  World world(def);
  fill(world, {{0.0, 0.0}, {0.4, 0.6}}, 0.02);
  runTo(world, 0.6);
  EXPECT_LT(momentumError(world), 1e-6);
  EXPECT_EQ(world.ledger().leaks, 0u);
  EXPECT_EQ(world.ledger().crushed, 0u);
}

TEST(Wcsph, water_that_is_let_go_in_a_tank_has_its_pressure_at_once_and_stays) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {0.5, 0.8}}, 0.0125);
  World world(def);
  fill(world, {{0.0, 0.0}, {0.5, 0.5}}, 0.0125);
  const double kG = 9.81, wave = std::sqrt(kG * 0.5);
  runTo(world, 0.01);
  const ParticlePool& pool = *world.fluid();
  double pressure = 0.0, count = 0.0;
  const auto column = pool.column(*pool.findColumn<float>("pressure"));
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (std::abs(pool.y()[i] - 0.25) > 0.02) continue;
    pressure += static_cast<double>(column[i]);
    count += 1.0;
  }
  EXPECT_NEAR(pressure / count, kG * 0.25, 0.05 * kG * 0.25);
  runTo(world, 0.5);
  EXPECT_LT(testing::meanSpeed(world), 0.01 * wave);
}

// A row of particles swings against a wall that stands still for too long; it is in corners that this shows first.
TEST(Wcsph, water_round_a_step_stays_where_it_is) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {0.5, 0.5}}, 0.0125);
  def.bodies.push_back(testing::body("step", Polygon::box({{0.25, 0.0}, {0.5, 0.1}}), {0.0, 0.0}));
  World world(def);
  fill(world, {{0.0, 0.0}, {0.25, 0.4}}, 0.0125);
  fill(world, {{0.25, 0.1}, {0.5, 0.4}}, 0.0125);
  const double wave = std::sqrt(9.81 * 0.4);
  for (const double t : {0.1, 0.4}) {
    runTo(world, t);
    EXPECT_LT(testing::meanSpeed(world), 0.01 * wave);
    EXPECT_LT(world.totals(Species::Fluid).kinetic, 0.5 * world.totals().mass * 0.015 * 0.015 * wave * wave);
  }
  EXPECT_EQ(world.ledger().wallHits, 0u);
}

// Colagrossi's patch: pressures below zero inside pull its sides in; its rows must not stay behind.
TEST(Wcsph, a_square_that_turns_stays_whole) {
  constexpr double kSpacing = 0.025;
  WorldDef def = wcsphWorld({{-2.0, -2.0}, {2.0, 2.0}}, kSpacing);
  def.domain.closed = {false, false, false, false};
  def.gravity = {0.0, 0.0};
  World world(def);
  const std::vector<Vec2> points = testing::latticePoints({{-0.5, -0.5}, {0.5, 0.5}}, kSpacing);
  std::vector<Vec2> turning;
  for (const Vec2& p : points) turning.emplace_back(p.y(), -p.x());
  world.addFluid(points, turning);
  const double angular = world.totals().angular;
  runTo(world, 0.01);
  EXPECT_NEAR(world.pressureAt({0.0, 0.0}), -0.1473427 * 1000.0,
              0.05 * 147.3427);  // ρ ω² L², series of Poisson's equation
  runTo(world, 1.5);
  EXPECT_NEAR(world.totals().angular, angular, 0.02 * std::abs(angular));
  const ParticlePool& pool = *std::as_const(world).fluid();
  int alone = 0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    double nearest = 1.0;
    for (std::size_t j = 0; j < pool.size(); ++j) {
      if (j != i) nearest = std::min(nearest, std::hypot(pool.x()[i] - pool.x()[j], pool.y()[i] - pool.y()[j]));
    }
    alone += nearest > 2.0 * kSpacing ? 1 : 0;
  }
  EXPECT_EQ(alone, 0);
}

TEST(Wcsph, the_same_bits_on_any_number_of_threads_and_from_a_saved_state) {
  std::string first;
  for (const int threads : {1, 2, 3}) {
    tbb::task_arena(threads).execute([&] {
      WorldDef def = wcsphWorld({{0.0, 0.0}, {1.2, 1.0}}, 0.01);
      World world(def), other(def);
      for (World* w : {&world, &other}) fill(*w, {{0.0, 0.0}, {0.4, 0.6}}, 0.01);
      for (int k = 0; k < 12; ++k) world.substep();
      MemorySnapshot state;
      state.save([&](Archive& a) { world.archive(a); });
      for (int k = 0; k < 12; ++k) world.substep();
      if (first.empty()) first = world.stateHash();
      EXPECT_EQ(world.stateHash(), first) << threads << " threads";
      state.load([&](Archive& a) { other.archive(a); });
      for (int k = 0; k < 12; ++k) other.substep();
      EXPECT_EQ(other.stateHash(), first) << "resumed on " << threads << " threads";
    });
  }
}

// Sound hundreds of times as fast as anything moves: a sub-step is as many acoustic steps as one may be.
TEST(Wcsph, a_saved_state_goes_on_with_the_same_bits_where_sound_binds_the_step) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {0.5, 0.8}}, 0.02);
  def.fluid->compressible.soundSpeed = 300.0;
  def.gravity = {0.0, 0.0};  // or pressures would bind it
  World world(def), other(def);
  const std::vector<Vec2> points = testing::latticePoints({{0.1, 0.2}, {0.4, 0.6}}, 0.02);
  std::vector<Vec2> velocities;
  for (const Vec2& p : points) velocities.emplace_back(0.1 * (p.x() - 0.25), 0.1 * (0.4 - p.y()));
  for (World* w : {&world, &other}) w->addFluid(points, velocities);
  StepReport report;
  for (int k = 0; k < 5; ++k) report = world.substep();
  EXPECT_EQ(report.limit, StepLimit::Acoustic);
  MemorySnapshot state;
  state.save([&](Archive& a) { world.archive(a); });
  state.load([&](Archive& a) { other.archive(a); });
  for (int k = 0; k < 5; ++k) {
    world.substep();
    other.substep();
  }
  EXPECT_EQ(world.stateHash(), other.stateHash());
}

TEST(Wcsph, what_a_nozzle_carries_goes_its_way_and_its_momentum_is_in_the_books) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {1.0, 0.8}}, 0.02);
  def.emitters.push_back(testing::nozzle({0.3, 0.5}, {0.3, 0.3}, 1.0, 400));
  World world(def);
  runTo(world, 0.2);
  EXPECT_GT(world.fluid()->size(), 30u);
  EXPECT_LT(momentumError(world), 1e-6);
}

TEST(Wcsph, what_it_has_not_is_refused) {
  WorldDef def = wcsphWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  def.fluid->compressible.support = 1.5;
  EXPECT_THROW(World{def}, Error);
}

}  // namespace
}  // namespace froude
