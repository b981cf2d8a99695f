// Soft bodies where methods fail: inverted, nearly incompressible, divided finely; and with a fluid.
#include <gtest/gtest.h>

#include <froude/base/random.h>
#include <froude/solver/world.h>

#include "support/soft_meshes.h"

namespace froude {
namespace {

using testing::lattice;
using testing::pinnedWhere;
using testing::softWorld;
using testing::tipOf;

// Σ over the points of the distance to where the best rigid motion of the rest shape puts them, rms.
double misfit(const World& world) {
  const auto& rest = world.softDefinition(0).mesh->points;
  const auto x = world.soft()->x(), y = world.soft()->y();
  Vec2 a(0.0, 0.0), b(0.0, 0.0);
  for (std::size_t k = 0; k < rest.size(); ++k) a += rest[k], b += Vec2(x[k], y[k]);
  a /= static_cast<double>(rest.size());
  b /= static_cast<double>(rest.size());
  double along = 0.0, turn = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const Vec2 p = rest[k] - a, q = Vec2(x[k], y[k]) - b;
    along += p.dot(q);
    turn += cross(p, q);
  }
  const Rotation r = Rotation::of(std::atan2(turn, along));
  for (std::size_t k = 0; k < rest.size(); ++k) {
    sum += (Vec2(x[k], y[k]) - b - r.apply(rest[k] - a)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(rest.size()));
}

int recovered(int trials) {
  int count = 0;
  for (int trial = 0; trial < trials; ++trial) {
    SoftDef def;
    def.mesh = lattice(0.4, 0.4, 5, 5);
    def.spacing = 0.08;
    def.poisson = 0.3;
    def.damping = 20.0;
    def.collidesWith = 0;  // nor with itself
    def.position = {0.8, 0.8};
    WorldDef worldDef = softWorld({def}, Vec2(0.0, 0.0));
    World world(worldDef);
    RandomStream random(static_cast<std::uint64_t>(trial), 1);
    for (std::size_t i = 0; i < world.soft()->size(); ++i) {
      world.soft()->x()[i] = random.uniform(0.8, 1.2);
      world.soft()->y()[i] = random.uniform(0.8, 1.2);
    }
    if (world.step(4.0).ok() && misfit(world) < 0.004) ++count;
  }
  return count;
}

TEST(SoftLimits, points_thrown_together_at_random_find_their_shape_again) { EXPECT_EQ(recovered(10), 10); }
TEST(LongSoftLimits, a_hundred_bodies_turned_inside_out_recover) { EXPECT_EQ(recovered(100), 100); }

TEST(SoftLimits, a_block_squeezed_to_half_changes_its_area_as_its_law_says) {
  SoftDef def;
  def.mesh = lattice(0.4, 0.4, 8, 8);
  def.spacing = 0.05;
  def.young = 1.0e5;
  def.poisson = 0.49;
  def.damping = 10.0;
  def.friction = 0.0;
  def.position = {0.8, 0.0};
  WorldDef worldDef = softWorld({def}, Vec2(0.0, 0.0));
  BodyDef press;
  press.name = "press";
  press.shape = std::make_shared<Polygon>(Polygon::box({{0.0, 0.41}, {2.0, 0.6}}));
  press.motion = Motion::Scripted;
  press.script.push_back({0.42, {}, [](double) { return -0.5; }, {}});
  worldDef.bodies.push_back(press);
  World world(worldDef);
  ASSERT_TRUE(world.step(1.0).ok());
  double top = 0.0;
  for (const double y : world.soft()->y()) top = std::max(top, y);
  EXPECT_NEAR(top, 0.2, 1e-3);
  // Stretches 1/2 and 2 J with free sides: μ λ_x + (λ + μ)(J − γ)/2 = 0; at ν = 0.49 the law gives J = 0.9444.
  const double ratio = 1.0 - 2.0 * 0.49, exact = (1.0 + ratio) / (1.0 + 4.0 * ratio);
  EXPECT_NEAR(world.softState(0).area / 0.16, exact, 0.01);
}

TEST(SoftLimits, statics_do_not_depend_on_how_finely_a_step_is_divided_or_swept) {
  std::vector<double> tips;
  for (const auto& [substeps, tolerance] : std::vector<std::pair<int, double>>{{10, 0.0}, {200, 0.0}, {10, 1e-4}}) {
    SoftDef def;
    def.mesh = lattice(0.4, 0.08, 20, 4);
    def.spacing = 0.02;
    def.young = 1.0e5;
    def.poisson = 0.3;
    def.damping = 18.0;
    def.pinned = pinnedWhere(*def.mesh, [](const Vec2& p) { return p.x() < 1e-9; });
    WorldDef worldDef = softWorld({def}, Vec2(0.0, -1.0));
    worldDef.softSettings = {substeps, tolerance};
    World world(worldDef);
    ASSERT_TRUE(world.step(2.0).ok());
    tips.push_back(tipOf(world, 0, Vec2(0.4, 0.04)).y());
  }
  EXPECT_LT(tips[0], -0.01);
  EXPECT_NEAR(tips[1], tips[0], 1e-3 * std::abs(tips[0]));
  EXPECT_NEAR(tips[2], tips[0], 1e-3 * std::abs(tips[0]));
}

}  // namespace
}  // namespace froude
