#include "scene/shape_argument.h"

#include <fmt/format.h>

#include <filesystem>

#include "scene/draft.h"
#include "scene/point_table.h"
#include "scene/svg_drawing.h"

namespace froude::scene {

namespace {

constexpr double kLargest = 1e9;  // coordinate of a vertex, as in scenes [m]
constexpr std::size_t kMostNames = 12;

enum class Source { Toml, Csv, Svg, Unknown };

Source sourceOf(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".toml") return Source::Toml;
  if (extension == ".csv") return Source::Csv;
  if (extension == ".svg") return Source::Svg;
  return Source::Unknown;
}

struct Named {
  std::string file, id;
};

/// FILE#ID, where what stands before the # has an extension that is known; else all of it is the file.
Named split(const std::string& argument) {
  const std::size_t hash = argument.rfind('#');
  if (hash == std::string::npos || sourceOf(argument.substr(0, hash)) == Source::Unknown) return {argument, {}};
  if (hash + 1 == argument.size())
    throw SceneError({argument.substr(0, hash), 0, 0}, "shape", "nothing stands behind the #, right is a name or no #");
  return {argument.substr(0, hash), argument.substr(hash + 1)};
}

std::vector<std::string> bodyNames(const Node& document) {
  std::vector<std::string> names;
  const Node* bodies = document.find("body");
  if (bodies == nullptr) return names;
  for (const Node& body : bodies->items) {
    const Node* name = body.kind == Node::Kind::Table ? body.find("name") : nullptr;
    if (name != nullptr && name->kind == Node::Kind::Text) names.push_back(name->text);
  }
  return names;
}

std::string listed(std::vector<std::string> names) {
  if (names.empty()) return "it has none with a name";
  const bool more = names.size() > kMostNames;
  if (more) names.resize(kMostNames);
  return fmt::format("there are {}{}", fmt::join(names, ", "), more ? ", …" : "");
}

ShapeArgument shapeOfFile(const std::string& file, const Node& document) {
  const bool isScene =
      document.find("shape") == nullptr && (document.find("format") != nullptr || document.find("body") != nullptr);
  if (isScene)
    throw SceneError({file, 1, 1}, "shape",
                     "this is a scene, right is FILE.toml#NAME with one of its bodies: " + listed(bodyNames(document)));
  TableReader root(file, document, "", {"shape"});
  Draft draft;
  const std::shared_ptr<const Polygon> polygon = readShape(root, "shape", draft);
  return {*polygon, {}, draft.scene.notes};
}

/// The body of that name, copies included, as the scene's own reader makes it.
ShapeArgument shapeOfBody(const std::string& file, const std::string& name, const Node& document) {
  if (document.find("shape") != nullptr && document.find("body") == nullptr)
    throw SceneError({file, 1, 1}, "shape",
                     "this file holds one shape and no bodies, right is its name without #" + name);
  TableReader root(file, document, "", sceneKeys());
  Draft draft;
  readHeader(root, draft);
  readDomain(root, draft);
  readBodies(root, draft);
  std::vector<std::string> names;
  for (const BodyDef& body : draft.scene.world.bodies) {
    names.push_back(body.name);
    if (body.name != name) continue;
    ShapeArgument shape{*body.shape, {}, {}};
    const std::string path = "body." + name;
    for (const std::string& note : draft.scene.notes)
      if (path.starts_with(note.substr(0, note.find(".shape")))) shape.notes.push_back(note);
    return shape;
  }
  throw SceneError({file, 0, 0}, "body",
                   fmt::format("no body is called \"{}\"{}; {}", name, suggestion(name, names), listed(names)));
}

ShapeArgument shapeOfTable(const std::string& file) {
  std::vector<Vec2> vertices = readPoints(file, kLargest);
  std::vector<std::string> notes;
  try {
    Polygon polygon = Polygon::make(std::move(vertices), {}, &notes);
    return {std::move(polygon), {}, std::move(notes)};
  } catch (const PolygonError& error) {
    throw SceneError({file, 0, 0}, "polygon", error.what());
  }
}

ShapeArgument shapeOfDrawing(const std::string& file, const std::string& id, const SvgOptions& svg) {
  std::vector<std::string> notes;
  Polygon polygon = svgPolygon(file, id, svg.scale, svg.tolerance, &notes);
  return {std::move(polygon), {}, std::move(notes)};
}

ShapeArgument shapeOf(const Named& named, const SvgOptions& svg) {
  switch (sourceOf(named.file)) {
    case Source::Toml: {
      const Node document = parseDocument(named.file, readText(named.file, "a shape or a scene (.toml)"));
      return named.id.empty() ? shapeOfFile(named.file, document) : shapeOfBody(named.file, named.id, document);
    }
    case Source::Csv:
      if (!named.id.empty())
        throw SceneError({named.file, 0, 0}, "shape",
                         "a table of vertices has no names in it, right is no #" + named.id);
      return shapeOfTable(named.file);
    case Source::Svg:
      return shapeOfDrawing(named.file, named.id, svg);
    case Source::Unknown:
      break;
  }
  throw SceneError({named.file, 0, 0}, "shape",
                   "is none of the files with shapes, right is FILE.toml with shape = { … }, SCENE.toml#BODY, FILE.csv "
                   "with x,y in each row, or FILE.svg#ID");
}

}  // namespace

ShapeArgument readShapeArgument(const std::string& argument, const SvgOptions& svg) {
  const Named named = split(argument);
  ShapeArgument shape = shapeOf(named, svg);
  shape.name = std::filesystem::path(named.file).filename().string();
  if (!named.id.empty()) shape.name += "#" + named.id;
  return shape;
}

bool isDrawing(const std::string& argument) {
  const std::size_t hash = argument.rfind('#');
  return sourceOf(argument) == Source::Svg ||
         (hash != std::string::npos && sourceOf(argument.substr(0, hash)) == Source::Svg);
}

}  // namespace froude::scene
