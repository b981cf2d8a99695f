// Worlds of free bodies alone: the whole program copes with a world that has no particle at all.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "program_runs/program.h"

namespace froude::testing {
namespace {

using Bodies = ProgramTest;

/// Two boxes that fall onto a third, a wheel that a motor turns: more than two turns by the end.
std::string bodiesScene() {
  return R"toml(format = 1
title = "bodies"
duration = 1.0
[domain]
box = [0.0, 0.0, 3.0, 2.0]
[[body]]
name = "base"
shape = { box = [0.5, 0.0, 1.5, 0.2] }
[[body]]
name = "box"
shape = { box = [-0.1, -0.1, 0.1, 0.1] }
position = [1.0, 0.31]
motion = "free"
repeat = { count = [1, 2], step = [[0.0, 0.0], [0.03, 0.25]], turn = 3.0 }
[[body]]
name = "wheel"
shape = { regular = { sides = 12, radius = 0.3 } }
position = [2.4, 1.0]
motion = "free"
hinge = { at = [2.4, 1.0], motor = { speed = 20.0, torque = 2000.0 } }
[[gauge]]
name = "wheel"
type = "pose"
body = "wheel"
every = 0.1
[[gauge]]
name = "box"
type = "pose"
body = "box.1"
every = 0.1
[[gauge]]
name = "push"
type = "force"
body = "box.0"
every = 0.1
[[gauge]]
name = "energy"
type = "energy"
every = 0.1
[[gauge]]
name = "momentum"
type = "momentum"
every = 0.1
[output]
every = 0.25
frames = ["png", "h5"]
png = { width = 200 }
)toml";
}

/// The last row of gauges.csv.
std::vector<double> lastRow(const std::string& csv) {
  std::istringstream lines(csv);
  std::string last;
  for (std::string line; std::getline(lines, line);) last = line;
  std::vector<double> row;
  std::istringstream cells(last);
  for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell.empty() ? std::nan("") : std::stod(cell));
  return row;
}

TEST_F(Bodies, are_checked_explained_and_run_without_a_particle) {
  write("s.toml", bodiesScene());
  Outcome o = froude({"check", "s.toml", "--strict"});
  EXPECT_EQ(o.code, 0) << o.err;
  o = froude({"explain", "s.toml"});
  EXPECT_EQ(o.code, 0) << o.err;
  for (const char* text : {"3 free polygons", "1 hinge, 1 motor", "1 fixed polygon"})
    EXPECT_NE(o.out.find(text), std::string::npos) << o.out;
  o = froude({"run", "s.toml", "-o", "o"});
  ASSERT_EQ(o.code, 0) << o.err;
  const nlohmann::json summary = this->summary("o");
  EXPECT_EQ(summary["status"], "done");
  EXPECT_EQ(summary["model"], "none");
  EXPECT_EQ(summary["particles"], 0);
  EXPECT_GT(summary["substeps"].get<int>(), 10);
  for (const char* key : {"energy_drift", "momentum_error", "volume_error", "particle_steps_per_second"})
    EXPECT_TRUE(summary[key].is_number()) << key << ": " << summary[key];
  EXPECT_EQ(summary["frames"], 5);
}

TEST_F(Bodies, are_read_by_gauges_and_their_angle_is_not_wrapped) {
  write("s.toml", bodiesScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "o", "--frames", "none"}).code, 0);
  const std::vector<double> row =
      lastRow(read("o/gauges.csv"));  // t, wheel x y angle, box x y angle, push x y torque, …
  ASSERT_EQ(row.size(), 1u + 3u + 3u + 3u + 4u + 3u);
  EXPECT_NEAR(row[1], 2.4, 1e-3) << "the hinge holds it";
  EXPECT_NEAR(row[2], 1.0, 1e-3);
  EXPECT_GT(row[3], 720.0);
  EXPECT_LT(row[3], 20.0 * 180.0 / M_PI + 1.0);
  EXPECT_LT(row[5], 0.9) << "it has fallen";
  EXPECT_GT(row[5], 0.2);
  const double inertia =
      1000.0 * 0.3 * 0.3 * 0.3 * 0.3 * (12.0 / 2.0) * std::sin(M_PI / 6) * (2.0 + std::cos(M_PI / 6)) / 6.0;
  EXPECT_GT(row[10], 0.4 * inertia * 20.0 * 20.0) << "the energy gauge includes the wheel's";
}

TEST_F(Bodies, go_on_after_a_checkpoint_and_again_from_the_resolved_scene_with_the_same_bits) {
  write("s.toml", bodiesScene());
  ASSERT_EQ(froude({"run", "s.toml", "-o", "whole"}).code, 0);
  ASSERT_EQ(froude({"run", "s.toml", "-o", "half", "--until", "0.5"}).code, 0);
  const Outcome o = froude({"resume", "half"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(stateHash("half"), stateHash("whole"));
  EXPECT_EQ(read("half/gauges.csv"), read("whole/gauges.csv"));
  ASSERT_EQ(froude({"run", "whole/scene.toml", "-o", "again"}).code, 0);
  EXPECT_EQ(stateHash("again"), stateHash("whole"));
}

}  // namespace
}  // namespace froude::testing
