// A case's world whose particles a test puts where the exact solution has them, and tables of right answers.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "validation/runner.h"

namespace froude::validation {

/// Rows of numbers of a table in tests/data.
inline std::vector<std::vector<double>> table(const std::string& file) {
  std::ifstream stream(std::string(FROUDE_TEST_DATA) + "/" + file);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    rows.emplace_back();
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  EXPECT_FALSE(rows.empty()) << file;
  return rows;
}

inline const Case& caseNamed(const std::string& name) {
  for (const Case& c : allCases())
    if (c.name == name) return c;
  throw Error("no case " + name);
}

/// A case's world at its quick spacing, whose particles a test puts where the exact solution has them.
struct Stage {
  explicit Stage(const std::string& name)
      : entry(caseNamed(name)),
        scene(scene::load(scenePath(entry.scene), {{"model.spacing", std::to_string(entry.quick.spacings.at(0))}})),
        world(scene::makeWorld(scene)),
        measure(entry.measure(scene)) {
    if (entry.prepare) entry.prepare(world);
    ParticlePool& pool = *world.fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) start.emplace_back(pool.x()[i], pool.y()[i]);
  }

  /// state(x0, t): position and velocity at t of what was at x0.
  template <typename State>
  void show(double t, State&& state) {
    ParticlePool& pool = *world.fluid();
    for (std::size_t i = 0; i < pool.size(); ++i) {
      const auto [x, v] = state(start[i], t);
      pool.x()[i] = x.x();
      pool.y()[i] = x.y();
      pool.vx()[i] = v.x();
      pool.vy()[i] = v.y();
    }
    measure->read(world, t);
  }
  /// With everything where it is and exact velocities.
  template <typename Field>
  void showField(double t, Field&& field) {
    show(t, [&](const Vec2& x, double time) { return std::pair(x, field(x, time)); });
  }
  double error(const std::string& metric) const {
    for (const Metric& m : measure->results())
      if (m.name == metric) return m.error;
    ADD_FAILURE() << "no metric " << metric;
    return std::nan("");
  }

  const Case& entry;
  scene::Scene scene;
  World world;
  std::unique_ptr<Measure> measure;
  std::vector<Vec2> start;
};

}  // namespace froude::validation
