// The page of a distance field: the polygon and its cells, for a browser to compute the field from.
#pragma once

#include <string>

#include <froude/fields/distance_field.h>

namespace froude::exporting {

/// Writes the page FILE.html: colours, contours, cells, the minimum translation vector under the pointer, and the
/// Voronoi regions of the closest features of two polygons. Throws OutputError. Size: about 8 bytes an edge of a cell.
void writeFieldPage(const std::string& file, const DistanceField& field, const std::string& title);

}  // namespace froude::exporting
