#include "validation/chart.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>

#include <froude/base/assert.h>
#include "plan/chart_page.h"
#include "plan/diagram.h"
#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/progress.h"
#include "run/signals.h"
#include "run/threads.h"
#include "scene/document.h"
#include "validation/runner.h"

namespace froude::validation {
namespace {

namespace fs = std::filesystem;

constexpr double kShortStep = 0.1;                         // courant of the second curve of particle methods …
constexpr double kShortStepOfGrid = 1.0;                   // … and of apic, which counts cells
constexpr double kQuickLimit = 5.0, kQuickBudget = 150.0;  // wall time of a point, of all steps together [s]

constexpr bool kTimed = !kAssertionsOn && kOptimized;

std::string today() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

void expectKnown(const std::vector<std::string>& asked, const std::vector<std::string>& known,
                 const std::string& option) {
  for (const std::string& name : asked)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw run::UsageError(fmt::format("{} {}: there is no such one{}; there are {}", option, name,
                                        scene::suggestion(name, known), fmt::join(known, ", ")));
}

bool among(const std::vector<std::string>& list, const std::string& name) {
  return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
}

bool same(const plan::Point& point, const Task& task) {
  return point.subject == task.entry->name && point.model == task.model && point.courant == task.courant &&
         std::abs(point.spacing - task.spacing) < 1e-6 * task.spacing;
}

/// Root mean square of the metrics that the case names; the strictest target among them.
void judge(const Case& entry, const Outcome& outcome, plan::Point& point) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const Metric& metric : outcome.metrics) {
    if (std::find(entry.norm.begin(), entry.norm.end(), metric.name) == entry.norm.end()) continue;
    squares += metric.error * metric.error;
    ++count;
    if (metric.target && *metric.target > 0.0)
      point.target = point.target > 0.0 ? std::min(point.target, *metric.target) : *metric.target;
  }
  if (count == entry.norm.size()) point.error = std::sqrt(squares / static_cast<double>(count));
}

void draw(const std::string& folder, const std::string& file) {
  if (!fs::exists(file)) return;
  const plan::PointTable table = plan::readPoints(file);
  const std::vector<plan::Panel> panels = plan::panels(table.points);
  for (const char* name : {"/chart.svg", "/chart.png"})
    run::writeWholeFile(folder + name, plan::drawChart(folder + name, panels, plan::captionOf(table)));
  plan::writeChartPage(folder + "/index.html", panels, plan::captionOf(table));
}

std::string line(const plan::Point& p) {
  const std::string what = fmt::format("{} {} {:g} m{}", p.subject, p.model, p.spacing,
                                       p.courant > 0.0 ? fmt::format(" courant {:g}", p.courant) : "");
  if (!p.ended()) return fmt::format("{}: {}", what, p.state);
  if (!std::isfinite(p.cost())) return fmt::format("{}: error {:.3g}", what, p.error);
  return fmt::format("{}: error {:.3g}, {:.3g} s a simulated second", what, p.error, p.cost());
}

/// Measures what is missing, a line of the file each. Returns the signal that ended it, or 0.
int measureAll(const plan::ChartOptions& options, const plan::Circumstances& where, const std::string& file) {
  std::vector<plan::Point> known;
  if (fs::exists(file)) {
    const plan::PointTable table = plan::readPoints(file);
    if (table.where == where) known = table.points;
  }
  std::ofstream out(file, std::ios::app);
  if (!fs::exists(file) || fs::file_size(file) == 0) out << plan::pointsHead();
  const std::vector<Task> tasks = chartTasks(options);
  const run::SignalGuard guard;
  const double limit = options.quick ? std::min(options.limit, kQuickLimit) : options.limit;
  double spent = 0.0;
  std::size_t done = 0;
  for (const Task& task : tasks) {
    ++done;
    if (std::any_of(known.begin(), known.end(), [&](const plan::Point& p) { return same(p, task); })) continue;
    if (options.quick && spent > kQuickBudget) {
      fmt::print(stderr, "--quick ends here, {} of {} points are left out\n", tasks.size() - done + 1, tasks.size());
      break;
    }
    const auto begin = std::chrono::steady_clock::now();
    plan::Point point = measure(task, limit, [&] { return guard.pending() != 0; });
    spent += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (guard.pending() != 0) break;
    if (!kTimed) point.wallSeconds = std::nan("");
    out << plan::pointLine(point, where, today());
    if (!out.flush()) run::throwOutputError(file);
    fmt::print(stderr, "[{}/{}] {}\n", done, tasks.size(), line(point));
  }
  return guard.pending();
}

}  // namespace

std::vector<Task> chartTasks(const plan::ChartOptions& options) {
  std::vector<std::string> cases, models;
  for (const Case& entry : allCases()) {
    if (entry.norm.empty()) continue;
    cases.push_back(entry.name);
    for (const std::string& model : methodsOf(entry))
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  }
  expectKnown(options.cases, cases, "--cases");
  expectKnown(options.models, models, "--models");
  std::vector<Task> tasks;
  for (std::size_t round = 0; round < 4; ++round) {
    for (const Case& entry : allCases()) {
      if (entry.norm.empty() || !among(options.cases, entry.name)) continue;
      const auto& spacings = entry.full.spacings;
      if (round >= spacings.size() || (options.quick && round > 1)) continue;
      for (const std::string& model : methodsOf(entry)) {
        if (!among(options.models, model)) continue;
        tasks.push_back({&entry, model, spacings[round], 0.0});
        if (entry.softModels.empty() && !options.quick)
          tasks.push_back({&entry, model, spacings[round], model == "apic" ? kShortStepOfGrid : kShortStep});
      }
    }
  }
  return tasks;
}

plan::Point measure(const Task& task, double limit, const std::function<bool()>& stop) {
  std::vector<scene::Override> overrides = task.entry->full.overrides;
  if (task.courant > 0.0) overrides.emplace_back("model.courant", fmt::format("{:g}", task.courant));
  const Outcome outcome = runOnce(*task.entry, task.model, task.spacing, overrides, {limit, stop});
  plan::Point point{std::string(flowName(task.entry->flow)), task.entry->name, task.model, task.spacing, task.courant};
  point.particles = outcome.particles;
  point.wallSeconds = outcome.wall;
  point.simulatedSeconds = outcome.simulated;
  point.particleSteps = static_cast<double>(outcome.particles) * static_cast<double>(outcome.ledger.substeps);
  point.state = outcome.state;
  judge(*task.entry, outcome, point);
  return point;
}

int chartCommand(const plan::ChartOptions& options) {
  chartTasks(options);  // before anything is written
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) throw run::InputError(fmt::format("{}: cannot be made: {}", options.folder, error.message()));
  const std::string file = options.folder + "/points.csv";
  const int threads = options.threads > 0 ? options.threads : run::usableCores();
  if (!kTimed)
    fmt::print(stderr,
               "chart: this build has assertions or is not optimised: errors alone are measured, nothing is drawn\n");
  int signal = 0;
  run::withThreads(threads, [&] { signal = measureAll(options, plan::circumstances(threads), file); });
  if (kTimed) draw(options.folder, file);
  fmt::print("{}\n", options.folder);
  return signal == 0 ? run::kDone : 128 + signal;
}

}  // namespace froude::validation
