// Soft bodies in pictures: triangles by their strain, ropes as lines.
#include <cairo.h>

#include <algorithm>

#include "export/png_painter.h"
#include "export/sketch.h"
#include "export/soft_surface.h"

namespace froude::exporting {
namespace {

constexpr double kOutline = 1.5, kMeshLine = 0.5;  // in units of the layout
constexpr double kSeenTriangle = 7.0;              // edge of triangles whose own edges are drawn [pixels]
constexpr double kThinnestRope = 2.5;              // in units of the layout
constexpr double kDark = 0.16;

}  // namespace

void PngPainter::drawSoft(_cairo* cr, const World& world) const {
  if (world.softCount() == 0) return;
  const SoftSurface surface = softSurface(world);
  const auto x = world.soft()->x(), y = world.soft()->y();
  const auto at = [&](std::uint32_t i) { return toPixel(Vec2(x[i], y[i])); };
  const auto path = [&](auto points, bool closed) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 p = at(points[k]);
      (k == 0 ? cairo_move_to : cairo_line_to)(cr, p.x(), p.y());
    }
    if (closed) cairo_close_path(cr);
  };
  cairo_save(cr);
  cairo_rectangle(cr, left_, top_, right_ - left_, bottom_ - top_);
  cairo_clip(cr);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);  // else seams show between neighbours
  double edge = 0.0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    path(surface.triangles[t], true);
    setColor(cr, strainColor(strainScale_.position(static_cast<double>(surface.strain[t]))));
    cairo_fill(cr);
    edge += (at(surface.triangles[t][1]) - at(surface.triangles[t][0])).norm();
  }
  cairo_set_antialias(cr, CAIRO_ANTIALIAS_DEFAULT);
  if (edge > kSeenTriangle * static_cast<double>(surface.triangles.size())) {
    for (const auto& triangle : surface.triangles) path(triangle, true);
    cairo_set_line_width(cr, kMeshLine * unit_);
    setGrey(cr, 0.35);
    cairo_stroke(cr);
  }
  for (const auto& piece : surface.outline) path(piece, false);
  cairo_set_line_width(cr, kOutline * unit_);
  setGrey(cr, kDark);
  cairo_stroke(cr);
  for (const bool rim : {true, false})
    for (std::size_t k = 0; k < surface.links.size(); ++k) {
      const double width = std::max(static_cast<double>(surface.linkThickness[k]) * pixels_, kThinnestRope * unit_);
      cairo_set_line_width(cr, rim ? width + 2.0 * kOutline * unit_ : width);
      if (rim)
        setGrey(cr, kDark);
      else
        setColor(cr, strainColor(strainScale_.position(static_cast<double>(surface.linkStrain[k]))));
      path(surface.links[k], false);
      cairo_stroke(cr);
    }
  cairo_restore(cr);
}

}  // namespace froude::exporting
