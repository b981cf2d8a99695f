// What comes out: [output] and [[gauge]].
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "export/vdb_frames.h"
#include "scene/draft.h"
#include "scene/material_point.h"

namespace froude::scene {

namespace {

PngDef readPng(TableReader& output, const Box& domain) {
  static const Node kEmptyTable;
  const std::vector<std::string> keys{"width", "view", "color", "range", "strain_range"};
  std::optional<TableReader> given = output.table("png", keys);
  TableReader png = given ? *given : TableReader(output.file(), kEmptyTable, "output.png", keys);
  PngDef def;
  def.width = static_cast<int>(png.integer("width", 16, 16384, 1280));
  def.view = png.box("view", domain);
  def.color = png.word("color", {"speed", "pressure", "density"}, "speed");
  for (const auto& [key, range] : {std::pair{"range", &def.range}, std::pair{"strain_range", &def.strainRange}}) {
    if (!png.has(key)) continue;
    const Vec2 ends = png.vector(key);
    if (!(ends.x() < ends.y())) png.fail(key, "right is [min, max] with min < max");
    *range = {ends.x(), ends.y()};
  }
  output.resolved().set("png", png.resolved());
  return def;
}

}  // namespace

void readOutput(TableReader& root, Draft& draft) {
  static const Node kEmptyTable;
  const std::vector<std::string> keys{"every", "frames", "checkpoint", "png"};
  std::optional<TableReader> given = root.table("output", keys);
  TableReader output = given ? *given : TableReader(root.file(), kEmptyTable, "output", keys);
  OutputDef& def = draft.scene.output;
  def.every = output.number("every", Range::positive(), 0.02);
  if (draft.scene.duration / def.every > 1e6)
    output.fail("every",
                fmt::format("asks for {:.3g} frames, right are at most 1e6", draft.scene.duration / def.every));
  if (const Node* frames = output.find("frames"); frames != nullptr && !exporting::kHasOpenVdb)
    for (const Node& item : frames->items)
      if (item.kind == Node::Kind::Text && item.text == "vdb")
        output.fail(item, "frames", "\"vdb\" wants a build with OpenVDB; this build has: h5, png");
  const std::vector<std::string> frames = output.words("frames", {"h5", "png", "vdb"}, {"h5", "png"});
  def.h5 = std::find(frames.begin(), frames.end(), "h5") != frames.end();
  def.png = std::find(frames.begin(), frames.end(), "png") != frames.end();
  def.vdb = std::find(frames.begin(), frames.end(), "vdb") != frames.end();
  def.checkpoint = output.number("checkpoint", Range::positive(), 60.0);
  def.image = readPng(output, draft.scene.world.domain.box);
  root.resolved().set("output", output.resolved());
}

namespace {

/// What a type of gauge takes besides name, type and every, and whether it reads the fluid.
struct GaugeType {
  std::string name;
  std::vector<std::string> keys;
  bool needsFluid = false;
};

const std::vector<GaugeType>& gaugeTypes() {
  static const std::vector<GaugeType> kTypes{{"front", {"axis", "quantile"}, true},
                                             {"toe", {}, true},
                                             {"height", {"x"}, true},
                                             {"level", {}, true},
                                             {"volume", {}, true},
                                             {"pressure", {"at", "window"}, true},
                                             {"velocity", {"at"}, true},
                                             {"profile", {"from", "to", "count"}, true},
                                             {"force", {"body"}, false},
                                             {"pose", {"body"}, false},
                                             {"tip", {"soft", "at"}, false},
                                             {"area", {"soft"}, false},
                                             {"energy", {"species"}, false},
                                             {"momentum", {"species"}, false},
                                             {"mass", {"species"}, false},
                                             {"count", {"species"}, false},
                                             {"max_speed", {}, false},
                                             {"density_error", {}, true},
                                             {"leaks", {}, false}};
  return kTypes;
}

const GaugeType& readType(TableReader& gauge, bool hasFluid) {
  std::vector<std::string> names;
  for (const GaugeType& type : gaugeTypes()) names.push_back(type.name);
  const Node* node = gauge.find("type");
  if (node != nullptr && node->kind == Node::Kind::Text &&
      std::find(names.begin(), names.end(), node->text) == names.end())
    gauge.fail("type", fmt::format("\"{}\" is no type of gauge{}", node->text, suggestion(node->text, names)));
  const std::string word = gauge.word("type", names, std::nullopt);
  const auto type =
      std::find_if(gaugeTypes().begin(), gaugeTypes().end(), [&](const auto& t) { return t.name == word; });
  for (const GaugeType& other : gaugeTypes())
    for (const std::string& key : other.keys)
      if (gauge.has(key) && std::find(type->keys.begin(), type->keys.end(), key) == type->keys.end())
        throw SceneError(gauge.keyPlace(key), gauge.pathOf(key),
                         fmt::format("a gauge of type {} takes {}", word,
                                     type->keys.empty() ? "no parameter"
                                                        : "only " + fmt::format("{}", fmt::join(type->keys, ", "))));
  if (type->needsFluid && !hasFluid)
    gauge.fail("type", fmt::format("\"{}\" reads the fluid, and this scene has none", word));
  return *type;
}

Vec2 pointInDomain(TableReader& gauge, const std::string& key, const Box& domain) {
  const Vec2 point = gauge.vector(key);
  if (!domain.contains(point))
    gauge.fail(key, fmt::format("the point [{}, {}] is outside the domain", show(point.x()), show(point.y())));
  return point;
}

std::string readBodyName(TableReader& gauge, const std::vector<BodyDef>& bodies) {
  std::vector<std::string> names;
  for (const BodyDef& body : bodies) names.push_back(body.name);
  const std::string name = gauge.text("body");
  if (names.empty()) gauge.fail("body", fmt::format("\"{}\" names no body, the scene has none", name));
  if (std::find(names.begin(), names.end(), name) == names.end())
    gauge.fail("body", fmt::format("\"{}\" names no body{}", name, suggestion(name, names)));
  return name;
}

const SoftDef& readSoftName(TableReader& gauge, const std::vector<SoftDef>& soft) {
  std::vector<std::string> names;
  for (const SoftDef& def : soft) names.push_back(def.name);
  const std::string name = gauge.text("soft");
  if (names.empty()) gauge.fail("soft", fmt::format("\"{}\" names no soft body, the scene has none", name));
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    gauge.fail("soft", fmt::format("\"{}\" names no soft body{}", name, suggestion(name, names)));
  return soft[static_cast<std::size_t>(found - names.begin())];
}

/// The material point of a tip, which must belong to the body.
Vec2 readMaterialPoint(TableReader& gauge, const SoftDef& soft) {
  const Vec2 at = gauge.vector("at");
  const MaterialPoint point(*soft.mesh, at);
  if (point.distance > 1e-6 * soft.spacing)
    gauge.fail("at", fmt::format("[{}, {}] is {:.3g} m outside of \"{}\" at rest, in its own coordinates; right is a "
                                 "point of the body, the nearest is [{}, {}]",
                                 show(at.x()), show(at.y()), point.distance, soft.name, show(point.nearest.x()),
                                 show(point.nearest.y())));
  return at;
}

Species readSpecies(TableReader& gauge, const WorldDef& world) {
  const std::string word = gauge.word("species", {"fluid", "bullet", "soft"}, std::nullopt);
  const Species species = word == "fluid" ? Species::Fluid : word == "bullet" ? Species::Bullet : Species::Soft;
  const bool there = species == Species::Fluid    ? world.fluid.has_value()
                     : species == Species::Bullet ? world.bullet.has_value()
                                                  : !world.soft.empty();
  if (!there) gauge.fail("species", "the scene has no such particles");
  return species;
}

void readParameters(TableReader& gauge, const GaugeType& type, const WorldDef& world, GaugeDef& def) {
  const Box& domain = world.domain.box;
  for (const std::string& key : type.keys) {
    if (key == "axis") def.axis = gauge.word("axis", {"x", "y"}, "x")[0];
    if (key == "quantile") def.quantile = gauge.number("quantile", Range::between(0.0, 1.0), 0.995);
    if (key == "x") def.x = gauge.number("x", Range::between(domain.min.x(), domain.max.x()));
    if (key == "soft") def.soft = readSoftName(gauge, world.soft).name;
    if (key == "at")
      def.at = def.soft.empty() ? pointInDomain(gauge, "at", domain)
                                : readMaterialPoint(gauge, readSoftName(gauge, world.soft));
    if (key == "window") def.window = gauge.number("window", Range::notNegative(), 0.0);
    if (key == "from") def.from = pointInDomain(gauge, "from", domain);
    if (key == "to") def.to = pointInDomain(gauge, "to", domain);
    if (key == "count") def.count = static_cast<int>(gauge.integer("count", 2, 100000));
    if (key == "body") def.body = readBodyName(gauge, world.bodies);
    if (key == "species" && gauge.has("species")) def.species = readSpecies(gauge, world);
  }
}

void checkName(const TableReader& gauge, const std::string& name) {
  const auto good = [](char c, bool first) {
    const auto byte = static_cast<unsigned char>(c);
    return c == '_' || (first ? std::isalpha(byte) : std::isalnum(byte) || c == '-') != 0;
  };
  bool ok = !name.empty() && good(name[0], true);
  for (std::size_t i = 1; i < name.size(); ++i) ok = ok && good(name[i], false);
  if (!ok) gauge.fail("name", fmt::format("is \"{}\", right are a letter or _, then letters, digits, _ and -", name));
}

}  // namespace

void readGauges(TableReader& root, Draft& draft) {
  std::vector<std::string> keys{"name", "type", "every"};
  for (const GaugeType& type : gaugeTypes())
    for (const std::string& key : type.keys)
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  Node resolved = Node::array();
  std::set<std::string> names;
  for (TableReader& gauge : root.tables("gauge", keys)) {
    GaugeDef def;
    def.name = gauge.text("name");
    checkName(gauge, def.name);
    if (def.name == "t") gauge.fail("name", "\"t\" is the column of time, right is another name");
    if (!names.insert(def.name).second)
      gauge.fail("name", fmt::format("\"{}\" is taken by an earlier gauge, right is a name of its own", def.name));
    const GaugeType& type = readType(gauge, draft.scene.world.fluid.has_value());
    def.type = type.name;
    def.every = gauge.number("every", Range::positive(), draft.scene.output.every);
    if (draft.scene.duration / def.every > 1e8)
      gauge.fail("every", fmt::format("asks for {:.3g} rows, right are at most 1e8", draft.scene.duration / def.every));
    readParameters(gauge, type, draft.scene.world, def);
    draft.scene.gauges.push_back(std::move(def));
    resolved.items.push_back(gauge.resolved());
  }
  if (!resolved.items.empty()) root.resolved().set("gauge", std::move(resolved));
}

}  // namespace froude::scene
