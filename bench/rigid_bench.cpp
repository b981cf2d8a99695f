// What does a step of many rigid bodies cost, and what does Box2D 2.4 take for the same scene? An item is a step of
// 1/60 s. `froude/N` works on N threads, Box2D on one, in 8 velocity and 3 position iterations. Both in turn:
// --benchmark_enable_random_interleaving=true.
//
// The tumbler: 2,025 regular polygons of 4, 5, 6 and 8 corners in a square drum that turns; steps 120 to 420, after the
// fall. The pyramid: 465 boxes at rest, steps 3 to 30, before Froude's fall asleep; Box2D's may not. The error is the
// deepest overlap of two bodies, or of one and the drum, after the last step [m]. Box2D takes its polygons to be 0.01
// thicker all around, which is counted as it counts.
#include <benchmark/benchmark.h>
#include <box2d/b2_body.h>
#include <box2d/b2_fixture.h>
#include <box2d/b2_polygon_shape.h>
#include <box2d/b2_world.h>
#include <tbb/task_arena.h>

#include <chrono>

#include <froude/solver/contact/sat.h>
#include <froude/solver/world.h>
#include "rows.h"

namespace {

using namespace froude;

constexpr double kStep = 1.0 / 60.0;
constexpr double kFriction = 0.6, kDensity = 100.0;

struct Scene {
  std::vector<Polygon> shapes;
  struct Member {
    std::size_t shape;
    Vec2 at;
  };
  std::vector<Member> members;
  std::vector<Box> ground;         // convex boxes of the drum or floor
  std::optional<Polygon> outline;  // of all of the ground
  double spin = 0.0;               // of the ground [rad/s]
  double reach = 0.0;              // of the domain [m]
  int from = 0, until = 0;         // steps that are measured
  bool maySleep = true;
};

Polygon boxOf(double halfX, double halfY) { return Polygon::box({{-halfX, -halfY}, {halfX, halfY}}); }

Scene tumbler() {
  Scene scene;
  for (const int sides : {4, 5, 6, 8}) scene.shapes.push_back(Polygon::regular(sides, 0.2));
  for (std::size_t k = 0; k < 45 * 45; ++k)
    scene.members.push_back(
        {k % 4, 0.4 * Vec2(static_cast<double>(k % 45) - 22.0, static_cast<double>(k / 45) - 22.0)});
  scene.ground = {{{-11, -11}, {-10, 11}}, {{10, -11}, {11, 11}}, {{-11, -11}, {11, -10}}, {{-11, 10}, {11, 11}}};
  scene.outline =
      Polygon::make({{-11, -11}, {11, -11}, {11, 11}, {-11, 11}}, {{{-10, -10}, {-10, 10}, {10, 10}, {10, -10}}});
  scene.spin = 0.436;
  scene.reach = 20.0;
  scene.from = 120, scene.until = 420;
  return scene;
}

Scene pyramid() {
  Scene scene;
  scene.shapes.push_back(boxOf(0.25, 0.25));
  for (int row = 0; row < 30; ++row) {
    for (int k = 0; k < 30 - row; ++k) scene.members.push_back({0, {0.55 * (k - 0.5 * (29 - row)), 0.25 + 0.5 * row}});
  }
  scene.ground = {{{-20, -1}, {20, 0}}};
  scene.outline = Polygon::box(scene.ground[0]);
  scene.reach = 30.0;
  scene.from = 3, scene.until = 30;
  scene.maySleep = false;
  return scene;
}

WorldDef worldOf(const Scene& scene) {
  WorldDef def;
  def.domain.box = {{-scene.reach, -scene.reach}, {scene.reach, scene.reach}};
  def.timeStep = kStep;
  std::vector<std::shared_ptr<const Polygon>> shapes;
  for (const Polygon& shape : scene.shapes) shapes.push_back(std::make_shared<const Polygon>(shape));
  BodyDef ground;
  ground.name = "ground";
  ground.shape = std::make_shared<const Polygon>(*scene.outline);
  ground.motion = scene.spin == 0.0 ? Motion::Fixed : Motion::Scripted;
  ground.spin = scene.spin;
  ground.friction = kFriction;
  ground.restitution = 0.0;
  for (const Scene::Member& member : scene.members) {
    BodyDef body;
    body.name = "body";
    body.shape = shapes[member.shape];
    body.position = member.at;
    body.motion = Motion::Free;
    body.density = kDensity;
    body.friction = kFriction;
    body.restitution = 0.0;
    def.bodies.push_back(body);
  }
  def.bodies.push_back(ground);
  return def;
}

// Poses of the members, the ground's last.
double deepestOverlap(const Scene& scene, const std::vector<Transform>& poses, double skins) {
  std::vector<ConvexShape> shapes, ground;
  for (const Polygon& shape : scene.shapes) shapes.push_back(ConvexShape::piecesOf(shape).front());
  for (const Box& box : scene.ground) ground.push_back(ConvexShape::piecesOf(Polygon::box(box)).front());
  double least = kInfinity;
  auto compare = [&](const ConvexShape& a, const Transform& poseA, const ConvexShape& b, const Transform& poseB) {
    if (!a.box(poseA).grown(skins).overlaps(b.box(poseB))) return;
    PairCache cache;
    least = std::min(least, sat(a, b, poseIn(poseA, poseB), cache).separation);
  };
  for (std::size_t i = 0; i < scene.members.size(); ++i) {
    const ConvexShape& a = shapes[scene.members[i].shape];
    for (std::size_t j = 0; j < i; ++j) compare(a, poses[i], shapes[scene.members[j].shape], poses[j]);
    for (const ConvexShape& wall : ground) compare(a, poses[i], wall, poses.back());
  }
  return std::max(0.0, skins - least);
}

// Times the measured steps; `poses` asks for them at the end.
template <typename Step, typename Poses>
void run(benchmark::State& state, const Scene& scene, double skins, Step&& step, Poses&& poses) {
  for (int k = 0; k < scene.from; ++k) step();
  const auto begin = std::chrono::steady_clock::now();
  for (int k = scene.from; k < scene.until; ++k) step();
  state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  bench::items(state, static_cast<std::size_t>(scene.until - scene.from));
  bench::timeStep(state, kStep);
  bench::error(state, deepestOverlap(scene, poses(), skins));
}

void froudeSteps(benchmark::State& state, const Scene& scene) {
  const int threads = static_cast<int>(state.range(0));
  tbb::task_arena(threads).execute([&] {
    for (auto _ : state) {
      World world(worldOf(scene));
      run(
          state, scene, 0.0, [&] { world.step(kStep); },
          [&] {
            std::vector<Transform> poses;
            for (std::size_t i = 0; i < world.bodyCount(); ++i) poses.push_back(world.body(i).transform);
            return poses;
          });
    }
  });
  bench::threads(state, threads);
}

b2Vec2 boxVec(const Vec2& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y())}; }

void addFixture(b2Body& body, const Polygon& shape) {
  std::vector<b2Vec2> points;
  for (const Vec2& v : shape.vertices()) points.push_back(boxVec(v));
  b2PolygonShape made;
  made.Set(points.data(), static_cast<int32>(points.size()));
  b2FixtureDef fixture;
  fixture.shape = &made;
  fixture.density = static_cast<float>(kDensity);
  fixture.friction = static_cast<float>(kFriction);
  body.CreateFixture(&fixture);
}

std::vector<b2Body*> fill(b2World& world, const Scene& scene) {
  world.SetAllowSleeping(scene.maySleep);
  std::vector<b2Body*> bodies;
  for (const Scene::Member& member : scene.members) {
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position = boxVec(member.at);
    bodies.push_back(world.CreateBody(&def));
    addFixture(*bodies.back(), scene.shapes[member.shape]);
  }
  b2BodyDef def;
  def.type = scene.spin == 0.0 ? b2_staticBody : b2_kinematicBody;
  def.angularVelocity = static_cast<float>(scene.spin);
  bodies.push_back(world.CreateBody(&def));
  for (const Box& box : scene.ground) addFixture(*bodies.back(), Polygon::box(box));
  return bodies;
}

void box2dSteps(benchmark::State& state, const Scene& scene) {
  for (auto _ : state) {
    b2World world(b2Vec2(0.0f, -9.81f));
    const std::vector<b2Body*> bodies = fill(world, scene);
    run(
        state, scene, 2.0 * b2_polygonRadius, [&] { world.Step(static_cast<float>(kStep), 8, 3); },
        [&] {
          std::vector<Transform> poses;
          for (const b2Body* body : bodies) {
            const b2Transform& at = body->GetTransform();
            poses.push_back({Vec2(at.p.x, at.p.y), {at.q.c, at.q.s}});
          }
          return poses;
        });
  }
}

#define FROUDE_ONCE ->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond)
BENCHMARK_CAPTURE(froudeSteps, tumbler, tumbler())->Arg(1)->Arg(2) FROUDE_ONCE;
BENCHMARK_CAPTURE(box2dSteps, tumbler, tumbler()) FROUDE_ONCE;
BENCHMARK_CAPTURE(froudeSteps, pyramid, pyramid())->Arg(1)->Arg(2) FROUDE_ONCE;
BENCHMARK_CAPTURE(box2dSteps, pyramid, pyramid()) FROUDE_ONCE;

}  // namespace
