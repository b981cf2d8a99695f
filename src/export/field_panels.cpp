#include "export/field_panels.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "export/field_contours.h"
#include "export/sketch.h"

namespace froude::exporting {
namespace {

constexpr double kDark = 0.16;
constexpr double kLetters = 13.0, kLine = 20.0, kSwatch = 14.0;  // of legends, in units of the layout
constexpr int kShades = 64;        // of the distance: more are not told apart, and pictures get larger
constexpr int kMostLevels = 12;    // contours
constexpr double kArrows = 320.0;  // wanted
constexpr double kClosestArrows = 9.0, kWidestArrows = 44.0;  // between them, in units of the layout
constexpr double kSmallestArrow = 3.0;                        // in units of the layout
constexpr Color kOffset{176, 0, 120}, kContour{70, 70, 70};

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

/// The panel's pixels, each coloured by `color(k)` with k counting rows from the top.
void drawPixels(const FieldPanel& panel, FunctionRef<Color(std::size_t)> color) {
  const int width = panel.raster->width, height = panel.raster->height;
  const Surface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy);
  unsigned char* data = cairo_image_surface_get_data(image.get());
  if (data == nullptr) return;  // Cairo keeps the reason, and whoever writes the picture tells it
  const int stride = cairo_image_surface_get_stride(image.get());
  for (int j = 0; j < height; ++j) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(j) * stride);
    for (int i = 0; i < width; ++i) {
      const Color c =
          color(static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i));
      row[i] = static_cast<std::uint32_t>(c.r) << 16 | static_cast<std::uint32_t>(c.g) << 8 | c.b;
    }
  }
  cairo_surface_mark_dirty(image.get());
  cairo_set_source_surface(panel.cr, image.get(), panel.left, panel.top);
  cairo_rectangle(panel.cr, panel.left, panel.top, width, height);
  cairo_fill(panel.cr);
}

void clipToMap(const FieldPanel& panel) {
  cairo_save(panel.cr);
  cairo_rectangle(panel.cr, panel.left, panel.top, panel.raster->width, panel.raster->height);
  cairo_clip(panel.cr);
  cairo_set_line_join(panel.cr, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(panel.cr, CAIRO_LINE_CAP_ROUND);
}

/// The polygon's outline, then the frame of the map; ends what `clipToMap` began.
void finishMap(const FieldPanel& panel, double lineWidth) {
  cairo_t* cr = panel.cr;
  const Polygon& polygon = panel.field->polygon();
  const auto starts = polygon.ringStarts();
  for (std::size_t ring = 0; ring + 1 < starts.size(); ++ring) {
    for (std::uint32_t v = starts[ring]; v < starts[ring + 1]; ++v) {
      const Vec2 p = panel.toPixel(polygon.vertices()[v]);
      (v == starts[ring] ? cairo_move_to : cairo_line_to)(cr, p.x(), p.y());
    }
    cairo_close_path(cr);
  }
  setGrey(cr, 0.0);
  cairo_set_line_width(cr, lineWidth * panel.unit);
  cairo_stroke(cr);
  cairo_restore(cr);
  setGrey(cr, 0.6);
  cairo_set_line_width(cr, panel.unit);
  cairo_rectangle(cr, panel.left, panel.top, panel.raster->width, panel.raster->height);
  cairo_stroke(cr);
}

/// Swatches with words behind them, in lines.
class Legend {
 public:
  explicit Legend(const FieldPanel& panel) : panel_(panel), x_(panel.legendLeft), y_(panel.legendTop) {
    setFont(panel.cr, kLetters * panel.unit);
  }
  void swatch(Color color, const std::string& text) {
    const double size = kSwatch * panel_.unit;
    makeRoom(size + 5.0 * panel_.unit + textWidth(panel_.cr, text));
    setColor(panel_.cr, color);
    cairo_rectangle(panel_.cr, x_, y_ + 2.0 * panel_.unit, size, size);
    cairo_fill_preserve(panel_.cr);
    setGrey(panel_.cr, 0.5);
    cairo_set_line_width(panel_.cr, 0.7 * panel_.unit);
    cairo_stroke(panel_.cr);
    x_ += size + 5.0 * panel_.unit;
    words(text);
  }
  void line(Color color, double lineWidth, const std::string& text) {
    const double size = 1.6 * kSwatch * panel_.unit, y = y_ + 9.0 * panel_.unit;
    makeRoom(size + 5.0 * panel_.unit + textWidth(panel_.cr, text));
    setColor(panel_.cr, color);
    cairo_set_line_width(panel_.cr, lineWidth * panel_.unit);
    cairo_move_to(panel_.cr, x_, y);
    cairo_line_to(panel_.cr, x_ + size, y);
    cairo_stroke(panel_.cr);
    x_ += size + 5.0 * panel_.unit;
    words(text);
  }
  void text(const std::string& text) {
    makeRoom(textWidth(panel_.cr, text));
    words(text);
  }
  void nextLine() {
    if (x_ == panel_.legendLeft) return;
    x_ = panel_.legendLeft;
    y_ += kLine * panel_.unit;
  }

 private:
  void makeRoom(double wide) {
    if (x_ + wide > panel_.legendLeft + panel_.legendWidth) nextLine();
  }
  void words(const std::string& text) {
    setGrey(panel_.cr, kDark);
    const std::string shown = shortened(panel_.cr, text, panel_.legendLeft + panel_.legendWidth - x_);
    drawText(panel_.cr, shown, x_, y_ + 14.0 * panel_.unit, 0.0);
    x_ += textWidth(panel_.cr, shown) + (text.empty() ? 0.0 : 16.0) * panel_.unit;
  }

  const FieldPanel& panel_;
  double x_, y_;
};

double shade(double distance, double largest) {
  const double place = distance / largest;
  const double step = 2.0 / kShades;
  return (std::floor(place / step) + 0.5) * step;
}

void drawDistanceBar(const FieldPanel& panel, double largest, const LengthUnit& unit) {
  cairo_t* cr = panel.cr;
  const double u = panel.unit, low = panel.raster->low, high = panel.raster->high;
  setFont(cr, kLetters * u);
  const std::string label = "distance (" + unit.name + ")";
  const double x = panel.legendLeft + textWidth(cr, label) + 22.0 * u, tall = 13.0 * u;
  const double length = panel.legendLeft + panel.legendWidth - 14.0 * u - x, y = panel.legendTop + 2.0 * u;
  setGrey(cr, kDark);
  drawText(cr, label, panel.legendLeft, y + 12.0 * u, 0.0);
  const auto place = [&](double d) { return x + length * (d - low) / (high - low); };
  const int steps = std::max(1, static_cast<int>(length));
  for (int k = 0; k < steps; ++k) {
    setColor(cr, diverging(shade(low + (high - low) * (k + 0.5) / steps, largest)));
    cairo_rectangle(cr, x + length * k / steps, y, length / steps + 0.5, tall);
    cairo_fill(cr);
  }
  setGrey(cr, kDark);
  cairo_set_line_width(cr, u);
  cairo_rectangle(cr, x, y, length, tall);
  cairo_stroke(cr);
  double free = -kInfinity;
  const int wanted = std::clamp(static_cast<int>(length / (55.0 * u)), 4, 8);
  for (const double tick : niceTicks(low / unit.metres, high / unit.metres, wanted)) {
    const double at = place(tick * unit.metres);
    const std::string text = unit.label(std::abs(tick) < 1e-9 * (high - low) / unit.metres ? 0.0 : tick * unit.metres);
    const double half = 0.5 * textWidth(cr, text);
    if (at - half < free) continue;
    cairo_move_to(cr, at, y + tall);
    cairo_line_to(cr, at, y + tall + 4.0 * u);
    cairo_stroke(cr);
    drawText(cr, text, at, y + tall + 17.0 * u, 0.5);
    free = at + half + 4.0 * u;
  }
}

constexpr std::size_t kCellKinds = 7;  // outside the grid, outside, inside, 1, 2, 3, 4 or more edges

std::size_t kindOf(const FieldCell& cell) {
  if (cell.kind == FieldCell::Kind::Outside) return 1;
  if (cell.kind == FieldCell::Kind::Inside) return 2;
  return 2 + std::min<std::size_t>(cell.edges, 4);
}

void drawGridLines(const FieldPanel& panel) {
  const DistanceField& field = *panel.field;
  const double cell = field.cellSize();
  const Vec2 end = field.gridOrigin() + cell * Vec2(field.nx(), field.ny());
  const Vec2 low = panel.toPixel(field.gridOrigin()), high = panel.toPixel(end);
  for (int i = 0; i <= field.nx(); ++i) {
    const double x = low.x() + i * cell * panel.pixels;
    cairo_move_to(panel.cr, x, low.y());
    cairo_line_to(panel.cr, x, high.y());
  }
  for (int j = 0; j <= field.ny(); ++j) {
    const double y = low.y() - j * cell * panel.pixels;
    cairo_move_to(panel.cr, low.x(), y);
    cairo_line_to(panel.cr, high.x(), y);
  }
  cairo_set_source_rgba(panel.cr, 0, 0, 0, 0.28);
  cairo_set_line_width(panel.cr, 0.5 * panel.unit);
  cairo_stroke(panel.cr);
}

void drawArrow(const FieldPanel& panel, const Vec2& from, const Vec2& to) {
  cairo_t* cr = panel.cr;
  const Vec2 along = to - from;
  const double length = along.norm(), head = std::min(6.0 * panel.unit, 0.45 * length);
  const Vec2 back = along * (head / length), side = 0.4 * leftNormal(back);
  const Vec2 neck = to - back;
  cairo_move_to(cr, from.x(), from.y());
  cairo_line_to(cr, neck.x(), neck.y());
  cairo_set_line_width(cr, 1.1 * panel.unit);
  cairo_stroke(cr);
  cairo_move_to(cr, to.x(), to.y());
  cairo_line_to(cr, neck.x() + side.x(), neck.y() + side.y());
  cairo_line_to(cr, neck.x() - side.x(), neck.y() - side.y());
  cairo_close_path(cr);
  cairo_fill(cr);
}

/// Light colours whose neighbours in number are far apart in hue.
Color edgeColor(std::int32_t edge) {
  const double turn = 6.0 * std::fmod(0.61803398875 * edge + 0.55, 1.0);
  const auto channel = [&](double shift) {
    const double k = std::fmod(turn + shift, 6.0);
    return 0.93 * (1.0 - 0.42 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  };
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(255.0 * v)); };
  return {byte(channel(5.0)), byte(channel(3.0)), byte(channel(1.0))};
}

Color vertexColor(std::int32_t vertex) {
  const double place = std::fmod(0.61803398875 * vertex, 1.0);
  const auto level = static_cast<std::uint8_t>(112.0 + 66.0 * place);
  return {level, level, level};
}

}  // namespace

FieldRaster sampleField(const DistanceField& field, const Box& view, int width, int height) {
  FieldRaster raster;
  raster.width = width;
  raster.height = height;
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  raster.distance.resize(count);
  raster.edge.resize(count);
  raster.vertex.resize(count);
  const Vec2 step(view.size().x() / width, view.size().y() / height);
  parallelFor(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<double>(k % static_cast<std::size_t>(width));
      const auto j = static_cast<double>(k / static_cast<std::size_t>(width));
      const FieldSample s =
          field.sampleExact({view.min.x() + (i + 0.5) * step.x(), view.max.y() - (j + 0.5) * step.y()});
      raster.distance[k] = s.distance;
      raster.edge[k] = s.edge;
      raster.vertex[k] = s.feature == FeatureKind::StartVertex ? 1 : 0;
    }
  });
  raster.low = std::min(0.0, *std::min_element(raster.distance.begin(), raster.distance.end()));
  raster.high = std::max(0.0, *std::max_element(raster.distance.begin(), raster.distance.end()));
  return raster;
}

void drawDistancePanel(const FieldPanel& panel, const std::vector<double>& offsets) {
  const FieldRaster& raster = *panel.raster;
  const double largest = std::max(-raster.low, raster.high);
  const LengthUnit unit = lengthUnitFor(largest);
  drawPixels(panel, [&](std::size_t k) { return diverging(shade(raster.distance[k], largest)); });
  clipToMap(panel);
  ContourPainter contours(panel, unit);
  for (const double offset : offsets)
    if (contours.drawCurve(offset, kOffset, 2.4)) contours.labelCurve(offset, kOffset);
  const std::vector<double> levels = niceTicks(raster.low, raster.high, kMostLevels);
  for (const double level : levels) {
    const auto isLevel = [&](double d) { return std::abs(level - d) < 1e-9 * largest; };
    if (isLevel(0.0) || std::any_of(offsets.begin(), offsets.end(), isLevel)) continue;
    if (contours.drawCurve(level, kContour, 0.8)) contours.labelCurve(level, {20, 20, 20});
  }
  finishMap(panel, 2.0);
  drawDistanceBar(panel, largest, unit);
  FieldPanel below = panel;
  below.legendTop += 40.0 * panel.unit;
  Legend legend(below);
  if (levels.size() > 1)
    legend.line(kContour, 0.8, fmt::format("contours every {} {}", unit.label(levels[1] - levels[0]), unit.name));
  if (!offsets.empty()) legend.line(kOffset, 2.4, "offset curves");
}

void drawCellsPanel(const FieldPanel& panel) {
  const DistanceField& field = *panel.field;
  const FieldRaster& raster = *panel.raster;
  static const std::array<std::string, kCellKinds> kNames{"",        "outside", "inside",         "1 edge",
                                                          "2 edges", "3 edges", "4 or more edges"};
  const std::array<Color, kCellKinds> colors{Color{255, 255, 255}, Color{236, 236, 236}, Color{176, 176, 176},
                                             viridis(0.98),        viridis(0.72),        viridis(0.42),
                                             viridis(0.08)};
  std::array<std::size_t, kCellKinds> counts{};
  std::vector<std::uint8_t> kinds;
  kinds.reserve(static_cast<std::size_t>(field.nx()) * static_cast<std::size_t>(field.ny()));
  for (int j = 0; j < field.ny(); ++j)
    for (int i = 0; i < field.nx(); ++i) {
      kinds.push_back(static_cast<std::uint8_t>(kindOf(field.cell(i, j))));
      ++counts[kinds.back()];
    }
  drawPixels(panel, [&](std::size_t k) {
    const auto column = static_cast<double>(k % static_cast<std::size_t>(raster.width));
    const auto row = static_cast<double>(k / static_cast<std::size_t>(raster.width));
    const Vec2 p(panel.view.min.x() + (column + 0.5) / panel.pixels, panel.view.max.y() - (row + 0.5) / panel.pixels);
    const Vec2 at = (p - field.gridOrigin()) / field.cellSize();
    if (at.x() < 0.0 || at.y() < 0.0 || at.x() >= field.nx() || at.y() >= field.ny()) return colors[0];
    const auto cell =
        static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(field.nx()) + static_cast<std::size_t>(at.x());
    return colors[kinds[cell]];
  });
  clipToMap(panel);
  if (field.cellSize() * panel.pixels >= 4.0 * panel.unit) drawGridLines(panel);
  finishMap(panel, 2.0);
  Legend legend(panel);
  for (std::size_t kind = 1; kind < kCellKinds; ++kind)
    if (counts[kind] > 0)
      legend.swatch(colors[kind],
                    fmt::format("{} {:.3g} %", kNames[kind],
                                100.0 * static_cast<double>(counts[kind]) / static_cast<double>(kinds.size())));
}

void drawVectorsPanel(const FieldPanel& panel) {
  const FieldRaster& raster = *panel.raster;
  const double u = panel.unit;
  const Color inside = diverging(-0.01), outside{255, 255, 255}, arrow{20, 62, 112};
  drawPixels(panel, [&](std::size_t k) { return raster.distance[k] < 0.0 ? inside : outside; });
  clipToMap(panel);
  const double area = panel.field->polygon().area() * panel.pixels * panel.pixels;
  const double step = std::clamp(std::sqrt(area / kArrows), kClosestArrows * u, kWidestArrows * u) / panel.pixels;
  const Box& bounds = panel.field->polygon().bounds();
  const int nx = static_cast<int>(bounds.size().x() / step) + 1, ny = static_cast<int>(bounds.size().y() / step) + 1;
  const Vec2 first = bounds.center() - 0.5 * step * Vec2(nx - 1, ny - 1);
  setColor(panel.cr, arrow);
  std::size_t arrows = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 p = first + step * Vec2(i, j);
      const FieldSample s = panel.field->sampleExact(p);
      if (!(s.distance < 0.0) || -s.distance * panel.pixels < kSmallestArrow * u) continue;
      drawArrow(panel, panel.toPixel(p), panel.toPixel(p - s.distance * s.normal));
      ++arrows;
    }
  finishMap(panel, 1.4);
  Legend legend(panel);
  if (arrows > 0) {
    legend.line(arrow, 1.4, "the shortest way out");
  } else {
    legend.text("too thin for arrows at this scale; a larger --width shows them");
  }
}

void drawFeaturesPanel(const FieldPanel& panel) {
  const FieldRaster& raster = *panel.raster;
  drawPixels(panel, [&](std::size_t k) {
    return raster.vertex[k] != 0 ? vertexColor(raster.edge[k]) : edgeColor(raster.edge[k]);
  });
  clipToMap(panel);
  finishMap(panel, 2.0);
  Legend legend(panel);
  for (std::int32_t e = 0; e < 4; ++e)
    legend.swatch(edgeColor(e), e == 3 ? "a colour for each edge that is closest" : "");
  legend.nextLine();
  legend.swatch(vertexColor(0), "");
  legend.swatch(vertexColor(1), "grey: a vertex is closest");
}

}  // namespace froude::exporting
