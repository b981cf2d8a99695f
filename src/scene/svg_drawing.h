// Shapes out of SVG drawings: the outlines of a drawing, or of one element or group of it, united into one polygon.
// Reads what encloses area; strokes, texts, pictures and filters are not drawn.
#pragma once

#include <string>
#include <vector>

#include <froude/fields/polygon.h>

#include "scene/curve.h"

namespace froude::scene {

/// A drawing that gives no polygon: `what()` is "DRAWING.svg:LINE: element: what is wrong, what would be right". The
/// line is left out where it is the whole file that is wrong.
class DrawingError : public Error {
 public:
  using Error::Error;
};

/// The polygon of the drawing at `path`, or of its element or group `id` where that is not empty. The point (x, y) of
/// the drawing's user space becomes (scale·x, −scale·y) [m]: y points up.
/// `scale` [m per user unit], 0: the drawing's true size if it states one (width or height in mm, cm, in, pt or pc),
/// else 1. `tolerance` [m], 0: 1/2000 of the larger side of what is drawn; no piece of a curve's polygon is farther
/// from the curve. Outlines are filled by their fill rule and united on a lattice whose spacing is at most 2⁻²⁹ of the
/// larger side; vertices of the drawing keep their coordinates, points where outlines cross lie on the lattice.
/// What was left out is said in `notes`. Throws DrawingError; nothing but the file itself is read.
/// Cost: reading, and n log n in the number of vertices, at most 100,000, plus the number of their edges' crossings, at
/// most 1,000,000.
Polygon svgPolygon(const std::string& path, const std::string& id, double scale, double tolerance,
                   std::vector<std::string>* notes);

/// The same from text, for which messages say `name`.
Polygon svgPolygonOf(const std::string& text, const std::string& name, const std::string& id, double scale,
                     double tolerance, std::vector<std::string>* notes);

/// What an element draws, placed: subpaths in metres with y up, each a chain of curves that is closed by a straight
/// line.
struct DrawnElement {
  std::string name;   // `path "hull"`
  std::string place;  // `boat.svg:12`
  bool evenOdd = false;
  std::vector<std::vector<Curve>> subpaths;
};

/// Reads the elements of a drawing; svgPolygon's first half. Throws DrawingError.
std::vector<DrawnElement> readDrawing(const std::string& text, const std::string& name, const std::string& id,
                                      double scale, std::vector<std::string>* notes);

}  // namespace froude::scene
