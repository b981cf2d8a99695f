// Points typed or measured by people: a CSV file with x,y in each row.
#pragma once

#include <string>
#include <vector>

#include <froude/base/types.h>

namespace froude::scene {

/// The points of a CSV file, in order; "-" is standard input. A first row `x,y` is a header; blank rows and rows that
/// begin with # are skipped. Coordinates are finite and at most `largest` in size. Throws SceneError with line and
/// column.
std::vector<Vec2> readPoints(const std::string& file, double largest);

}  // namespace froude::scene
