// When gauges are read and which rows they write: a body on a known course, steps of all lengths.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gauge_support.h"

namespace froude::run {
namespace {

using test::cells;
using test::gauge;
using test::kEmpty;

/// A world without particles whose one body has the velocity t² along x.
World movingBody() {
  WorldDef def;
  def.domain.box = {{-10.0, -10.0}, {10.0, 10.0}};
  BodyDef body;
  body.name = "slide";
  body.shape = std::make_shared<Polygon>(Polygon::box({{-0.1, -0.1}, {0.1, 0.1}}));
  body.motion = Motion::Scripted;
  body.script = {{100.0, [](double t) { return t * t; }, {}, [](double) { return 1.0; }}};
  def.bodies.push_back(body);
  return World(def);
}

scene::GaugeDef poseOf(const std::string& name, double every) {
  scene::GaugeDef def = gauge("pose", every);
  def.name = name;
  def.body = "slide";
  return def;
}

/// Time and place of the body at each step end, kept beside the gauges: the oracle.
struct Course {
  std::vector<double> t, x;
  void add(const World& world) {
    t.push_back(world.time());
    x.push_back(world.body(0).transform.position.x());
  }
  double at(double when) const {
    std::size_t k = 1;
    while (k + 1 < t.size() && t[k] < when) ++k;
    const double w = (when - t[k - 1]) / (t[k] - t[k - 1]);
    return (1.0 - w) * x[k - 1] + w * x[k];
  }
};

double stepLength(std::mt19937& random, double mean) {
  return mean * std::uniform_real_distribution<double>(0.6, 1.1)(random);
}

TEST(GaugeRows, stand_at_zero_at_every_multiple_and_at_the_end) {
  World world = movingBody();
  GaugeSet gauges({poseOf("pose", 0.01)}, world);
  EXPECT_EQ(gauges.header(), "t,pose.x,pose.y,pose.angle");
  std::vector<std::string> rows;
  Course course;
  std::mt19937 random(7);
  gauges.afterStep(world, rows);
  course.add(world);
  ASSERT_EQ(rows.size(), 1u);
  while (world.time() < 0.3) {
    world.step(stepLength(random, 0.0037));
    gauges.afterStep(world, rows);
    course.add(world);
  }
  gauges.atEnd(world, rows);
  const auto expected = static_cast<std::size_t>(std::floor(world.time() / 0.01)) + 2;
  ASSERT_EQ(rows.size(), expected);
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    const std::vector<double> row = cells(rows[k]);
    ASSERT_EQ(row.size(), 4u);
    EXPECT_EQ(row[0], static_cast<double>(k) * 0.01);
    EXPECT_NEAR(row[1], course.at(row[0]), 1e-16 + 1e-14 * std::abs(row[1]));
    EXPECT_NEAR(row[3], row[0] * 180.0 / kPi, 1e-9);
  }
  EXPECT_EQ(cells(rows.back())[0], world.time());
  EXPECT_EQ(cells(rows.back())[1], course.x.back());
}

TEST(GaugeRows, a_gauge_that_is_not_due_leaves_its_cell_empty) {
  World world = movingBody();
  GaugeSet gauges({poseOf("fast", 0.01), poseOf("slow", 0.03)}, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  for (int k = 0; k < 50; ++k) {
    world.step(0.0037);
    gauges.afterStep(world, rows);
  }
  ASSERT_EQ(rows.size(), 19u);  // t = 0.185: rows up to 0.18, 0.03·k among them not doubled by their last bit
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::vector<double> row = cells(rows[k]);
    ASSERT_EQ(row.size(), 7u);
    EXPECT_NE(row[1], kEmpty);
    EXPECT_EQ(row[4] == kEmpty, k % 3 != 0) << rows[k];
    if (k % 3 == 0) {
      EXPECT_EQ(row[4], row[1]);
    }
  }
  gauges.atEnd(world, rows);
  EXPECT_NE(cells(rows.back())[4], kEmpty);
}

TEST(GaugeRows, one_long_step_fills_several_rows) {
  World world = movingBody();
  GaugeSet gauges({poseOf("pose", 0.01)}, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  world.step(0.055);
  gauges.afterStep(world, rows);
  ASSERT_EQ(rows.size(), 6u);
  const double end = world.body(0).transform.position.x();
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(cells(rows[k])[1], end * static_cast<double>(k) * 0.01 / 0.055, 1e-15);
}

TEST(GaugeRows, a_step_that_grows_a_hundredfold_misses_no_row) {
  World world = movingBody();
  GaugeSet gauges({poseOf("pose", 0.01)}, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  for (const double dt : {0.0001, 0.0001, 0.01, 0.0001, 0.02, 0.0001}) {
    world.step(dt);
    gauges.afterStep(world, rows);
  }
  ASSERT_EQ(rows.size(), 4u);  // 0, 0.01, 0.02, 0.03
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(cells(rows[k])[0], static_cast<double>(k) * 0.01);
}

TEST(GaugeRows, the_last_row_holds_all_gauges_even_when_one_is_due_just_then) {
  World world = movingBody();
  GaugeSet gauges({poseOf("fast", 0.25), poseOf("slow", 0.4)}, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  for (int k = 0; k < 4; ++k) {
    world.step(0.125);
    gauges.afterStep(world, rows);
  }
  gauges.atEnd(world, rows);
  ASSERT_EQ(world.time(), 0.5);
  ASSERT_EQ(rows.size(), 4u);  // 0, 0.25, 0.4, 0.5: no second row at 0.5
  EXPECT_EQ(cells(rows[3])[0], 0.5);
  EXPECT_EQ(cells(rows[3])[1], world.body(0).transform.position.x());
  EXPECT_EQ(cells(rows[3])[4], world.body(0).transform.position.x());
}

TEST(GaugeRows, a_run_that_ends_where_it_begins_has_one_row) {
  World world = movingBody();
  GaugeSet gauges({poseOf("pose", 0.01)}, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  gauges.atEnd(world, rows);
  EXPECT_EQ(rows.size(), 1u);
}

TEST(GaugeRows, a_resumed_run_writes_the_same_bytes) {
  const std::vector<scene::GaugeDef> defs = {poseOf("a", 0.01), poseOf("b", 0.0173), poseOf("c", 1.0)};
  std::mt19937 random(3);
  std::vector<double> steps;
  for (int k = 0; k < 60; ++k) steps.push_back(stepLength(random, 0.005));
  for (const std::size_t pause : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{31}, std::size_t{59}}) {
    World world = movingBody();
    GaugeSet whole(defs, world);
    auto parts = std::make_unique<GaugeSet>(defs, world);
    std::vector<std::string> rows, resumed;
    whole.afterStep(world, rows);
    parts->afterStep(world, resumed);
    for (std::size_t k = 0; k < steps.size(); ++k) {
      world.step(steps[k]);
      whole.afterStep(world, rows);
      parts->afterStep(world, resumed);
      if (k != pause) continue;
      MemorySnapshot kept;
      kept.save([&](Archive& a) { parts->archive(a); });
      parts = std::make_unique<GaugeSet>(defs, world);
      kept.load([&](Archive& a) { parts->archive(a); });
    }
    whole.atEnd(world, rows);
    parts->atEnd(world, resumed);
    EXPECT_EQ(rows, resumed) << "pause after step " << pause;
  }
}

TEST(GaugeRows, a_state_of_other_gauges_is_refused) {
  World world = movingBody();
  GaugeSet pose({poseOf("g", 0.01)}, world);
  std::vector<std::string> rows;
  pose.afterStep(world, rows);
  MemorySnapshot kept;
  kept.save([&](Archive& a) { pose.archive(a); });
  scene::GaugeDef leaks = gauge("leaks", 0.01);
  leaks.name = "g";
  GaugeSet other({leaks}, world);
  EXPECT_THROW(kept.load([&](Archive& a) { other.archive(a); }), Error);
}

TEST(GaugeRows, numbers_have_seventeen_digits) {
  World world = movingBody();
  world.step(1.0 / 3.0);
  const std::vector<double> values = test::readNow(world, poseOf("pose", 0.1));
  EXPECT_EQ(values[0], world.body(0).transform.position.x());
}

TEST(GaugeRows, definitions_that_cannot_be_are_refused) {
  const World world = movingBody();
  const auto refused = [&](const scene::GaugeDef& def) { EXPECT_THROW(GaugeSet({def}, world), Error) << def.type; };
  refused(gauge("tow", 0.1));
  refused(gauge("leaks", 0.0));
  refused(gauge("leaks", std::nan("")));
  refused(gauge("profile", 0.1));
  scene::GaugeDef front = gauge("front", 0.1);
  front.quantile = 1.5;
  refused(front);
  scene::GaugeDef pose = gauge("pose", 0.1);
  pose.body = "slid";
  refused(pose);
}

}  // namespace
}  // namespace froude::run
