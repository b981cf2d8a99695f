#include <froude/solver/bullet/flight.h>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <froude/base/random.h>
#include <froude/solver/coupling/free_map.h>
#include <froude/solver/world.h>

#include "support/worlds.h"

namespace froude {
namespace {

Polygon star() {
  std::vector<Vec2> ring;
  for (int k = 0; k < 10; ++k) {
    const double angle = kPi * k / 5, r = k % 2 == 0 ? 0.12 : 0.05;
    ring.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return Polygon::make(std::move(ring));
}

WorldDef stars(bool periodic, SimdTarget simd) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {1.0, 0.8}};
  def.domain.periodicX = periodic;
  def.domain.closed[3] = false;
  def.simd = simd;
  def.bullet = BulletDef{};
  def.bullet->restitution = 0.8;
  for (int k = 0; k < 6; ++k) {
    BodyDef body = testing::body("star." + std::to_string(k), star(), {0.15 + 0.3 * (k % 3), 0.25 + 0.3 * (k / 3)});
    if (k % 2 == 0) {
      body.motion = Motion::Scripted;
      body.spin = 5.0 - k;
      body.velocity = {0.1, 0.0};
    }
    def.bodies.push_back(body);
  }
  return def;
}

World shower(bool periodic, SimdTarget simd, std::size_t count) {
  World world(stars(periodic, simd));
  RandomStream random(3, 1);
  std::vector<Vec2> at, velocity;
  while (at.size() < count) {
    const Vec2 p(random.uniform(0.01, 0.99), random.uniform(0.01, 0.79));
    bool blocked = false;
    for (std::size_t b = 0; b < world.bodyCount(); ++b) {
      blocked |= (p - world.body(b).transform.position).norm() < 0.13;
    }
    if (blocked) continue;
    at.push_back(p);
    velocity.push_back({random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0)});
  }
  world.addBullets(at, velocity);
  return world;
}

std::string hashAfter(bool periodic, SimdTarget simd, int threads, int steps) {
  World world = shower(periodic, simd, 5003);
  tbb::task_arena arena(threads);
  arena.execute([&] {
    for (int k = 0; k < steps; ++k) world.substep();
  });
  return world.stateHash();
}

TEST(Flight, every_target_and_number_of_threads_gives_the_same_bits) {
  for (const bool periodic : {false, true}) {
    const std::string expected = hashAfter(periodic, SimdTarget::Scalar, 1, 20);
    for (const SimdTarget target : supportedSimdTargets()) {
      for (const int threads : {1, 2, 3, 7}) {
        EXPECT_EQ(hashAfter(periodic, target, threads, 20), expected) << name(target) << ", " << threads << " threads";
      }
    }
  }
}

TEST(Flight, moves_what_is_proven_free_and_lists_the_rest_in_order) {
  // One row of 8 cells of 1 m, free for 2 m on the left and blocked on the right.
  AlignedArray<std::uint8_t> cells(8 + 4);
  for (std::size_t i = 0; i < 4; ++i) cells[i] = 16;
  FreeMap::View map{cells.data(), 0.0, 0.0, 1.0, 1.0, 0.125, 8, 1};
  for (const SimdTarget target : supportedSimdTargets()) {
    const std::size_t n = 21;
    AlignedArray<double> x(n), y(n), vx(n), vy(n);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = i % 3 == 0 ? 6.5 : 0.5;
      y[i] = 0.5;
      vx[i] = i % 5 == 1 ? 3.0 : 1.0;
    }
    vx[4] = std::nan("");
    y[7] = 9.0;  // not on the map
    std::vector<std::uint32_t> near(n);
    const Flight flight{x.data(), y.data(), vx.data(), vy.data(), 1.0, {0.0, 0.0}, map, {{0.0, 0.0}, {8.0, 8.0}}};
    const FlightResult result = flyLoop(target)(flight, 0, n, near.data());
    near.resize(result.near);
    // 3 m along the row are free in two steps: 2 m from 0.5, then 2 m from 2.5.
    EXPECT_EQ(near, (std::vector<std::uint32_t>{0, 3, 4, 6, 7, 9, 12, 15, 18})) << name(target);
    EXPECT_EQ(x[1], 3.5);
    EXPECT_EQ(x[2], 1.5);
    EXPECT_EQ(x[0], 6.5);
    EXPECT_FALSE(result.left);
  }
}

TEST(FreeMap, promises_no_more_than_the_distance_during_the_whole_step) {
  const WorldDef def = stars(false, SimdTarget::Scalar);
  BodySet bodies(def.bodies);
  Obstacles obstacles(def.domain, bodies, 0.004);
  const double dt = 0.02, radius = 0.002;
  bodies.beginStep(0.0, dt);
  obstacles.beginStep(bodies, dt, 0.2);
  const DistanceField field(*def.bodies[0].shape, 0.1);
  FreeMap map;
  for (const std::size_t particles : {std::size_t{100}, std::size_t{10000}, std::size_t{100000}}) {
    map.prepare(obstacles, radius, {}, particles);
    map.refresh(obstacles);
    const FreeMap::View view = map.view();
    RandomStream random(1, 1);
    std::size_t free = 0;
    for (int k = 0; k < 3000; ++k) {
      const Vec2 p(random.uniform(0.0, 1.0), random.uniform(0.0, 0.8));
      const Vec2 c = (p - Vec2(view.originX, view.originY)) * view.inverse;
      const Vec2 middle(std::floor(c.x()) + 0.5, std::floor(c.y()) + 0.5);
      const auto cell = static_cast<std::ptrdiff_t>(c.y()) * view.nx + static_cast<std::ptrdiff_t>(c.x());
      const double promised = view.cells[cell] * view.quantum - (c - middle).norm() * view.cell;
      if (promised <= 0.0) continue;
      ++free;
      ASSERT_GE(std::min({p.x(), 1.0 - p.x(), p.y()}), promised + radius);
      for (const double t : {0.0, 0.3 * dt, dt}) {
        for (std::size_t b = 0; b < def.bodies.size(); ++b) {
          const BodyMotion& m = bodies.motion(b);
          const Transform pose = Transform::of(m.position + t * m.velocity, m.angle + t * m.spin);
          ASSERT_GE(field.sampleExact(pose.toLocal(p)).distance, promised + radius);
        }
      }
    }
    EXPECT_GT(free, particles > 1000 ? 1200u : 600u);
  }
}

// Under a gravity field every bullet takes the exact query.
TEST(Ballistic, the_map_of_free_space_changes_no_bit) {
  for (const bool periodic : {false, true}) {
    WorldDef byField = stars(periodic, bestSimdTarget());
    byField.gravityField = [g = byField.gravity](const Vec2&, double) { return g; };
    World exact(byField);
    World mapped = shower(periodic, bestSimdTarget(), 4000);
    const ParticlePool& from = *mapped.bullets();
    std::vector<Vec2> at, velocity;
    for (std::size_t i = 0; i < from.size(); ++i) {
      at.push_back({from.x()[i], from.y()[i]});
      velocity.push_back({from.vx()[i], from.vy()[i]});
    }
    exact.addBullets(at, velocity);
    for (int k = 0; k < 30; ++k) {
      mapped.substep(0.004);
      exact.substep(0.004);
      ASSERT_EQ(mapped.bullets()->size(), exact.bullets()->size());
      for (std::size_t i = 0; i < mapped.bullets()->size(); ++i) {
        ASSERT_EQ(mapped.bullets()->x()[i], exact.bullets()->x()[i]);
        ASSERT_EQ(mapped.bullets()->y()[i], exact.bullets()->y()[i]);
        ASSERT_EQ(mapped.bullets()->vx()[i], exact.bullets()->vx()[i]);
        ASSERT_EQ(mapped.bullets()->vy()[i], exact.bullets()->vy()[i]);
      }
    }
    EXPECT_LT(mapped.bullets()->size(), 4000u);  // the top is open
  }
}

TEST(Ballistic, a_fast_bullet_meets_what_is_behind_a_periodic_seam) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {1.0, 1.0}};
  def.domain.periodicX = true;
  def.gravity = {0.0, 0.0};
  def.timeStep = 0.01;
  def.bullet = BulletDef{};
  def.bullet->restitution = 1.0;
  def.bodies.push_back(testing::body("post", Polygon::box({{0.0, -0.2}, {0.05, 0.2}}), {0.02, 0.5}));
  World world(def);
  world.addBullets(std::vector<Vec2>{{0.93, 0.5}}, std::vector<Vec2>{{12.0, 0.0}});
  world.substep();
  EXPECT_NEAR(world.bullets()->vx()[0], -12.0, 1e-12);
  EXPECT_FALSE(world.insideSolid({world.bullets()->x()[0], world.bullets()->y()[0]}));
}

TEST(Ballistic, a_marked_bullet_is_taken_out_though_none_left) {
  World world = shower(false, bestSimdTarget(), 100);
  const std::size_t before = world.bullets()->size();
  world.bullets()->kill(17);
  world.substep(1e-6);
  EXPECT_EQ(world.bullets()->size(), before - 1);
}

}  // namespace
}  // namespace froude
