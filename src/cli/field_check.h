// `froude field SHAPE --check`: a polygon's distance field against OpenVDB's level set of it, as a table.
#pragma once

#include <froude/fields/polygon.h>

#include <iosfwd>
#include <string>

namespace froude::cli {

/// Compares at several voxel sizes and prints a table to `out`; `name` is the shape's, for the title. Returns the exit
/// code: 0 whatever the comparison shows, 2 in a build without OpenVDB (said on stderr). Docs: docs/openvdb.md.
int printFieldCheck(const Polygon& polygon, const std::string& name, std::ostream& out);

}  // namespace froude::cli
