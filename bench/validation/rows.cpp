#include "validation/rows.h"

#include <fmt/format.h>

#include <cmath>
#include <thread>

#include <froude/base/assert.h>
#include <froude/version.h>
#include "run/machine.h"
#include "run/summary.h"

namespace froude::validation {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

bool reached(const Metric& metric) { return std::abs(metric.error) <= *metric.target; }

}  // namespace

Context context(int threads) { return {threads, !kAssertionsOn && kOptimized}; }

std::string tableHead() {
  return fmt::format("{:<18} {:<26} {:>6} {:>9} {:>9} {:>12} {:>6} {:>8} {:>7} {:>8} {:>9}", "case", "error of",
                     "method", "spacing", "particles", "error", "order", "target", "", "wall s", "sub-steps");
}

std::vector<std::string> tableLines(const Series& series, const Context& context) {
  std::vector<std::string> lines;
  const std::string& entry = series.entry->name;
  for (const Outcome& o : series.outcomes) {
    const bool finest = &o == &series.outcomes.back();
    const std::string wall = context.timed ? fmt::format("{:.2f}", o.wall) : "-";
    if (!o.done())
      lines.push_back(fmt::format("{:<18} {:<26} {:>6} {:>9.4g} {:>9} {}", entry, "-", series.method, o.spacing,
                                  o.particles, o.state));
    for (const Metric& m : o.metrics) {
      const double slope = finest ? order(series.outcomes, m.name) : std::nan("");
      lines.push_back(fmt::format("{:<18} {:<26} {:>6} {:>9.4g} {:>9} {:>12.4g} {:>6} {:>8} {:>7} {:>8} {:>9}", entry,
                                  m.name, series.method, o.spacing, o.particles, m.error,
                                  std::isfinite(slope) ? fmt::format("{:.2f}", slope) : "",
                                  m.target ? fmt::format("{:.3g}", *m.target) : "",
                                  m.target ? (reached(m) ? "reached" : "missed") : "", wall, o.ledger.substeps));
    }
  }
  return lines;
}

std::string csvHead() {
  return "case,metric,unit,method,spacing,particles,error,order,target,reached,wall_seconds,substeps,sweeps,state,cpu,"
         "cores,commit,build,simd,threads";
}

std::vector<std::string> csvLines(const Series& series, const Context& context) {
  std::vector<std::string> lines;
  const std::string tail =
      fmt::format("{},{},{},{},{},{}", quoted(run::cpuName()), std::thread::hardware_concurrency(), FROUDE_COMMIT,
                  quoted(run::buildType()), name(bestSimdTarget()), context.threads);
  for (const Outcome& o : series.outcomes) {
    const bool finest = &o == &series.outcomes.back();
    const auto line = [&](const std::string& metric, const std::string& unit, const std::string& numbers) {
      lines.push_back(fmt::format("{},{},{},{},{:.8g},{},{},{},{},{},{},{}", series.entry->name, metric, unit,
                                  series.method, o.spacing, o.particles, numbers,
                                  context.timed && o.wall > 0.0 ? fmt::format("{:.4g}", o.wall) : "", o.ledger.substeps,
                                  o.ledger.sweeps, quoted(o.state), tail));
    };
    if (!o.done()) line("", "", ",,,");
    for (const Metric& m : o.metrics) {
      line(m.name, m.unit,
           fmt::format("{},{},{},{}", cell(m.error), finest ? cell(order(series.outcomes, m.name)) : "",
                       m.target ? cell(*m.target) : "", m.target ? (reached(m) ? "yes" : "no") : ""));
    }
  }
  return lines;
}

}  // namespace froude::validation
