// What pictures share: grey levels, letters, labels of lengths, and a surface as PNG bytes.
#pragma once

#include <memory>
#include <string>

#include <froude/base/parallel.h>
#include "export/color_scale.h"

struct _cairo;
struct _cairo_surface;

namespace froude::exporting {

void setGrey(_cairo* cr, double level);
void setColor(_cairo* cr, Color color, double opacity = 1.0);

/// Letters of all pictures, `size` in pixels.
void setFont(_cairo* cr, double size);
double textWidth(_cairo* cr, const std::string& text);
/// `align` 0: begins at x, ½: centred, 1: ends at x. y is the base line.
void drawText(_cairo* cr, const std::string& text, double x, double y, double align);
/// The text, or as much of its beginning as fits into `room` and an ellipsis.
std::string shortened(_cairo* cr, const std::string& text, double room);

/// 0.5 → "0.5 m", 0.02 → "2 cm", 0.002 → "2 mm".
std::string lengthLabel(double metres);

/// A bar that is `metres` long from x on, y its middle, with its length below.
struct ScaleBar {
  double metres, x, y;
  double pixels;  // per metre
  double unit;    // pixels per unit of the layout
};
void drawScaleBar(_cairo* cr, const ScaleBar& bar);

/// A picture of its own, in pixels. Letters become outlines in SVG, so title and description are said there once more,
/// for those who search or listen.
struct Sheet {
  int width = 0, height = 0;
  std::string title, description;
};
/// Bytes of the picture that `paint` draws: SVG for a name that ends in .svg, else PNG. Throws OutputError, naming
/// `file`, where Cairo failed.
std::string drawSheet(const std::string& file, const Sheet& sheet, FunctionRef<void(_cairo*)> paint);

/// Throws OutputError, naming `file`, where Cairo failed.
std::string pngBytes(_cairo* cr, _cairo_surface* surface, const std::string& file);

}  // namespace froude::exporting
