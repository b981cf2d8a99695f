// What diagrams share: logarithmic axes, colours and marks that people with every common colour blindness tell apart.
#pragma once

#include <string>
#include <vector>

#include "export/color_scale.h"

struct _cairo;

namespace froude::plan {

/// Curve number k: eight colours (Okabe & Ito 2008), four marks.
struct Style {
  exporting::Color color{};
  int mark = 0;
};
Style styleOf(std::size_t k);

/// One logarithmic axis, in whole decades.
struct Axis {
  double low = 0.0, high = 0.0;  // decades
  double from = 0.0, to = 0.0;   // pixels
  double at(double value) const;
};
/// Over positive values, all of them inside; of none a decade to either side of 1.
Axis axisOver(const std::vector<double>& values, double from, double to);

/// Lines at the decades with their numbers, a frame, and what the axes mean.
void drawAxes(_cairo* cr, const Axis& x, const Axis& y, const std::string& along, const std::string& up);
/// The path of a mark of radius r [pixels], to be filled.
void traceMark(_cairo* cr, int kind, double x, double y, double r);
/// Lines from here on are dashed, or whole with 0.
void setDashes(_cairo* cr, double dash, double gap);

}  // namespace froude::plan
