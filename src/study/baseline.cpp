#include "study/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

namespace froude::study {
namespace {

constexpr std::array<std::string_view, 18> kNotCompared{"checkpoint_seconds",
                                                        "run",
                                                        "scene",
                                                        "reason",
                                                        "froude_version",
                                                        "git_commit",
                                                        "build_type",
                                                        "command",
                                                        "cpu",
                                                        "wall_seconds",
                                                        "particle_steps_per_second",
                                                        "compiler",
                                                        "threads",
                                                        "schema",
                                                        "warnings",
                                                        "scene_sha256",
                                                        "simd",
                                                        "frames"};
constexpr std::size_t kMostTold = 6;  // changes of a run

std::string sceneKey(const std::string& file) { return std::filesystem::path(file).filename().string(); }

// Index of the column; the number of columns where there is none.
std::size_t columnOf(const CsvTable& table, const std::string& name) {
  return static_cast<std::size_t>(std::find(table.columns.begin(), table.columns.end(), name) - table.columns.begin());
}

std::string cellOf(const CsvTable& table, const std::vector<std::string>& row, const std::string& column) {
  const std::size_t c = columnOf(table, column);
  return c < row.size() ? row[c] : "";
}

const std::vector<std::string>* rowOf(const CsvTable& table, const PlannedRun& run) {
  for (const auto& row : table.rows) {
    if (sceneKey(cellOf(table, row, "scene")) != sceneKey(run.scene)) continue;
    const bool same = std::all_of(run.parameters.begin(), run.parameters.end(),
                                  [&](const scene::Override& p) { return cellOf(table, row, p.first) == p.second; });
    if (same) return &row;
  }
  return nullptr;
}

std::optional<double> numberIn(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string brief(const std::string& cell) {
  const std::optional<double> value = numberIn(cell);
  return value ? fmt::format("{:.6g}", *value) : cell;
}

}  // namespace

std::string Change::words() const {
  std::string text = fmt::format("{} {} → {}", column, brief(before), brief(now));
  const std::optional<double> a = numberIn(before), b = numberIn(now);
  if (a && b && *a != 0.0) text += fmt::format(" ({:+.2g} %)", 100.0 * (*b - *a) / std::abs(*a));
  return text;
}

std::string Comparison::mark() const {
  if (!known) return "new";
  if (changes.empty()) return "same";
  return changes.size() == 1 ? "1 change" : fmt::format("{} changes", changes.size());
}

std::vector<Comparison> compare(const CsvTable& baseline, const BatchPlan& plan,
                                const std::vector<RunResult>& results) {
  std::vector<Comparison> all(results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::vector<std::string>* row = rowOf(baseline, plan.runs[i]);
    if (row == nullptr) continue;
    Comparison& comparison = all[i];
    comparison.known = true;
    const auto look = [&](const std::string& column, const std::string& now) {
      if (columnOf(baseline, column) >= baseline.columns.size()) return;
      const std::string before = cellOf(baseline, *row, column);
      if (before != now) comparison.changes.push_back({column, before, now});
    };
    look("status", results[i].status);
    look("state_hash", results[i].value("state_hash"));
    for (const auto& [column, cell] : results[i].values)
      if (column != "state_hash" && std::find(kNotCompared.begin(), kNotCompared.end(), column) == kNotCompared.end())
        look(column, cell);
    const std::optional<double> before = numberIn(cellOf(baseline, *row, "particle_steps_per_second")),
                                now = numberIn(results[i].value("particle_steps_per_second"));
    if (before && now && *before > 0.0) comparison.speed = *now / *before;
  }
  return all;
}

std::string changesText(const BatchPlan& plan, const std::vector<Comparison>& comparisons) {
  std::string text;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const std::vector<Change>& changes = comparisons[i].changes;
    if (changes.empty()) continue;
    text += plan.runs[i].folder + ": ";
    for (std::size_t k = 0; k < std::min(changes.size(), kMostTold); ++k)
      text += (k > 0 ? ", " : "") + changes[k].words();
    if (changes.size() > kMostTold) text += fmt::format(" and {} more", changes.size() - kMostTold);
    text += "\n";
  }
  return text;
}

}  // namespace froude::study
