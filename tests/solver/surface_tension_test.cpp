// Surface tension against Laplace, Rayleigh and Young, its books, and its sub-step.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "support/fluid_methods.h"

namespace froude::testing {
namespace {

class SurfaceTension : public FluidMethod {
 protected:
  /// σ = 1 N, ρ = 1 kg/m², no weight.
  static WorldDef tenseWorld(const Box& domain, double dx) {
    WorldDef def = fluidWorld(domain, dx);
    def.gravity = {0.0, 0.0};
    def.fluid->density = 1.0;
    def.fluid->surfaceTension = 1.0;
    return def;
  }
  /// Lattice points in the disc of radius 0.5 m about the middle.
  static std::vector<Vec2> disc(const Vec2& middle, double dx) {
    std::vector<Vec2> points;
    for (const Vec2& p : latticePoints({{-0.5, -0.5}, {0.5, 0.5}}, dx)) {
      if (p.norm() < 0.5) points.push_back(middle + p);
    }
    return points;
  }
  static double kinetic(const World& world) { return world.totals().kinetic; }
};

INSTANTIATE_TEST_SUITE_P(Methods, SurfaceTension, kTensionMethods, methodName);

TEST_P(SurfaceTension, a_drop_at_rest_has_the_pressure_of_laplace_and_comes_to_rest) {
  WorldDef def = tenseWorld({{-1.0, -1.0}, {1.0, 1.0}}, 0.04);
  def.fluid->viscosity = 0.05;
  World world(def);
  const std::vector<Vec2> points = disc({0.0, 0.0}, 0.04);
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  const double radius = std::sqrt(world.totals().mass / kPi);
  runTo(world, 0.6);
  double pressure = 0.0, count = 0.0;
  while (world.time() < 1.0) {
    ASSERT_TRUE(world.substep().ok());
    for (int k = 0; k < 16; ++k) {
      pressure += world.pressureAt({0.15 * (k % 4 - 1.5), 0.15 * (k / 4 - 1.5)});
      count += 1.0;
    }
  }
  EXPECT_NEAR(pressure / count, 1.0 / radius, 0.05 / radius);
  EXPECT_LT(meanSpeed(world), 0.03 * std::sqrt(1.0 / radius));
}

TEST_P(SurfaceTension, a_drop_swings_with_the_period_of_rayleigh) {
  WorldDef def = tenseWorld({{-1.0, -1.0}, {1.0, 1.0}}, 0.04);
  World world(def);
  const std::vector<Vec2> points = disc({0.0, 0.0}, 0.04);
  std::vector<Vec2> push;
  for (const Vec2& p : points) push.emplace_back(0.3 * p.x(), -0.3 * p.y());
  world.addFluid(points, push);
  const double area = world.totals().mass, radius = std::sqrt(area / kPi);
  const double period = 2.0 * kPi / std::sqrt(6.0 / (radius * radius * radius));
  auto lying = [&] {
    double sum = 0.0;
    const ParticlePool& pool = *std::as_const(world).fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) sum += pool.x()[i] * pool.x()[i] - pool.y()[i] * pool.y()[i];
    return sum;
  };
  std::vector<double> round;
  runTo(world, 0.25 * period);
  EXPECT_GT(lying(), 0.0);
  double last = lying();
  while (round.size() < 3 && world.time() < 2.0 * period) {
    ASSERT_TRUE(world.substep().ok());
    const double now = lying();
    if (now * last < 0.0) round.push_back(world.time());
    last = now;
  }
  ASSERT_EQ(round.size(), 3u);
  EXPECT_NEAR(round[2] - round[0], period, 0.05 * period);
}

// As much mass again far away: what a drop loses is not given to another.
TEST_P(SurfaceTension, momentum_closes_to_rounding_for_each_drop) {
  WorldDef def = tenseWorld({{-3.0, -1.0}, {3.0, 1.0}}, 0.05);
  World world(def);
  for (const double side : {-1.5, 1.5}) {
    std::vector<Vec2> points = latticePoints({{side - 0.4, -0.2}, {side + 0.3, 0.3}}, 0.05);
    points.push_back({side + 0.37, 0.05});
    world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  }
  runTo(world, 0.3);
  EXPECT_GT(world.ledger().maxSpeed, 0.3) << "it draws itself together";
  Vec2 left(0.0, 0.0), right(0.0, 0.0);
  const ParticlePool& pool = *std::as_const(world).fluid();
  for (std::size_t i = 0; i < pool.size(); ++i) {
    (pool.x()[i] < 0.0 ? left : right) += Vec2(pool.vx()[i], pool.vy()[i]);
  }
  // dfsph gives what its tense particles take back to all of them alike, near or far.
  const double scale = 1e-6 * static_cast<double>(pool.size()) * world.ledger().maxSpeed;
  EXPECT_LT((left + right).norm(), scale);
  if (pbf()) {
    EXPECT_LT(left.norm(), scale);
    EXPECT_LT(right.norm(), scale);
  }
}

TEST_P(SurfaceTension, what_a_wall_pulls_is_in_the_books_and_a_free_body_takes_it) {
  WorldDef def = tenseWorld({{-1.0, 0.0}, {1.0, 1.2}}, 0.05);
  def.fluid->contactAngle = kPi / 4.0;
  BodyDef raft = body("raft", Polygon::box({{-0.4, -0.05}, {0.4, 0.05}}), {0.1, 0.6});
  raft.motion = Motion::Free;
  raft.density = 3.0;
  def.bodies.push_back(raft);
  World world(def);
  fill(world, {{-0.6, 0.0}, {0.0, 0.3}}, 0.05);   // on the floor
  fill(world, {{-0.2, 0.65}, {0.1, 0.9}}, 0.05);  // on the body
  runTo(world, 0.5);
  EXPECT_GT(world.ledger().impulse.norm(), 1e-3 * world.totals().mass) << "the floor pulls";
  EXPECT_LT(momentumError(world), 1e-6);
  EXPECT_LT(world.ledger().energyDrift, 0.02);
}

TEST_P(SurfaceTension, a_drop_meets_a_floor_at_the_contact_angle) {
  for (const double degrees : {60.0, 120.0}) {
    WorldDef def = tenseWorld({{-1.5, 0.0}, {1.5, 1.2}}, 0.05);
    def.fluid->contactAngle = degrees * kPi / 180.0;
    def.fluid->viscosity = 0.1;
    World world(def);
    std::vector<Vec2> points;
    for (const Vec2& p : latticePoints({{-0.5, 0.0}, {0.5, 0.5}}, 0.05)) {
      if (p.norm() < 0.5) points.push_back(p);
    }
    world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
    const double area = world.totals().mass;
    runTo(world, 3.0);
    double height = 0.0, count = 0.0;
    while (world.time() < 5.0) {
      ASSERT_TRUE(world.substep().ok());
      for (const double y : world.fluid()->y()) height += y;
      count += static_cast<double>(world.fluid()->size());
    }
    // The centroid of a circle's cap above its base, over the root of its area.
    auto centroid = [](double angle) {
      const double s = std::sin(angle), cap = angle - s * std::cos(angle);
      return (2.0 / 3.0 * s * s * s / cap - std::cos(angle)) / std::sqrt(cap);
    };
    const double found = height / count / std::sqrt(area);
    EXPECT_GT(found, centroid((degrees - 7.0) * kPi / 180.0)) << degrees;
    EXPECT_LT(found, centroid((degrees + 7.0) * kPi / 180.0)) << degrees;
  }
}

TEST_P(SurfaceTension, capillary_waves_bind_the_sub_step_and_are_named) {
  WorldDef def = tenseWorld({{-1.0, -1.0}, {1.0, 1.0}}, 0.05);
  World world(def);
  const std::vector<Vec2> points = disc({0.0, 0.0}, 0.05);
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  const StepReport report = world.substep();
  EXPECT_EQ(report.limit, StepLimit::Tension);
  EXPECT_EQ(name(report.limit), "surface tension");
  EXPECT_NEAR(report.dt, 0.2 * std::sqrt(0.05 * 0.05 * 0.05), 1e-12);
}

// A drop that is let go draws its skin straight, and sends a wave of pressure through itself.
TEST_P(SurfaceTension, a_drop_does_not_ring) {
  WorldDef def = tenseWorld({{-1.0, -1.0}, {1.0, 1.0}}, 0.04);
  def.fluid->viscosity = 0.02;
  World world(def);
  const std::vector<Vec2> points = disc({0.0, 0.0}, 0.04);
  world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
  runTo(world, 0.5);
  while (world.time() < 0.7) {
    ASSERT_TRUE(world.substep().ok());
    EXPECT_NEAR(world.pressureAt({0.0, 0.0}), 2.0, 0.4) << world.time();
  }
}

TEST_P(SurfaceTension, the_same_bits_on_any_number_of_threads) {
  auto hash = [&](int threads) {
    std::string result;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      WorldDef def = tenseWorld({{-1.0, 0.0}, {1.0, 1.2}}, 0.02);
      World world(def);
      fill(world, {{-0.6, 0.0}, {0.0, 0.3}}, 0.02);
      for (int k = 0; k < 30; ++k) world.substep();
      result = world.stateHash();
    });
    return result;
  };
  const std::string one = hash(1);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(hash(threads), one) << threads;
}

TEST_P(SurfaceTension, a_single_particle_and_what_a_nozzle_carries_are_left_alone) {
  WorldDef def = tenseWorld({{-1.0, -1.0}, {1.0, 1.0}}, 0.05);
  def.emitters.push_back(nozzle({-0.8, 0.1}, {-0.8, -0.1}, 0.5, 1000));
  World world(def);
  world.addFluid(std::vector<Vec2>{{0.8, 0.8}}, std::vector<Vec2>{{0.0, -0.1}});
  runTo(world, 0.5);
  const ParticlePool& pool = *std::as_const(world).fluid();
  EXPECT_GT(pool.size(), 15u);
  bool found = false;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (pool.y()[i] > 0.6) {
      found = true;
      EXPECT_EQ(pool.vx()[i], 0.0);
      EXPECT_NEAR(pool.vy()[i], -0.1, 1e-12);
    }
    // One support radius is carried; the jet leaves along x.
    EXPECT_TRUE(pool.x()[i] > -0.75 || std::abs(pool.vx()[i] - 0.5) < 1e-9) << pool.x()[i] << " " << pool.vx()[i];
  }
  EXPECT_TRUE(found);
  EXPECT_LT(momentumError(world), 1e-6);
}

TEST_P(SurfaceTension, the_sides_of_a_seam_are_one_drop) {
  auto spread = [&](double middle, bool periodic) {
    WorldDef def = tenseWorld({{-1.0, -1.0}, {1.0, 1.0}}, 0.05);
    def.domain.periodicX = periodic;
    def.domain.closed = {!periodic, !periodic, true, true};
    World world(def);
    std::vector<Vec2> points = latticePoints({{-0.4, -0.2}, {0.4, 0.2}}, 0.05);
    for (Vec2& p : points) {
      p.x() += middle;
      if (p.x() > 1.0) p.x() -= 2.0;
    }
    world.addFluid(points, std::vector<Vec2>(points.size(), Vec2(0.0, 0.0)));
    runTo(world, 0.2);
    double sum = 0.0;
    for (const double y : world.fluid()->y()) sum += y * y;
    return sum / static_cast<double>(points.size());
  };
  const double whole = spread(0.0, false);
  EXPECT_NEAR(spread(1.0, true), whole, 0.05 * whole) << "dfsph takes means over cells, which lie otherwise";
}

}  // namespace
}  // namespace froude::testing
