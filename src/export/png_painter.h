// Pictures of a world: particles coloured by a quantity, polygons, walls, time, a scale and a colour bar.
#pragma once

#include <string>

#include <froude/solver/world.h>
#include "export/color_scale.h"
#include "scene/scene.h"

struct _cairo;

namespace froude::exporting {

/// Draws all pictures of a run alike: the layout follows from the scene, so that they join to a film.
class PngPainter {
 public:
  explicit PngPainter(const scene::Scene& scene);

  /// Writes beside and renames. Throws OutputError.
  void draw(const std::string& file, const World& world) const;

  int width() const { return width_; }    // as the scene asks [pixels]
  int height() const { return height_; }  // follows from the view; even, as films want it [pixels]
  const ColorScale& scale() const { return scale_; }

 private:
  Vec2 toPixel(const Vec2& p) const {
    return {left_ + (p.x() - view_.min.x()) * pixels_, bottom_ - (p.y() - view_.min.y()) * pixels_};
  }
  void drawParticles(const World& world, std::uint8_t* data, int stride) const;
  void drawSoft(_cairo* cr, const World& world) const;  // png_soft.cpp
  void drawBodies(_cairo* cr, const World& world) const;
  void drawMark(_cairo* cr, const BodyDef& body, const Transform& transform) const;
  void drawSides(_cairo* cr) const;
  void drawHeader(_cairo* cr, double time) const;
  void drawScale(_cairo* cr) const;
  void drawColorBars(_cairo* cr) const;

  DomainDef domain_;
  std::string title_;
  ColorScale scale_, strainScale_;
  Box view_;                                              // [m]
  double restDensity_ = 1000.0, bulletDensity_ = 1000.0;  // [kg/m²]
  double fluidRadius_ = 0.0, bulletRadius_ = 0.0;         // [m]
  bool particles_ = false, soft_ = false;                 // else there is nothing to colour
  int timeDigits_ = 3;
  int width_ = 0, height_ = 0;
  double unit_ = 1.0;                                           // pixels per unit of the layout: 1 at a width of 1280
  double pixels_ = 1.0;                                         // per metre
  double left_ = 0.0, top_ = 0.0, right_ = 0.0, bottom_ = 0.0;  // of the view [pixels]
};

}  // namespace froude::exporting
