#include <fmt/format.h>

#include <filesystem>

#include "scene/draft.h"
#include "scene/svg_drawing.h"

namespace froude::scene {

namespace {

std::vector<Vec2> readRing(const TableReader& shape, const std::string& key, const Node& ring) {
  static const std::string kRight = "right are vertices, [[x, y], [x, y], [x, y], …]";
  if (ring.kind != Node::Kind::Array) shape.fail(ring, key, fmt::format("is {}, {}", kindName(ring.kind), kRight));
  std::vector<Vec2> vertices;
  vertices.reserve(ring.items.size());
  for (const Node& item : ring.items) {
    if (item.kind != Node::Kind::Array || item.items.size() != 2)
      shape.fail(item, key, fmt::format("vertex {} is no pair of numbers, {}", vertices.size(), kRight));
    double xy[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const Node& number = item.items[i];
      if (!number.isNumeric())
        shape.fail(number, key, fmt::format("vertex {} holds {}, {}", vertices.size(), kindName(number.kind), kRight));
      xy[i] = number.kind == Node::Kind::Integer ? static_cast<double>(number.integer) : number.number;
      if (!(std::abs(xy[i]) <= 1e9))
        shape.fail(
            number, key,
            fmt::format("vertex {} holds {}, right is a number from -1e9 at most 1e9", vertices.size(), show(xy[i])));
    }
    vertices.emplace_back(xy[0], xy[1]);
  }
  return vertices;
}

Polygon readPolygon(TableReader& shape, std::vector<std::string>& notes) {
  std::vector<Vec2> outer = readRing(shape, "polygon", *shape.find("polygon"));
  std::vector<std::vector<Vec2>> holes;
  if (const Node* node = shape.find("holes")) {
    if (node->kind != Node::Kind::Array)
      shape.fail("holes",
                 fmt::format("is {}, right is a list of holes, each a list of vertices", kindName(node->kind)));
    for (const Node& ring : node->items) holes.push_back(readRing(shape, "holes", ring));
  }
  return Polygon::make(std::move(outer), std::move(holes), &notes);
}

/// A drawing's path is relative to the scene's folder.
Polygon readDrawn(TableReader& shape, std::vector<std::string>& notes) {
  TableReader svg = *shape.table("svg", {"file", "id", "scale", "tolerance"});
  const std::string file = svg.text("file");
  if (file.empty()) svg.fail("file", "is empty, right is the path of an SVG drawing, relative to the scene's folder");
  const std::string id = svg.text("id", "");
  const double scale = svg.number("scale", Range::positive(), 0.0);
  const double tolerance = svg.number("tolerance", Range::positive(), 0.0);
  const std::filesystem::path path = std::filesystem::path(shape.file()).parent_path() / file;
  return svgPolygon(path.string(), id, scale, tolerance, &notes);
}

/// The one of `keys` that the shape has.
std::string kindOf(const TableReader& shape, const std::vector<std::string>& keys) {
  std::string found;
  for (const std::string& key : keys) {
    if (!shape.has(key)) continue;
    if (!found.empty()) shape.fail(key, fmt::format("a second kind of shape besides {}, one is right", found));
    found = key;
  }
  if (found.empty())
    throw SceneError(
        shape.place(), shape.path(),
        fmt::format("names no shape, right is one of {}, for example {{ box = [0, 0, 1, 1] }}", choice(keys)));
  return found;
}

Node ringNode(const Polygon& polygon, std::size_t ring) {
  Node vertices = Node::array();
  for (std::uint32_t i = polygon.ringStarts()[ring]; i < polygon.ringStarts()[ring + 1]; ++i)
    vertices.items.push_back(Node::of(polygon.vertices()[i]));
  return vertices;
}

}  // namespace

Node shapeNode(const Polygon& polygon) {
  Node holes = Node::array();
  for (std::size_t ring = 1; ring + 1 < polygon.ringStarts().size(); ++ring)
    holes.items.push_back(ringNode(polygon, ring));
  Node shape;
  shape.set("polygon", ringNode(polygon, 0));
  shape.set("holes", std::move(holes));
  return shape;
}

std::shared_ptr<const Polygon> sharedShape(Polygon polygon, Draft& draft) {
  std::string bits(reinterpret_cast<const char*>(polygon.vertices().data()), polygon.vertices().size_bytes());
  bits.append(reinterpret_cast<const char*>(polygon.ringStarts().data()), polygon.ringStarts().size_bytes());
  std::shared_ptr<const Polygon>& shared = draft.shapes[bits];
  if (shared == nullptr) shared = std::make_shared<const Polygon>(std::move(polygon));
  return shared;
}

std::shared_ptr<const Polygon> readShape(TableReader& parent, const std::string& key, Draft& draft) {
  static const std::vector<std::string> kKinds{"polygon", "box", "regular", "svg"};
  parent.need(key, "for example { box = [0, 0, 1, 1] }");
  TableReader shape = *parent.table(key, {"polygon", "holes", "box", "regular", "svg"});
  const std::string kind = kindOf(shape, kKinds);
  if (shape.has("holes") && kind != "polygon") shape.fail("holes", "holes belong to a polygon, not to a " + kind);
  std::vector<std::string> notes;
  std::shared_ptr<const Polygon> polygon;
  try {
    if (kind == "polygon") {
      polygon = sharedShape(readPolygon(shape, notes), draft);
    } else if (kind == "box") {
      polygon = sharedShape(Polygon::box(shape.box("box")), draft);
    } else if (kind == "svg") {
      polygon = sharedShape(readDrawn(shape, notes), draft);
    } else {
      TableReader regular = *shape.table("regular", {"sides", "radius"});
      const auto sides = static_cast<int>(regular.integer("sides", 3, 100000));
      polygon = sharedShape(Polygon::regular(sides, regular.number("radius", Range::positive())), draft);
    }
  } catch (const PolygonError& error) {
    shape.fail(kind, error.what());
  } catch (const DrawingError& error) {
    shape.fail(kind, error.what());
  }
  for (const std::string& note : notes) draft.scene.notes.push_back(shape.path() + ": " + note);
  parent.resolved().set(key, shapeNode(*polygon));
  return polygon;
}

}  // namespace froude::scene
