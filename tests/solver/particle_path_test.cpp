// Paths of single particles among moving polygons.
#include <froude/solver/coupling/particle_path.h>

#include <gtest/gtest.h>

#include <froude/solver/rigid/body_set.h>
#include "support/worlds.h"

namespace froude {
namespace {

// A paddle turns into a particle that slides out along it: it meets it again and again, and after the last contact the
// particle has to follow the paddle's arc, for a chord would end inside.
TEST(ParticlePath, what_a_turning_paddle_pushes_for_many_contacts_ends_outside_it) {
  WorldDef def;
  def.domain.box = {{-2.0, -2.0}, {2.0, 2.0}};
  BodyDef paddle = testing::body("paddle", Polygon::box({{0.0, -0.02}, {0.5, 0.02}}), {0.0, 0.0});
  paddle.motion = Motion::Scripted;
  paddle.spin = 5.0;
  def.bodies.push_back(paddle);
  const double dt = 0.02;
  BodySet bodies(def.bodies);
  Obstacles obstacles(def.domain, bodies, 0.1);
  bodies.beginStep(0.0, dt);
  obstacles.beginStep(bodies, dt, 1.0);
  const DiscContact point{0.0, 0.0, 0.0, {}, true};
  int many = 0;
  for (int k = 0; k < 400; ++k) {
    const Vec2 start(0.05 + 0.001 * k, 0.0201 + 1e-5 * (k % 7));
    const Vec2 velocity(0.5 * (k % 5), -1.0 - 0.5 * (k % 3));
    PathResult path;
    followPath(obstacles, start, velocity, dt, point, path);
    many += path.contacts > kMaxBounces ? 1 : 0;
    EXPECT_GE(obstacles.distance(path.x, {}).distance, 0.0) << k << " after " << path.contacts << " contacts";
    EXPECT_FALSE(path.crushed) << k;
  }
  EXPECT_GT(many, 10) << "the case that this test is about";
}

}  // namespace
}  // namespace froude
