// A shape as it is named on a command line: a drawing, a table of vertices, a file with one shape, or a scene's body.
#pragma once

#include <string>
#include <vector>

#include <froude/fields/polygon.h>

namespace froude::scene {

/// How a drawing becomes metres.
struct SvgOptions {
  double scale = 0.0;      // [m per user unit]; 0: the size that the drawing states, else 1
  double tolerance = 0.0;  // between a curve and its chords [m]; 0: by the drawing's size
};

struct ShapeArgument {
  Polygon polygon;
  std::string name;                // for titles: the file's name without its folder, and what was picked in it
  std::vector<std::string> notes;  // repairs
};

/// Reads FILE.toml (one line `shape = { … }` as in a scene), FILE.toml#NAME (a scene's body, in its own frame),
/// FILE.csv (x,y in each row, the outer ring) or FILE.svg#ID. Throws SceneError with the place.
ShapeArgument readShapeArgument(const std::string& argument, const SvgOptions& svg);

/// True if the argument names a drawing.
bool isDrawing(const std::string& argument);

}  // namespace froude::scene
