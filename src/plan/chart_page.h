// The chart as a page that opens from its file, with what each point is under the pointer.
#pragma once

#include <span>
#include <string>

#include "plan/front.h"

namespace froude::plan {

/// Writes the page beside and renames it. Throws exporting::OutputError.
void writeChartPage(const std::string& file, std::span<const Panel> panels, const std::string& caption);

}  // namespace froude::plan
