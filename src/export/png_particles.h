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

/// Apart: one by one in their order, with a darker rim where there is room for one. Together: each pixel takes the mean
/// value of the discs in it, by the area that each covers, and the discs are half as wide again, so that a dense fluid
/// is a smooth surface whatever the ratio of its spacing to the pixels.
enum class Look { Apart, Together };

/// Paints discs of one radius [pixels].
void paintDiscs(const Canvas& canvas, const std::vector<Disc>& discs, double radius, Look look);

}  // namespace froude::exporting
