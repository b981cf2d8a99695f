#include "plan/points.h"

#include <fmt/format.h>
#include <froude/base/simd.h>
#include <froude/version.h>

#include <charconv>
#include <thread>

#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/summary.h"
#include "study/csv.h"

namespace froude::plan {
namespace {

const std::vector<std::string>& columns() {
  static const std::vector<std::string> kColumns{
      "flow",    "case",   "model", "spacing",          "courant",      "particles",
      "error",   "target", "cost",  "steps_per_second", "wall_seconds", "simulated_seconds",
      "state",   "cpu",    "cores", "commit",           "build",        "simd",
      "threads", "date"};
  return kColumns;
}

/// An empty cell is not a number.
double number(const std::string& cell, const std::string& file) {
  if (cell.empty()) return std::nan("");
  double value = 0.0;
  const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (result.ec == std::errc() && result.ptr == cell.data() + cell.size()) return value;
  throw run::InputError(fmt::format("{}: '{}' is no number", file, cell));
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

}  // namespace

Circumstances circumstances(int threads) {
  return {run::cpuName(),
          FROUDE_COMMIT,
          run::buildType(),
          std::string(name(bestSimdTarget())),
          static_cast<int>(std::thread::hardware_concurrency()),
          threads};
}

std::string pointsHead() { return study::csvLine(columns()); }

std::string pointLine(const Point& p, const Circumstances& where, const std::string& date) {
  return study::csvLine({p.flow,
                         p.subject,
                         p.model,
                         fmt::format("{:.8g}", p.spacing),
                         fmt::format("{:g}", p.courant),
                         fmt::format("{}", p.particles),
                         cell(p.error),
                         cell(p.target),
                         cell(p.cost()),
                         cell(p.stepsPerSecond()),
                         cell(p.wallSeconds),
                         cell(p.simulatedSeconds),
                         p.state,
                         where.cpu,
                         fmt::format("{}", where.cores),
                         where.commit,
                         where.build,
                         where.simd,
                         fmt::format("{}", where.threads),
                         date});
}

PointTable readPoints(const std::string& file) {
  const study::CsvTable table = study::parseCsv(run::readWholeFile(file), file);
  if (table.columns != columns()) throw run::InputError(file + ": holds something else than points of a chart");
  PointTable out;
  const auto whereOf = [&](const std::vector<std::string>& row) {
    return Circumstances{row[13],
                         row[15],
                         row[16],
                         row[17],
                         static_cast<int>(number(row[14], file)),
                         static_cast<int>(number(row[18], file))};
  };
  if (table.rows.empty()) return out;
  out.where = whereOf(table.rows.back());
  out.date = table.rows.back().back();
  for (const std::vector<std::string>& row : table.rows) {
    if (whereOf(row) != out.where) continue;
    Point p{row[0], row[1], row[2], number(row[3], file), number(row[4], file)};
    p.particles = static_cast<std::size_t>(number(row[5], file));
    p.error = number(row[6], file);
    p.target = row[7].empty() ? 0.0 : number(row[7], file);
    p.wallSeconds = number(row[10], file);
    p.simulatedSeconds = number(row[11], file);
    p.particleSteps = number(row[9], file) * p.wallSeconds;
    p.state = row[12];
    out.points.push_back(std::move(p));
  }
  return out;
}

}  // namespace froude::plan
