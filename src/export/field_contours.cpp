#include "export/field_contours.h"

#include <cairo.h>
#include <fmt/format.h>

#include <froude/fields/offset_curve.h>

#include "export/sketch.h"

namespace froude::exporting {
namespace {

constexpr double kLabel = 12.0;   // size of letters, in units of the layout
constexpr double kStride = 12.0;  // between places that are tried for a label, in units of the layout

}  // namespace

std::string LengthUnit::label(double distance) const {
  const std::string text = fmt::format("{:.6g}", distance / metres);
  return text.starts_with('-') ? "−" + text.substr(1) : text;
}

LengthUnit lengthUnitFor(double largest) {
  if (largest >= 2000.0) return {1000.0, "km"};
  if (largest >= 0.1) return {1.0, "m"};
  if (largest >= 1e-4) return {1e-3, "mm"};
  return {1e-6, "µm"};
}

ContourPainter::ContourPainter(const FieldPanel& panel, LengthUnit unit) : panel_(panel), unit_(std::move(unit)) {}

bool ContourPainter::drawCurve(double distance, Color color, double lineWidth) {
  const Polygon& polygon = panel_.field->polygon();
  const std::vector<OffsetPiece> pieces = offsetCurve(polygon, distance);
  cairo_t* cr = panel_.cr;
  const double gap = 1e-9 * panel_.view.size().maxCoeff();
  places_.clear();
  Vec2 end(kInfinity, kInfinity);
  double walked = kStride * panel_.unit;
  for (const OffsetPiece& piece : pieces) {
    const Vec2 from = panel_.toPixel(piece.from), to = panel_.toPixel(piece.to);
    if (!((piece.from - end).norm() <= gap)) cairo_move_to(cr, from.x(), from.y());
    double length = (to - from).norm();
    if (piece.feature == FeatureKind::Edge) {
      cairo_line_to(cr, to.x(), to.y());
    } else {
      const Vec2 center = panel_.toPixel(polygon.edgeStart(piece.edge));
      const double radius = std::abs(distance) * panel_.pixels, last = piece.startAngle + piece.sweep;
      // y points down on the picture, so counter-clockwise is Cairo's negative.
      (piece.sweep > 0.0 ? cairo_arc_negative : cairo_arc)(cr, center.x(), center.y(), radius, -piece.startAngle,
                                                           -last);
      length = radius * std::abs(piece.sweep);
    }
    end = piece.to;
    for (walked += length; walked >= kStride * panel_.unit; walked -= kStride * panel_.unit)
      places_.push_back(panel_.toPixel(piece.at(
          length > 0.0 ? 1.0 - std::min(walked - kStride * panel_.unit, length) / length : 0.0, polygon, distance)));
  }
  setColor(cr, color);
  cairo_set_line_width(cr, lineWidth * panel_.unit);
  cairo_stroke(cr);
  return !pieces.empty();
}

bool ContourPainter::isFree(const Box& place) const {
  const double margin = 3.0 * panel_.unit;
  const Vec2 size = panel_.view.size() * panel_.pixels;
  const Box map{{panel_.left + margin, panel_.top + margin},
                {panel_.left + size.x() - margin, panel_.top + size.y() - margin}};
  if (!map.contains(place.min) || !map.contains(place.max)) return false;
  return std::none_of(taken_.begin(), taken_.end(), [&](const Box& t) { return t.overlaps(place); });
}

void ContourPainter::labelCurve(double distance, Color color) {
  cairo_t* cr = panel_.cr;
  setFont(cr, kLabel * panel_.unit);
  const std::string text = unit_.label(distance);
  const Vec2 half(0.5 * textWidth(cr, text) + 2.0 * panel_.unit, 0.5 * kLabel * panel_.unit);
  // From the middle of the curve on, in large steps first, so that labels of neighbouring curves do not queue up.
  const std::size_t count = places_.size();
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2& p = places_[(count / 3 + k * 7) % count];
    const Box place{p - half, p + half};
    if (!isFree(place)) continue;
    taken_.push_back(place.grown(6.0 * panel_.unit));
    const double base = p.y() + 0.36 * kLabel * panel_.unit;
    cairo_move_to(cr, p.x() - half.x() + 2.0 * panel_.unit, base);
    cairo_text_path(cr, text.c_str());
    cairo_set_source_rgba(cr, 1, 1, 1, 0.9);
    cairo_set_line_width(cr, 3.0 * panel_.unit);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(cr);
    setColor(cr, color);
    drawText(cr, text, p.x() - half.x() + 2.0 * panel_.unit, base, 0.0);
    return;
  }
}

}  // namespace froude::exporting
