// The values of SVG attributes: path data, points, transforms, lengths, style. No library shows through.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <froude/base/types.h>

namespace froude::scene {

/// One command of path data, with absolute coordinates and shorthands written out [user units].
struct PathSegment {
  enum class Kind { Move, Line, Quadratic, Cubic, Arc, Close };
  Kind kind = Kind::Move;
  Vec2 a{0, 0}, b{0, 0};  // control points
  Vec2 to{0, 0};          // where it ends; of Close: where its subpath began
  // Of an arc: center + half-axes turned by `turn` [rad], from the angle `from` to the angle `until` on the circle that
  // it is an image of. Radii that are too small are enlarged (SVG 1.1, F.6.6).
  Vec2 center{0, 0};
  double rx = 0.0, ry = 0.0, turn = 0.0, from = 0.0, until = 0.0;
};

/// Appends segments up to the end or to where the text stops being path data; true in the first case.
bool parsePathData(const std::string& text, std::vector<PathSegment>* segments);
/// Appends points likewise.
bool parsePoints(const std::string& text, std::vector<Vec2>* points);
/// a, b, c, d, e, f of x' = a x + c y + e, y' = b x + d y + f for a list of transforms.
std::optional<std::array<double, 6>> parseTransform(const std::string& text);
/// A length in user units: 96 px an inch. Empty for em, ex and per cent, which have no meaning without a page.
std::optional<double> parseLength(const std::string& text);
/// The properties of an attribute `style`, in order.
std::vector<std::pair<std::string, std::string>> parseStyle(const std::string& text);

}  // namespace froude::scene
