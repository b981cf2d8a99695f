#include "export/field_painter.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <froude/fields/offset_curve.h>

#include "export/field_contours.h"
#include "export/field_page.h"
#include "export/field_panels.h"
#include "export/frames.h"
#include "export/sketch.h"
#include "run/atomic_file.h"

namespace froude::exporting {
namespace {

// The layout, in units of 1/1280 of the width.
constexpr double kMargin = 28.0, kHeader = 84.0, kGap = 28.0, kPanelTitle = 28.0, kLegend = 74.0;
constexpr double kTallest = 1.15;      // picture, against its width
constexpr double kSmallestUnit = 0.6;  // letters stay legible in small pictures
constexpr double kShare = 0.15;        // band against the shape's size
constexpr int kSmallestMap = 8;        // [pixels]
constexpr double kDark = 0.16;

bool endsWith(const std::string& file, std::string_view ending) {
  return file.size() > ending.size() && std::string_view(file).ends_with(ending);
}

const char* titleOf(FieldLayer layer) {
  switch (layer) {
    case FieldLayer::Distance:
      return "Signed distance";
    case FieldLayer::Cells:
      return "Cells, by the edges they keep";
    case FieldLayer::Vectors:
      return "Minimum translation vectors";
    case FieldLayer::Features:
      break;
  }
  return "Closest edge or vertex";
}

/// How many panels stand beside each other, and how large they are: the arrangement with the largest scale.
struct Layout {
  int columns = 1, rows = 1;
  double unit = 1.0, pixels = 0.0;  // per unit of the layout; per metre
  int mapWidth = 0, mapHeight = 0;  // [pixels]
  double columnWidth = 0.0, rowHeight = 0.0;
  int height = 0;  // of the picture [pixels]
};

Layout arrange(int width, std::size_t panels, const Vec2& size) {
  Layout best;
  const double unit = std::max(width / 1280.0, kSmallestUnit);
  for (const int columns : {1, 2, 4}) {
    if (columns > static_cast<int>(panels)) break;
    Layout layout;
    layout.unit = unit;
    layout.columns = columns;
    layout.rows = (static_cast<int>(panels) + columns - 1) / columns;
    layout.columnWidth = (width - 2.0 * kMargin * unit - (columns - 1) * kGap * unit) / columns;
    const double words = (kPanelTitle + kLegend) * unit;
    const double room = (kTallest * width - kHeader * unit) / layout.rows - words;
    layout.pixels = std::min(layout.columnWidth / size.x(), std::max(room, kSmallestMap * unit) / size.y());
    if (layout.pixels <= best.pixels) continue;
    layout.mapWidth = std::max(kSmallestMap, static_cast<int>(std::floor(layout.pixels * size.x())));
    layout.mapHeight = std::max(kSmallestMap, static_cast<int>(std::floor(layout.pixels * size.y())));
    layout.rowHeight = layout.mapHeight + words;
    layout.height = static_cast<int>(std::ceil(kHeader * unit + layout.rows * layout.rowHeight));
    best = layout;
  }
  return best;
}

class Painter {
 public:
  /// `quick` answers for the pixels: the same polygon's field, in cells that suit it.
  Painter(const DistanceField& field, const DistanceField& quick, std::string title, const FieldPicture& picture)
      : field_(field), title_(std::move(title)), picture_(picture) {
    double margin = detail::kBandMargin * field.band();
    for (const double offset : picture.offsets) margin = std::max(margin, 1.15 * offset);
    view_ = field.polygon().bounds().grown(margin);
    if (picture_.layers.empty())
      picture_.layers = {FieldLayer::Distance, FieldLayer::Cells, FieldLayer::Vectors, FieldLayer::Features};
    layout_ = arrange(picture.width, picture_.layers.size(), view_.size());
    raster_ = sampleField(quick, view_, layout_.mapWidth, layout_.mapHeight);
  }

  int width() const { return picture_.width; }
  int height() const { return layout_.height; }

  void paint(cairo_t* cr) const {
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_paint(cr);
    drawHeader(cr);
    for (std::size_t k = 0; k < picture_.layers.size(); ++k) drawPanel(cr, static_cast<int>(k));
  }

  std::string description() const {
    const Polygon& polygon = field_.polygon();
    const std::size_t holes = polygon.ringStarts().size() - 2;
    return fmt::format("{} edges{} · area {:.4g} m² · band {} · {} × {} cells of {} · {:.3g} kB", polygon.edgeCount(),
                       holes == 0 ? "" : fmt::format(", {} hole{}", holes, holes == 1 ? "" : "s"), polygon.area(),
                       lengthLabel(rounded(field_.band())), field_.nx(), field_.ny(),
                       lengthLabel(rounded(field_.cellSize())), static_cast<double>(field_.memoryBytes()) / 1000.0);
  }

 private:
  static double rounded(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
    return std::round(value / unit) * unit;
  }

  void drawHeader(cairo_t* cr) const {
    const double u = layout_.unit, margin = kMargin * u;
    const double metres = roundDown(std::min(0.16 * picture_.width, 0.8 * layout_.mapWidth) / layout_.pixels);
    const double barLeft = picture_.width - margin - metres * layout_.pixels;
    setFont(cr, 20.0 * u);
    setGrey(cr, kDark);
    drawScaleBar(cr, {metres, barLeft, 26.0 * u, layout_.pixels, u});
    const double room = barLeft - 2.0 * margin;
    setFont(cr, 20.0 * u);
    drawText(cr, shortened(cr, title_, room), margin, 36.0 * u, 0.0);
    setFont(cr, 13.0 * u);
    setGrey(cr, 0.35);
    drawText(cr, shortened(cr, description(), room), margin, 60.0 * u, 0.0);
  }

  void drawPanel(cairo_t* cr, int index) const {
    const double u = layout_.unit;
    const int column = index % layout_.columns, row = index / layout_.columns;
    FieldPanel panel;
    panel.cr = cr;
    panel.field = &field_;
    panel.raster = &raster_;
    panel.view = view_;
    panel.unit = u;
    panel.pixels = layout_.pixels;
    panel.legendWidth = layout_.columnWidth;
    panel.legendLeft = kMargin * u + column * (layout_.columnWidth + kGap * u);
    panel.left = std::round(panel.legendLeft + 0.5 * (layout_.columnWidth - layout_.mapWidth));
    panel.top = std::round(kHeader * u + row * layout_.rowHeight + kPanelTitle * u);
    panel.legendTop = panel.top + layout_.mapHeight + 8.0 * u;
    setFont(cr, 15.0 * u);
    setGrey(cr, kDark);
    const FieldLayer layer = picture_.layers[static_cast<std::size_t>(index)];
    drawText(cr, shortened(cr, titleOf(layer), layout_.columnWidth), panel.legendLeft, panel.top - 9.0 * u, 0.0);
    if (layer == FieldLayer::Distance) drawDistancePanel(panel, picture_.offsets);
    if (layer == FieldLayer::Cells) drawCellsPanel(panel);
    if (layer == FieldLayer::Vectors) drawVectorsPanel(panel);
    if (layer == FieldLayer::Features) drawFeaturesPanel(panel);
  }

  const DistanceField& field_;
  std::string title_;
  FieldPicture picture_;
  Box view_;
  Layout layout_;
  FieldRaster raster_;
};

}  // namespace

bool isPicture(const std::string& file) {
  return endsWith(file, ".png") || endsWith(file, ".svg") || endsWith(file, ".html");
}

std::vector<std::string> drawField(const std::string& file, const Polygon& polygon, const std::string& title,
                                   const FieldPicture& picture) {
  const double usual = kShare * polygon.bounds().size().maxCoeff();
  const DistanceField field(polygon, picture.band > 0.0 ? picture.band : usual, picture.cell);
  if (endsWith(file, ".html")) {
    writeFieldPage(file, field, title);
    return {};
  }
  // Cells as they were asked for are shown. Millions of pixels are not answered by them: far too many or too large
  // ones would take hours, and the answers are exact whatever the cells.
  std::optional<DistanceField> suited;
  if (picture.band > 0.0 || picture.cell > 0.0) suited.emplace(polygon, usual);
  const Painter painter(field, suited ? *suited : field, title, picture);
  const Sheet sheet{painter.width(), painter.height(), title, painter.description()};
  run::writeWholeFile(file, drawSheet(file, sheet, [&](cairo_t* cr) { painter.paint(cr); }));
  std::vector<std::string> remarks;
  if (picture.cell > 0.0 && field.cellSize() > 1.001 * picture.cell)
    remarks.push_back(fmt::format("cells of {:g} m would be too many and are {:.3g} m wide; right is that or more",
                                  picture.cell, field.cellSize()));
  for (const double offset : picture.offsets)
    if (offsetCurve(polygon, offset).empty())
      remarks.push_back(
          fmt::format("no point of the shape is {} deep, so there is no curve at {:g}", lengthLabel(-offset), offset));
  return remarks;
}

}  // namespace froude::exporting
