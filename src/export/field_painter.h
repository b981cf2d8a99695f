// A picture of a polygon's distance field, as PNG or SVG.
#pragma once

#include <string>
#include <vector>

#include <froude/fields/polygon.h>

namespace froude::exporting {

enum class FieldLayer { Distance, Cells, Vectors, Features };

/// What to draw; what is 0 or empty is chosen.
struct FieldPicture {
  std::vector<FieldLayer> layers;  // one panel each; empty: all four
  std::vector<double> offsets;     // curves at these distances, negative inside [m]
  double band = 0.0;               // how far the field's cells reach [m]; 0: 15 % of the shape's size
  double cell = 0.0;               // their size [m]; 0: by size and number of edges
  int width = 1280;                // [pixels]
};

/// True for the files that can be drawn: names that end in .png or .svg, or .html for a page to explore it.
bool isPicture(const std::string& file);

/// Draws the field of `polygon` and writes beside and renames. Returns remarks, for example about an offset that is
/// nowhere. Throws OutputError, and Error for a band or cell that cannot be.
std::vector<std::string> drawField(const std::string& file, const Polygon& polygon, const std::string& title,
                                   const FieldPicture& picture);

}  // namespace froude::exporting
