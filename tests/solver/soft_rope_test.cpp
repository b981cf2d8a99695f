// Ropes, springs, shape matching, inner pressure: against chains, the elastica and exact laws.
#include <gtest/gtest.h>

#include <froude/solver/world.h>

#include "support/soft_meshes.h"

namespace froude {
namespace {

using testing::lattice;
using testing::pinnedWhere;
using testing::softWorld;
using testing::tipOf;

SoftDef rope(const Vec2& from, const Vec2& to, int links, double thickness, double young) {
  SoftDef def;
  def.name = "rope";
  def.model = SoftModel::Rope;
  auto mesh = std::make_shared<TriangleMesh>();
  for (int k = 0; k <= links; ++k) mesh->points.push_back(from + (to - from) * k / links);
  def.mesh = mesh;
  def.thickness = thickness;
  def.spacing = (to - from).norm() / links;
  def.young = young;
  return def;
}

// soft_elastica_self_weight.csv: β = w L³/(E I).
TEST(SoftRope, a_clamped_rope_sags_as_the_elastica) {
  struct Row {
    double beta, dx, dy;
  };
  for (const Row& row : {Row{1.0, 0.008753604653, 0.123471402}, Row{4.0, 0.1098892533, 0.4251592842},
                         Row{8.0, 0.2755752659, 0.6406307174}}) {
    SoftDef def = rope({0.0, 0.0}, {1.0, 0.0}, 40, 0.05, 1.0e6);
    def.pinned = {0, 1};
    def.damping = 3.0;
    const double bending = 1.0e6 * 0.05 * 0.05 * 0.05 / 12.0, free = 39.0 / 40.0;
    const double gravity = row.beta * bending / (1000.0 * 0.05 * free * free * free);
    World world(softWorld({def}, Vec2(0.0, -gravity)));
    ASSERT_TRUE(world.step(5.0).ok());
    const Vec2 tip = tipOf(world, 0, Vec2(1.0, 0.0)) / free;
    EXPECT_NEAR(-tip.y(), row.dy, 0.03 * row.dy) << row.beta;
    EXPECT_NEAR(-tip.x(), row.dx, 0.03 * row.dx + 0.003) << row.beta;
  }
}

// soft_chain_links.csv: ten links of 0.2 m between (0, 0) and (1, 0), weights at the joints; its middle hangs 0.80437
// m.
TEST(SoftRope, a_bead_chain_hangs_as_it_must) {
  SoftDef def = rope({0.0, 0.0}, {1.0, 0.0}, 10, 0.001, 1.0e9);
  auto mesh = std::make_shared<TriangleMesh>();  // a zigzag of the right lengths
  for (int k = 0; k <= 10; ++k) mesh->points.emplace_back(0.1 * k, k % 2 == 0 ? 0.0 : -std::sqrt(0.03));
  def.mesh = mesh;
  def.thickness = 0.0001;
  def.pinned = {0, 10};
  def.damping = 4.0;
  def.spacing = 0.2;
  World world(softWorld({def}, Vec2(0.0, -9.81)));
  ASSERT_TRUE(world.step(4.0).ok());
  const std::size_t first = world.softFirst(0);
  EXPECT_NEAR(world.soft()->y()[first + 5] - 1.0, -0.8043709983, 0.01 * 0.80437);
  EXPECT_NEAR(world.soft()->x()[first + 1], 0.04941394571, 0.01);
}

TEST(SoftRope, a_heavy_box_on_a_light_rope_stretches_it_as_its_stiffness_says) {
  WorldDef def = softWorld({}, Vec2(0.0, -9.81));
  SoftDef line = rope({0.0, 1.0}, {1.0, 1.0}, 40, 0.01, 2.0e7);
  line.density = 10.0;  // 0.1 kg/m
  line.pinned = {0, 40};
  line.position = {0.0, 0.0};
  line.friction = 1.0;
  line.damping = 2.0;
  def.soft.push_back(line);
  def.soft.back().position = {0.0, 1e-12};
  BodyDef box;
  box.name = "box";
  box.shape = std::make_shared<Polygon>(Polygon::box({{-0.1, 0.0}, {0.1, 0.1}}));
  box.position = {0.5, 1.006};
  box.motion = Motion::Free;
  box.density = 100.0 / 0.02;  // 100 kg: a thousand times the rope
  box.friction = 1.0;
  def.bodies.push_back(box);
  World world(def);
  ASSERT_TRUE(world.step(0.6).ok());
  double length = 0.0;
  for (std::size_t k = 0; k < 40; ++k) {
    const Vec2 a(world.soft()->x()[k], world.soft()->y()[k]), b(world.soft()->x()[k + 1], world.soft()->y()[k + 1]);
    length += (b - a).norm();
    EXPECT_LT((b - a).norm(), 1.05 * 0.025);
  }
  EXPECT_GT(world.body(std::size_t{0}).transform.position.y(), 0.8);
  const Totals t = world.totals();
  const Ledger& l = world.ledger();
  EXPECT_LT((t.momentum - l.momentum0 - l.impulse).norm(), 1e-6 * t.mass);
}

TEST(SoftSprings, a_hanging_strip_of_springs_stretches_by_its_weight_over_its_stiffness) {
  SoftDef def;
  def.model = SoftModel::Springs;
  auto mesh = std::make_shared<TriangleMesh>(*lattice(1.0, 0.2, 20, 4));
  for (Vec2& p : mesh->points) p.x() -= 0.5 * p.y(), p.y() *= 0.5 * std::sqrt(3.0);  // equilateral, diagonals short
  def.mesh = mesh;
  def.young = 1.0e6;
  def.poisson = 0.25;  // of springs alone
  def.damping = 60.0;
  def.pinned = pinnedWhere(*mesh, [](const Vec2& p) { return p.x() + p.y() / std::sqrt(3.0) < 1e-9; });
  World world(softWorld({def}, Vec2(1.0, 0.0)));
  ASSERT_TRUE(world.step(0.5).ok());
  const double exact = 1000.0 / 2.0 * (1.0 - 0.25 * 0.25) / 1.0e6;
  EXPECT_NEAR(tipOf(world, 0, mesh->points[20]).x(), exact, 0.08 * exact);
}

TEST(SoftShapeMatching, a_squeezed_block_comes_back_and_keeps_its_momentum) {
  SoftDef def;
  def.model = SoftModel::ShapeMatching;
  def.mesh = lattice(0.4, 0.4, 16, 16);
  def.spacing = 0.025;
  def.damping = 4.0;
  World world(softWorld({def}, Vec2(0.0, 0.0)));
  ParticlePool& pool = *world.soft();
  for (std::size_t i = 0; i < pool.size(); ++i) pool.x()[i] *= 0.5, pool.vy()[i] = 0.25;
  ASSERT_TRUE(world.step(2.0).ok());
  const SoftState s = world.softState(0);
  EXPECT_NEAR(s.momentum.y(), 0.25 * s.mass, 1e-9 * s.mass);
  EXPECT_NEAR(s.area, 0.16, 0.002);
  EXPECT_LT(s.strain, 1e-6 * s.mass);
}

// A ring of thin wall: pressure p, radius R, wall h, plane strain: hoop stress p R/h, radius grows by p R² (1 − ν²)/(E
// h).
TEST(SoftPressure, a_ring_grows_as_the_thin_vessel) {
  auto mesh = std::make_shared<TriangleMesh>();
  const int around = 120, across = 2;
  const double inner = 0.49, wall = 0.02;
  for (int j = 0; j <= across; ++j) {
    for (int i = 0; i < around; ++i) {
      const double r = inner + wall * j / across, angle = 2.0 * kPi * i / around;
      mesh->points.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
  }
  auto id = [&](int i, int j) { return static_cast<std::uint32_t>(j * around + i % around); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      mesh->triangles.push_back({id(i, j), id(i, j + 1), id(i + 1, j + 1)});
      mesh->triangles.push_back({id(i, j), id(i + 1, j + 1), id(i + 1, j)});
    }
  }
  for (int i = 0; i < around; ++i) mesh->outline.push_back({id(i, across), id(i + 1, across)});
  for (int i = around; i > 0; --i) mesh->outline.push_back({id(i, 0), id(i - 1, 0)});
  SoftDef def;
  def.mesh = mesh;
  def.young = 1.0e6;
  def.poisson = 0.3;
  def.pressure = 100.0;
  def.damping = 60.0;
  def.position = {0.5, 1.0};
  World world(softWorld({def}, Vec2(0.0, 0.0)));
  ASSERT_TRUE(world.step(0.5).ok());
  const double growth = world.soft()->x()[around] - 0.5 - (inner + 0.5 * wall);
  const double exact = 100.0 * inner * 0.5 * (1.0 - 0.09) / (1.0e6 * wall);
  EXPECT_NEAR(growth, exact, 0.03 * exact);
  EXPECT_LT(world.softState(0).momentum.norm(), 1e-9);
}

TEST(SoftTearing, a_strip_that_is_pulled_beyond_its_limit_parts) {
  SoftDef def;
  def.mesh = lattice(0.4, 0.05, 16, 2);
  def.young = 1.0e4;
  def.strainLimit = 0.3;
  def.pinned = pinnedWhere(*def.mesh, [](const Vec2& p) { return p.x() < 1e-9; });
  World world(softWorld({def}, Vec2(60.0, 0.0)));
  ASSERT_TRUE(world.step(0.15).ok());
  EXPECT_GT(world.softState(0).torn, 1u);
  std::vector<double> strain;
  world.softStrain(0, strain);
  EXPECT_GT(std::count_if(strain.begin(), strain.end(), [](double v) { return std::isnan(v); }), 1);
}

}  // namespace
}  // namespace froude
