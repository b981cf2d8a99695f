// Small worlds and a reader of rows, for the tests of the gauges.
#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <froude/solver/world.h>
#include "run/gauges.h"

namespace froude::test {

inline constexpr double kTank[2] = {2.0, 1.0};  // [m]

/// A closed tank of 2 m × 1 m, without particles.
inline WorldDef tank(double spacing) {
  WorldDef def;
  def.domain.box = {{0.0, 0.0}, {kTank[0], kTank[1]}};
  def.fluid = FluidDef{};
  def.fluid->spacing = spacing;
  return def;
}

/// The places of a block of water on the lattice of spacing dx from its lower left corner, particles inside polygons
/// left out.
inline std::vector<Vec2> blockOf(const World& world, const Box& box) {
  const double dx = world.definition().fluid->spacing;
  std::vector<Vec2> places;
  for (double y = box.min.y() + 0.5 * dx; y < box.max.y(); y += dx)
    for (double x = box.min.x() + 0.5 * dx; x < box.max.x(); x += dx)
      if (!world.insideSolid({x, y})) places.emplace_back(x, y);
  return places;
}

inline void addBlock(World& world, const Box& box) {
  const std::vector<Vec2> places = blockOf(world, box);
  world.addFluid(places, std::vector<Vec2>(places.size(), Vec2(0, 0)));
}

inline scene::GaugeDef gauge(const std::string& type, double every) {
  scene::GaugeDef def;
  def.name = type;
  def.type = type;
  def.every = every;
  return def;
}

/// Cells of a row; NaN for "nan", a special value for an empty cell.
inline constexpr double kEmpty = -12345.0;
inline std::vector<double> cells(const std::string& row) {
  std::vector<double> values;
  std::stringstream stream(row + ",");
  for (std::string cell; std::getline(stream, cell, ',');)
    values.push_back(cell.empty() ? kEmpty : std::strtod(cell.c_str(), nullptr));
  return values;
}

/// The values of one gauge at the present state.
inline std::vector<double> readNow(const World& world, const scene::GaugeDef& def) {
  run::GaugeSet gauges({def}, world);
  std::vector<std::string> rows;
  gauges.afterStep(world, rows);
  std::vector<double> values = cells(rows.at(0));
  values.erase(values.begin());
  return values;
}

}  // namespace froude::test
