// What does a step of a world of bullets cost a bullet? Walls, fixed and spinning concave polygons, bounces included.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <string>
#include <vector>

#include <froude/base/random.h>
#include <froude/solver/world.h>
#include "rows.h"

namespace {

using namespace froude;

// A star with `points` tips: every second vertex is reflex.
Polygon star(int points, double radius) {
  std::vector<Vec2> ring;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = kPi * k / points;
    const double r = k % 2 == 0 ? radius : 0.45 * radius;
    ring.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return Polygon::make(std::move(ring));
}

// 4 m × 3 m, closed, 50 stars on a lattice of which every second one spins, bullets of 2 mm everywhere between them
// with 5 m/s in random directions. Restitution 1 and no friction, so that the state is as lively after any number of
// steps.
struct Shower {
  Shower(std::size_t bullets, double dt) : world(definition(dt)) {
    RandomStream random(7, 1);
    std::vector<Vec2> at, velocity;
    while (at.size() < bullets) {
      const Vec2 p(random.uniform(0.01, 3.99), random.uniform(0.01, 2.99));
      const Vec2 inCell(std::fmod(p.x(), 0.4) - 0.2, std::fmod(p.y(), 0.6) - 0.3);
      if (inCell.norm() < 0.11) continue;
      const double angle = random.uniform(0.0, 2.0 * kPi);
      at.push_back(p);
      velocity.push_back(5.0 * Vec2(std::cos(angle), std::sin(angle)));
    }
    world.addBullets(at, velocity);
  }
  static WorldDef definition(double dt) {
    WorldDef def;
    def.domain.box = {{0.0, 0.0}, {4.0, 3.0}};
    if (dt > 0.0) def.timeStep = dt;
    def.bullet = BulletDef{};
    def.bullet->restitution = 1.0;
    const auto shape = std::make_shared<const Polygon>(star(5, 0.1));
    for (int k = 0; k < 50; ++k) {
      BodyDef body;
      body.name = "star." + std::to_string(k);
      body.shape = shape;
      body.position = {0.2 + 0.4 * (k % 10), 0.3 + 0.6 * (k / 10)};
      body.angle = 0.1 * k;
      if (k % 2 == 0) {
        body.motion = Motion::Scripted;
        body.spin = k % 4 == 0 ? 3.0 : -3.0;
      }
      def.bodies.push_back(body);
    }
    return def;
  }
  World world;
};

// Arguments: bullets, step [µs], threads.
void step(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const double dt = 1e-6 * static_cast<double>(state.range(1));
  Shower shower(count, dt);
  tbb::task_arena arena(static_cast<int>(state.range(2)));
  arena.execute([&] {
    for (int k = 0; k < 3; ++k) shower.world.substep();
    for (auto _ : state) shower.world.substep();
  });
  bench::items(state, count);
  bench::threads(state, static_cast<int>(state.range(2)));
  bench::timeStep(state, dt);
}
BENCHMARK(step)->ArgsProduct({{1000000}, {1000, 10000}, {1, 2}})->UseRealTime()->Unit(benchmark::kMillisecond);

// The same after the bullets, here with restitution 0.5, came to rest on what is below them: contacts for all.
void rest(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  WorldDef def = Shower::definition(0.0);
  def.bullet->restitution = 0.5;
  World world(def);
  RandomStream random(7, 1);
  std::vector<Vec2> at, velocity(count, Vec2(0.0, 0.0));
  for (std::size_t i = 0; i < count; ++i) at.push_back({random.uniform(0.01, 3.99), random.uniform(0.003, 0.1)});
  world.addBullets(at, velocity);
  world.step(2.0);
  tbb::task_arena arena(static_cast<int>(state.range(1)));
  arena.execute([&] {
    for (auto _ : state) world.substep();
  });
  bench::items(state, count);
  bench::threads(state, static_cast<int>(state.range(1)));
}
BENCHMARK(rest)->ArgsProduct({{100000}, {1, 2}})->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
