#include "study/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/progress.h"
#include "study/csv.h"
#include "study/gauge_statistics.h"

namespace froude::study {
namespace {

using Json = nlohmann::ordered_json;

std::string cellOf(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.is_null() ? "" : value.dump();
}

void flatten(const Json& object, const std::string& before, std::vector<std::pair<std::string, std::string>>& out) {
  for (const auto& [key, value] : object.items()) {
    if (before.empty() && (key == "gauges" || key == "status" || key == "reason")) continue;
    if (value.is_object()) {
      flatten(value, before + key + ".", out);
    } else if (value.is_array()) {
      out.emplace_back(before + key, std::to_string(value.size()));  // warnings: how many
    } else {
      out.emplace_back(before + key, cellOf(value));
    }
  }
}

// Numbers for people: three digits.
std::string rounded(const std::string& cell, double scale = 1.0) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  return cell.empty() || *end != '\0' ? cell : fmt::format("{:.3g}", scale * value);
}

std::vector<std::string> tableRow(const PlannedRun& run, const RunResult& result) {
  const std::string wall = result.value("wall_seconds");
  return {run.folder,
          result.status,
          result.value("particles"),
          rounded(result.value("simulated_seconds")),
          wall.empty() ? "" : run::durationInWords(std::strtod(wall.c_str(), nullptr)),
          result.value("leaks"),
          rounded(result.value("max_density_error"), 100.0),
          rounded(result.value("volume_error"), 100.0),
          result.value("state_hash").substr(0, 8)};
}

// Width in characters, not bytes.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

std::string RunResult::value(const std::string& column) const {
  for (const auto& [name, cell] : values)
    if (name == column) return cell;
  return {};
}

RunResult readResult(const std::string& folder) {
  RunResult result;
  std::error_code error;
  if (!std::filesystem::exists(folder + "/summary.json", error)) {
    result.status = "not begun";
    return result;
  }
  try {
    const Json summary = Json::parse(run::readWholeFile(folder + "/summary.json"));
    result.status = summary.at("status").get<std::string>();
    result.reason = summary.value("reason", "");
    flatten(summary, "", result.values);
    const std::string gauges = folder + "/gauges.csv";
    if (std::filesystem::exists(gauges, error)) {
      const auto statistics = gaugeStatistics(run::readWholeFile(gauges), gauges);
      result.values.insert(result.values.end(), statistics.begin(), statistics.end());
    }
  } catch (const Json::exception& e) {
    result.status = "failed";
    result.reason = folder + "/summary.json: cannot be read: " + e.what();
  } catch (const Error& e) {
    result.status = "failed";
    result.reason = e.what();
  }
  return result;
}

std::string resultsCsv(const BatchPlan& plan, const std::vector<RunResult>& results) {
  std::vector<std::string> header{"run", "scene"};
  header.insert(header.end(), plan.parameters.begin(), plan.parameters.end());
  header.insert(header.end(), {"status", "reason"});
  std::set<std::string> known(header.begin(), header.end());
  std::vector<std::string> columns;  // of summaries and gauges
  for (const RunResult& result : results)
    for (const auto& [name, cell] : result.values)
      if (known.insert(name).second) columns.push_back(name);
  header.insert(header.end(), columns.begin(), columns.end());

  std::string text = csvLine(header);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const PlannedRun& run = plan.runs[i];
    std::vector<std::string> row{run.folder, run.scene};
    for (const std::string& path : plan.parameters) {
      const auto own = std::find_if(run.parameters.begin(), run.parameters.end(),
                                    [&](const scene::Override& p) { return p.first == path; });
      row.push_back(own == run.parameters.end() ? "" : own->second);
    }
    row.push_back(results[i].status);
    row.push_back(results[i].reason);
    const std::map<std::string, std::string> cells(results[i].values.begin(), results[i].values.end());
    for (const std::string& column : columns) {
      const auto cell = cells.find(column);
      row.push_back(cell == cells.end() ? "" : cell->second);
    }
    text += csvLine(row);
  }
  return text;
}

std::string resultsTable(const BatchPlan& plan, const std::vector<RunResult>& results,
                         const std::vector<std::string>& marks) {
  std::vector<std::vector<std::string>> rows{
      {"run", "status", "particles", "t [s]", "wall time", "leaks", "compression [%]", "volume [%]", "state"}};
  for (std::size_t i = 0; i < results.size(); ++i) rows.push_back(tableRow(plan.runs[i], results[i]));
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], widthOf(row[c]));
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::string line;
    for (std::size_t c = 0; c < rows[i].size(); ++c) {
      const std::string blanks(widths[c] - widthOf(rows[i][c]), ' ');
      const bool words = c < 2;  // words stand left, numbers right
      line += (c > 0 ? "  " : "") + (words ? rows[i][c] + blanks : blanks + rows[i][c]);
    }
    if (i > 0 && i - 1 < marks.size() && !marks[i - 1].empty()) line += "  " + marks[i - 1];
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
    const bool told = i > 0 && !results[i - 1].done() && !results[i - 1].reason.empty();
    if (told) text += "    " + results[i - 1].reason + "\n";
  }
  return text;
}

}  // namespace froude::study
