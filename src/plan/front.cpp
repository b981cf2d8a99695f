#include "plan/front.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace froude::plan {

std::vector<std::size_t> paretoFront(std::span<const Point> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !points[i].ended() || !(points[i].cost() > 0.0); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points[a].cost() != points[b].cost()) return points[a].cost() < points[b].cost();
    return points[a].error < points[b].error;
  });
  double least = std::numeric_limits<double>::infinity();
  std::erase_if(order, [&](std::size_t i) {
    const bool beaten = points[i].error >= least;
    least = std::min(least, points[i].error);
    return beaten;
  });
  return order;
}

std::vector<Panel> panels(std::span<const Point> points) {
  std::vector<Panel> out;
  for (const Point& point : points) {
    auto found = std::find_if(out.begin(), out.end(), [&](const Panel& p) { return p.subject == point.subject; });
    if (found == out.end()) found = out.insert(out.end(), {point.flow, point.subject, {}, {}});
    found->points.push_back(point);
  }
  for (Panel& panel : out) panel.front = paretoFront(panel.points);
  return out;
}

std::vector<Standing> standings(std::span<const Panel> panels) {
  std::vector<Standing> out;
  for (const Panel& panel : panels) {
    std::set<std::string> ended, front;
    for (const Point& p : panel.points)
      if (p.ended()) ended.insert(p.model);
    for (const std::size_t i : panel.front) front.insert(panel.points[i].model);
    for (const std::string& model : ended) {
      auto found = std::find_if(out.begin(), out.end(), [&](const Standing& s) { return s.model == model; });
      if (found == out.end()) found = out.insert(out.end(), {model, 0, 0, {}});
      ++found->cases;
      if (!front.contains(model)) continue;
      ++found->fronts;
      found->where.push_back(panel.subject);
    }
  }
  std::sort(out.begin(), out.end(), [](const Standing& a, const Standing& b) { return a.model < b.model; });
  return out;
}

}  // namespace froude::plan
