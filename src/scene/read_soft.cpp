// [[soft]]: bodies that deform, filled with points and triangles, and ropes.
#include <fmt/format.h>
#include <froude/fields/triangle_mesh.h>

#include <algorithm>
#include <set>

#include "run/machine.h"
#include "scene/draft.h"
#include "scene/repeat.h"

namespace froude::scene {

namespace {

constexpr double kDegrees = kPi / 180.0;
constexpr double kPointBytes = 1000.0;  // of a point with its triangles, in the mesh and in the world

SoftModel readModelName(TableReader& soft) {
  std::vector<std::string> words;
  for (const auto& [name, model] : softModelNames()) words.push_back(name);
  const std::string word = soft.word("model", words, soft.has("path") ? "rope" : "neo-hookean");
  const SoftModel model = std::find_if(softModelNames().begin(), softModelNames().end(), [&](const auto& entry) {
                            return entry.first == word;
                          })->second;
  const bool rope = model == SoftModel::Rope;
  for (const char* key : rope ? std::array{"shape", "poisson", "pressure"} : std::array{"path", "thickness", "path"})
    if (soft.has(key))
      throw SceneError(soft.keyPlace(key), soft.pathOf(key),
                       rope ? "a rope has none, right are path, thickness, young and density"
                            : fmt::format("belongs to ropes, right is model = \"rope\" or to leave it out"));
  return model;
}

/// Points of a rope about a spacing apart; the corners of its path are among them.
std::shared_ptr<const TriangleMesh> readPath(TableReader& soft, double spacing) {
  static const std::string kRight = "at least two points, [[x, y], [x, y]]";
  const Node& path = soft.need("path", kRight);
  if (path.kind != Node::Kind::Array || path.items.size() < 2) soft.fail("path", "right are " + kRight);
  auto mesh = std::make_shared<TriangleMesh>();
  Node resolved = Node::array();
  for (const Node& item : path.items) {
    Node point;  // a table with one key, so that it is checked like any other
    point.set("path", item);
    const Vec2 p = TableReader(soft.file(), point, soft.path(), {"path"}).vector("path");
    resolved.items.push_back(Node::of(p));
    if (mesh->points.empty()) {
      mesh->points.push_back(p);
      continue;
    }
    const Vec2 from = mesh->points.back();
    const double length = (p - from).norm();
    if (!(length > 0.0)) soft.fail(item, "path", "holds the same point twice in a row, once is right");
    const double pieces = std::max(1.0, std::round(length / spacing));
    if (pieces > 1e7)
      soft.fail("spacing", fmt::format("cuts the rope into {:.2g} links, right is a larger one", pieces));
    for (double k = 1.0; k <= pieces; ++k)
      mesh->points.push_back(k == pieces ? p : Vec2(from + (k / pieces) * (p - from)));
  }
  for (std::uint32_t i = 0; i + 1 < mesh->points.size(); ++i) mesh->outline.push_back({i, i + 1});
  soft.resolved().set("path", std::move(resolved));
  return mesh;
}

/// Refuses what would not fit into memory before it is made.
void checkPoints(const TableReader& soft, double area, double spacing) {
  const double points = area / (spacing * spacing * std::sqrt(0.75));
  const auto had = static_cast<double>(run::availableMemoryBytes());
  if (had == 0.0 || kPointBytes * points <= had) return;
  soft.fail("spacing",
            fmt::format("makes {:.3g} points, which would need {}, and {} are available; right is a larger one", points,
                        run::bytesInWords(kPointBytes * points), run::bytesInWords(had)));
}

std::shared_ptr<const TriangleMesh> meshOf(TableReader& soft, std::shared_ptr<const Polygon>& shape, double spacing,
                                           Draft& draft) {
  checkPoints(soft, shape->area(), spacing);
  if (soft.word("outline", {"coarse", "exact"}, "coarse") == "coarse") {
    const std::uint32_t before = shape->edgeCount();
    const double area = shape->area();
    shape = sharedShape(coarseOutline(*shape, spacing), draft);
    if (shape->edgeCount() != before)
      draft.scene.notes.push_back(fmt::format(
          "{}: the outline is coarsened to the spacing, from {} to {} vertices, its area by {:.2g} %; outline = "
          "\"exact\" keeps it",
          soft.pathOf("shape"), before, shape->edgeCount(), 100.0 * (shape->area() / area - 1.0)));
    soft.resolved().set("shape", shapeNode(*shape));
    soft.resolved().set("outline", Node::of("exact"));
  }
  std::shared_ptr<const TriangleMesh>& mesh = draft.meshes[{shape.get(), spacing}];
  try {
    if (mesh == nullptr) mesh = std::make_shared<const TriangleMesh>(triangleMesh(*shape, spacing));
  } catch (const MeshError& error) {
    soft.fail("shape", error.what());
  }
  return mesh;
}

/// Points of the mesh that `pin` holds: one shape, or a list of them, in the body's own coordinates.
std::vector<std::uint32_t> readPins(TableReader& soft, const TriangleMesh& mesh, double spacing, Draft& draft) {
  const Node* pin = soft.find("pin");
  std::set<std::uint32_t> pinned;
  if (pin == nullptr) return {};
  const bool list = pin->kind == Node::Kind::Array;
  Node resolved = Node::array();
  for (const Node& item : list ? pin->items : std::vector<Node>{*pin}) {
    Node table;  // with one key, so that the shape is read like any other
    table.set("pin", item);
    TableReader reader(soft.file(), table, soft.path(), {"pin"});
    const std::shared_ptr<const Polygon> shape = readShape(reader, "pin", draft);
    const std::size_t before = pinned.size();
    double nearest = kInfinity;
    for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
      const Vec2& p = mesh.points[i];
      const double distance = shape->contains(p) ? 0.0 : distanceToOutline(*shape, p);
      if (distance <= 1e-6 * spacing) pinned.insert(i);
      nearest = std::min(nearest, distance);
    }
    if (nearest > 1e-6 * spacing)
      soft.fail(item, "pin",
                fmt::format("holds no point of the body, the nearest is {:.3g} m away; right is a larger shape, in the "
                            "body's own coordinates",
                            nearest));
    if (pinned.size() == before)
      soft.fail(item, "pin", "holds only points that an earlier one holds, right is to leave it out");
    resolved.items.push_back(reader.resolved().entries.front().second);
  }
  if (list && resolved.items.empty()) soft.fail("pin", "is an empty list, right is a shape or to leave it out");
  soft.resolved().set("pin", std::move(resolved));
  return {pinned.begin(), pinned.end()};
}

void readMaterial(TableReader& soft, SoftDef& def) {
  const bool rope = def.model == SoftModel::Rope;
  def.density = soft.number("density", Range::positive(1e12), 1000.0);
  def.young = soft.number("young", Range::positive(1e15), 1.0e5);
  if (!rope) def.poisson = soft.number("poisson", Range{0.0, 0.5, false, true}, 0.45);
  def.damping = soft.number("damping", Range::notNegative(1e9), 0.0);
  def.friction = soft.number("friction", Range::notNegative(1e3), 0.3);
  def.strainLimit = soft.number("strain_limit", Range::notNegative(1e6), 0.0);
  if (!rope) def.pressure = soft.number("pressure", Range::between(-1e12, 1e12), 0.0);
  constexpr std::int64_t kAll = 0xFFFFFFFF;
  def.group = static_cast<std::uint32_t>(soft.integer("group", 0, kAll, 1));
  def.collidesWith = static_cast<std::uint32_t>(soft.integer("collides_with", 0, kAll, kAll));
}

/// What has been read of all soft bodies.
struct Reading {
  Draft& draft;
  std::set<std::string> names;
  Node resolved = Node::array();
};

/// Adds one body, after checking its name and that it lies in the domain.
void addSoft(TableReader& soft, SoftDef def, const std::shared_ptr<const Polygon>& shape, double degrees,
             Reading& reading) {
  Draft& draft = reading.draft;
  if (!reading.names.insert(def.name).second)
    soft.fail("name", fmt::format("\"{}\" is taken by an earlier soft body, right is a name of its own", def.name));
  Box box;
  const Transform transform = Transform::of(def.position, def.angle);
  for (const Vec2& p : def.mesh->points) box.include(transform.toWorld(p));
  const Box& domain = draft.scene.world.domain.box;
  if (!domain.overlaps(box))
    soft.fail(soft.has("position")           ? "position"
              : def.model == SoftModel::Rope ? "path"
                                             : "shape",
              fmt::format("{} lies wholly outside the domain: x {} … {}, y {} … {} against x {} … {}, y {} … {}",
                          def.name, show(box.min.x()), show(box.max.x()), show(box.min.y()), show(box.max.y()),
                          show(domain.min.x()), show(domain.max.x()), show(domain.min.y()), show(domain.max.y())));
  Node copy = soft.resolved();
  copy.set("name", Node::of(def.name));
  copy.set("position", Node::of(def.position));
  copy.set("angle", Node::of(degrees));
  reading.resolved.items.push_back(std::move(copy));
  draft.soft.push_back({soft.place(def.model == SoftModel::Rope ? "path" : "shape"), "soft." + def.name, shape});
  draft.scene.world.soft.push_back(std::move(def));
}

void readOne(TableReader& soft, std::size_t index, Reading& reading) {
  Draft& draft = reading.draft;
  SoftDef def;
  def.name = soft.text("name", "soft" + std::to_string(index));
  checkBodyName(soft, def.name);
  def.model = readModelName(soft);
  def.spacing = soft.number("spacing", Range{1e-9, 1e6, false, false}, 0.02);
  std::shared_ptr<const Polygon> shape;
  if (def.model == SoftModel::Rope) {
    def.mesh = readPath(soft, def.spacing);
    def.thickness = soft.number("thickness", Range::positive(1e6));
  } else {
    shape = readShape(soft, "shape", draft);
    def.mesh = meshOf(soft, shape, def.spacing, draft);
  }
  const Vec2 position = soft.vector("position", Vec2(0.0, 0.0));
  const double degrees = soft.number("angle", Range::any(), 0.0);
  def.velocity = soft.vector("velocity", Vec2(0.0, 0.0));
  def.spin = soft.number("spin", Range::between(-1e6, 1e6), 0.0);
  readMaterial(soft, def);
  def.pinned = readPins(soft, *def.mesh, def.spacing, draft);
  const std::optional<Repeat> repeat = readRepeat(soft);
  const Repeat r = repeat.value_or(Repeat{});
  for (std::int64_t k = 0; k < r.copies(); ++k) {
    SoftDef copy = def;
    if (repeat) copy.name += "." + std::to_string(k);
    copy.position = position + r.offset(k);
    const double turned = turnedBy(soft, r, degrees, k);
    copy.angle = kDegrees * turned;
    addSoft(soft, std::move(copy), shape, turned, reading);
  }
}

}  // namespace

const std::vector<std::pair<std::string, SoftModel>>& softModelNames() {
  static const std::vector<std::pair<std::string, SoftModel>> kNames{{"neo-hookean", SoftModel::NeoHookean},
                                                                     {"stvk", SoftModel::StVenantKirchhoff},
                                                                     {"shape-matching", SoftModel::ShapeMatching},
                                                                     {"springs", SoftModel::Springs},
                                                                     {"rope", SoftModel::Rope}};
  return kNames;
}

double distanceToOutline(const Polygon& polygon, const Vec2& p) {
  double least = kInfinity;
  for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
    const Vec2 a = polygon.edgeStart(i), along = polygon.edgeEnd(i) - a;
    const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - a - t * along).norm());
  }
  return least;
}

void readSoft(TableReader& root, Draft& draft) {
  Reading reading{draft, {}, Node::array()};
  std::size_t index = 0;
  for (TableReader& soft :
       root.tables("soft", {"name",  "shape",    "outline",       "path",     "thickness",    "position",
                            "angle", "velocity", "spin",          "spacing",  "model",        "density",
                            "young", "poisson",  "damping",       "friction", "strain_limit", "pressure",
                            "pin",   "group",    "collides_with", "repeat"}))
    readOne(soft, index++, reading);
  if (!reading.resolved.items.empty()) root.resolved().set("soft", std::move(reading.resolved));
}

}  // namespace froude::scene
