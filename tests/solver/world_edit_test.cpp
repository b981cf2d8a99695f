// What callers change between steps: bodies that come, go and are moved, particles added and taken away, user columns.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <map>

#include <froude/solver/world.h>
#include "support/worlds.h"

namespace froude {
namespace {

using testing::body;
using testing::busyWorld;
using testing::fill;
using testing::fluidWorld;

WorldDef bulletWorld() {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {4.0, 4.0}};
  def.gravity = {0.0, 0.0};
  def.bullet = BulletDef{};
  def.bullet->radius = 0.01;
  return def;
}

BodyDef paddle(const std::string& name, const Vec2& position) {
  BodyDef def = body(name, Polygon::box({{-0.1, -0.02}, {0.1, 0.02}}), position);
  def.motion = Motion::Scripted;
  return def;
}

std::vector<ParticleHandle> shoot(World& world, const Vec2& from, const Vec2& velocity) {
  return world.addBullets(std::vector<Vec2>{from}, std::vector<Vec2>{velocity});
}

// Bodies of all kinds come and go while a column falls; the same calls in the same frames.
void frame(World& world, int k) {
  if (k == 2) world.createBody(paddle("made", {0.5, 0.6}));
  if (k == 4) world.createBody(body("block", Polygon::regular(5, 0.06), {1.2, 0.2}));
  if (k == 5) world.destroyBody(world.bodyId(world.bodyIndex("octagon")));
  if (k == 6) {
    world.setBodyVelocity(world.bodyId(world.bodyIndex("made")), {0.3, -0.1}, 2.0);
    world.createBody(body(
        "late", Polygon::make({{0, 0}, {0.2, 0}, {0.2, 0.2}, {0, 0.2}}, {{{0.05, 0.05}, {0.1, 0.15}, {0.15, 0.05}}}),
        {0.9, 0.7}));
  }
  if (k == 8) world.placeBody(world.bodyId(world.bodyIndex("block")), {0.3, 0.5}, 0.4);
  if (k == 9) {
    std::vector<Vec2> points = testing::latticePoints({{0.8, 0.9}, {1.0, 1.1}}, 0.025);
    world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.5, 0.0)));
    world.kill(Species::Fluid, Disc{{0.2, 0.1}, 0.05});
  }
  ASSERT_TRUE(world.step(0.01).ok());
}

constexpr int kFrames = 14;

TEST(WorldEdit, bodies_that_come_and_go_leave_the_same_bits_on_1_2_3_and_7_threads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      World world = busyWorld();
      for (int k = 0; k < kFrames; ++k) frame(world, k);
      EXPECT_EQ(world.ledger().leaks, 0u);
      hashes.push_back(world.stateHash());
    });
  }
  for (const std::string& h : hashes) EXPECT_EQ(h, hashes.front());
}

TEST(WorldEdit, a_state_with_created_and_destroyed_bodies_is_loaded_into_a_world_without_them) {
  World straight = busyWorld();
  for (int k = 0; k < kFrames; ++k) frame(straight, k);
  for (const int at : {1, 3, 5, 7, 9, 10, 13}) {
    World first = busyWorld();
    for (int k = 0; k < at; ++k) frame(first, k);
    MemorySnapshot snapshot;
    snapshot.save([&](Archive& a) { first.archive(a); });
    World second = busyWorld();
    second.createBody(paddle("something else", {1.3, 0.9}));
    second.step(0.02);
    snapshot.load([&](Archive& a) { second.archive(a); });
    EXPECT_EQ(second.stateHash(), first.stateHash());
    EXPECT_EQ(second.bodyCount(), first.bodyCount());
    for (std::size_t i = 0; i < first.bodyCount(); ++i) EXPECT_EQ(second.bodyId(i), first.bodyId(i));
    for (int k = at; k < kFrames; ++k) frame(second, k);
    EXPECT_EQ(second.stateHash(), straight.stateHash()) << "saved after " << at;
  }
}

TEST(WorldEdit, the_state_hash_knows_which_bodies_there_are) {
  World one(bulletWorld()), other(bulletWorld());
  const BodyId id = one.createBody(body("block", Polygon::regular(5, 0.2), {2.0, 2.0}));
  EXPECT_NE(one.stateHash(), other.stateHash());
  other.createBody(body("block", Polygon::regular(6, 0.2), {2.0, 2.0}));
  EXPECT_NE(one.stateHash(), other.stateHash());
  World third(bulletWorld());
  third.createBody(body("block", Polygon::regular(5, 0.2), {2.0, 2.0}));
  EXPECT_EQ(one.stateHash(), third.stateHash());
  one.destroyBody(id);
  EXPECT_NE(one.stateHash(), World(bulletWorld()).stateHash()) << "the slot has a history";
}

TEST(WorldEdit, ids_last_while_indices_move_down_and_stale_ones_are_refused_in_words) {
  World world(bulletWorld());
  std::vector<BodyId> ids;
  for (int i = 0; i < 4; ++i) {
    ids.push_back(world.createBody(body("b" + std::to_string(i), Polygon::regular(4, 0.1), {0.5 + i, 1.0})));
  }
  world.destroyBody(ids[1]);
  EXPECT_FALSE(world.isAlive(ids[1]));
  EXPECT_EQ(world.bodyCount(), 3u);
  EXPECT_EQ(world.bodyIndex(ids[2]), 1u);
  EXPECT_EQ(world.bodyDefinition(ids[3]).name, "b3");
  EXPECT_EQ(world.body(ids[3]).transform.position, Vec2(3.5, 1.0));
  const BodyId again = world.createBody(body("new", Polygon::regular(4, 0.1), {1.5, 1.0}));
  EXPECT_NE(again, ids[1]);
  EXPECT_EQ(world.bodyAt({1.5, 1.0}), again);
  EXPECT_EQ(world.bodyIndex("new"), 3u);
  for (const BodyId bad : {BodyId{}, ids[1], BodyId{99, 1}, BodyId{0, 2}}) {
    EXPECT_THROW(world.destroyBody(bad), Error);
    EXPECT_THROW(world.placeBody(bad, {1.0, 1.0}, 0.0), Error);
    EXPECT_THROW(static_cast<void>(world.body(bad)), Error);
    EXPECT_FALSE(world.isAlive(bad));
  }
  EXPECT_THROW(static_cast<void>(world.bodyId(7)), Error);
}

TEST(WorldEdit, a_definition_that_cannot_work_changes_nothing) {
  World world(bulletWorld());
  const BodyId fixed = world.createBody(body("fixed", Polygon::regular(4, 0.1), {1.0, 1.0}));
  const std::string before = world.stateHash();
  BodyDef bad = paddle("bad", {1.0, 1.0});
  bad.position.x() = std::nan("");
  EXPECT_THROW(world.createBody(bad), Error);
  bad = BodyDef{};
  EXPECT_THROW(world.createBody(bad), Error);
  EXPECT_THROW(world.setBodyVelocity(fixed, {1.0, 0.0}, 0.0), Error);
  EXPECT_THROW(world.placeBody(fixed, {kInfinity, 0.0}, 0.0), Error);
  EXPECT_THROW(world.addFluid({}, {}), Error);
  EXPECT_THROW(shoot(world, {1.0, 1.0}, {0.0, 0.0}), Error);
  EXPECT_EQ(world.stateHash(), before);
}

TEST(WorldEdit, definitions_that_would_break_a_step_are_refused_before_it) {
  const WorldDef good = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.05);
  WorldDef bad = good;
  bad.sinks.push_back({});
  EXPECT_THROW(World{bad}, Error);
  bad = good;
  bad.gravity.x() = kInfinity;
  EXPECT_THROW(World{bad}, Error);
  bad = good;
  bad.domain.periodicX = true;
  bad.fluid->spacing = 0.13;
  EXPECT_THROW(World{bad}, Error);
  bad.fluid->spacing = 0.125;
  World narrow(bad);
  fill(narrow, {{0.0, 0.0}, {1.0, 0.5}}, 0.125);
  EXPECT_TRUE(narrow.step(0.01).ok());
  EXPECT_EQ(narrow.step(kInfinity).substeps + narrow.step(std::nan("")).substeps + narrow.step(-1.0).substeps, 0);
}

TEST(WorldEdit, what_cannot_be_right_is_refused_when_it_comes_in) {
  WorldDef def = bulletWorld();
  def.bullet->restitution = 5.0;
  EXPECT_THROW(World{def}, Error);
  WorldDef fluid = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.05);
  fluid.fluid->viscosity = -1.0;
  EXPECT_THROW(World{fluid}, Error);
  fluid.fluid->viscosity = 0.0;
  for (const double tension : {-0.07, kInfinity, std::nan("")}) {
    fluid.fluid->surfaceTension = tension;
    EXPECT_THROW(World{fluid}, Error);
  }
  fluid.fluid->surfaceTension = 0.07;
  for (const double angle : {-0.1, 3.2, std::nan("")}) {
    fluid.fluid->contactAngle = angle;
    EXPECT_THROW(World{fluid}, Error);
  }
  World world(bulletWorld());
  EXPECT_THROW(shoot(world, {1.0, 1.0}, {std::nan(""), 0.0}), Error);
  shoot(world, {1.0, 1.0}, {1.0, 0.0});
  const std::string before = world.stateHash();
  for (const double dt : {0.0, -1.0, std::nan("")}) {
    const StepReport report = world.substep(dt);
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.substeps, 0);
  }
  EXPECT_EQ(world.stateHash(), before);
}

TEST(WorldEdit, a_body_by_call_meets_particles_like_one_of_the_definition) {
  for (const bool moving : {false, true}) {
    const BodyDef wall =
        moving ? paddle("wall", {2.0, 1.0}) : body("wall", Polygon::box({{-0.1, -0.02}, {0.1, 0.02}}), {2.0, 1.0});
    WorldDef def = bulletWorld();
    World byCall(def);
    byCall.createBody(wall);
    def.bodies.push_back(wall);
    World byDefinition(def);
    for (World* world : {&byCall, &byDefinition}) {
      shoot(*world, {2.03, 2.0}, {0.0, -3.0});
      for (int k = 0; k < 50; ++k) ASSERT_TRUE(world->step(0.01).ok());
    }
    EXPECT_GT(byCall.bullets()->vy()[0], 0.0);
    EXPECT_EQ(byCall.bullets()->y()[0], byDefinition.bullets()->y()[0]);
  }
}

TEST(WorldEdit, a_destroyed_body_is_flown_through_and_a_placed_one_is_met_where_it_stands) {
  World world(bulletWorld());
  const BodyId gone = world.createBody(body("gone", Polygon::box({{-0.5, -0.1}, {0.5, 0.1}}), {1.0, 2.0}));
  const BodyId put = world.createBody(body("put", Polygon::box({{-0.5, -0.1}, {0.5, 0.1}}), {1.0, 1.0}));
  world.destroyBody(gone);
  world.placeBody(put, {3.0, 1.0}, kPi / 2);
  shoot(world, {1.0, 3.0}, {0.0, -4.0});
  shoot(world, {2.0, 1.2}, {4.0, 0.0});
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(world.step(0.01).ok());
  EXPECT_LT(world.bullets()->y()[0], 1.5);
  EXPECT_LT(world.bullets()->vx()[1], 0.0) << "turned by a right angle it stands in the way";
}

TEST(WorldEdit, a_steered_body_arrives_and_pushes_what_is_in_its_way) {
  World world(bulletWorld());
  const BodyId id = world.createBody(paddle("piston", {1.0, 1.0}));
  shoot(world, {1.3, 1.0}, {0.0, 0.0});
  for (int k = 1; k <= 20; ++k) {
    world.steerBody(id, {1.0 + 0.05 * k, 1.0}, 0.0, 1.0 / 60.0);
    ASSERT_TRUE(world.step(1.0 / 60.0).ok());
    EXPECT_NEAR(world.body(id).transform.position.x(), 1.0 + 0.05 * k, 1e-12);
  }
  EXPECT_GT(world.bullets()->vx()[0], 2.9);
  EXPECT_EQ(world.ledger().crushed, 0u);
  EXPECT_GT(world.ledger().work, 0.0);
}

TEST(WorldEdit, what_stands_where_a_body_is_put_is_crushed_unless_it_does_not_collide) {
  WorldDef def = bulletWorld();
  def.bullet->group = 2;
  World world(def);
  shoot(world, {1.0, 1.0}, {0.0, 0.0});
  shoot(world, {1.205, 1.0}, {0.0, 0.0});  // its disc reaches in, its centre does not
  shoot(world, {1.3, 1.0}, {0.0, 0.0});
  world.step(0.01);
  BodyDef block = body("block", Polygon::box({{-0.2, -0.2}, {0.2, 0.2}}), {1.0, 1.0});
  block.collidesWith = 1;
  const BodyId ghost = world.createBody(block);
  EXPECT_EQ(world.bullets()->size(), 3u);
  world.step(0.01);
  EXPECT_EQ(world.bullets()->size(), 3u);
  EXPECT_NO_THROW(shoot(world, {1.0, 1.1}, {0.0, 0.0})) << "what passes may also begin inside";
  world.destroyBody(ghost);
  block.collidesWith = 2;
  world.createBody(block);
  EXPECT_EQ(world.bullets()->size(), 1u);
  EXPECT_EQ(world.ledger().crushed, 3u);
}

TEST(WorldEdit, a_fluid_falls_through_what_it_does_not_collide_with_and_rests_on_what_it_does) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {0.4, 1.0}}, 0.02);
  def.fluid->group = 4;
  World world(def);
  BodyDef shelf = body("shelf", Polygon::box({{-0.2, -0.02}, {0.2, 0.02}}), {0.2, 0.5});
  shelf.collidesWith = ~4u;
  world.createBody(shelf);
  shelf.position.y() = 0.2;
  shelf.collidesWith = 4;
  const BodyId stops = world.createBody(shelf);
  fill(world, {{0.1, 0.44}, {0.3, 0.6}}, 0.02);
  for (int k = 0; k < 60; ++k) ASSERT_TRUE(world.step(0.01).ok());
  const ParticlePool& pool = *std::as_const(world).fluid();
  EXPECT_EQ(pool.size(), 80u);
  std::size_t low = 0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    EXPECT_GT(pool.y()[i], 0.22);
    low += pool.y()[i] < 0.45 ? 1 : 0;
  }
  EXPECT_GT(low, 60u) << "all but the splash";
  EXPECT_LT(world.body(stops).force.y(), -0.5 * world.totals().mass * 9.81);
  EXPECT_EQ(world.ledger().leaks + world.ledger().crushed, 0u);
}

TEST(WorldEdit, a_body_across_a_periodic_side_crushes_and_holds_on_both_ends) {
  WorldDef def = bulletWorld();
  def.domain.periodicX = true;
  World world(def);
  shoot(world, {0.1, 1.0}, {0.0, 0.0});
  shoot(world, {3.9, 1.0}, {0.0, 0.0});
  shoot(world, {2.0, 1.0}, {0.0, 0.0});
  world.step(0.01);
  const BodyId id = world.createBody(body("block", Polygon::box({{-0.3, -0.3}, {0.3, 0.3}}), {4.0, 1.0}));
  EXPECT_EQ(world.ledger().crushed, 2u);
  EXPECT_EQ(world.bullets()->size(), 1u);
  EXPECT_EQ(world.bodyAt({3.8, 1.0}), id);
  EXPECT_EQ(world.bodyAt({0.1, 1.0}), id);
  EXPECT_TRUE(world.bodyAt({0.5, 1.0}).isNull());
}

TEST(WorldEdit, particles_added_and_killed_between_steps_are_booked_as_work_from_outside) {
  World world = busyWorld();
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world.step(0.01).ok());
  const std::vector<Vec2> points = testing::latticePoints({{0.5, 0.9}, {0.8, 1.1}}, 0.025);
  const auto handles = world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(-3.0, 0.0)));
  const std::size_t killed = world.kill(Species::Fluid, Box{{0.0, 0.0}, {0.2, 0.2}});
  EXPECT_GT(killed, 20u);
  EXPECT_TRUE(world.kill(Species::Fluid, handles[3]));
  EXPECT_FALSE(world.kill(Species::Fluid, handles[3]));
  const std::size_t bullets = world.bullets()->size();
  EXPECT_EQ(world.kill(Species::Bullet, Disc{{0.8, 0.6}, 5.0}), bullets);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step(0.01).ok());
  const Ledger& ledger = world.ledger();
  EXPECT_EQ(ledger.rejected, 0u);
  EXPECT_EQ(ledger.added, points.size());
  EXPECT_EQ(ledger.killed, killed + 1 + bullets);
  EXPECT_LT(ledger.energyDrift, 0.05);
  const Totals totals = world.totals();
  EXPECT_LT((totals.momentum - ledger.momentum0 - ledger.impulse).norm() / (totals.mass * ledger.maxSpeed), 1e-7);
}

TEST(WorldEdit, taking_the_columns_for_writing_and_writing_nothing_changes_no_bit) {
  World one = busyWorld(), other = busyWorld();
  for (int k = 0; k < 10; ++k) {
    static_cast<void>(one.fluid());
    static_cast<void>(one.bullets());
    one.step(0.01);
    other.step(0.01);
  }
  EXPECT_EQ(one.stateHash(), other.stateHash());
}

TEST(WorldEdit, user_columns_stay_with_their_particles_through_sort_kill_and_archive) {
  auto make = [] {
    World world = busyWorld();
    world.fluid()->addColumn<float>("colour", ColumnKind::State);
    return world;
  };
  World world = make();
  ParticlePool& pool = *world.fluid();
  const auto colour = *pool.findColumn<float>("colour");
  std::map<std::pair<std::uint32_t, std::uint32_t>, float> given;
  for (std::uint32_t i = 0; i < pool.size(); ++i) {
    pool.column(colour)[i] = 1.0f + static_cast<float>(i);
    const ParticleHandle h = pool.handleAt(i);
    given[{h.slot, h.generation}] = pool.column(colour)[i];
  }
  auto check = [&](const World& w) {
    std::size_t painted = 0;
    for (std::uint32_t i = 0; i < w.fluid()->size(); ++i) {
      const ParticleHandle h = w.fluid()->handleAt(i);
      const auto known = given.find({h.slot, h.generation});
      EXPECT_EQ(w.fluid()->column(colour)[i], known == given.end() ? 0.0f : known->second);
      painted += known == given.end() ? 0 : 1;
    }
    return painted;
  };
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(world.step(0.01).ok());
  const std::size_t killed = world.kill(Species::Fluid, Box{{0.1, 0.0}, {0.2, 0.3}});
  EXPECT_GT(killed, 0u);
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(world.step(0.01).ok());
  EXPECT_EQ(check(world), given.size() - killed);
  MemorySnapshot snapshot;
  snapshot.save([&](Archive& a) { world.archive(a); });
  World second = make();
  snapshot.load([&](Archive& a) { second.archive(a); });
  EXPECT_EQ(check(second), given.size() - killed);
  EXPECT_EQ(second.stateHash(), world.stateHash());
  World without = busyWorld();
  EXPECT_THROW(snapshot.load([&](Archive& a) { without.archive(a); }), Error);
}

TEST(WorldEdit, the_script_of_a_body_by_call_is_not_saved_and_is_asked_for) {
  BodyDef lift = paddle("lift", {2.0, 1.0});
  lift.script.push_back({10.0, {}, [](double t) { return std::sin(t); }, {}});
  World world(bulletWorld());
  const BodyId id = world.createBody(lift);
  EXPECT_THROW(world.setBodyVelocity(id, {1.0, 0.0}, 0.0), Error);
  world.step(0.5);
  MemorySnapshot snapshot;
  snapshot.save([&](Archive& a) { world.archive(a); });
  World without(bulletWorld());
  try {
    snapshot.load([&](Archive& a) { without.archive(a); });
    FAIL() << "a script out of nowhere";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'lift'"), std::string::npos) << error.what();
  }
  World with(bulletWorld());
  with.createBody(lift);
  snapshot.load([&](Archive& a) { with.archive(a); });
  with.step(0.5);
  world.step(0.5);
  EXPECT_EQ(with.stateHash(), world.stateHash());
}

}  // namespace
}  // namespace froude
