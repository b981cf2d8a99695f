#include "export/png_painter.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "export/frames.h"
#include "export/png_particles.h"
#include "export/sketch.h"
#include "run/atomic_file.h"

namespace froude::exporting {
namespace {

// The layout, in units of 1/1280 of the width.
constexpr double kMargin = 28.0, kHeader = 60.0, kFooter = 84.0;
constexpr double kWall = 4.0, kOutline = 1.5;
constexpr double kTallest = 1.4;                   // view, against the picture's width
constexpr double kSmallestUnit = 0.6;              // letters stay legible in small pictures
constexpr double kBar = 340.0, kShortBar = 220.0;  // two bars stand side by side
constexpr double kSmallestBullet = 1.25;           // radius
constexpr double kSmallestDrop = 3.5;              // radius of a fluid's particle that is seen by itself [pixels]
constexpr double kDark = 0.16, kGrey = 0.45, kBody = 0.78;
constexpr Color kScripted{184, 202, 222}, kFree{240, 204, 158}, kAsleep{249, 233, 212};
constexpr double kSmallestMarked = 8.0;  // radius of a free body whose turning is still seen [pixels]
constexpr double kHinge = 4.5;           // radius of its ring

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

/// The first stretch of the ray from a shape's centre of area along its own x axis that lies within it.
std::array<Vec2, 2> markOf(const Polygon& shape) {
  const Vec2 center = shape.centroid();
  std::vector<double> crossings;
  for (std::uint32_t i = 0; i < shape.edgeCount(); ++i) {
    const Vec2 a = shape.edgeStart(i) - center, b = shape.edgeEnd(i) - center;
    if ((a.y() > 0.0) == (b.y() > 0.0)) continue;
    const double x = a.x() + (b.x() - a.x()) * a.y() / (a.y() - b.y());
    if (x > 0.0) crossings.push_back(x);
  }
  std::sort(crossings.begin(), crossings.end());
  const bool within = crossings.size() % 2 == 1;
  if (crossings.empty()) return {center, center};
  const double from = within ? 0.0 : crossings[0], to = crossings[within ? 0 : 1];
  return {center + Vec2(from, 0.0), center + Vec2(to, 0.0)};
}

}  // namespace

PngPainter::PngPainter(const scene::Scene& scene)
    : domain_(scene.world.domain),
      title_(scene.title),
      scale_(colorScale(scene)),
      strainScale_(strainScale(scene)),
      width_(scene.output.image.width) {
  view_ = scene.output.image.view;
  if (view_.empty() || !(view_.size().minCoeff() > 0.0)) view_ = domain_.box;
  if (title_.empty()) title_ = scene.name;
  if (scene.world.fluid) {
    restDensity_ = scene.world.fluid->density;
    fluidRadius_ = 0.5 * scene.world.fluid->spacing;
  }
  if (scene.world.bullet) {
    bulletDensity_ = scene.world.bullet->density;
    bulletRadius_ = scene.world.bullet->radius;
  }
  particles_ = scene.world.fluid || scene.world.bullet;
  soft_ = !scene.world.soft.empty();
  // One digit more than the frames need: they are taken at step ends, a little after their times.
  timeDigits_ = std::clamp(static_cast<int>(std::ceil(-std::log10(scene.output.every))) + 1, 1, 9);

  unit_ = std::max(width_ / 1280.0, kSmallestUnit);
  const double room = std::max(width_ - 2.0 * kMargin * unit_, 1.0);
  const Vec2 size = view_.size();
  pixels_ = std::min(room / size.x(), kTallest * room / size.y());
  left_ = 0.5 * (width_ - pixels_ * size.x());
  right_ = left_ + pixels_ * size.x();
  top_ = std::round(kHeader * unit_);
  bottom_ = top_ + pixels_ * size.y();
  height_ = static_cast<int>(std::ceil((bottom_ + kFooter * unit_) / 2.0)) * 2;
}

void PngPainter::draw(const std::string& file, const World& world) const {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, height_), cairo_surface_destroy);
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_t* cr = context.get();
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_paint(cr);
  cairo_surface_flush(surface.get());
  if (unsigned char* data = cairo_image_surface_get_data(surface.get()))
    drawParticles(world, data, cairo_image_surface_get_stride(surface.get()));
  cairo_surface_mark_dirty(surface.get());
  drawSoft(cr, world);
  drawBodies(cr, world);
  drawSides(cr);
  drawHeader(cr, world.time());
  drawScale(cr);
  drawColorBars(cr);

  run::writeWholeFile(file, pngBytes(cr, surface.get(), file));
}

void PngPainter::drawParticles(const World& world, std::uint8_t* data, int stride) const {
  const Canvas canvas{data,
                      stride,
                      static_cast<int>(std::lround(left_)),
                      static_cast<int>(std::lround(top_)),
                      static_cast<int>(std::lround(right_)),
                      static_cast<int>(std::lround(bottom_))};
  std::vector<Disc> discs;
  for (const ParticlePool* pool : {world.fluid(), world.bullets()}) {
    if (pool == nullptr || pool->empty()) continue;
    const bool isFluid = pool == world.fluid();
    const double radius = isFluid ? fluidRadius_ * pixels_ : std::max(bulletRadius_ * pixels_, kSmallestBullet * unit_);
    const Box seen = view_.grown((radius + 1.0) / pixels_);
    const auto pressure = pool->findColumn<float>("pressure"), density = pool->findColumn<float>("density");
    const auto x = pool->x(), y = pool->y(), vx = pool->vx(), vy = pool->vy();
    discs.clear();
    for (std::size_t i = 0; i < pool->size(); ++i) {
      const Vec2 p(x[i], y[i]);
      if (!seen.contains(p)) continue;
      double value = std::nan("");
      if (scale_.quantity == ColorScale::Quantity::Speed)
        value = std::hypot(vx[i], vy[i]);
      else if (scale_.quantity == ColorScale::Quantity::Pressure && isFluid && pressure)
        value = restDensity_ * static_cast<double>(pool->column(*pressure)[i]);
      else if (scale_.quantity == ColorScale::Quantity::Density && isFluid && density)
        value = restDensity_ * static_cast<double>(pool->column(*density)[i]);
      const Vec2 at = toPixel(p);
      discs.push_back(
          {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(scale_.position(value))});
    }
    paintDiscs(canvas, discs, radius, isFluid && radius < kSmallestDrop ? Look::Together : Look::Apart);
  }
}

void PngPainter::drawBodies(cairo_t* cr, const World& world) const {
  cairo_save(cr);
  cairo_rectangle(cr, left_, top_, right_ - left_, bottom_ - top_);
  cairo_clip(cr);
  cairo_set_line_width(cr, kOutline * unit_);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  for (std::size_t b = 0; b < world.bodyCount(); ++b) {
    const Polygon& shape = *world.bodyDefinition(b).shape;
    const Transform& transform = world.body(b).transform;
    const auto starts = shape.ringStarts();
    for (std::size_t ring = 0; ring + 1 < starts.size(); ++ring) {
      for (std::uint32_t v = starts[ring]; v < starts[ring + 1]; ++v) {
        const Vec2 p = toPixel(transform.toWorld(shape.vertices()[v]));
        if (v == starts[ring])
          cairo_move_to(cr, p.x(), p.y());
        else
          cairo_line_to(cr, p.x(), p.y());
      }
      cairo_close_path(cr);
    }
    const Motion motion = world.bodyDefinition(b).motion;
    if (motion == Motion::Fixed)
      setGrey(cr, kBody);
    else
      setColor(cr, motion == Motion::Scripted ? kScripted : world.body(b).asleep ? kAsleep : kFree);
    cairo_fill_preserve(cr);  // holes run the other way round, so the winding rule leaves them out
    setGrey(cr, kDark);
    cairo_stroke(cr);
  }
  for (std::size_t b = 0; b < world.bodyCount(); ++b)
    if (world.bodyDefinition(b).motion == Motion::Free) drawMark(cr, world.bodyDefinition(b), world.body(b).transform);
  cairo_restore(cr);
}

/// What shows that a free body turns, and what holds it: a line, a ring about its hinge.
void PngPainter::drawMark(cairo_t* cr, const BodyDef& body, const Transform& transform) const {
  setGrey(cr, kDark);
  if (std::sqrt(body.shape->area() / kPi) * pixels_ >= kSmallestMarked * unit_) {
    const auto [from, to] = markOf(*body.shape);
    const Vec2 a = toPixel(transform.toWorld(from)), b = toPixel(transform.toWorld(to));
    cairo_move_to(cr, a.x(), a.y());
    cairo_line_to(cr, b.x(), b.y());
    cairo_stroke(cr);
  }
  if (!body.hinge) return;
  const Vec2 at = toPixel(body.hinge->at);
  cairo_new_sub_path(cr);
  cairo_arc(cr, at.x(), at.y(), kHinge * unit_, 0.0, 2.0 * kPi);
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_fill_preserve(cr);
  setGrey(cr, kDark);
  cairo_stroke(cr);
}

void PngPainter::drawSides(cairo_t* cr) const {
  const Box& box = domain_.box;
  const double half = 0.5 * kWall * unit_;
  for (int side = 0; side < 4; ++side) {
    const bool vertical = side < 2;
    const double at = vertical ? (side == 0 ? box.min.x() : box.max.x()) : (side == 2 ? box.min.y() : box.max.y());
    const int along = vertical ? 1 : 0, across = 1 - along;
    const double slack = 1e-6 * view_.size()[across];
    if (at < view_.min[across] - slack || at > view_.max[across] + slack) continue;
    const double from = std::max(box.min[along], view_.min[along]), to = std::min(box.max[along], view_.max[along]);
    if (!(from < to)) continue;
    const bool closed = domain_.closed[static_cast<std::size_t>(side)];
    const Vec2 outward = side == 0 ? Vec2(-1, 0) : side == 1 ? Vec2(1, 0) : side == 2 ? Vec2(0, 1) : Vec2(0, -1);
    Vec2 a, b;
    a[across] = b[across] = at;
    a[along] = from;
    b[along] = to;
    // A wall's inner face is where the water ends, so the line lies outside of it.
    const Vec2 shift = closed ? Vec2(half * outward) : Vec2(0, 0);
    a = toPixel(a) + shift;
    b = toPixel(b) + shift;
    setGrey(cr, closed ? kDark : kGrey);
    cairo_set_line_width(cr, closed ? 2.0 * half : kOutline * unit_);
    cairo_set_line_cap(cr, closed ? CAIRO_LINE_CAP_SQUARE : CAIRO_LINE_CAP_BUTT);
    const double dashes[] = {6.0 * unit_, 5.0 * unit_};
    cairo_set_dash(cr, dashes, closed ? 0 : 2, 0.0);
    cairo_move_to(cr, a.x(), a.y());
    cairo_line_to(cr, b.x(), b.y());
    cairo_stroke(cr);
  }
  cairo_set_dash(cr, nullptr, 0, 0.0);
}

void PngPainter::drawHeader(cairo_t* cr, double time) const {
  const double margin = kMargin * unit_, base = top_ - 20.0 * unit_;
  setFont(cr, 20.0 * unit_);
  setGrey(cr, kDark);
  const std::string clock = fmt::format("t = {:.{}f} s", time, timeDigits_);
  drawText(cr, clock, width_ - margin, base, 1.0);
  const double room = width_ - 3.0 * margin - textWidth(cr, clock);
  drawText(cr, shortened(cr, title_, room), margin, base, 0.0);
}

void PngPainter::drawScale(cairo_t* cr) const {
  setGrey(cr, kDark);
  const double metres = roundDown(0.18 * (right_ - left_) / pixels_);
  drawScaleBar(cr, {metres, std::max(left_, kMargin * unit_), bottom_ + 34.0 * unit_, pixels_, unit_});
}

namespace {

/// Where a colour bar stands.
struct Bar {
  double x, y, length, tall, unit;  // its left upper corner and size; pixels per unit of the layout
};

/// Returns how far its label reaches to the left.
double drawColorBar(cairo_t* cr, const ColorScale& scale, Color (*color)(double), const Bar& bar) {
  const auto [x, y, length, tall, unit] = bar;
  const double end = x + length;
  cairo_pattern_t* gradient = cairo_pattern_create_linear(x, 0, end, 0);
  for (int k = 0; k <= 20; ++k) {
    const Color c = color(k / 20.0);
    cairo_pattern_add_color_stop_rgb(gradient, k / 20.0, c.r / 255.0, c.g / 255.0, c.b / 255.0);
  }
  cairo_rectangle(cr, x, y, length, tall);
  cairo_set_source(cr, gradient);
  cairo_fill_preserve(cr);
  cairo_pattern_destroy(gradient);
  setGrey(cr, kDark);
  cairo_set_line_width(cr, 1.0 * unit);
  cairo_stroke(cr);
  cairo_set_font_size(cr, 16.0 * unit);
  drawText(cr, scale.label, x - 16.0 * unit, y + tall, 1.0);
  for (const double tick : niceTicks(scale.low * scale.factor, scale.high * scale.factor, 5)) {
    const double at = x + length * scale.position(tick / scale.factor);
    cairo_move_to(cr, at, y + tall);
    cairo_line_to(cr, at, y + tall + 5.0 * unit);
    cairo_stroke(cr);
    drawText(cr, fmt::format("{:g}", std::abs(tick) < 1e-12 ? 0.0 : tick), at, y + tall + 23.0 * unit, 0.5);
  }
  return x - 16.0 * unit - textWidth(cr, scale.label);
}

}  // namespace

/// Particles on the right; soft bodies left of it, or there where there are no particles.
void PngPainter::drawColorBars(cairo_t* cr) const {
  const bool both = particles_ && soft_;
  const double length = std::min((both ? kShortBar : kBar) * unit_, 0.4 * width_);
  const double end = width_ - kMargin * unit_ - 8.0 * unit_;
  Bar bar{end - length, bottom_ + 26.0 * unit_, length, 14.0 * unit_, unit_};
  if (particles_) bar.x = drawColorBar(cr, scale_, viridis, bar) - 24.0 * unit_ - length;
  if (soft_) drawColorBar(cr, strainScale_, strainColor, bar);
}

void drawPng(const std::string& file, const World& world, const scene::Scene& scene) {
  PngPainter(scene).draw(file, world);
}

}  // namespace froude::exporting
