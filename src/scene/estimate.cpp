#include "scene/estimate.h"

#include <froude/particles/pool.h>
#include <froude/solver/bullet/ballistic.h>
#include <froude/solver/fluid/fluid_model.h>
#include <froude/solver/fluid/wcsph.h>

#include <algorithm>

namespace froude::scene {

namespace {

double gravityScale(const WorldDef& world) {
  if (!world.gravityField) return world.gravity.norm();
  const Vec2 g = world.gravityField(world.domain.box.center(), 0.0);
  return g.allFinite() ? g.norm() : 0.0;
}

/// Calls visit(position, velocity) for all that starts or is emitted.
template <typename Visit>
void forEachStart(const Scene& scene, bool bulletsToo, Visit&& visit) {
  for (const auto* blocks : {&scene.fluidBlocks, &scene.bulletBlocks}) {
    if (blocks == &scene.bulletBlocks && !bulletsToo) continue;
    for (const SeededBlock& block : *blocks)
      for (std::size_t i = 0; i < block.positions.size(); ++i) visit(block.positions[i], block.velocities[i]);
  }
  for (const EmitterDef& emitter : scene.world.emitters) {
    if (emitter.kind == EmitterDef::Kind::Bullet && !bulletsToo) continue;
    const Vec2 velocity = emitter.speed * leftNormal(emitter.to - emitter.from).normalized();
    visit(emitter.from, velocity);
    visit(emitter.to, velocity);
  }
}

}  // namespace

double expectedSpeed(const Scene& scene, bool bulletsToo) {
  const WorldDef& world = scene.world;
  const double gravity = gravityScale(world);
  const Vec2 down = world.gravityField || gravity == 0.0 ? Vec2(0.0, 0.0) : Vec2(world.gravity / gravity);
  const Box& box = world.domain.box;
  const double floor = std::max(down.x() * box.min.x(), down.x() * box.max.x()) +
                       std::max(down.y() * box.min.y(), down.y() * box.max.y());
  double start = 0.0, height = world.gravityField ? box.size().norm() : 0.0;  // a field may pull anywhere
  forEachStart(scene, bulletsToo, [&](const Vec2& position, const Vec2& velocity) {
    start = std::max(start, velocity.squaredNorm());
    height = std::max(height, floor - down.dot(position));
  });
  return std::sqrt(start + 2.0 * gravity * height);
}

namespace {

/// The bounds of the world's own models, asked one by one: a model names the smallest of what it is asked for.
std::vector<NamedBound> boundsOf(const Scene& scene, double gravity) {
  const WorldDef& world = scene.world;
  if (world.timeStep) return {{StepLimit::Literal, *world.timeStep}};
  std::vector<NamedBound> bounds;
  if (world.fluid) {
    ParticlePool pool(PoolSettings{});
    const auto model = makeFluidModel(*world.fluid, world.domain, pool);
    const double speed = expectedSpeed(scene, false);
    for (const StepBound& b :
         {model->stepBound(pool, 0.0, 0.0), model->stepBound(pool, speed, 0.0), model->stepBound(pool, 0.0, gravity)}) {
      const auto same = [&](const NamedBound& known) { return known.limit == b.limit; };
      if (std::isfinite(b.dt) && std::none_of(bounds.begin(), bounds.end(), same)) bounds.push_back({b.limit, b.dt});
    }
  }
  if (world.bullet && gravity > 0.0) bounds.push_back({StepLimit::Bullet, bulletStepBound(*world.bullet, gravity)});
  double spin = 0.0;
  for (const BodyDef& body : world.bodies) spin = std::max(spin, std::abs(body.spin));
  if (spin > 0.0) bounds.push_back({StepLimit::Spin, 0.5 / spin});
  std::stable_sort(bounds.begin(), bounds.end(), [](const auto& a, const auto& b) { return a.dt < b.dt; });
  return bounds;
}

}  // namespace

Estimate estimate(const Scene& scene) {
  const WorldDef& world = scene.world;
  const double gravity = gravityScale(world);
  Estimate result;
  result.speed = expectedSpeed(scene, true);
  for (const BodyDef& body : world.bodies) result.speed = std::max(result.speed, body.velocity.norm());
  result.particles = static_cast<double>(scene.fluidParticles() + scene.bulletCount() + scene.softPoints());
  // Peak resident memory of the program with 10,000 boxes, fixed, scripted or free: 9.5 to 10 kB each.
  constexpr double kBodyBytes = 1e4;
  constexpr double kSoftBytes = 1e3;  // of a point with its triangles
  result.bytes = static_cast<double>(estimateWorldBytes(world, scene.fluidParticles(), scene.bulletCount())) +
                 kBodyBytes * static_cast<double>(world.bodies.size()) +
                 kSoftBytes * static_cast<double>(scene.softPoints());
  result.bounds = boundsOf(scene, gravity);
  constexpr double kLongest = 0.01;  // [s] that a world steps at once where nothing binds it
  result.substep = std::min(scene.duration, world.timeStep.value_or(kLongest));
  if (!result.bounds.empty()) result.substep = std::min(result.substep, result.bounds.front().dt);
  result.substeps = std::ceil(scene.duration / result.substep);
  if (world.fluid && world.fluid->model == "wcsph" && result.speed > 0.0) {
    result.acousticSteps =
        std::max(result.substeps, std::ceil(scene.duration / acousticStepAt(*world.fluid, result.speed)));
  }
  return result;
}

}  // namespace froude::scene
