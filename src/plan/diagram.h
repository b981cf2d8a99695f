// Work-precision diagrams: time against error, both logarithmic, one curve a model, the Pareto front marked.
#pragma once

#include <span>
#include <string>

#include "plan/front.h"

namespace froude::plan {

/// What stands over the panels: where and how the points were measured.
std::string captionOf(const PointTable& table);

/// Bytes of a picture of all panels, three a row, behind one that holds all points together: time over that of the
/// case's quickest point, error over the case's target. `file` decides on SVG or PNG and names the picture in errors.
/// Throws exporting::OutputError where it cannot be drawn.
std::string drawChart(const std::string& file, std::span<const Panel> panels, const std::string& caption);

}  // namespace froude::plan
