#include "plan/plot.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/sketch.h"

namespace froude::plan {
namespace {

constexpr double kDark = 0.16, kPale = 0.88;

constexpr std::array<exporting::Color, 8> kColors{{{0, 114, 178},
                                                   {213, 94, 0},
                                                   {0, 158, 115},
                                                   {204, 121, 167},
                                                   {230, 159, 0},
                                                   {86, 180, 233},
                                                   {90, 90, 90},
                                                   {120, 60, 20}}};

std::string decade(int k) {
  return k >= -2 && k <= 3 ? fmt::format("{:g}", std::pow(10.0, k)) : fmt::format("1e{}", k);
}

}  // namespace

Style styleOf(std::size_t k) { return {kColors[k % kColors.size()], static_cast<int>(k % 4)}; }

double Axis::at(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }

Axis axisOver(const std::vector<double>& values, double from, double to) {
  Axis axis{-1.0, 1.0, from, to};
  if (values.empty()) return axis;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  axis.low = std::floor(std::log10(*least) - 0.02);
  axis.high = std::ceil(std::log10(*most) + 0.02);
  return axis;
}

void traceMark(cairo_t* cr, int kind, double x, double y, double r) {
  cairo_new_path(cr);
  if (kind == 0) cairo_arc(cr, x, y, r, 0.0, 6.2831853);
  if (kind == 1) cairo_rectangle(cr, x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
  if (kind >= 2) {
    const double way = kind == 2 ? 1.0 : -1.0;
    cairo_move_to(cr, x, y - way * 1.25 * r);
    cairo_line_to(cr, x + 1.1 * r, y + way * 0.75 * r);
    cairo_line_to(cr, x - 1.1 * r, y + way * 0.75 * r);
    cairo_close_path(cr);
  }
}

void drawAxes(cairo_t* cr, const Axis& x, const Axis& y, const std::string& along, const std::string& up) {
  exporting::setFont(cr, 10.5);
  cairo_set_line_width(cr, 1.0);
  for (int k = static_cast<int>(x.low); k <= static_cast<int>(x.high); ++k) {
    exporting::setGrey(cr, kPale);
    cairo_move_to(cr, x.at(std::pow(10.0, k)), y.from);
    cairo_line_to(cr, x.at(std::pow(10.0, k)), y.to);
    cairo_stroke(cr);
    exporting::setGrey(cr, kDark);
    exporting::drawText(cr, decade(k), x.at(std::pow(10.0, k)), y.from + 15.0, 0.5);
  }
  for (int k = static_cast<int>(y.low); k <= static_cast<int>(y.high); ++k) {
    exporting::setGrey(cr, kPale);
    cairo_move_to(cr, x.from, y.at(std::pow(10.0, k)));
    cairo_line_to(cr, x.to, y.at(std::pow(10.0, k)));
    cairo_stroke(cr);
    exporting::setGrey(cr, kDark);
    exporting::drawText(cr, decade(k), x.from - 6.0, y.at(std::pow(10.0, k)) + 4.0, 1.0);
  }
  exporting::setGrey(cr, 0.4);
  cairo_rectangle(cr, x.from, y.to, x.to - x.from, y.from - y.to);
  cairo_stroke(cr);
  exporting::setGrey(cr, kDark);
  exporting::drawText(cr, along, 0.5 * (x.from + x.to), y.from + 32.0, 0.5);
  cairo_save(cr);
  cairo_translate(cr, x.from - 50.0, 0.5 * (y.from + y.to));
  cairo_rotate(cr, -1.5707963);
  exporting::drawText(cr, up, 0.0, 0.0, 0.5);
  cairo_restore(cr);
}

void setDashes(cairo_t* cr, double dash, double gap) {
  const double dashes[] = {dash, gap};
  cairo_set_dash(cr, dashes, dash > 0.0 ? 2 : 0, 0.0);
}

}  // namespace froude::plan
