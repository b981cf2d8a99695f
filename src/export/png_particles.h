// Discs straight into the pixels of an image: fast enough for a million particles, smooth edges.
#pragma once

#include <cstdint>
#include <vector>

#include "export/color_scale.h"

namespace froude::exporting {

/// One particle as it appears; `place` on the colour bar [0 … 1], NaN for the neutral colour.
struct Disc {
  float x, y;  // centre [pixels]
  float place;
};

/// Part of an image of 32-bit pixels (0x00RRGGBB) that may be painted on.
struct Canvas {
  std::uint8_t* data;
  int stride;                    // bytes a row
  int left, top, right, bottom;  // painted pixels: left ≤ x < right, top ≤ y < bottom
};

/// Paints discs of one radius [pixels] in their order. Small ones (under 3.5 pixels) are not seen one by one: there
/// each pixel takes the mean value of the discs in it, by the area that each covers, so that a dense fluid is a smooth
/// surface whatever the ratio of its spacing to the pixels. Larger ones are painted one over the other, with a darker
/// rim.
void paintDiscs(const Canvas& canvas, const std::vector<Disc>& discs, double radius);

}  // namespace froude::exporting
