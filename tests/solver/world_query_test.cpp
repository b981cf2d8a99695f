// Rays, areas, events and the caller's force.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <set>

#include <froude/base/random.h>
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

// The nearest crossing of from → to with any edge, edge by edge.
double nearestCrossing(const World& world, const Vec2& from, const Vec2& to, std::uint32_t mask) {
  double nearest = kInfinity;
  auto edge = [&](const Vec2& a, const Vec2& b) {
    const Vec2 d = to - from, e = b - a;
    const double det = cross(d, e);
    if (det == 0.0) return;
    const double t = cross(Vec2(a - from), e) / det, s = cross(Vec2(a - from), d) / det;
    if (t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0) nearest = std::min(nearest, t * d.norm());
  };
  for (std::size_t i = 0; i < world.bodyCount(); ++i) {
    const BodyDef& def = world.bodyDefinition(i);
    if ((def.group & mask) == 0) continue;
    const Transform& pose = world.body(i).transform;
    for (std::uint32_t e = 0; e < def.shape->edgeCount(); ++e) {
      edge(pose.toWorld(def.shape->edgeStart(e)), pose.toWorld(def.shape->edgeEnd(e)));
    }
  }
  const Box& box = world.definition().domain.box;
  const Vec2 right(box.max.x(), box.min.y()), left(box.min.x(), box.max.y());
  edge(box.min, right), edge(right, box.max), edge(box.max, left), edge(left, box.min);
  return nearest;
}

TEST(WorldRay, finds_what_a_search_over_all_edges_finds_among_fixed_and_turning_bodies) {
  World world(bulletWorld());
  RandomStream random(3, 1);
  for (int k = 0; k < 24; ++k) {
    BodyDef def = body("b", Polygon::regular(3 + k % 5, random.uniform(0.05, 0.3)),
                       {random.uniform(0.5, 3.5), random.uniform(0.5, 3.5)});
    def.angle = random.uniform(-3.0, 3.0);
    def.group = k % 3 == 0 ? 2 : 1;
    if (k % 2 == 0) {
      def.motion = Motion::Scripted;
      def.velocity = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
      def.spin = random.uniform(-5.0, 5.0);
    }
    world.createBody(def);
  }
  world.step(0.1);
  int hits = 0, free = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec2 from(random.uniform(0.0, 4.0), random.uniform(0.0, 4.0));
    const Vec2 to(random.uniform(0.0, 4.0), random.uniform(0.0, 4.0));
    const std::uint32_t mask = k % 2 == 0 ? ~0u : 2u;
    const CollisionFilter filter{~0u, mask};
    if (world.insideSolid(from, filter)) {
      EXPECT_TRUE(world.castRay(from, to, filter).startedInside);
      continue;
    }
    const double expected = nearestCrossing(world, from, to, mask);
    const RayHit hit = world.castRay(from, to, filter);
    ASSERT_EQ(hit.hit, std::isfinite(expected)) << k;
    ++(hit.hit ? hits : free);
    if (!hit.hit) continue;
    EXPECT_NEAR(hit.distance, expected, 1e-9);
    EXPECT_NEAR((hit.point - from).norm(), expected, 1e-9);
    EXPECT_NEAR(hit.normal.norm(), 1.0, 1e-12);
    EXPECT_LE(hit.normal.dot(to - from), 1e-9);
    if (!hit.body.isNull()) {
      EXPECT_NE(world.bodyDefinition(hit.body).group & mask, 0u);
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(free, 200);
}

TEST(WorldRay, sees_the_copies_of_bodies_across_periodic_sides) {
  WorldDef def = bulletWorld();
  def.domain.periodicX = true;
  def.bodies.push_back(body("post", Polygon::box({{-0.1, -0.5}, {0.1, 0.5}}), {0.5, 2.0}));
  World world(def);
  const RayHit hit = world.castRay({3.5, 2.0}, {6.0, 2.0});
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.distance, 0.9, 1e-12);
  EXPECT_NEAR(hit.normal.x(), -1.0, 1e-12);
}

TEST(WorldArea, particles_in_an_area_are_found_and_killed_as_a_loop_would) {
  World world(bulletWorld());
  RandomStream random(8, 1);
  std::vector<Vec2> points;
  for (int k = 0; k < 5000; ++k) points.emplace_back(random.uniform(0.1, 3.9), random.uniform(0.1, 3.9));
  world.addBullets(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  const Polygon star = Polygon::make({{1.0, 1.0}, {3.0, 1.2}, {2.0, 1.5}, {2.2, 3.0}});
  std::vector<std::uint32_t> found;
  auto check = [&](const Area& area, auto&& inside) {
    world.find(Species::Bullet, area, found);
    std::vector<std::uint32_t> expected;
    const ParticlePool& pool = *world.bullets();
    for (std::uint32_t i = 0; i < pool.size(); ++i) {
      if (inside(Vec2(pool.x()[i], pool.y()[i]))) expected.push_back(i);
    }
    EXPECT_GT(expected.size(), 50u);
    EXPECT_EQ(found, expected);
  };
  const Box box{{0.5, 0.5}, {1.5, 3.0}};
  check(box, [&](const Vec2& p) { return box.contains(p); });
  check(star, [&](const Vec2& p) { return star.contains(p); });
  check(Disc{{2.0, 2.0}, 0.5}, [&](const Vec2& p) { return (p - Vec2(2.0, 2.0)).norm() <= 0.5; });
  world.find(Species::Bullet, star, found);
  const std::size_t inStar = found.size(), before = world.bullets()->size();
  EXPECT_EQ(world.kill(Species::Bullet, star), inStar);
  EXPECT_EQ(world.bullets()->size(), before - inStar);
  world.find(Species::Bullet, star, found);
  EXPECT_TRUE(found.empty());
  EXPECT_THROW(world.find(Species::Fluid, box, found), Error);
}

TEST(WorldArea, bodies_are_found_by_box_disc_polygon_and_point) {
  World world(bulletWorld());
  const BodyId big = world.createBody(body("big", Polygon::box({{-1.0, -1.0}, {1.0, 1.0}}), {2.0, 2.0}));
  BodyDef turned = body("turned", Polygon::box({{-0.5, -0.05}, {0.5, 0.05}}), {0.5, 3.5});
  turned.angle = kPi / 4;
  turned.group = 4;
  const BodyId thin = world.createBody(turned);
  std::vector<BodyId> found;
  auto at = [&](const Area& area) {
    world.findBodies(area, found);
    return found;
  };
  EXPECT_EQ(at(Box{{1.9, 1.9}, {2.1, 2.1}}), std::vector<BodyId>{big}) << "the area lies in the body";
  EXPECT_EQ(at(Box{{0.0, 0.0}, {4.0, 4.0}}), (std::vector<BodyId>{big, thin})) << "the bodies lie in the area";
  EXPECT_EQ(at(Box{{0.9, 2.0}, {1.1, 2.2}}), std::vector<BodyId>{big}) << "boundaries cross";
  EXPECT_TRUE(at(Box{{0.1, 3.7}, {0.3, 3.9}}).empty()) << "in the turned body's box, not in the body";
  EXPECT_EQ(at(Disc{{0.85, 2.0}, 0.2}), std::vector<BodyId>{big});
  EXPECT_TRUE(at(Disc{{0.85, 0.85}, 0.2}).empty());
  const Polygon wedge = Polygon::make({{0.0, 4.0}, {0.0, 3.9}, {0.6, 3.5}});
  EXPECT_EQ(at(wedge), std::vector<BodyId>{thin});
  world.findBodies(Box{{0.0, 0.0}, {4.0, 4.0}}, found, {~0u, 4u});
  EXPECT_EQ(found, std::vector<BodyId>{thin});
  EXPECT_EQ(world.bodyAt({2.5, 2.5}), big);
  EXPECT_TRUE(world.bodyAt({3.5, 3.5}).isNull());
  EXPECT_TRUE(world.bodyAt({2.5, 2.5}, {~0u, 4u}).isNull());
}

TEST(WorldEvents, a_bounce_is_told_with_particle_body_point_normal_speed_and_time) {
  World world(bulletWorld());
  const BodyId wall = world.createBody(body("wall", Polygon::box({{-0.1, -1.0}, {0.1, 1.0}}), {2.0, 2.0}));
  const ParticleHandle bullet = world.addBullets(std::vector<Vec2>{{1.0, 2.3}}, std::vector<Vec2>{{4.0, 1.0}})[0];
  EventSettings settings;
  settings.bulletContacts = true;
  world.record(settings);
  std::vector<ContactEvent> told;
  for (int k = 0; k < 30; ++k) {
    world.step(0.01);
    told.insert(told.end(), world.contacts().begin(), world.contacts().end());
  }
  ASSERT_EQ(told.size(), 1u);
  const ContactEvent& e = told[0];
  EXPECT_EQ(e.species, Species::Bullet);
  EXPECT_EQ(e.particle, bullet);
  EXPECT_EQ(e.body, wall);
  const double time = (1.9 - 0.01 - 1.0) / 4.0;
  EXPECT_NEAR(e.time, time, 1e-9);
  EXPECT_NEAR(e.speed, 4.0, 1e-12);
  EXPECT_NEAR((e.point - Vec2(1.9, 2.3 + time)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((e.normal - Vec2(-1.0, 0.0)).norm(), 0.0, 1e-12);
  world.step(0.3);
  world.record({});
  world.step(0.3);
  EXPECT_TRUE(world.contacts().empty());
}

TEST(WorldEvents, are_the_same_on_any_number_of_threads_and_change_no_bit) {
  auto run = [](int threads, bool recorded) {
    std::pair<std::string, std::vector<ContactEvent>> result;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      World world = busyWorld();
      if (recorded) world.record({true, true, true, 0.05});
      for (int k = 0; k < 30; ++k) {
        world.step(0.02);
        result.second.insert(result.second.end(), world.contacts().begin(), world.contacts().end());
      }
      result.first = world.stateHash();
    });
    return result;
  };
  const auto silent = run(1, false);
  EXPECT_TRUE(silent.second.empty());
  const auto one = run(1, true);
  EXPECT_EQ(one.first, silent.first);
  EXPECT_GT(one.second.size(), 100u);
  std::set<Species> species;
  double last = 0.0;
  for (const ContactEvent& e : one.second) {
    species.insert(e.species);
    EXPECT_GE(e.speed, 0.05);
    EXPECT_GE(e.time, last - 0.02);
    last = std::max(last, e.time);
  }
  EXPECT_EQ(species.size(), 2u);
  for (const int threads : {2, 3, 7}) {
    const auto other = run(threads, true);
    EXPECT_EQ(other.first, one.first);
    ASSERT_EQ(other.second.size(), one.second.size());
    for (std::size_t k = 0; k < one.second.size(); ++k) {
      const ContactEvent &a = one.second[k], &b = other.second[k];
      ASSERT_TRUE(a.particle == b.particle && a.body == b.body && a.species == b.species && a.point == b.point &&
                  a.normal == b.normal && a.speed == b.speed && a.time == b.time)
          << k;
    }
  }
}

TEST(WorldEvents, a_step_that_was_undone_tells_nothing) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  def.timeStep = 0.2;  // far too long
  World world(def);
  fill(world, {{0.0, 0.0}, {0.4, 0.8}}, 0.02);
  world.record({true, true, true, 0.0});
  StepReport report;
  for (int i = 0; i < 20 && report.ok(); ++i) report = world.substep();
  EXPECT_FALSE(report.ok());
  EXPECT_TRUE(world.contacts().empty());
}

TEST(WorldEvents, a_sink_tells_what_it_swallowed_and_where) {
  WorldDef def = bulletWorld();
  def.sinks.push_back({std::make_shared<const Polygon>(Polygon::box({{3.0, 0.0}, {4.0, 4.0}}))});
  def.sinks.push_back({std::make_shared<const Polygon>(Polygon::box({{0.0, 0.0}, {1.0, 4.0}}))});
  World world(def);
  const ParticleHandle right = world.addBullets(std::vector<Vec2>{{2.0, 1.0}}, std::vector<Vec2>{{2.0, 0.0}})[0];
  const ParticleHandle left = world.addBullets(std::vector<Vec2>{{2.0, 3.0}}, std::vector<Vec2>{{-1.0, 0.0}})[0];
  EventSettings settings;
  settings.sinks = true;
  world.record(settings);
  std::vector<SinkEvent> told;
  for (int k = 0; k < 120; ++k) {
    world.step(0.01);
    told.insert(told.end(), world.swallowed().begin(), world.swallowed().end());
  }
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].particle, right);
  EXPECT_EQ(told[0].sink, 0u);
  EXPECT_NEAR(told[0].position.x(), 3.0, 0.03);
  EXPECT_EQ(told[1].particle, left);
  EXPECT_EQ(told[1].sink, 1u);
  EXPECT_EQ(world.ledger().sunk, 2u);
  EXPECT_FALSE(world.bullets()->isAlive(left));
}

TEST(WorldForce, a_constant_acceleration_does_what_gravity_does) {
  WorldDef def = bulletWorld();
  World pulled(def);
  pulled.setForce([](const ForcePoint&) { return Vec2(1.0, -9.81); });
  def.gravity = {1.0, -9.81};
  World falling(def);
  for (World* world : {&pulled, &falling}) {
    world->addBullets(std::vector<Vec2>{{1.0, 2.0}}, std::vector<Vec2>{{0.3, 1.0}});
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(world->step(0.01).ok());
  }
  const World &a = pulled, &b = falling;
  EXPECT_NEAR(a.bullets()->x()[0], b.bullets()->x()[0], 1e-9);
  EXPECT_NEAR(a.bullets()->y()[0], b.bullets()->y()[0], 1e-9);
}

TEST(WorldForce, drag_by_velocity_slows_as_the_closed_form_says) {
  WorldDef def = bulletWorld();
  def.timeStep = 0.001;
  constexpr double kDrag = 2.0;  // [1/s]
  def.force = [](const ForcePoint& p) { return Vec2(-kDrag * p.v); };
  World world(def);
  world.addBullets(std::vector<Vec2>{{1.0, 2.0}}, std::vector<Vec2>{{3.0, 0.0}});
  while (world.time() < 1.0 - 1e-9) world.substep();
  EXPECT_NEAR(world.bullets()->vx()[0], 3.0 * std::exp(-kDrag), 1e-6);
  EXPECT_NEAR(world.bullets()->x()[0], 1.0 + 3.0 / kDrag * (1.0 - std::exp(-kDrag)), 1e-6);
  EXPECT_LT(world.ledger().work, 0.0);
}

TEST(WorldForce, a_fluid_under_it_rests_closes_its_books_and_keeps_its_bits_on_any_threads) {
  std::set<std::string> hashes;
  for (const int threads : {1, 3}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      WorldDef def = fluidWorld({{0.0, 0.0}, {0.4, 0.6}}, 0.02);
      def.gravity = {0.0, 0.0};
      def.force = [](const ForcePoint& p) { return Vec2(Vec2(0.0, -9.81) - 0.5 * p.v); };
      World world(def);
      fill(world, {{0.0, 0.0}, {0.4, 0.3}}, 0.02);
      for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(0.01).ok());
      const Totals totals = world.totals();
      EXPECT_LT(totals.kinetic, 1e-3 * totals.mass * 9.81 * 0.3);
      const Ledger& ledger = world.ledger();
      EXPECT_LT((totals.momentum - ledger.momentum0 - ledger.impulse).norm() / (totals.mass * ledger.maxSpeed), 1e-6);
      EXPECT_LT(std::abs(ledger.work), 0.02 * totals.mass * 9.81 * 0.3) << "who rests is not worked upon";
      hashes.insert(world.stateHash());
    });
  }
  EXPECT_EQ(hashes.size(), 1u);
}

TEST(WorldForce, a_fluid_does_under_a_constant_one_what_it_does_under_gravity_to_the_bit) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {0.8, 0.6}}, 0.02);
  World falling(def);
  def.gravity = {0.0, 0.0};
  def.force = [](const ForcePoint&) { return Vec2(0.0, -9.81); };
  World pulled(def);
  for (World* world : {&falling, &pulled}) {
    fill(*world, {{0.0, 0.0}, {0.3, 0.5}}, 0.02);
    for (int k = 0; k < 30; ++k) ASSERT_TRUE(world->step(0.01).ok());
  }
  const ParticlePool &a = *std::as_const(falling).fluid(), &b = *std::as_const(pulled).fluid();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.x()[i], b.x()[i]);
    ASSERT_EQ(a.vy()[i], b.vy()[i]);
  }
  // What gravity took from the potential energy is the work of the force, up to the rule by which it is summed.
  const double fallen = falling.ledger().energy0 - falling.totals().potential;
  EXPECT_NEAR(pulled.ledger().work, fallen, 0.03 * fallen);
}

TEST(WorldForce, what_is_not_finite_is_reported_by_a_fluid_and_retired_among_bullets) {
  const ForceCallback broken = [](const ForcePoint& p) {
    return p.index == 3 ? Vec2(std::nan(""), 0.0) : Vec2(0.0, 0.0);
  };
  WorldDef def = fluidWorld({{0.0, 0.0}, {0.4, 0.6}}, 0.02);
  def.force = broken;
  World fluid(def);
  fill(fluid, {{0.0, 0.0}, {0.4, 0.3}}, 0.02);
  EXPECT_EQ(fluid.substep().trouble, Trouble::NonFinite);
  def = bulletWorld();
  def.force = broken;
  World bullets(def);
  for (int k = 0; k < 10; ++k)
    bullets.addBullets(std::vector<Vec2>{{0.3 + 0.3 * k, 2.0}}, std::vector<Vec2>{{0.0, 0.0}});
  EXPECT_TRUE(bullets.substep().ok());
  bullets.setForce({});
  EXPECT_TRUE(bullets.substep().ok());
  EXPECT_EQ(bullets.ledger().retired + bullets.ledger().quarantined, 1u);
  EXPECT_EQ(bullets.bullets()->size(), 9u);
}

TEST(World, runs_in_the_arena_of_its_caller_and_sets_nothing_global) {
  const std::size_t before = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  std::atomic<int> largest{0};
  tbb::task_arena arena(2);
  arena.execute([&] {
    World world = busyWorld();
    world.setForce([&](const ForcePoint&) {
      int seen = largest.load();
      const int slot = tbb::this_task_arena::current_thread_index();
      while (slot > seen && !largest.compare_exchange_weak(seen, slot)) {
      }
      EXPECT_EQ(tbb::this_task_arena::max_concurrency(), 2);
      return Vec2(0.0, 0.0);
    });
    world.step(0.05);
  });
  EXPECT_LE(largest.load(), 1);
  EXPECT_EQ(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), before);
}

}  // namespace
}  // namespace froude
