#include "study/batch_page.h"

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "export/page.h"
#include "run/atomic_file.h"
#include "study/csv.h"

namespace froude::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoints = 240;  // of a curve

/// Times and values of each column of a run's gauges, without the cells that are empty.
Json gaugesOf(const std::string& folder) {
  Json gauges = Json::object();
  std::error_code error;
  const std::string file = folder + "/gauges.csv";
  if (!std::filesystem::exists(file, error)) return gauges;
  CsvTable table;
  try {
    table = parseCsv(run::readWholeFile(file), file);
  } catch (const Error&) {  // the table says what is wrong with the run
    return gauges;
  }
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    std::vector<std::size_t> filled;
    for (std::size_t r = 0; r < table.rows.size(); ++r)
      if (!table.rows[r][c].empty()) filled.push_back(r);
    Json times = Json::array(), values = Json::array();
    const std::size_t stride = filled.size() / kMostPoints + 1;
    for (std::size_t k = 0; k < filled.size(); ++k) {
      if (k % stride != 0 && k + 1 != filled.size()) continue;
      times.push_back(std::strtod(table.rows[filled[k]][0].c_str(), nullptr));
      values.push_back(std::strtod(table.rows[filled[k]][c].c_str(), nullptr));
    }
    gauges[table.columns[c]] = Json::array({std::move(times), std::move(values)});
  }
  return gauges;
}

/// Units of gauges, as the first summary that has them says.
Json unitsOf(const std::string& folder, const BatchPlan& plan) {
  std::error_code error;
  for (const PlannedRun& run : plan.runs) {
    const std::string file = folder + "/" + run.folder + "/summary.json";
    if (!std::filesystem::exists(file, error)) continue;
    const Json summary = Json::parse(run::readWholeFile(file), nullptr, false);
    if (summary.is_object() && summary.contains("gauges") && !summary["gauges"].empty()) return summary["gauges"];
  }
  return Json::object();
}

}  // namespace

void writeBatchPage(const std::string& folder, const BatchPlan& plan, const std::vector<RunResult>& results) {
  Json page;
  page["kind"] = "batch";
  page["title"] = "Batch " + std::filesystem::path(folder).filename().string();
  page["command"] = plan.command;
  page["parameters"] = plan.parameters;
  page["table"] = resultsCsv(plan, results);
  page["units"] = unitsOf(folder, plan);
  page["runs"] = Json::array();
  for (const PlannedRun& run : plan.runs)
    page["runs"].push_back({{"name", run.folder}, {"gauges", gaugesOf(folder + "/" + run.folder)}});
  page["notices"] = exporting::pageNotices();
  exporting::writePage(
      folder + "/index.html",
      {page["title"].get<std::string>(), page.dump(-1, ' ', false, Json::error_handler_t::replace), {}});
}

}  // namespace froude::study
