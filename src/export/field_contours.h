// Offset curves and their labels on a panel of a distance field.
#pragma once

#include <string>
#include <vector>

#include "export/color_scale.h"
#include "export/field_panels.h"

namespace froude::exporting {

/// Metres, or the unit in which distances up to `largest` [m] read well.
struct LengthUnit {
  double metres = 1.0;  // one unit [m]
  std::string name = "m";
  std::string label(double distance) const;  // without the name
};
LengthUnit lengthUnitFor(double largest);

/// Draws curves and keeps their labels apart.
class ContourPainter {
 public:
  ContourPainter(const FieldPanel& panel, LengthUnit unit);

  /// All points at that distance [m], as straight lines and true arcs. False if there are none.
  bool drawCurve(double distance, Color color, double lineWidth);
  /// A label on the curve that was drawn last, where there is room; none where there is not.
  void labelCurve(double distance, Color color);

 private:
  bool isFree(const Box& place) const;

  const FieldPanel& panel_;
  LengthUnit unit_;
  std::vector<Box> taken_;    // by labels [pixels]
  std::vector<Vec2> places_;  // along the last curve [pixels]
};

}  // namespace froude::exporting
