#include "plan/diagram.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "export/sketch.h"
#include "plan/plot.h"

namespace froude::plan {
namespace {

// The sheet [pixels].
constexpr int kColumns = 3, kPanelWidth = 460, kPanelHeight = 360, kHeader = 104, kMargin = 20;
constexpr double kLeft = 66.0, kRight = 14.0, kTop = 34.0, kBottom = 46.0;  // of a panel, around its axes
constexpr double kLeastError = 1e-7;                                        // an error below it is drawn there
constexpr double kDark = 0.16;

using Styles = std::map<std::string, Style>;

Styles stylesOf(std::span<const Panel> panels) {
  std::set<std::string> models;
  for (const Panel& panel : panels)
    for (const Point& p : panel.points) models.insert(p.model);
  Styles styles;
  int next = 0;
  for (const std::string& model : models) {
    styles[model] = styleOf(static_cast<std::size_t>(next));
    ++next;
  }
  return styles;
}

/// A point where it is drawn.
struct Mark {
  double x = 0.0, y = 0.0;  // values on the axes
  const Point* point = nullptr;
  bool front = false;
};

void drawFront(cairo_t* cr, const std::vector<Mark>& marks, const Axis& x, const Axis& y) {
  std::vector<Mark> front;
  std::copy_if(marks.begin(), marks.end(), std::back_inserter(front), [](const Mark& m) { return m.front; });
  std::sort(front.begin(), front.end(), [](const Mark& a, const Mark& b) { return a.x < b.x; });
  if (front.empty()) return;
  exporting::setColor(cr, {250, 210, 90}, 0.9);
  cairo_set_line_width(cr, 7.0);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  cairo_move_to(cr, x.at(front.front().x), y.at(front.front().y));
  for (std::size_t i = 1; i < front.size(); ++i) {  // what is reached for a time, until the next point
    cairo_line_to(cr, x.at(front[i].x), y.at(front[i - 1].y));
    cairo_line_to(cr, x.at(front[i].x), y.at(front[i].y));
  }
  cairo_line_to(cr, x.to, y.at(front.back().y));
  cairo_stroke(cr);
}

/// Points of a model with one step, from coarse to fine.
void drawCurve(cairo_t* cr, std::vector<Mark> marks, const Style& style, const Axis& x, const Axis& y) {
  std::sort(marks.begin(), marks.end(),
            [](const Mark& a, const Mark& b) { return a.point->spacing > b.point->spacing; });
  exporting::setColor(cr, style.color, 0.8);
  cairo_set_line_width(cr, 1.4);
  if (marks.front().point->courant > 0.0) setDashes(cr, 4.0, 3.0);
  for (const Mark& m : marks) cairo_line_to(cr, x.at(m.x), y.at(m.y));
  cairo_stroke(cr);
  setDashes(cr, 0.0, 0.0);
}

/// To three digits: as much as a label has room for.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return unit * std::round(value / unit);
}

/// The spacings of a model, beside its points at its own step.
void drawLabels(cairo_t* cr, const std::vector<Mark>& marks, const Styles& styles, const Axis& x, const Axis& y) {
  exporting::setFont(cr, 9.0);
  for (const Mark& m : marks) {
    if (m.point->courant > 0.0 && !m.front) continue;
    exporting::setColor(cr, styles.at(m.point->model).color);
    const bool right = x.at(m.x) > x.to - 52.0;
    exporting::drawText(cr, exporting::lengthLabel(rounded(m.point->spacing)), x.at(m.x) + (right ? -7.0 : 7.0),
                        y.at(m.y) - 5.0, right ? 1.0 : 0.0);
  }
}

struct Axes {
  Axis x, y;
};

void drawMarks(cairo_t* cr, const std::vector<Mark>& marks, const Styles& styles, const Axes& axes, bool curves) {
  if (curves) {
    std::map<std::pair<std::string, double>, std::vector<Mark>> byModel;
    for (const Mark& m : marks) byModel[{m.point->model, m.point->courant}].push_back(m);
    for (const auto& [key, own] : byModel) drawCurve(cr, own, styles.at(key.first), axes.x, axes.y);
  }
  for (const Mark& m : marks) {
    const Style& style = styles.at(m.point->model);
    traceMark(cr, style.mark, axes.x.at(m.x), axes.y.at(m.y), m.front ? 5.0 : 3.6);
    exporting::setColor(cr, style.color, curves || m.front ? 1.0 : 0.45);
    cairo_fill_preserve(cr);
    exporting::setGrey(cr, m.front ? 0.0 : 1.0);
    cairo_set_line_width(cr, m.front ? 1.2 : 0.6);
    cairo_stroke(cr);
  }
  if (curves) drawLabels(cr, marks, styles, axes.x, axes.y);
}

/// Both logarithmic; y grows with the error, so better is lower left.
Axes axesFor(const std::vector<Mark>& marks, double left, double top) {
  std::vector<double> xs, ys;
  for (const Mark& m : marks) {
    xs.push_back(m.x);
    ys.push_back(m.y);
  }
  return {axisOver(xs, left + kLeft, left + kPanelWidth - kRight),
          axisOver(ys, top + kPanelHeight - kBottom, top + kTop)};
}

void drawTitle(cairo_t* cr, const std::string& title, double left, double top) {
  exporting::setFont(cr, 13.0);
  exporting::setGrey(cr, kDark);
  exporting::drawText(cr, exporting::shortened(cr, title, kPanelWidth - kLeft - kRight), left + kLeft, top + 22.0, 0.0);
}

void drawTarget(cairo_t* cr, const Axes& axes, double target) {
  if (!(target > 0.0) || std::log10(target) < axes.y.low || std::log10(target) > axes.y.high) return;
  exporting::setGrey(cr, 0.45);
  cairo_set_line_width(cr, 1.0);
  setDashes(cr, 2.0, 3.0);
  cairo_move_to(cr, axes.x.from, axes.y.at(target));
  cairo_line_to(cr, axes.x.to, axes.y.at(target));
  cairo_stroke(cr);
  setDashes(cr, 0.0, 0.0);
}

std::vector<Mark> marksOf(const Panel& panel) {
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < panel.points.size(); ++i) {
    const Point& p = panel.points[i];
    if (!p.ended() || !(p.cost() > 0.0)) continue;
    const bool front = std::find(panel.front.begin(), panel.front.end(), i) != panel.front.end();
    marks.push_back({p.cost(), std::max(p.error, kLeastError), &p, front});
  }
  return marks;
}

void drawPanel(cairo_t* cr, const Panel& panel, const Styles& styles, double left, double top) {
  const std::vector<Mark> marks = marksOf(panel);
  drawTitle(cr, fmt::format("{} ({})", panel.subject, panel.flow), left, top);
  const Axes axes = axesFor(marks, left, top);
  drawAxes(cr, axes.x, axes.y, "wall time of a simulated second [s]", "error");
  if (marks.empty()) return;
  drawFront(cr, marks, axes.x, axes.y);
  drawTarget(cr, axes, marks.front().point->target);
  drawMarks(cr, marks, styles, axes, true);
}

void drawOverall(cairo_t* cr, std::span<const Panel> panels, const Styles& styles, double left, double top) {
  std::vector<Mark> all;
  for (const Panel& panel : panels) {
    const std::vector<Mark> marks = marksOf(panel);
    if (marks.empty() || !(marks.front().point->target > 0.0)) continue;
    const auto quickest =
        std::min_element(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) { return a.x < b.x; });
    for (Mark m : marks) {
      m.x /= quickest->x;
      m.y /= m.point->target;
      all.push_back(m);
    }
  }
  drawTitle(cr, "all cases together", left, top);
  const Axes axes = axesFor(all, left, top);
  drawAxes(cr, axes.x, axes.y, "time over that of the case's quickest point", "error over the case's target");
  drawTarget(cr, axes, 1.0);
  drawMarks(cr, all, styles, axes, false);
}

void drawHeader(cairo_t* cr, std::span<const Panel> panels, const Styles& styles, const std::string& caption) {
  exporting::setGrey(cr, kDark);
  exporting::setFont(cr, 20.0);
  exporting::drawText(cr, "Speed against accuracy", kMargin, 32.0, 0.0);
  exporting::setFont(cr, 12.0);
  exporting::drawText(cr, caption, kMargin, 54.0, 0.0);
  exporting::drawText(cr,
                      "Lower left is better. Yellow: the front, which no other point beats in both. Dashed: a shorter "
                      "step. Dotted: the target.",
                      kMargin, 72.0, 0.0);
  const std::vector<Standing> standing = standings(panels);
  double x = kMargin;
  for (const auto& [model, style] : styles) {
    const auto own =
        std::find_if(standing.begin(), standing.end(), [&](const Standing& s) { return s.model == model; });
    const std::string text = own == standing.end()
                                 ? model + " (never ended)"
                                 : fmt::format("{} (front of {} of {})", model, own->fronts, own->cases);
    traceMark(cr, style.mark, x + 6.0, 90.0, 5.0);
    exporting::setColor(cr, style.color);
    cairo_fill(cr);
    exporting::setGrey(cr, kDark);
    exporting::drawText(cr, text, x + 16.0, 94.0, 0.0);
    x += 34.0 + exporting::textWidth(cr, text);
  }
}

}  // namespace

std::string captionOf(const PointTable& table) {
  return fmt::format("{}, {} cores, {} threads, {}, {}, commit {}, {}; {} points", table.where.cpu, table.where.cores,
                     table.where.threads, table.where.build, table.where.simd, table.where.commit, table.date,
                     table.points.size());
}

std::string drawChart(const std::string& file, std::span<const Panel> panels, const std::string& caption) {
  const int count = static_cast<int>(panels.size()) + 1;
  const int rows = (count + kColumns - 1) / kColumns;
  const exporting::Sheet sheet{2 * kMargin + kColumns * kPanelWidth, kHeader + rows * kPanelHeight + kMargin,
                               "Speed against accuracy", caption};
  const Styles styles = stylesOf(panels);
  return exporting::drawSheet(file, sheet, [&](cairo_t* cr) {
    exporting::setGrey(cr, 1.0);
    cairo_paint(cr);
    drawHeader(cr, panels, styles, caption);
    for (int k = 0; k < count; ++k) {
      const double left = kMargin + (k % kColumns) * kPanelWidth, top = kHeader + (k / kColumns) * kPanelHeight;
      if (k == 0) {
        drawOverall(cr, panels, styles, left, top);
      } else {
        drawPanel(cr, panels[static_cast<std::size_t>(k) - 1], styles, left, top);
      }
    }
  });
}

}  // namespace froude::plan
