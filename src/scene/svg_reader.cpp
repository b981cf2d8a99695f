// An SVG document, read by libxml2, as curves that are placed in metres.
#include <fmt/format.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include <map>
#include <memory>
#include <optional>
#include <span>

#include "scene/document.h"
#include "scene/svg_drawing.h"
#include "scene/svg_pen.h"
#include "scene/svg_values.h"

namespace froude::scene {

namespace {

constexpr double kLargest = 1e9;                // m, as everywhere in a scene
constexpr std::size_t kMostElements = 100'000;  // visited, a `use` counted each time
constexpr int kDeepest = 100;                   // groups and uses in each other
constexpr const char* kSvgNamespace = "http://www.w3.org/2000/svg";

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

/// For messages: not longer than a line.
std::string excerpt(const std::string& text) {
  std::string shown;
  for (const char c : text.substr(0, 60)) shown += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  while (shown.size() < text.size() && !shown.empty() && (static_cast<unsigned char>(shown.back()) & 0x80) != 0)
    shown.pop_back();  // no half of a letter
  return '"' + shown + (shown.size() < text.size() ? "…\"" : "\"");
}

std::string listed(const std::vector<long>& lines) {
  constexpr std::size_t kMost = 8;
  const std::span<const long> first(lines.data(), std::min(lines.size(), kMost));
  return fmt::format("line {}{}", fmt::join(first, ", "),
                     lines.size() > kMost ? fmt::format(" and {} more", lines.size() - kMost) : "");
}

struct FreeDocument {
  void operator()(xmlDoc* document) const { xmlFreeDoc(document); }
};
using Document = std::unique_ptr<xmlDoc, FreeDocument>;

/// libxml2 writes some complaints (broken encodings) to stderr whatever it is asked; not while this lives, on this
/// thread.
class SilentXml {
 public:
  SilentXml() : function_(xmlGenericError), context_(xmlGenericErrorContext) {
    xmlSetGenericErrorFunc(nullptr, silence);
  }
  ~SilentXml() { xmlSetGenericErrorFunc(context_, function_); }
  SilentXml(const SilentXml&) = delete;
  SilentXml& operator=(const SilentXml&) = delete;

 private:
  static void silence(void*, const char*, ...) {}

  xmlGenericErrorFunc function_;
  void* context_;
};

Document parseXml(const std::string& text, const std::string& name) {
  const SilentXml silent;
  const std::unique_ptr<xmlParserCtxt, decltype(&xmlFreeParserCtxt)> context(xmlNewParserCtxt(), xmlFreeParserCtxt);
  // No network, no external entities, no entity replaced; libxml2's own bounds on depth and size stay on.
  constexpr int kOptions = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_BIG_LINES;
  Document document(
      xmlCtxtReadMemory(context.get(), text.data(), static_cast<int>(text.size()), name.c_str(), nullptr, kOptions));
  if (document == nullptr) {
    const xmlError& error = context->lastError;
    throw DrawingError(fmt::format("{}:{}: this is not XML: {}, right is an SVG drawing", name, std::max(error.line, 1),
                                   error.message != nullptr ? trimmed(error.message) : "nothing in it"));
  }
  if (document->intSubset != nullptr && document->intSubset->entities != nullptr)
    throw DrawingError(fmt::format(
        "{}: declares entities, which are not read; right is a plain SVG drawing without <!ENTITY …>", name));
  const xmlNode* root = xmlDocGetRootElement(document.get());
  if (root == nullptr || std::string_view(reinterpret_cast<const char*>(root->name)) != "svg")
    throw DrawingError(fmt::format("{}: its root is <{}>, right is an SVG drawing, <svg>", name,
                                   root != nullptr ? reinterpret_cast<const char*>(root->name) : ""));
  return document;
}

/// Of the properties of an element what decides on its area.
struct Style {
  bool evenOdd = false, filled = true, visible = true;  // inherited
  bool display = true;
};

class DrawingReader {
 public:
  DrawingReader(const xmlDoc* document, const std::string& name, std::vector<std::string>* notes)
      : root_(xmlDocGetRootElement(const_cast<xmlDoc*>(document))), name_(name), notes_(notes) {
    findIds(root_);
  }

  double trueScale() const;
  void read(const std::string& id, double scale);
  std::vector<DrawnElement> take() {
    for (const auto& [what, lines] : leftOut_)
      if (notes_ != nullptr) notes_->push_back(fmt::format("{}: {} ({})", name_, what, listed(lines)));
    return std::move(elements_);
  }

 private:
  using Element = const xmlNode*;

  static std::string tag(Element node) { return reinterpret_cast<const char*>(node->name); }
  static bool isElement(Element node) {
    return node->type == XML_ELEMENT_NODE &&
           (node->ns == nullptr || std::string_view(reinterpret_cast<const char*>(node->ns->href)) == kSvgNamespace);
  }
  static std::optional<std::string> attribute(Element node, const char* key) {
    const std::unique_ptr<xmlChar, decltype(xmlFree)> value(
        xmlGetNoNsProp(const_cast<xmlNode*>(node), reinterpret_cast<const xmlChar*>(key)), xmlFree);
    if (value == nullptr) return std::nullopt;
    return std::string(reinterpret_cast<const char*>(value.get()));
  }
  static std::string nameOf(Element node) {
    const std::optional<std::string> id = attribute(node, "id");
    return id && !id->empty() ? tag(node) + " " + excerpt(*id) : "<" + tag(node) + ">";
  }
  std::string placeOf(Element node) const { return fmt::format("{}:{}", name_, xmlGetLineNo(node)); }
  [[noreturn]] void fail(Element node, const std::string& problem) const {
    throw DrawingError(fmt::format("{}: {}: {}", placeOf(node), nameOf(node), problem));
  }
  void leaveOut(Element node, const std::string& what) { leftOut_[what].push_back(xmlGetLineNo(node)); }

  void findIds(Element node);
  Element named(const std::string& id) const;
  double length(Element node, const char* key, const std::string& text) const;
  double length(Element node, const char* key, double byDefault) const;
  double size(Element node, const char* key) const;
  Affine transformOf(Element node, const Affine& outer) const;
  void setProperty(Element node, const std::string& key, const std::string& value, Style* style);
  Style styleOf(Element node, const Style& inherited);
  void walk(Element node, const Affine& outer, const Style& inherited, int depth);
  void use(Element node, const Affine& place, const Style& style, int depth);
  void draw(Element node, const Affine& place, const Style& style);
  std::vector<std::vector<Curve>> outline(Element node, const Affine& place) const;
  void path(Element node, Pen* pen) const;
  void polyline(Element node, Pen* pen) const;
  void rect(Element node, Pen* pen) const;

  Element root_;
  std::string name_;
  std::vector<std::string>* notes_;
  std::map<std::string, std::vector<Element>> ids_;
  std::map<std::string, std::vector<long>> leftOut_;  // why, and the lines
  std::vector<DrawnElement> elements_;
  std::size_t visited_ = 0;
  bool chosen_ = false;  // by id: asked for by name, drawn even if hidden
};

bool isShape(const std::string& tag) {
  static const std::vector<std::string> kShapes{"path", "rect", "circle", "ellipse", "polygon", "polyline"};
  return std::find(kShapes.begin(), kShapes.end(), tag) != kShapes.end();
}
bool isGroup(const std::string& tag) { return tag == "g" || tag == "a"; }

/// What describes and does not draw.
bool isSilent(const std::string& tag) {
  static const std::vector<std::string> kSilent{
      "defs",           "title",  "desc",           "metadata", "symbol", "clipPath", "mask", "marker", "pattern",
      "linearGradient", "filter", "radialGradient", "animate",  "set",    "script",   "view", "cursor", "namedview"};
  return std::find(kSilent.begin(), kSilent.end(), tag) != kSilent.end();
}

void DrawingReader::findIds(Element node) {
  for (Element child = node; child != nullptr; child = child->next) {
    if (!isElement(child)) continue;
    if (const std::optional<std::string> id = attribute(child, "id")) ids_[*id].push_back(child);
    findIds(child->children);
  }
}

DrawingReader::Element DrawingReader::named(const std::string& id) const {
  const auto found = ids_.find(id);
  if (found != ids_.end() && found->second.size() == 1) return found->second.front();
  if (found != ids_.end())
    fail(found->second[1], fmt::format("the id is taken already, in line {}; right are ids of one element each",
                                       xmlGetLineNo(found->second[0])));
  std::vector<std::string> known;
  for (const auto& [word, nodes] : ids_)
    if (isShape(tag(nodes[0])) || isGroup(tag(nodes[0])) || tag(nodes[0]) == "use") known.push_back(word);
  if (known.empty()) throw DrawingError(fmt::format("{}: no element has the id {}, none has any", name_, excerpt(id)));
  throw DrawingError(fmt::format(
      "{}: no element has the id {}{}", name_, excerpt(id),
      known.size() <= 8 ? ", right is one of " + fmt::format("{}", fmt::join(known, ", ")) : suggestion(id, known)));
}

/// Absolute units by 96 px an inch; units of fonts and per cent have no meaning here.
double DrawingReader::length(Element node, const char* key, const std::string& text) const {
  const std::optional<double> value = parseLength(trimmed(text));
  if (!value || !std::isfinite(*value))
    fail(node, fmt::format("{} is {}, right is a length such as 12 or 3.5mm", key, excerpt(text)));
  return *value;
}

double DrawingReader::length(Element node, const char* key, double byDefault) const {
  const std::optional<std::string> text = attribute(node, key);
  return text ? length(node, key, *text) : byDefault;
}

/// A length that must be there and not be negative.
double DrawingReader::size(Element node, const char* key) const {
  const std::optional<std::string> text = attribute(node, key);
  if (!text) fail(node, fmt::format("has no {}, right is a length", key));
  const double value = length(node, key, *text);
  if (value < 0.0) fail(node, fmt::format("{} is {}, right is a length that is not negative", key, excerpt(*text)));
  return value;
}

Affine DrawingReader::transformOf(Element node, const Affine& outer) const {
  if (attribute(node, "transform-origin"))
    fail(node, "transform-origin is not read, right is a transform that contains it: rotate(angle, x, y)");
  const std::optional<std::string> text = attribute(node, "transform");
  if (!text || trimmed(*text).empty()) return outer;
  const std::optional<std::array<double, 6>> matrix = parseTransform(trimmed(*text));
  if (!matrix)
    fail(node, fmt::format("transform is {}, right is for example rotate(30) translate(5, 2)", excerpt(*text)));
  const auto& [a, b, c, d, e, f] = *matrix;
  const Affine m{a, b, c, d, e, f};
  const double determinant = m.a * m.d - m.b * m.c;
  const double size = std::max({std::abs(m.a), std::abs(m.b), std::abs(m.c), std::abs(m.d)});
  if (!std::isfinite(determinant + m.e + m.f) || !(std::abs(determinant) > 1e-15 * size * size))
    fail(node, fmt::format("the transform {} has no inverse: it flattens everything to a line or a point, "
                           "right is one that leaves area",
                           excerpt(*text)));
  return outer.after(m);
}

void DrawingReader::setProperty(Element node, const std::string& key, const std::string& raw, Style* style) {
  std::string value = trimmed(raw);
  if (const auto mark = value.find('!'); mark != std::string::npos) value = trimmed(value.substr(0, mark));
  if (value == "inherit") return;
  if (key == "fill-rule") {
    if (value != "evenodd" && value != "nonzero")
      fail(node, fmt::format("fill-rule is {}, right is \"nonzero\" or \"evenodd\"", excerpt(value)));
    style->evenOdd = value == "evenodd";
  } else if (key == "fill") {
    style->filled = value != "none";
  } else if (key == "visibility") {
    style->visible = value == "visible";
  } else if (key == "display") {
    style->display = value != "none";
  } else if (key == "transform") {
    fail(node, "a transform in style is not read, right is the attribute transform");
  } else if ((key == "clip-path" || key == "mask") && value != "none") {
    leaveOut(node, key + " is not applied");
  }
}

Style DrawingReader::styleOf(Element node, const Style& inherited) {
  Style style = inherited;
  style.display = true;
  for (const char* key : {"fill-rule", "fill", "visibility", "display", "clip-path", "mask"})
    if (const std::optional<std::string> value = attribute(node, key)) setProperty(node, key, *value, &style);
  if (const std::optional<std::string> css = attribute(node, "style")) {
    for (const auto& [key, value] : parseStyle(*css)) setProperty(node, key, value, &style);
  }
  return style;
}

void DrawingReader::walk(Element node, const Affine& outer, const Style& inherited, int depth) {
  if (!isElement(node)) return;
  const std::string kind = tag(node);
  if (isSilent(kind)) return;
  if (++visited_ > kMostElements)
    fail(node, fmt::format("the drawing has more than {} elements, uses written out; right is a simpler one, or the "
                           "id of a part of it",
                           kMostElements));
  if (depth > kDeepest) fail(node, fmt::format("groups and uses lie in each other {} deep, or in a ring", kDeepest));
  if (kind == "style") return leaveOut(node, "the rules of <style> are not read, only attributes and style=\"…\"");
  if (kind == "svg" || kind == "switch")
    fail(node, fmt::format("a <{}> within a drawing is not read, right is a group, <g>", kind));
  if (!isShape(kind) && !isGroup(kind) && kind != "use")
    return leaveOut(node, fmt::format("<{}> has no outline and was left out", kind));
  Style style = styleOf(node, inherited);
  if (chosen_) style.display = style.visible = true;
  chosen_ = false;
  if (!style.display) return leaveOut(node, "display=\"none\" was left out");
  const Affine place = transformOf(node, outer);
  if (kind == "use") return use(node, place, style, depth);
  if (isShape(kind)) return draw(node, place, style);
  for (Element child = node->children; child != nullptr; child = child->next) walk(child, place, style, depth + 1);
}

void DrawingReader::use(Element node, const Affine& place, const Style& style, int depth) {
  const std::unique_ptr<xmlChar, decltype(xmlFree)> linked(
      xmlGetNsProp(const_cast<xmlNode*>(node), reinterpret_cast<const xmlChar*>("href"),
                   reinterpret_cast<const xmlChar*>("http://www.w3.org/1999/xlink")),
      xmlFree);
  std::optional<std::string> href = attribute(node, "href");
  if (!href && linked != nullptr) href = reinterpret_cast<const char*>(linked.get());
  if (!href || href->size() < 2 || href->front() != '#')
    fail(node, fmt::format("its href is {}, right is an element of the same drawing, href=\"#id\"",
                           href ? excerpt(*href) : std::string("missing")));
  const Element target = named(href->substr(1));
  const std::string kind = tag(target);
  if (!isShape(kind) && !isGroup(kind) && kind != "use")
    fail(node, fmt::format("uses the <{}> {}, right is a group or an outline", kind, excerpt(*href)));
  const Affine moved = place.after({1, 0, 0, 1, length(node, "x", 0.0), length(node, "y", 0.0)});
  walk(target, moved, style, depth + 1);
}

void DrawingReader::path(Element node, Pen* pen) const {
  const std::string d = attribute(node, "d").value_or("");
  std::vector<PathSegment> segments;
  const bool good = parsePathData(trimmed(d), &segments);
  for (const PathSegment& segment : segments) pen->add(segment);
  if (!good)
    fail(node, fmt::format("{} stops being path data behind the segment that ends at ({}, {}), "
                           "right are M L H V C S Q T A Z with their numbers",
                           "d=" + excerpt(d), pen->last().x(), pen->last().y()));
}

void DrawingReader::polyline(Element node, Pen* pen) const {
  const std::string text = trimmed(attribute(node, "points").value_or(""));
  std::vector<Vec2> points;
  if (!text.empty() && !parsePoints(text, &points))
    fail(node, fmt::format("{} stops being a list of points behind {} of them, right are pairs of numbers, x,y x,y …",
                           "points=" + excerpt(text), points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0) pen->move(points[i].x(), points[i].y());
    if (i > 0) pen->line(points[i].x(), points[i].y());
  }
}

void DrawingReader::rect(Element node, Pen* pen) const {
  const double x = length(node, "x", 0.0), y = length(node, "y", 0.0);
  const double width = size(node, "width"), height = size(node, "height");
  const auto radius = [&](const char* key, const char* other) {
    const std::string own = trimmed(attribute(node, key).value_or("auto"));
    if (own != "auto") return size(node, key);
    return trimmed(attribute(node, other).value_or("auto")) == "auto" ? 0.0 : size(node, other);
  };
  const double rx = std::min(radius("rx", "ry"), 0.5 * width), ry = std::min(radius("ry", "rx"), 0.5 * height);
  const double right = x + width, bottom = y + height;
  if (rx == 0.0 || ry == 0.0) {
    pen->move(x, y);
    pen->line(right, y);
    pen->line(right, bottom);
    pen->line(x, bottom);
    return;
  }
  pen->move(x + rx, y);
  pen->line(right - rx, y);
  pen->arc({right - rx, y + ry}, rx, ry, 3, 4);
  pen->line(right, bottom - ry);
  pen->arc({right - rx, bottom - ry}, rx, ry, 0, 1);
  pen->line(x + rx, bottom);
  pen->arc({x + rx, bottom - ry}, rx, ry, 1, 2);
  pen->line(x, y + ry);
  pen->arc({x + rx, y + ry}, rx, ry, 2, 3);
}

std::vector<std::vector<Curve>> DrawingReader::outline(Element node, const Affine& place) const {
  Pen pen(place);
  const std::string kind = tag(node);
  if (kind == "path") {
    path(node, &pen);
  } else if (kind == "rect") {
    rect(node, &pen);
  } else if (kind == "circle" || kind == "ellipse") {
    const Vec2 center(length(node, "cx", 0.0), length(node, "cy", 0.0));
    const double rx = size(node, kind == "circle" ? "r" : "rx"), ry = size(node, kind == "circle" ? "r" : "ry");
    pen.move(center.x() + rx, center.y());
    pen.arc(center, rx, ry, 0, 4);
  } else {
    polyline(node, &pen);
  }
  return pen.take();
}

void DrawingReader::draw(Element node, const Affine& place, const Style& style) {
  if (!style.visible) return leaveOut(node, "visibility=\"hidden\" was left out");
  if (!style.filled) return leaveOut(node, "fill=\"none\" encloses no area and was left out");
  DrawnElement element{nameOf(node), placeOf(node), style.evenOdd, outline(node, place)};
  for (const std::vector<Curve>& subpath : element.subpaths)
    for (const Curve& curve : subpath) {
      const Box box = curve.bounds();
      const double reach = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
      if (!(reach <= kLargest) || !curve.start().allFinite() || !curve.stop().allFinite())
        fail(node, "reaches beyond 1e9 m, right is a smaller scale or a smaller drawing");
    }
  elements_.push_back(std::move(element));
}

/// Metres a user unit, if the drawing states its size in units of length; else 1.
double DrawingReader::trueScale() const {
  constexpr double kInch = 0.0254, kPixel = kInch / 96.0;  // m
  static const std::pair<const char*, double> kUnits[] = {
      {"mm", 1e-3}, {"cm", 1e-2}, {"in", kInch}, {"pt", kInch / 72.0}, {"pc", kInch / 6.0}};
  std::vector<double> box;
  std::string viewBox = attribute(root_, "viewBox").value_or("");
  std::replace(viewBox.begin(), viewBox.end(), ',', ' ');
  for (std::size_t at = 0; (at = viewBox.find_first_not_of(" \t\r\n", at)) != std::string::npos;) {
    const std::size_t end = std::min(viewBox.find_first_of(" \t\r\n", at), viewBox.size());
    box.push_back(length(root_, "viewBox", viewBox.substr(at, end - at)));
    at = end;
  }
  if (!box.empty() && !(box.size() == 4 && box[2] > 0.0 && box[3] > 0.0))
    fail(root_, fmt::format("viewBox is {}, right is \"x y width height\" with a width and a height above 0",
                            excerpt(viewBox)));
  double scale = kInfinity;
  for (const auto& [key, side] : {std::pair("width", std::size_t{2}), std::pair("height", std::size_t{3})}) {
    const std::string text = trimmed(attribute(root_, key).value_or(""));
    for (const auto& [unit, metresOf] : kUnits) {
      if (!text.ends_with(unit)) continue;
      const double metres = length(root_, key, text.substr(0, text.size() - 2)) * metresOf;
      if (!(metres > 0.0)) fail(root_, fmt::format("{} is {}, right is a length above 0", key, excerpt(text)));
      scale = std::min(scale, box.empty() ? kPixel : metres / box[side]);
    }
  }
  return std::isfinite(scale) ? scale : 1.0;
}

void DrawingReader::read(const std::string& id, double scale) {
  const Affine world{scale, 0.0, 0.0, -scale, 0.0, 0.0};
  const Style rootStyle = styleOf(root_, {});
  const Affine drawing = transformOf(root_, world);
  Element part = id.empty() ? nullptr : named(id);
  if (part == nullptr || part == root_) {
    for (Element child = root_->children; child != nullptr; child = child->next) walk(child, drawing, rootStyle, 0);
  } else {
    if (!isShape(tag(part)) && !isGroup(tag(part)) && tag(part) != "use")
      fail(part, fmt::format("a <{}> has no outline of its own, right is the id of a path, a rect, a circle, an "
                             "ellipse, a polygon, a polyline or a group",
                             tag(part)));
    std::vector<Element> outside;  // from the part's parent up to the root's child
    for (Element node = part->parent; node != nullptr && node != root_; node = node->parent) outside.push_back(node);
    Affine place = drawing;
    Style style = rootStyle;
    for (auto node = outside.rbegin(); node != outside.rend(); ++node) {
      if (tag(*node) == "svg") fail(*node, "a <svg> within a drawing is not read, right is a group, <g>");
      style = styleOf(*node, style);
      place = transformOf(*node, place);
    }
    chosen_ = true;
    walk(part, place, style, 0);
  }
  if (elements_.empty()) {
    std::string reasons;
    for (const auto& [what, lines] : leftOut_) reasons += fmt::format("; {} ({})", what, listed(lines));
    const std::string of = id.empty() ? "" : " in " + excerpt(id);
    throw DrawingError(fmt::format("{}{}: nothing is drawn{} that encloses area{}; right is a filled outline", name_,
                                   part != nullptr ? fmt::format(":{}", xmlGetLineNo(part)) : "", of, reasons));
  }
}

}  // namespace

std::vector<DrawnElement> readDrawing(const std::string& text, const std::string& name, const std::string& id,
                                      double scale, std::vector<std::string>* notes) {
  const Document document = parseXml(text, name);
  DrawingReader reader(document.get(), name, notes);
  if (scale == 0.0) {
    scale = reader.trueScale();
    if (scale != 1.0 && notes != nullptr)
      notes->push_back(fmt::format("{}: drawn at its true size, {} m per user unit", name, scale));
  }
  reader.read(id, scale);
  return reader.take();
}

}  // namespace froude::scene
