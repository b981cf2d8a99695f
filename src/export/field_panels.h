// The four panels of a picture of a distance field: distance, cells, translation vectors, closest features.
#pragma once

#include <string>
#include <vector>

#include <froude/fields/distance_field.h>

struct _cairo;

namespace froude::exporting {

/// The exact field at the pixels of a panel, row by row from the top.
struct FieldRaster {
  int width = 0, height = 0;
  std::vector<double> distance;      // [m]
  std::vector<std::int32_t> edge;    // number of the closest edge or vertex
  std::vector<std::uint8_t> vertex;  // 1: a vertex is closest
  double low = 0.0, high = 0.0;      // of the distances [m]
};

/// Where a panel stands, and what it shows.
struct FieldPanel {
  _cairo* cr = nullptr;
  const DistanceField* field = nullptr;
  const FieldRaster* raster = nullptr;
  Box view;                                                     // [m]
  double left = 0.0, top = 0.0;                                 // of the map [pixels]
  double pixels = 1.0;                                          // per metre
  double unit = 1.0;                                            // pixels per unit of the layout
  double legendLeft = 0.0, legendTop = 0.0, legendWidth = 0.0;  // room below the map [pixels]

  Vec2 toPixel(const Vec2& p) const {
    return {left + (p.x() - view.min.x()) * pixels, top + (view.max.y() - p.y()) * pixels};
  }
};

/// The field at the middle of each pixel. Cost: an exact query for each, in parallel.
FieldRaster sampleField(const DistanceField& field, const Box& view, int width, int height);

// Each draws its map, the outline over it, and its legend.
/// Colours, contours at round distances, and the curves at `offsets` [m], all exact.
void drawDistancePanel(const FieldPanel& panel, const std::vector<double>& offsets);
void drawCellsPanel(const FieldPanel& panel);
void drawVectorsPanel(const FieldPanel& panel);
void drawFeaturesPanel(const FieldPanel& panel);

}  // namespace froude::exporting
