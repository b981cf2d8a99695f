// The Pareto front of measured points: those that no other point beats in both error and time.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plan/points.h"

namespace froude::plan {

/// Indices of the points on the front, from the cheapest to the most exact: no other point that ended takes at most as
/// long with at most the error. Of equal points the first stands for both. Cost: n log n.
std::vector<std::size_t> paretoFront(std::span<const Point> points);

/// The points of each case, in the order in which the cases first appear.
struct Panel {
  std::string flow, subject;
  std::vector<Point> points;
  std::vector<std::size_t> front;  // of `points`
};
std::vector<Panel> panels(std::span<const Point> points);

/// On how many fronts each model stands, of all models that have a point, by name.
struct Standing {
  std::string model;
  std::size_t fronts = 0;          // cases on whose front it is
  std::size_t cases = 0;           // that it ended
  std::vector<std::string> where;  // the former
};
std::vector<Standing> standings(std::span<const Panel> panels);

}  // namespace froude::plan
