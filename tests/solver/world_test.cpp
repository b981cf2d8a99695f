// The world as a whole: same bits, save and load, undo, what comes and goes, and what the ledger says of it.
#include <froude/solver/world.h>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "support/fluid_methods.h"

namespace {
std::atomic<std::size_t> allocations{0};  // of all threads
}

// Counts every allocation of this test program; the sanitizers bring their own operators. Not inlined, or the compiler
// sees memory of `new` go to `free`, and warns.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FROUDE_COUNTS_ALLOCATIONS 1
[[gnu::noinline]] void* operator new(std::size_t n) {
  ++allocations;
  if (void* p = std::malloc(n)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t n, std::align_val_t a) {
  ++allocations;
  const auto align = static_cast<std::size_t>(a);
  if (void* p = std::aligned_alloc(align, (n + align - 1) / align * align)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
#endif

namespace froude {
namespace {

using testing::body;
using testing::busyWorld;
using testing::fill;
using testing::fluidWorld;

void run(World& world, int substeps) {
  for (int i = 0; i < substeps; ++i) ASSERT_TRUE(world.substep().ok());
}

using FluidWorld = testing::FluidMethod;
INSTANTIATE_TEST_SUITE_P(Each, FluidWorld, testing::kFluidMethods, testing::methodName);

TEST_P(FluidWorld, the_state_hash_is_the_same_on_1_2_3_and_7_threads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      World world = busyWorld(GetParam());
      run(world, 120);
      hashes.push_back(world.stateHash());
    });
  }
  for (const std::string& h : hashes) EXPECT_EQ(h, hashes.front());
}

TEST_P(FluidWorld, a_loaded_state_goes_on_as_if_it_had_never_been_saved) {
  World straight = busyWorld(GetParam());
  run(straight, 130);
  for (const int at : {1, 37, 90}) {
    World first = busyWorld(GetParam());
    run(first, at);
    MemorySnapshot snapshot;
    snapshot.save([&](Archive& a) { first.archive(a); });
    World second = busyWorld(GetParam());
    run(second, 5);  // something else in the way
    snapshot.load([&](Archive& a) { second.archive(a); });
    EXPECT_EQ(second.stateHash(), first.stateHash());
    tbb::task_arena arena(3);
    arena.execute([&] { run(second, 130 - at); });
    EXPECT_EQ(second.stateHash(), straight.stateHash()) << "saved after " << at;
  }
}

TEST_P(FluidWorld, asking_questions_alters_nothing) {
  World asked = busyWorld(GetParam()), silent = busyWorld(GetParam());
  std::vector<Vec2> points(50, Vec2(0.2, 0.3));
  std::vector<double> phi(points.size());
  for (int i = 0; i < 60; ++i) {
    asked.substep();
    silent.substep();
    asked.filledFraction(points, phi);
    EXPECT_TRUE(std::isfinite(asked.pressureAt({0.2, 0.1}) + asked.totals().kinetic));
  }
  EXPECT_EQ(asked.stateHash(), silent.stateHash());
}

#ifdef FROUDE_COUNTS_ALLOCATIONS
TEST_P(FluidWorld, a_steady_step_allocates_nothing) {
  World world = busyWorld(GetParam());
  run(world, 1500);  // buffers have met their largest splash
  const std::size_t before = allocations;
  for (int i = 0; i < 50; ++i) world.substep();
  EXPECT_EQ(allocations - before, 0u);
}

// With the contact solver, the coupling and the snapshot that undoes a bad step.
TEST_P(FluidWorld, a_steady_step_with_floating_and_resting_bodies_allocates_nothing) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.6, 1.2}}, 0.025);
  const auto square = [&](const std::string& name, const Vec2& at, double density) {
    BodyDef b = body(name, Polygon::box({{-0.1, -0.1}, {0.1, 0.1}}), at);
    b.motion = Motion::Free;
    b.density = density;
    def.bodies.push_back(b);
  };
  square("raft", {0.5, 0.55}, 500.0);
  square("cargo", {0.5, 0.75}, 50.0);
  square("stone", {1.2, 0.1}, 3000.0);
  World world(def);
  fill(world, {{0.0, 0.0}, {1.0, 0.45}}, 0.025);
  run(world, 1500);
  const std::size_t before = allocations;
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(world.substep().ok());
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(world.step(0.02).ok());
  EXPECT_EQ(allocations - before, 0u);
}

TEST(World, a_steady_step_that_solves_for_viscosity_allocates_nothing) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.2, 1.0}}, 0.025);
  def.fluid->viscosity = 0.5;
  def.domain.slip = Slip::NoSlip;
  BodyDef raft = body("raft", Polygon::box({{-0.1, -0.1}, {0.1, 0.1}}), {0.5, 0.6});
  raft.motion = Motion::Free;
  raft.density = 500.0;
  def.bodies.push_back(raft);
  World world(def);
  fill(world, {{0.0, 0.0}, {1.2, 0.45}}, 0.025);
  run(world, 800);
  const std::size_t before = allocations;
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(world.substep().ok());
  EXPECT_EQ(allocations - before, 0u);
}
#endif

TEST_P(FluidWorld, every_instruction_set_tells_the_same_story) {
  World reference = busyWorld(GetParam(), SimdTarget::Scalar);
  run(reference, 40);
  for (const SimdTarget target : supportedSimdTargets()) {
    World world = busyWorld(GetParam(), target);
    run(world, 40);
    EXPECT_NEAR(world.time(), reference.time(), 1e-3 * reference.time()) << name(target);
    EXPECT_NEAR(world.totals(Species::Fluid).potential, reference.totals(Species::Fluid).potential,
                2e-3 * reference.totals(Species::Fluid).potential)
        << name(target);
  }
}

TEST_P(FluidWorld, what_comes_and_goes_is_counted_and_momentum_closes) {
  World world = busyWorld(GetParam());
  run(world, 500);
  const Ledger& ledger = world.ledger();
  EXPECT_GT(ledger.emitted, 100u);
  EXPECT_GT(ledger.recycled, 0u);
  EXPECT_GT(ledger.expired, 0u);
  EXPECT_EQ(ledger.leaks, 0u);
  EXPECT_EQ(ledger.quarantined, 0u);
  const Totals totals = world.totals();
  const Vec2 missing = totals.momentum - ledger.momentum0 - ledger.impulse;
  // wcsph sums displacements in single precision over acoustic steps.
  EXPECT_LT(missing.norm() / (totals.mass * ledger.maxSpeed), wcsph() ? 1e-6 : 1e-7);
  const std::size_t start = 16 * 32;
  EXPECT_EQ(totals.count,
            start + ledger.emitted - ledger.recycled - ledger.expired - ledger.retired - ledger.sunk - ledger.crushed);
}

TEST_P(FluidWorld, a_broken_particle_is_quarantined_and_counted) {
  World world = busyWorld(GetParam());
  run(world, 3);
  world.fluid()->vx()[17] = std::nan("");
  run(world, 3);
  EXPECT_EQ(world.ledger().quarantined, 1u);
  EXPECT_TRUE(std::isfinite(world.totals().kinetic));
}

TEST(World, a_literal_step_that_is_far_too_long_is_refused_and_the_last_sound_state_kept) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  def.timeStep = 0.2;
  World world(def);
  fill(world, {{0.0, 0.0}, {0.4, 0.8}}, 0.02);
  StepReport report;
  for (int i = 0; i < 20 && report.ok(); ++i) report = world.substep();
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.substeps, 0);
  EXPECT_GT(report.troubleValue, report.troubleLimit);
  EXPECT_TRUE(std::isfinite(world.totals().kinetic));
  const double time = world.time(), kinetic = world.totals().kinetic;
  EXPECT_FALSE(world.substep().ok());
  EXPECT_EQ(world.time(), time);
  EXPECT_EQ(world.totals().kinetic, kinetic);
}

TEST_P(FluidWorld, stepping_by_a_frame_ends_at_the_frame) {
  World world = busyWorld(GetParam());
  for (int i = 1; i <= 6; ++i) {
    const StepReport report = world.step(1.0 / 60.0);
    EXPECT_TRUE(report.ok());
    EXPECT_NEAR(world.time(), i / 60.0, 1e-12);
  }
  EXPECT_EQ(world.ledger().steps, 6u);
}

TEST(World, a_bullet_flies_a_parabola_and_bounces_by_its_restitution) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {10.0, 10.0}};
  def.bullet = BulletDef{};
  def.bullet->radius = 0.01;
  def.bullet->restitution = 0.5;
  World world(def);
  world.addBullets(std::vector<Vec2>{{1.0, 2.01}}, std::vector<Vec2>{{1.0, 0.0}});
  const double fall = std::sqrt(2.0 * 2.0 / 9.81);
  while (world.time() < fall - 0.02) world.substep();
  EXPECT_NEAR(world.bullets()->y()[0], 2.01 - 0.5 * 9.81 * world.time() * world.time(), 1e-12);
  double highest = 0.0;
  while (world.time() < 2.0 * fall) {
    world.substep();
    if (world.time() > 1.1 * fall) highest = std::max(highest, world.bullets()->y()[0]);
  }
  EXPECT_NEAR(highest - 0.01, 2.0 * 0.25, 0.02);  // e² of the height; contacts lie on the chord of a step
  EXPECT_NEAR(world.bullets()->x()[0], 1.0 + world.time(), 1e-9);  // no friction
}

TEST(World, a_conveyor_carries_what_rests_on_it) {
  WorldDef def;
  def.domain.box = {{-5.0, -1.0}, {5.0, 1.0}};
  def.bullet = BulletDef{};
  def.bullet->friction = 0.5;
  def.bullet->restitution = 0.0;
  BodyDef belt = body("belt", Polygon::box({{-4.0, -0.1}, {4.0, 0.0}}), {0.0, 0.0});
  belt.surfaceVelocity = -0.7;  // along the edge counter-clockwise: the top runs to the left at −0.7 of it
  belt.friction = 0.5;
  belt.restitution = 0.0;
  def.bodies.push_back(belt);
  World world(def);
  world.addBullets(std::vector<Vec2>{{0.0, 0.01}}, std::vector<Vec2>{{0.0, 0.0}});
  while (world.time() < 1.0) world.substep();
  EXPECT_NEAR(world.bullets()->vx()[0], 0.7, 1e-6);
  EXPECT_GT(world.ledger().work, 0.0);
}

TEST(World, definitions_that_cannot_work_are_refused_in_words) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.05);
  def.fluid->model = "magic";
  EXPECT_THROW(World{def}, Error);
  def.fluid->model = "pbf";
  World world(def);
  EXPECT_THROW(world.addBullets({}, {}), Error);
  EXPECT_THROW(world.addFluid(std::vector<Vec2>{{2.0, 0.5}}, std::vector<Vec2>{{0.0, 0.0}}), Error);
  EXPECT_THROW(static_cast<void>(world.bodyIndex("gate")), Error);
}

}  // namespace
}  // namespace froude
