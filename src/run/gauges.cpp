#include "run/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "run/gauge_surface.h"
#include "run/gauge_values.h"

namespace froude::run {
namespace {

// Times that agree to this part of `every` are one row: 3·0.01 and 0.03 differ in the last bit.
constexpr double kSameTime = 1e-9;

std::string number(double v) { return std::isnan(v) ? "nan" : fmt::format("{:.17g}", v); }

double interpolate(double a, double b, double weight) {
  if (weight <= 0.0) return a;  // else a NaN or an infinity at the other end would reach over
  if (weight >= 1.0) return b;
  return a + (b - a) * weight;
}

std::size_t softIndex(const scene::GaugeDef& def, const World& world) {
  for (std::size_t i = 0; i < world.softCount(); ++i)
    if (world.softDefinition(i).name == def.soft) return i;
  throw Error(fmt::format("gauge {}: no soft body \"{}\"", def.name, def.soft));
}

}  // namespace

/// A definition and the readings that are still needed.
struct GaugeSet::Gauge {
  scene::GaugeDef def;
  std::size_t body = 0;
  std::size_t firstColumn = 0, width = 0;  // columns in the file
  std::size_t readings = 0;                // values of one reading: `width`, or one less with a window
  std::uint64_t next = 0;                  // number of the next time
  std::vector<double> times, values;       // [s]; readings.size() · times.size()

  double window() const { return readings < width ? def.window : 0.0; }
  /// By multiplication: sums of `every` would drift.
  double due() const { return static_cast<double>(next) * def.every; }
  double slack() const { return kSameTime * def.every; }

  bool mustRead(double t, double step) const { return window() > 0.0 || t + 2.0 * step >= due(); }

  void read(GaugeInput& input) {
    if (!times.empty() && times.back() == input.world().time()) return;
    times.push_back(input.world().time());
    values.resize(values.size() + readings);
    readGauge(def, body, input, std::span(values).last(readings));
  }

  /// Index of the first reading later than t.
  std::size_t after(double t) const {
    return static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  }

  double at(double t, std::size_t value) const {
    const std::size_t late = std::min(after(t), times.size() - 1), early = late > 0 ? late - 1 : 0;
    if (late == early) return values[late * readings + value];
    const double weight = (t - times[early]) / (times[late] - times[early]);
    return interpolate(values[early * readings + value], values[late * readings + value], weight);
  }

  /// Mean of the first value over [t − window, t].
  double meanAt(double t) const {
    const double from = std::max(t - window(), times.front());
    double integral = 0.0, covered = 0.0;
    for (std::size_t k = 1; k < times.size(); ++k) {
      const double begin = std::max(from, times[k - 1]), end = std::min(t, times[k]);
      if (!(end > begin)) continue;
      const double mean = 0.5 * (at(begin, 0) + at(end, 0));
      if (std::isnan(mean)) continue;
      integral += mean * (end - begin);
      covered += end - begin;
    }
    return covered > 0.0 ? integral / covered : at(t, 0);
  }

  void append(double t, std::string& row) const {
    for (std::size_t v = 0; v < readings; ++v) row += "," + number(at(t, v));
    if (readings < width) row += "," + number(meanAt(t));
  }

  /// Drops what no row to come needs: not the next one, nor one that ends the run here.
  void forget() {
    const std::size_t later = after(std::min(due(), times.back()) - window());
    const std::size_t drop = std::min(later > 0 ? later - 1 : 0, times.size() - 1);
    times.erase(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(drop));
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(drop * readings));
  }

  /// On to the first time that is later than t.
  void advance(double t) {
    while (due() <= t + slack()) ++next;
  }
};

GaugeSet::GaugeSet(const std::vector<scene::GaugeDef>& gauges, const World& world) {
  for (const scene::GaugeDef& def : gauges) {
    Gauge gauge;
    gauge.def = def;
    if (def.type == "force" || def.type == "pose") gauge.body = world.bodyIndex(def.body);
    if (def.type == "tip" || def.type == "area") gauge.body = softIndex(def, world);
    const std::vector<GaugeColumn> columns = gaugeColumns(def);
    gauge.firstColumn = columns_.size();
    gauge.width = columns.size();
    gauge.readings = columns.size() - (def.type == "pressure" && def.window > 0.0 ? 1 : 0);
    columns_.insert(columns_.end(), columns.begin(), columns.end());
    gauges_.push_back(std::move(gauge));
  }
}

GaugeSet::~GaugeSet() = default;
GaugeSet::GaugeSet(GaugeSet&&) noexcept = default;
GaugeSet& GaugeSet::operator=(GaugeSet&&) noexcept = default;

std::string GaugeSet::header() const {
  std::string line = "t";
  for (const GaugeColumn& c : columns_) line += "," + c.name;
  return line;
}

void GaugeSet::read(const World& world, bool all) {
  GaugeInput input(world);
  for (Gauge& g : gauges_)
    if (all || g.mustRead(world.time(), lastStep_)) g.read(input);
}

void GaugeSet::afterStep(const World& world, std::vector<std::string>& rows) {
  const double t = world.time();
  if (gauges_.empty() || (started_ && t <= lastTime_)) return;
  lastStep_ = started_ ? t - lastTime_ : 0.0;
  lastTime_ = t;
  read(world, !started_);
  if (!started_) writeRow(t, rows, true);
  started_ = true;
  writeDue(t, rows);
  for (Gauge& g : gauges_) g.forget();
}

void GaugeSet::atEnd(const World& world, std::vector<std::string>& rows) {
  if (gauges_.empty()) return;
  const double t = world.time();
  afterStep(world, rows);
  read(world, true);
  if (t > lastRow_) writeRow(t, rows, true);
}

/// Rows of all times before `end`, the earliest first.
void GaugeSet::writeDue(double end, std::vector<std::string>& rows) {
  while (true) {
    double earliest = kInfinity;
    for (const Gauge& g : gauges_)
      if (g.due() < end - g.slack()) earliest = std::min(earliest, g.due());
    if (earliest == kInfinity) return;
    writeRow(earliest, rows, false);
  }
}

/// The row at t, of all gauges or of those that are due then; those go on to their next times.
void GaugeSet::writeRow(double t, std::vector<std::string>& rows, bool all) {
  std::string row = number(t);
  for (Gauge& g : gauges_) {
    const bool due = g.due() <= t + g.slack();
    if (all || due)
      g.append(t, row);
    else
      row.append(g.width, ',');
    if (due) g.advance(t);
  }
  rows.push_back(std::move(row));
  lastRow_ = t;
}

void GaugeSet::archive(Archive& a) {
  a.beginSection("gauges");
  a.value("started", started_);
  a.value("last_row", lastRow_);
  a.value("last_time", lastTime_);
  a.value("last_step", lastStep_);
  for (Gauge& g : gauges_) {
    a.beginSection(g.def.name);
    a.value("next", g.next);
    a.array("times", g.times);
    a.array("values", g.values);
    if (a.loading() && g.values.size() != g.times.size() * g.readings)
      throw Error("gauge " + g.def.name + ": the saved state holds another kind of gauge of that name");
    a.endSection();
  }
  a.endSection();
}

double GaugeSet::fluidArea(const World& world) { return FluidSurface(world).area(); }

}  // namespace froude::run
