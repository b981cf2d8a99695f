// What gauges read: water at rest in shapes whose area, surface and toe are known.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "gauge_support.h"
#include "run/gauge_bulk.h"
#include "run/gauge_surface.h"
#include "run/gauge_values.h"

namespace froude::run {
namespace {

using test::addBlock;
using test::gauge;
using test::readNow;
using test::tank;

std::shared_ptr<const Polygon> shared(Polygon polygon) { return std::make_shared<const Polygon>(std::move(polygon)); }

TEST(GaugeQuantile, agrees_with_sorting) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (std::size_t n : {std::size_t{1}, std::size_t{2}, std::size_t{5}, std::size_t{1000}}) {
    std::vector<double> values(n);
    for (double& v : values) v = uniform(random);
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double q : {0.0, 0.1, 0.5, 0.995, 1.0}) {
      const double place = q * static_cast<double>(n - 1);
      const auto low = static_cast<std::size_t>(std::floor(place));
      const std::size_t high = std::min(low + 1, n - 1);
      const double expected = sorted[low] + (place - static_cast<double>(low)) * (sorted[high] - sorted[low]);
      EXPECT_DOUBLE_EQ(quantile(values, q), expected) << n << " values, q = " << q;
    }
  }
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(GaugeFront, is_the_quantile_of_the_named_coordinate) {
  World world(tank(0.01));
  addBlock(world, {{0.0, 0.0}, {1.0, 0.5}});
  scene::GaugeDef front = gauge("front", 0.1);
  front.quantile = 1.0;
  EXPECT_NEAR(readNow(world, front)[0], 0.995, 1e-12);
  front.axis = 'y';
  EXPECT_NEAR(readNow(world, front)[0], 0.495, 1e-12);
  front.quantile = 0.5;
  EXPECT_NEAR(readNow(world, front)[0], 0.25, 1e-12);
}

// The particles' part by adding up must be φ itself, away from all solids.
TEST(GaugeBulk, is_the_filled_fraction_away_from_solids) {
  WorldDef def = tank(0.02);
  def.domain.closed = {false, false, false, false};
  World world(def);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vec2> places;
  for (int k = 0; k < 3000; ++k) places.emplace_back(2.0 * uniform(random), uniform(random));
  world.addFluid(places, std::vector<Vec2>(places.size(), Vec2(0, 0)));
  const CellWindow window{{0.313, -0.031}, 0.01, 111, 97};
  const BulkFraction bulk(*world.fluid(), window);
  std::vector<float> sums(111 * 97);
  bulk.rows(0, 40, sums.data());
  for (const std::int64_t first : {0, 32, 64, 96})
    bulk.rows(first, std::min<std::int64_t>(32, 97 - first), sums.data() + first * 111);
  std::vector<Vec2> points;
  for (std::int64_t j = 0; j < window.rows; ++j)
    for (std::int64_t i = 0; i < window.columns; ++i) points.push_back(window.centre(i, j));
  std::vector<double> phi(points.size());
  world.filledFraction(points, phi);
  double largest = 0.0;
  for (std::size_t k = 0; k < phi.size(); ++k) {
    ASSERT_NEAR(static_cast<double>(sums[k]), phi[k], 1e-6) << points[k].transpose();
    largest = std::max(largest, phi[k]);
  }
  EXPECT_GT(largest, 1.0);
}

/// Area of the cells of dx/2 with φ ≥ ½ and a particle within the support radius, over the whole domain, one by one.
double areaByCounting(const World& world) {
  const Box box = world.definition().domain.box;
  const double dx = world.definition().fluid->spacing, h = 0.5 * dx;
  std::size_t wet = 0;
  for (double y = box.min.y() + 0.5 * h; y < box.max.y(); y += h)
    for (double x = box.min.x() + 0.5 * h; x < box.max.x(); x += h) {
      const Vec2 p(x, y);
      double phi = 0.0;
      world.filledFraction({&p, 1}, {&phi, 1});
      if (!(phi >= 0.5)) continue;
      const auto px = world.fluid()->x(), py = world.fluid()->y();
      bool near = false;
      for (std::size_t k = 0; k < px.size() && !near; ++k) near = std::hypot(px[k] - x, py[k] - y) < 2.0 * dx;
      if (near) ++wet;
    }
  return static_cast<double>(wet) * h * h;
}

TEST(GaugeVolume, of_a_block_is_its_area) {
  for (const double spacing : {0.02, 0.01}) {
    World world(tank(spacing));
    addBlock(world, {{0.0, 0.0}, {1.0, 0.5}});
    EXPECT_NEAR(readNow(world, gauge("volume", 0.1))[0], 0.5, 0.1 * spacing * spacing * 100) << spacing;
  }
}

TEST(GaugeVolume, is_the_count_of_wet_cells_whatever_lies_between) {
  WorldDef def = tank(0.02);
  def.bodies.resize(3);
  def.bodies[0].name = "octagon";
  def.bodies[0].shape = shared(Polygon::regular(8, 0.13));
  def.bodies[0].position = {0.5, 0.2};
  def.bodies[1].name = "hook";
  def.bodies[1].shape = shared(Polygon::make({{0, 0}, {0.3, 0}, {0.3, 0.3}, {0.25, 0.3}, {0.25, 0.05}, {0, 0.05}}));
  def.bodies[1].position = {0.8, 0.25};
  def.bodies[1].angle = 0.5;
  def.bodies[2].name = "speck";  // smaller than a spacing
  def.bodies[2].shape = shared(Polygon::regular(5, 0.008));
  def.bodies[2].position = {0.213, 0.333};
  World world(def);
  std::vector<Vec2> places = test::blockOf(world, {{0.0, 0.0}, {1.2, 0.5}});
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-0.006, 0.006);
  std::erase_if(places, [](const Vec2& p) { return (p - Vec2(0.3, 0.2)).norm() < 0.05; });  // a bubble
  for (Vec2& p : places) {
    const Vec2 moved = p + Vec2(uniform(random), uniform(random));
    if (!world.insideSolid(moved)) p = moved;
  }
  for (int k = 0; k < 40; ++k) places.emplace_back(1.9 + uniform(random), 0.02 * k + 0.1);  // spray
  world.addFluid(places, std::vector<Vec2>(places.size(), Vec2(0, 0)));
  const double counted = areaByCounting(world);
  EXPECT_NEAR(GaugeSet::fluidArea(world), counted, 1e-12);
  EXPECT_GT(counted, 0.4);
}

TEST(GaugeVolume, has_the_same_bits_on_any_number_of_threads) {
  WorldDef def = tank(0.01);
  def.bodies.resize(1);
  def.bodies[0].name = "octagon";
  def.bodies[0].shape = shared(Polygon::regular(8, 0.1));
  def.bodies[0].position = {0.5, 0.2};
  World world(def);
  addBlock(world, {{0.0, 0.0}, {1.2, 0.5}});
  world.step(0.01);
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 7);
  std::vector<double> first;
  for (const int threads : {1, 2, 3, 7}) {
    std::vector<double> values;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      FluidSurface surface(world);
      values = {surface.area(), surface.level(), surface.toe(), surface.height(0.5)};
    });
    if (first.empty()) first = values;
    EXPECT_EQ(values, first) << threads << " threads";
  }
}

TEST(GaugeLevel, of_still_water_is_its_depth_from_wall_to_wall) {
  World world(tank(0.02));
  addBlock(world, {{0.0, 0.0}, {2.0, 0.5}});
  EXPECT_NEAR(readNow(world, gauge("level", 0.1))[0], 0.5, 0.001);
  // Within a support radius of a wall λ lifts the line φ = ½, by less than a spacing.
  for (const double x : {0.003, 0.05, 0.5, 1.017, 1.999}) {
    scene::GaugeDef height = gauge("height", 0.1);
    height.x = x;
    EXPECT_NEAR(readNow(world, height)[0], 0.5, x < 0.04 || x > 1.96 ? 0.02 : 0.002) << x;
  }
}

TEST(GaugeLevel, is_above_the_domains_lower_side) {
  WorldDef def = tank(0.02);
  def.domain.box = {{0.0, -3.0}, {2.0, -2.0}};
  World world(def);
  addBlock(world, {{0.0, -3.0}, {2.0, -2.5}});
  EXPECT_NEAR(readNow(world, gauge("level", 0.1))[0], 0.5, 0.001);
}

TEST(GaugeLevel, of_a_full_tank_ends_at_the_ceiling) {
  World world(tank(0.02));
  addBlock(world, {{0.0, 0.0}, {2.0, 1.0}});
  EXPECT_NEAR(readNow(world, gauge("level", 0.1))[0], 1.0, 1e-6);
  EXPECT_NEAR(readNow(world, gauge("volume", 0.1))[0], 2.0, 1e-9);
}

TEST(GaugeHeight, ends_at_the_first_gap_and_is_zero_where_the_bottom_is_dry) {
  World world(tank(0.02));
  addBlock(world, {{0.0, 0.0}, {1.0, 0.2}});
  addBlock(world, {{0.0, 0.6}, {1.0, 0.8}});
  scene::GaugeDef height = gauge("height", 0.1);
  height.x = 0.5;
  EXPECT_NEAR(readNow(world, height)[0], 0.2, 0.002);
  height.x = 1.5;
  EXPECT_EQ(readNow(world, height)[0], 0.0);
  World floating(tank(0.02));
  addBlock(floating, {{0.0, 0.6}, {1.0, 0.8}});
  height.x = 0.5;
  EXPECT_EQ(readNow(floating, height)[0], 0.0);
  EXPECT_TRUE(std::isnan(readNow(floating, gauge("level", 0.1))[0]));
}

TEST(GaugeHeight, stands_on_a_bed_and_stops_under_a_roof) {
  WorldDef def = tank(0.02);
  def.bodies.resize(2);
  def.bodies[0].name = "bed";
  def.bodies[0].shape = shared(Polygon::box({{0.0, 0.0}, {2.0, 0.31}}));
  def.bodies[1].name = "roof";
  def.bodies[1].shape = shared(Polygon::box({{1.0, 0.517}, {2.0, 0.7}}));
  World world(def);
  addBlock(world, {{0.0, 0.31}, {1.0, 0.51}});
  addBlock(world, {{1.0, 0.31}, {2.0, 0.51}});
  scene::GaugeDef height = gauge("height", 0.1);
  height.x = 0.5;
  EXPECT_NEAR(readNow(world, height)[0], 0.51, 0.003);
  height.x = 1.5;
  EXPECT_NEAR(readNow(world, height)[0], 0.517, 1e-6);
  EXPECT_NEAR(readNow(world, gauge("volume", 0.1))[0], 2.0 * 0.2 + 0.007, 0.01);
}

// φ ≥ ½ reaches beyond the particles' own half-plane at the foot of a front: λ of the floor fills half of the support.
TEST(GaugeToe, of_a_block_is_its_foot) {
  for (const double spacing : {0.04, 0.02, 0.01}) {
    World world(tank(spacing));
    addBlock(world, {{0.0, 0.0}, {1.0, 0.52}});
    const double toe = readNow(world, gauge("toe", 0.1))[0];
    EXPECT_GT(toe, 1.0);
    EXPECT_LT(toe, 1.0 + 0.6 * spacing);
  }
}

TEST(GaugeToe, passes_over_drops_and_spray_and_dry_corners) {
  World world(tank(0.02));
  addBlock(world, {{0.0, 0.0}, {1.0, 0.5}});
  const double alone = FluidSurface(world).toe();
  addBlock(world, {{1.5, 0.6}, {1.8, 0.9}});  // in the air
  EXPECT_EQ(FluidSurface(world).toe(), alone);
  addBlock(world, {{1.2, 0.0}, {1.24, 0.04}});  // four particles on the floor
  EXPECT_EQ(FluidSurface(world).toe(), alone);
  addBlock(world, {{1.98, 0.0}, {2.0, 0.02}});  // one in the corner
  EXPECT_EQ(FluidSurface(world).toe(), alone);
}

TEST(GaugeToe, of_a_jet_that_comes_down_is_where_it_reaches) {
  // An arch: from the block along the top, down to the floor; and the same arch cut above the floor.
  const auto toeOf = [](double lowest) {
    World world(tank(0.02));
    addBlock(world, {{0.0, 0.0}, {0.5, 0.6}});
    addBlock(world, {{0.5, 0.5}, {1.6, 0.6}});
    addBlock(world, {{1.4, lowest}, {1.6, 0.5}});
    return FluidSurface(world).toe();
  };
  EXPECT_NEAR(toeOf(0.0), 1.6, 0.02);
  EXPECT_NEAR(toeOf(0.3), 1.6, 0.02);  // still one region, which touches the floor elsewhere
  World cut(tank(0.02));
  addBlock(cut, {{0.0, 0.0}, {0.5, 0.6}});
  addBlock(cut, {{0.7, 0.5}, {1.6, 0.6}});
  EXPECT_NEAR(FluidSurface(cut).toe(), 0.5, 0.02);
}

TEST(GaugeToe, takes_the_largest_drop_where_there_is_nothing_else) {
  World world(tank(0.02));
  addBlock(world, {{0.4, 0.0}, {0.44, 0.04}});
  addBlock(world, {{1.0, 0.0}, {1.02, 0.02}});
  EXPECT_NEAR(FluidSurface(world).toe(), 0.44, 0.02);
  World empty(tank(0.02));
  EXPECT_TRUE(std::isnan(FluidSurface(empty).toe()));
  EXPECT_EQ(FluidSurface(empty).area(), 0.0);
  EXPECT_EQ(FluidSurface(empty).height(0.5), 0.0);
}

TEST(GaugeToe, moves_with_the_water_and_never_jumps) {
  double before = 0.0;
  for (int k = 0; k <= 60; ++k) {
    WorldDef def = tank(0.02);
    def.domain.closed[0] = false;
    World world(def);
    const double left = 0.501 + 0.001 * k;
    addBlock(world, {{left, 0.0}, {left + 1.0 - 1e-9, 0.3}});
    const double toe = FluidSurface(world).toe();
    if (k > 0) {
      EXPECT_NEAR(toe - before, 0.001, 0.0006) << left;
    }
    before = toe;
  }
}

TEST(GaugeToe, of_water_at_a_wall_is_the_wall) {
  WorldDef def = tank(0.02);
  def.domain.box.max.x() = 1.983;  // between the cells
  World world(def);
  addBlock(world, {{0.983, 0.0}, {1.983, 0.3}});
  EXPECT_NEAR(FluidSurface(world).toe(), 1.983, 1e-9);
}

TEST(GaugeToe, crosses_no_wall) {
  WorldDef def = tank(0.02);
  def.bodies.resize(1);
  def.bodies[0].name = "gate";
  def.bodies[0].shape = shared(Polygon::box({{1.0, 0.0}, {1.1, 1.0}}));
  World world(def);
  addBlock(world, {{0.0, 0.0}, {1.0, 0.5}});
  EXPECT_NEAR(FluidSurface(world).toe(), 1.0, 1e-6);
}

TEST(GaugeSums, agree_with_sums_over_the_columns) {
  WorldDef def = tank(0.05);
  def.bullet = BulletDef{};
  World world(def);
  const std::vector<Vec2> places = test::blockOf(world, {{0.0, 0.0}, {0.5, 0.5}});
  std::vector<Vec2> velocities;
  for (const Vec2& p : places) velocities.emplace_back(p.y(), -2.0 * p.x());
  world.addFluid(places, velocities);
  world.addBullets(std::vector<Vec2>{{1.0, 0.5}, {1.5, 0.75}}, std::vector<Vec2>{{3.0, 4.0}, {0.0, 0.0}});
  const double m = 1000.0 * 0.05 * 0.05, b = 1000.0 * kPi * 0.002 * 0.002;
  double kinetic = 0.0, potential = 0.0, angular = 0.0, speed = 0.0;
  Vec2 momentum(0, 0);
  for (std::size_t k = 0; k < places.size(); ++k) {
    kinetic += 0.5 * m * velocities[k].squaredNorm();
    potential += m * 9.81 * places[k].y();
    momentum += m * velocities[k];
    angular += m * cross(places[k], velocities[k]);
    speed = std::max(speed, velocities[k].norm());
  }
  const auto count = static_cast<double>(places.size());
  const auto of = [&](const char* type, std::optional<Species> species) {
    scene::GaugeDef def1 = gauge(type, 0.1);
    def1.species = species;
    return readNow(world, def1);
  };
  const std::vector<double> energy = of("energy", Species::Fluid);
  EXPECT_NEAR(energy[0], kinetic, 1e-9 * kinetic);
  EXPECT_NEAR(energy[1], potential, 1e-9 * potential);
  EXPECT_EQ(energy[2], 0.0);
  EXPECT_NEAR(energy[3], kinetic + potential, 1e-9 * potential);
  EXPECT_NEAR(of("energy", std::nullopt)[0], kinetic + 0.5 * b * 25.0, 1e-9 * kinetic);
  EXPECT_NEAR(of("momentum", Species::Fluid)[0], momentum.x(), 1e-9 * momentum.norm());
  EXPECT_NEAR(of("momentum", Species::Fluid)[1], momentum.y(), 1e-9 * momentum.norm());
  EXPECT_NEAR(of("momentum", Species::Fluid)[2], angular, 1e-9 * std::abs(angular));
  EXPECT_NEAR(of("mass", Species::Bullet)[0], 2.0 * b, 1e-12);
  EXPECT_NEAR(of("mass", std::nullopt)[0], count * m + 2.0 * b, 1e-9 * count * m);
  EXPECT_EQ(of("count", Species::Fluid)[0], count);
  EXPECT_EQ(of("count", std::nullopt)[0], count + 2.0);
  EXPECT_NEAR(of("max_speed", Species::Fluid)[0], speed, 1e-12);
  EXPECT_NEAR(of("max_speed", std::nullopt)[0], 5.0, 1e-12);
}

TEST(GaugeDensityError, is_the_compression_of_the_density_column) {
  World world(tank(0.02));
  addBlock(world, {{0.0, 0.0}, {1.0, 0.5}});
  world.step(0.02);
  const auto density = world.fluid()->column(*world.fluid()->findColumn<float>("density"));
  double most = 0.0, sum = 0.0;
  for (const float d : density) {
    const double error = std::max(0.0, static_cast<double>(d) - 1.0);
    most = std::max(most, error);
    sum += error;
  }
  const std::vector<double> values = readNow(world, gauge("density_error", 0.1));
  EXPECT_EQ(values[0], most);
  EXPECT_NEAR(values[1], sum / static_cast<double>(density.size()), 1e-12);
}

TEST(GaugeProfile, reads_velocities_along_a_line_and_a_point_in_air_is_nan) {
  World world(tank(0.02));
  const std::vector<Vec2> places = test::blockOf(world, {{0.0, 0.0}, {1.0, 0.5}});
  world.addFluid(places, std::vector<Vec2>(places.size(), Vec2(0.25, -0.5)));
  scene::GaugeDef profile = gauge("profile", 0.1);
  profile.from = {0.1, 0.2};
  profile.to = {1.9, 0.2};
  profile.count = 3;
  const std::vector<double> values = readNow(world, profile);
  ASSERT_EQ(values.size(), 6u);
  EXPECT_NEAR(values[0], 0.25, 1e-6);
  EXPECT_NEAR(values[1], -0.5, 1e-6);
  EXPECT_TRUE(std::isnan(values[4]) && std::isnan(values[5]));
  GaugeSet gauges({profile}, world);
  EXPECT_EQ(gauges.header(), "t,profile.0.x,profile.0.y,profile.1.x,profile.1.y,profile.2.x,profile.2.y");
}

TEST(GaugePressure, mean_is_that_of_the_course_through_the_step_ends) {
  World world(tank(0.04));
  addBlock(world, {{0.0, 0.0}, {2.0, 0.52}});
  scene::GaugeDef pressure = gauge("pressure", 0.01);
  pressure.at = {1.0, 0.1};
  pressure.window = 0.025;
  GaugeSet gauges({pressure}, world);
  EXPECT_EQ(gauges.header(), "t,pressure,pressure.mean");
  std::vector<std::string> rows;
  std::vector<double> t, p;
  const auto look = [&] {
    gauges.afterStep(world, rows);
    t.push_back(world.time());
    p.push_back(world.pressureAt(pressure.at));
  };
  look();
  while (world.time() < 0.1) {
    ASSERT_TRUE(world.substep(0.003).ok());
    look();
  }
  gauges.atEnd(world, rows);
  const auto at = [&](double when) {
    std::size_t k = 1;
    while (k + 1 < t.size() && t[k] < when) ++k;
    return p[k - 1] + (p[k] - p[k - 1]) * (when - t[k - 1]) / (t[k] - t[k - 1]);
  };
  ASSERT_GE(rows.size(), 11u);
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::vector<double> row = test::cells(rows[r]);
    EXPECT_NEAR(row[1], at(row[0]), 1e-9 * std::abs(row[1]) + 1e-9);
    // A fine Riemann sum of the same course: slow, and code of its own.
    const double begin = std::max(0.0, row[0] - pressure.window);
    double sum = 0.0;
    const int parts = 20000;
    for (int k = 0; k < parts; ++k) sum += at(begin + (row[0] - begin) * (k + 0.5) / parts);
    EXPECT_NEAR(row[2], sum / parts, 2e-4 * std::abs(sum / parts) + 1e-6) << row[0];
  }
}

TEST(GaugeSet, reading_alters_nothing) {
  std::vector<scene::GaugeDef> all;
  for (const char* type : {"front", "toe", "height", "level", "volume", "pressure", "velocity", "energy", "momentum",
                           "mass", "count", "max_speed", "density_error", "leaks"})
    all.push_back(gauge(type, 0.002));
  World plain(tank(0.02)), gauged(tank(0.02));
  addBlock(plain, {{0.0, 0.0}, {1.0, 0.5}});
  addBlock(gauged, {{0.0, 0.0}, {1.0, 0.5}});
  GaugeSet gauges(all, gauged);
  std::vector<std::string> rows;
  gauges.afterStep(gauged, rows);
  for (int k = 0; k < 15; ++k) {
    plain.substep();
    gauged.substep();
    const std::string before = gauged.stateHash();
    gauges.afterStep(gauged, rows);
    ASSERT_EQ(gauged.stateHash(), before);
  }
  EXPECT_EQ(plain.stateHash(), gauged.stateHash());
  EXPECT_GT(rows.size(), 1u);
}

}  // namespace
}  // namespace froude::run
