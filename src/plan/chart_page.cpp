#include "plan/chart_page.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "export/page.h"

namespace froude::plan {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json pointOf(const Panel& panel, std::size_t i) {
  const Point& p = panel.points[i];
  return {{"model", p.model},
          {"spacing", p.spacing},
          {"courant", p.courant},
          {"particles", p.particles},
          {"error", number(p.error)},
          {"target", p.target},
          {"wall_seconds", number(p.wallSeconds)},
          {"simulated_seconds", number(p.simulatedSeconds)},
          {"steps_per_second", number(p.stepsPerSecond())},
          {"state", p.state},
          {"front", std::find(panel.front.begin(), panel.front.end(), i) != panel.front.end()}};
}

}  // namespace

void writeChartPage(const std::string& file, std::span<const Panel> panels, const std::string& caption) {
  Json page;
  page["kind"] = "chart";
  page["title"] = "Speed against accuracy";
  page["caption"] = caption;
  page["panels"] = Json::array();
  for (const Panel& panel : panels) {
    Json points = Json::array();
    for (std::size_t i = 0; i < panel.points.size(); ++i) points.push_back(pointOf(panel, i));
    page["panels"].push_back({{"flow", panel.flow}, {"subject", panel.subject}, {"points", std::move(points)}});
  }
  page["standings"] = Json::array();
  for (const Standing& s : standings(panels))
    page["standings"].push_back({{"model", s.model}, {"fronts", s.fronts}, {"cases", s.cases}, {"where", s.where}});
  page["notices"] = exporting::pageNotices();
  exporting::writePage(
      file, {page["title"].get<std::string>(), page.dump(-1, ' ', false, Json::error_handler_t::replace), {}});
}

}  // namespace froude::plan
