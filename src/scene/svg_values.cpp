#include "scene/svg_values.h"

// SVG++ wants libxml2's types before its own headers. The only file that includes SVG++: it compiles slowly.
#include <libxml/tree.h>

#include <svgpp/parser/css_style_iterator.hpp>
#include <svgpp/parser/value_parser.hpp>
#include <svgpp/utility/arc_endpoint_to_center.hpp>

namespace froude::scene {

namespace {

using Absolute = svgpp::tag::coordinate::absolute;
using Kind = PathSegment::Kind;
const auto kAttribute = svgpp::tag::source::attribute();

// What SVG++ calls with the values that it parses.

struct PathEvents {
  std::vector<PathSegment>* segments;
  Vec2 start{0, 0}, last{0, 0};

  void add(PathSegment segment) {
    last = segment.to;
    segments->push_back(segment);
  }
  void path_move_to(double x, double y, Absolute) {
    start = {x, y};
    add({.kind = Kind::Move, .to = start});
  }
  void path_line_to(double x, double y, Absolute) { add({.kind = Kind::Line, .to = {x, y}}); }
  void path_quadratic_bezier_to(double x1, double y1, double x, double y, Absolute) {
    add({.kind = Kind::Quadratic, .a = {x1, y1}, .to = {x, y}});
  }
  void path_cubic_bezier_to(double x1, double y1, double x2, double y2, double x, double y, Absolute) {
    add({.kind = Kind::Cubic, .a = {x1, y1}, .b = {x2, y2}, .to = {x, y}});
  }
  void path_elliptical_arc_to(double rx, double ry, double degrees, bool large, bool sweep, double x, double y,
                              Absolute) {
    if (last == Vec2(x, y)) return;
    if (rx == 0.0 || ry == 0.0) return path_line_to(x, y, Absolute());
    PathSegment arc{.kind = Kind::Arc, .to = {x, y}, .rx = rx, .ry = ry, .turn = degrees * (kPi / 180.0)};
    svgpp::arc_endpoint_to_center(last.x(), last.y(), x, y, arc.rx, arc.ry, arc.turn, large, sweep, arc.center.x(),
                                  arc.center.y(), arc.from, arc.until);
    if (sweep && arc.until < arc.from) arc.until += 2.0 * kPi;
    if (!sweep && arc.until > arc.from) arc.until -= 2.0 * kPi;
    add(arc);
  }
  void path_close_subpath() { add({.kind = Kind::Close, .to = start}); }
  void path_exit() {}
};

struct TransformEvents {
  std::array<double, 6> matrix{1, 0, 0, 1, 0, 0};
  void transform_matrix(const boost::array<double, 6>& m) { std::copy(m.begin(), m.end(), matrix.begin()); }
};

struct LengthEvents {
  double value = 0.0;
  template <typename Tag>
  void set(Tag, double v) {
    value = v;
  }
};

struct PointEvents {
  std::vector<Vec2>* points;
  template <typename Range>
  void set(svgpp::tag::attribute::points, const Range& range) {
    for (auto it = boost::begin(range); it != boost::end(range); ++it) points->emplace_back(it->first, it->second);
  }
};

/// SVG++ reports a text that it cannot parse by an exception.
template <typename Type, typename Attribute, typename Events>
bool parses(Attribute attribute, Events& events, const std::string& text) {
  try {
    return svgpp::value_parser<Type>::parse(attribute, events, text, kAttribute);
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

bool parsePathData(const std::string& text, std::vector<PathSegment>* segments) {
  PathEvents events{segments};
  return parses<svgpp::tag::type::path_data>(svgpp::tag::attribute::d(), events, text);
}

bool parsePoints(const std::string& text, std::vector<Vec2>* points) {
  PointEvents events{points};
  return parses<svgpp::tag::attribute::points>(svgpp::tag::attribute::points(), events, text);
}

std::optional<std::array<double, 6>> parseTransform(const std::string& text) {
  TransformEvents events;
  if (!parses<svgpp::tag::type::transform_list>(svgpp::tag::attribute::transform(), events, text)) return std::nullopt;
  return events.matrix;
}

std::optional<double> parseLength(const std::string& text) {
  if (text.find('%') != std::string::npos || text.ends_with("em") || text.ends_with("ex")) return std::nullopt;
  LengthEvents events;
  if (!parses<svgpp::tag::type::length>(svgpp::tag::attribute::x(), events, text)) return std::nullopt;
  return events.value;
}

std::vector<std::pair<std::string, std::string>> parseStyle(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> properties;
  for (svgpp::css_style_iterator<const char*> it(text.data(), text.data() + text.size()); !it.eof(); ++it)
    properties.emplace_back(std::string(it->first.begin(), it->first.end()),
                            std::string(it->second.begin(), it->second.end()));
  return properties;
}

}  // namespace froude::scene
