// Walls to which the fluid sticks, against exact flows between plates.
#include <gtest/gtest.h>

#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

constexpr double kHeight = 1.0, kViscosity = 0.1;  // m, m²/s

// A channel of 20 spacings between y = 0 and y = 1, periodic along x, without gravity across it.
WorldDef channel(const std::string& method) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {1.0, kHeight}};
  def.domain.periodicX = true;
  def.domain.closed = {false, false, true, true};
  def.domain.slip = Slip::NoSlip;
  def.gravity = {0.0, 0.0};
  def.fluid = FluidDef{};
  def.fluid->model = method;
  def.fluid->spacing = 0.05;
  def.fluid->viscosity = kViscosity;
  return def;
}

void fillChannel(World& world, double height) {
  std::vector<Vec2> positions;
  const double dx = world.definition().fluid->spacing;
  for (double y = 0.5 * dx; y < height; y += dx) {
    for (double x = 0.5 * dx; x < 1.0; x += dx) positions.emplace_back(x, y);
  }
  world.addFluid(positions, std::vector<Vec2>(positions.size(), Vec2(0.0, 0.0)));
}

// Largest difference of the particles' velocity along the channel to `exact`(y).
template <typename Exact>
double largestError(const World& world, Exact&& exact) {
  const ParticlePool& pool = *world.fluid();
  double most = 0.0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    most = std::max(most, std::abs(pool.vx()[i] - exact(pool.y()[i])));
  }
  return most;
}

// Start-up flows as series, from rest; Morris, Fox and Zhu, J. Comput. Phys. 136 (1997), eq. 28 and 29.
double poiseuille(double y, double t, double force) {
  double u = force / (2.0 * kViscosity) * y * (kHeight - y);
  for (int n = 0; n < 200; ++n) {
    const double k = kPi * (2 * n + 1) / kHeight;
    u -= 4.0 * force / (kViscosity * kHeight * k * k * k) * std::sin(k * y) * std::exp(-kViscosity * k * k * t);
  }
  return u;
}

double couette(double y, double t, double speed) {
  double u = speed * y / kHeight;
  for (int n = 1; n < 200; ++n) {
    const double k = kPi * n / kHeight;
    u += 2.0 * speed / (n * kPi) * (n % 2 == 0 ? 1.0 : -1.0) * std::sin(k * y) * std::exp(-kViscosity * k * k * t);
  }
  return u;
}

class NoSlip : public FluidMethod {};
INSTANTIATE_TEST_SUITE_P(Each, NoSlip, kFluidMethods, methodName);

TEST_P(NoSlip, a_flow_driven_between_plates_takes_the_parabola) {
  const double force = 0.08, largest = force * kHeight * kHeight / (8.0 * kViscosity);  // 0.1 m/s: Re = 1
  WorldDef def = channel(GetParam());
  def.gravity = {force, 0.0};
  World world(def);
  fillChannel(world, kHeight);
  for (const double time : {0.5, 2.0, 8.0}) {  // t ν/L² = 0.05, 0.2, 0.8
    ASSERT_TRUE(world.step(time - world.time()).ok());
    EXPECT_LT(largestError(world, [&](double y) { return poiseuille(y, time, force); }), 0.04 * largest) << time;
  }
  EXPECT_EQ(world.fluid()->size(), 400u);
  EXPECT_EQ(world.ledger().leaks, 0u);
}

TEST_P(NoSlip, a_belt_drags_the_fluid_along_and_feels_the_shear) {
  const double speed = 0.1;
  WorldDef def = channel(GetParam());
  def.domain.box.max.y() = 1.4;
  BodyDef belt;
  belt.name = "belt";
  belt.shape = std::make_shared<const Polygon>(Polygon::box({{-1.0, 0.0}, {2.0, 0.3}}));
  belt.position = {0.0, kHeight};
  // Counter-clockwise along the edge is along +x on the lower side.
  belt.surfaceVelocity = speed;
  def.bodies.push_back(belt);
  World world(def);
  fillChannel(world, kHeight);
  for (const double time : {0.5, 2.0, 8.0}) {
    ASSERT_TRUE(world.step(time - world.time()).ok());
    EXPECT_LT(largestError(world, [&](double y) { return couette(y, time, speed); }), 0.04 * speed) << time;
  }
  const double shear = def.fluid->density * kViscosity * speed / kHeight;  // [N/m] of a channel 1 m long
  EXPECT_NEAR(world.body(0).force.x(), -shear, 0.05 * shear);
}

TEST_P(NoSlip, a_free_wall_beside_it_lets_the_fluid_slide) {
  WorldDef def = channel(GetParam());
  def.domain.slip = Slip::Free;
  def.gravity = {0.08, 0.0};
  World world(def);
  fillChannel(world, kHeight);
  const StepReport report = world.step(1.0);
  ASSERT_TRUE(report.ok()) << name(report.trouble) << " " << report.troubleValue << " at " << world.time();
  EXPECT_LT(largestError(world, [](double) { return 0.08; }), 1e-3 * 0.08);
}

}  // namespace
}  // namespace froude::testing
