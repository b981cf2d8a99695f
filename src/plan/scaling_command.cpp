// `froude bench scaling`: sizes and threads in turn, rows, table and pictures.
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include <froude/base/assert.h>
#include "export/sketch.h"
#include "plan/plot.h"
#include "plan/scaling.h"
#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/signals.h"
#include "run/threads.h"
#include "scene/document.h"
#include "study/csv.h"

namespace froude::plan {
namespace {

namespace fs = std::filesystem;

constexpr double kSeconds = 2.0, kQuickSeconds = 0.2;  // wall time of a measurement
constexpr int kRounds = 3;
constexpr double kQuickMost = 2.0;
constexpr int kPanelWidth = 620, kPanelHeight = 440, kHeader = 110, kMargin = 20;
constexpr double kDark = 0.16;

std::vector<Subject> chosen(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Subject& s : scalingSubjects()) known.push_back(s.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw run::UsageError(fmt::format("--subjects {}: there is no such one{}; there are {}", name,
                                        scene::suggestion(name, known), fmt::join(known, ", ")));
  std::vector<Subject> out;
  for (const Subject& s : scalingSubjects())
    if (names.empty() || std::find(names.begin(), names.end(), s.name) != names.end()) out.push_back(s);
  return out;
}

std::string row(const Sample& s, const Circumstances& where) {
  return study::csvLine({s.subject, fmt::format("{}", s.particles), fmt::format("{}", s.threads),
                         fmt::format("{}", s.substeps), fmt::format("{:.4g}", s.sweeps),
                         fmt::format("{:.5g}", s.median), fmt::format("{:.5g}", s.best), fmt::format("{}", s.runs),
                         fmt::format("{:.0f}", s.bytes), where.cpu, fmt::format("{}", where.cores), where.commit,
                         where.build, where.simd});
}

const char* kHead =
    "subject,particles,threads,substeps,sweeps_a_substep,ns_median,ns_best,runs,bytes_a_particle,cpu,cores,commit,"
    "build,"
    "simd\n";

/// The other samples of a subject and a size.
const Sample* find(std::span<const Sample> samples, const Sample& like, std::size_t particles, int threads) {
  for (const Sample& s : samples)
    if (s.subject == like.subject && s.threads == threads &&
        std::abs(static_cast<double>(s.particles) / static_cast<double>(particles) - 1.0) < 0.05)
      return &s;
  return nullptr;
}

void printTable(std::span<const Sample> samples, double triad) {
  fmt::print("{:<10} {:>10} {:>8} {:>10} {:>10} {:>14} {:>8} {:>8}\n", "subject", "particles", "threads", "ns/step",
             "sweeps", "bytes/particle", "strong", "weak");
  for (const Sample& s : samples) {
    const Sample* one = find(samples, s, s.particles, 1);
    const Sample* part = find(samples, s, s.particles / static_cast<std::size_t>(s.threads), 1);
    const auto cell = [&](const Sample* other, double over) {
      return s.threads > 1 && other != nullptr ? fmt::format("{:.2f}", other->median / s.median / over) : std::string();
    };
    fmt::print("{:<10} {:>10} {:>8} {:>10.1f} {:>10.2f} {:>14.0f} {:>8} {:>8}\n", s.subject, s.particles, s.threads,
               s.median, s.sweeps, s.bytes, cell(one, 1.0), cell(part, s.threads));
  }
  fmt::print(
      "ns/step: a particle in a sub-step, of wcsph in an acoustic step; strong: times as fast as on one thread; weak: "
      "share of "
      "the speed kept with as many particles a thread; memory's own gain (triad): {:.2f}\n",
      triad);
}

void drawTimes(cairo_t* cr, std::span<const Sample> samples, const std::map<std::string, Style>& styles) {
  std::vector<double> xs, ys;
  for (const Sample& s : samples) {
    xs.push_back(static_cast<double>(s.particles));
    ys.push_back(s.median);
  }
  const Axis x = axisOver(xs, kMargin + 66.0, kMargin + kPanelWidth - 14.0);
  const Axis y = axisOver(ys, kHeader + kPanelHeight - 46.0, kHeader + 10.0);
  drawAxes(cr, x, y, "particles", "wall time of a particle-step [ns]");
  for (const auto& [name, style] : styles) {
    for (const int threads : {1, 2}) {
      exporting::setColor(cr, style.color);
      setDashes(cr, threads == 1 ? 0.0 : 4.0, 3.0);
      cairo_set_line_width(cr, 1.6);
      for (const Sample& s : samples)
        if (s.subject == name && (s.threads == 1) == (threads == 1))
          cairo_line_to(cr, x.at(static_cast<double>(s.particles)), y.at(s.median));
      cairo_stroke(cr);
    }
    setDashes(cr, 0.0, 0.0);
    for (const Sample& s : samples) {
      if (s.subject != name) continue;
      traceMark(cr, style.mark, x.at(static_cast<double>(s.particles)), y.at(s.median), 4.0);
      exporting::setColor(cr, style.color);
      cairo_fill(cr);
    }
  }
}

/// The gain over particles; its axis is linear from 0.8 to the number of threads.
void drawGains(cairo_t* cr, std::span<const Sample> samples, double triad, const std::map<std::string, Style>& styles) {
  std::vector<double> xs;
  int most = 1;
  for (const Sample& s : samples) {
    xs.push_back(static_cast<double>(s.particles));
    most = std::max(most, s.threads);
  }
  const double left = kMargin + kPanelWidth, top = kHeader + 10.0, bottom = kHeader + kPanelHeight - 46.0;
  const Axis x = axisOver(xs, left + 66.0, left + kPanelWidth - 14.0);
  const auto y = [&](double gain) { return bottom + (gain - 0.8) / (1.1 * most - 0.8) * (top - bottom); };
  drawAxes(cr, x, {1.0, 0.0, bottom, top}, "particles", fmt::format("times as fast on {} threads", most));
  exporting::setFont(cr, 10.5);
  for (double gain = 1.0; gain <= most + 1e-9; gain += 0.25) {
    exporting::setGrey(cr, 0.88);
    cairo_move_to(cr, x.from, y(gain));
    cairo_line_to(cr, x.to, y(gain));
    cairo_stroke(cr);
    exporting::setGrey(cr, kDark);
    exporting::drawText(cr, fmt::format("{:g}", gain), x.from - 6.0, y(gain) + 4.0, 1.0);
  }
  exporting::setGrey(cr, 0.4);
  setDashes(cr, 2.0, 3.0);
  cairo_move_to(cr, x.from, y(triad));
  cairo_line_to(cr, x.to, y(triad));
  cairo_stroke(cr);
  setDashes(cr, 0.0, 0.0);
  exporting::drawText(cr, "memory alone", x.to - 4.0, y(triad) - 5.0, 1.0);
  for (const Sample& s : samples) {
    const Sample* one = find(samples, s, s.particles, 1);
    if (s.threads != most || most == 1 || one == nullptr) continue;
    const Style& style = styles.at(s.subject);
    traceMark(cr, style.mark, x.at(static_cast<double>(s.particles)), y(one->median / s.median), 4.0);
    exporting::setColor(cr, style.color);
    cairo_fill(cr);
  }
}

/// Measures until a size takes too long. Returns the signal that ended it, or 0.
int measureAll(const ScalingOptions& options, std::vector<Sample>& samples) {
  const run::SignalGuard guard;
  std::vector<int> threads{1};
  if (run::usableCores() > 1) threads.push_back(run::usableCores());
  for (const Subject& subject : chosen(options.subjects)) {
    for (double k = 1.0; k <= (options.quick ? kQuickMost : subject.most); k *= 2.0) {
      if (guard.pending() != 0) return guard.pending();
      const std::vector<Sample> own =
          measureScaling(subject, k, threads, options.quick ? kQuickSeconds : kSeconds, options.quick ? 1 : kRounds);
      samples.insert(samples.end(), own.begin(), own.end());
      const Sample& s = own.front();
      const double wall = 1e-9 * s.median * static_cast<double>(s.particles) * static_cast<double>(s.substeps);
      fmt::print(stderr, "{} {}: {:.1f} ns\n", s.subject, s.particles, s.median);
      if (2.0 * wall > options.limit) break;
    }
  }
  return 0;
}

}  // namespace

std::string drawScaling(const std::string& file, std::span<const Sample> samples, double triad,
                        const std::string& caption) {
  std::map<std::string, Style> styles;
  for (const Sample& s : samples) styles.emplace(s.subject, styleOf(styles.size()));
  const exporting::Sheet sheet{2 * kMargin + 2 * kPanelWidth, kHeader + kPanelHeight + kMargin, "Scaling", caption};
  return exporting::drawSheet(file, sheet, [&](cairo_t* cr) {
    exporting::setGrey(cr, 1.0);
    cairo_paint(cr);
    exporting::setGrey(cr, kDark);
    exporting::setFont(cr, 20.0);
    exporting::drawText(cr, "Scaling with particles and threads", kMargin, 32.0, 0.0);
    exporting::setFont(cr, 12.0);
    exporting::drawText(cr, caption, kMargin, 54.0, 0.0);
    double at = kMargin;
    for (const auto& [name, style] : styles) {
      traceMark(cr, style.mark, at + 6.0, 76.0, 5.0);
      exporting::setColor(cr, style.color);
      cairo_fill(cr);
      exporting::setGrey(cr, kDark);
      exporting::drawText(cr, name, at + 16.0, 80.0, 0.0);
      at += 34.0 + exporting::textWidth(cr, name);
    }
    if (samples.empty()) return;
    drawTimes(cr, samples, styles);
    drawGains(cr, samples, triad, styles);
  });
}

int scalingCommand(const ScalingOptions& options) {
  if (kAssertionsOn || !kOptimized)
    throw run::UsageError(
        "bench: this build has assertions or is not optimised, its times would mean nothing; right is the preset "
        "release");
  chosen(options.subjects);  // before anything is written
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) throw run::InputError(fmt::format("{}: cannot be made: {}", options.folder, error.message()));
  std::vector<Sample> samples;
  const run::ThreadLimit limit(run::usableCores());
  const double triad = triadScaling(run::usableCores());
  const int signal = measureAll(options, samples);
  const Circumstances where = circumstances(run::usableCores());
  std::string rows = kHead;
  for (const Sample& s : samples) rows += row(s, where);
  run::writeWholeFile(options.folder + "/scaling.csv", rows);
  const std::string caption = fmt::format("{}, {} cores, {}, {}, commit {}; whole: one thread, dashed: all of them",
                                          where.cpu, where.cores, where.build, where.simd, where.commit);
  for (const char* name : {"/scaling.svg", "/scaling.png"})
    run::writeWholeFile(options.folder + name, drawScaling(options.folder + name, samples, triad, caption));
  printTable(samples, triad);
  fmt::print("{}\n", options.folder);
  return signal == 0 ? run::kDone : 128 + signal;
}

}  // namespace froude::plan
