// Leaks as events. Nothing leaks by itself, so callers put particles where they must not be, or bodies where fluids are
// known not to meet them.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "support/worlds.h"

namespace froude {
namespace {

using testing::body;
using testing::fill;
using testing::fluidWorld;

/// Water at rest beside a block, 0.4 m wide, from (0.6, 0.2) on.
World waterBesideBlock() {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.2, 1.0}}, 0.025);
  def.bodies.push_back(body("block", Polygon::box({{0.0, 0.0}, {0.4, 0.4}}), {0.6, 0.2}));
  World world(def);
  fill(world, {{0.0, 0.0}, {0.5, 0.4}}, 0.025);
  return world;
}

EventSettings leaksOnly() {
  EventSettings settings;
  settings.leaks = true;
  return settings;
}

/// Puts the particle of that handle to a place of the caller's choice.
void put(World& world, ParticleHandle particle, const Vec2& at) {
  ParticlePool& pool = *world.fluid();
  const std::uint32_t i = *pool.indexOf(particle);
  pool.x()[i] = at.x();
  pool.y()[i] = at.y();
  pool.vx()[i] = pool.vy()[i] = 0.0;
}

TEST(LeakEvents, tell_which_particle_is_where_in_what) {
  World world = waterBesideBlock();
  world.record(leaksOnly());
  ASSERT_TRUE(world.substep(0.001).ok());
  EXPECT_TRUE(world.leaks().empty());
  const std::size_t before = std::as_const(world).fluid()->size();
  const ParticleHandle lost = std::as_const(world).fluid()->handleAt(17);
  put(world, lost, {0.63, 0.4});  // 3 cm inside of the block's left face
  ASSERT_TRUE(world.substep(0.001).ok());
  ASSERT_EQ(world.ledger().leaks, 1u);
  ASSERT_EQ(world.leaks().size(), 1u);
  const LeakEvent& leak = world.leaks()[0];
  EXPECT_EQ(leak.species, Species::Fluid);
  EXPECT_EQ(leak.particle, lost);
  EXPECT_EQ(leak.body, world.bodyId(0));
  EXPECT_EQ(leak.from, Vec2(0.63, 0.4));
  EXPECT_NEAR((leak.position - Vec2(0.63, 0.4)).norm(), 0.0, 0.01);
  EXPECT_NEAR(leak.depth, leak.position.x() - 0.6, 1e-12);
  EXPECT_NEAR((leak.boundary - Vec2(0.6, leak.position.y())).norm(), 0.0, 1e-12);
  EXPECT_EQ(leak.time, world.time());
  EXPECT_EQ(std::as_const(world).fluid()->size(), before - 1);
  ASSERT_TRUE(world.substep(0.001).ok());
  EXPECT_TRUE(world.leaks().empty()) << "they are those of the last step";
  EXPECT_EQ(world.ledger().leaks, 1u);
}

TEST(LeakEvents, are_counted_but_not_kept_where_nobody_asks) {
  World world = waterBesideBlock();
  ASSERT_TRUE(world.substep(0.001).ok());
  put(world, std::as_const(world).fluid()->handleAt(3), {0.8, 0.4});
  ASSERT_TRUE(world.substep(0.001).ok());
  EXPECT_EQ(world.ledger().leaks, 1u);
  EXPECT_TRUE(world.leaks().empty());
}

TEST(LeakEvents, change_no_bit_of_the_state_and_come_in_one_order_on_any_number_of_threads) {
  std::vector<LeakEvent> first;
  std::string hash;
  for (const int threads : {1, 2, 7}) {
    for (const bool asked : {true, false}) {
      World world = waterBesideBlock();
      if (asked) world.record(leaksOnly());
      std::vector<LeakEvent> all;
      tbb::task_arena(threads).execute([&] {
        for (int k = 0; k < 5; ++k) {
          for (std::uint32_t j = 0; j < 6; ++j)
            put(world, std::as_const(world).fluid()->handleAt(40 * j + 5), {0.62 + 0.05 * j, 0.3 + 0.02 * k});
          ASSERT_TRUE(world.substep(0.001).ok());
          all.insert(all.end(), world.leaks().begin(), world.leaks().end());
        }
      });
      EXPECT_EQ(world.ledger().leaks, 30u);
      if (hash.empty()) hash = world.stateHash();
      EXPECT_EQ(world.stateHash(), hash) << threads;
      if (!asked) {
        EXPECT_TRUE(all.empty());
        continue;
      }
      if (first.empty()) first = all;
      ASSERT_EQ(all.size(), 30u);
      for (std::size_t k = 0; k < all.size(); ++k) {
        EXPECT_EQ(all[k].particle, first[k].particle);
        EXPECT_EQ(all[k].position, first[k].position);
      }
    }
  }
}

TEST(LeakEvents, a_step_tells_those_of_all_its_sub_steps) {
  World world = waterBesideBlock();
  world.record(leaksOnly());
  ASSERT_TRUE(world.step(0.01).ok());
  put(world, std::as_const(world).fluid()->handleAt(0), {0.8, 0.4});
  ASSERT_TRUE(world.step(0.05).ok());
  EXPECT_EQ(world.leaks().size(), world.ledger().leaks);
  EXPECT_EQ(world.leaks().size(), 1u);
}

}  // namespace
}  // namespace froude
