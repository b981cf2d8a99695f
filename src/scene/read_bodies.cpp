// [[body]]: polygons, where they stand and how they move.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scene/draft.h"
#include "scene/repeat.h"

namespace froude::scene {

namespace {

constexpr double kDegrees = kPi / 180.0;

TimeFunction inTime(const Expression& expression) {
  return [expression](double t) { return expression.evaluate(0.0, 0.0, t); };
}

void checkFinite(const TableReader& piece, const std::string& key, const Expression& expression, double until) {
  for (const double t : {0.0, until})
    if (!std::isfinite(expression.evaluate(0.0, 0.0, t)))
      piece.fail(key, fmt::format("is not finite at t = {} s, right is a finite value at all times", show(t)));
}

std::vector<ScriptPiece> readScript(TableReader& body) {
  std::vector<ScriptPiece> script;
  Node resolved = Node::array();
  double last = 0.0;
  for (TableReader& piece : body.tables("script", {"until", "velocity", "spin"})) {
    ScriptPiece p;
    p.until = piece.number("until", Range{last, 1e9, true, false});
    const auto velocity = piece.expressions("velocity", "t", {0.0, 0.0});
    const Expression spin = piece.expression("spin", "t", 0.0);
    for (const Expression& component : velocity) checkFinite(piece, "velocity", component, p.until);
    checkFinite(piece, "spin", spin, p.until);
    p.velocityX = inTime(velocity[0]);
    p.velocityY = inTime(velocity[1]);
    p.spin = inTime(spin);
    last = p.until;
    script.push_back(std::move(p));
    resolved.items.push_back(piece.resolved());
  }
  if (!script.empty()) body.resolved().set("script", std::move(resolved));
  return script;
}

std::optional<HingeDef> readHinge(TableReader& body) {
  std::optional<TableReader> table = body.table("hinge", {"at", "motor"});
  if (!table) return std::nullopt;
  HingeDef hinge;
  hinge.at = table->vector("at");
  if (std::optional<TableReader> motor = table->table("motor", {"speed", "torque"})) {
    hinge.motor =
        MotorDef{motor->number("speed", Range::between(-1e6, 1e6)), motor->number("torque", Range::notNegative(1e15))};
    table->resolved().set("motor", motor->resolved());
  }
  body.resolved().set("hinge", table->resolved());
  return hinge;
}

void readMotion(TableReader& body, BodyDef& def) {
  const std::string motion = body.word("motion", {"fixed", "scripted", "free"}, "fixed");
  def.motion = motion == "fixed" ? Motion::Fixed : motion == "free" ? Motion::Free : Motion::Scripted;
  def.hinge = readHinge(body);
  if (def.hinge && def.motion != Motion::Free)
    body.fail("hinge", fmt::format("a hinge holds a free body and this one is {}, right is motion = \"free\"", motion));
  def.velocity = body.vector("velocity", Vec2(0.0, 0.0));
  def.spin = body.number("spin", Range::between(-1e6, 1e6), 0.0);
  def.script = readScript(body);
  const bool moves = def.velocity != Vec2(0.0, 0.0) || def.spin != 0.0;
  if (def.motion == Motion::Fixed && moves)
    body.fail(def.spin != 0.0 ? "spin" : "velocity", "a fixed body does not move, right is motion = \"scripted\"");
  if (def.motion == Motion::Fixed && !def.script.empty())
    body.fail("script", "a fixed body does not move, right is motion = \"scripted\"");
  if (def.motion == Motion::Free && !def.script.empty())
    body.fail("script",
              "a free body is moved by forces, right is motion = \"scripted\", or velocity and spin at the start");
  if (!def.script.empty() && moves)
    body.fail(def.spin != 0.0 ? "spin" : "velocity", "stands beside a script, right is one of them");
}

void readSurface(TableReader& body, BodyDef& def) {
  def.density = body.number("density", Range::positive(1e12), 1000.0);
  def.friction = body.number("friction", Range::notNegative(1e3), 0.3);
  def.restitution = body.number("restitution", Range::between(0.0, 1.0), 0.1);
  if (body.has("slip")) {
    def.slip = body.word("slip", {"free", "no"}, std::nullopt) == "no" ? Slip::NoSlip : Slip::Free;
  }
  def.surfaceVelocity = body.number("surface_velocity", Range::between(-1e6, 1e6), 0.0);
  constexpr std::int64_t kAll = 0xFFFFFFFF;
  def.group = static_cast<std::uint32_t>(body.integer("group", 0, kAll, 1));
  def.collidesWith = static_cast<std::uint32_t>(body.integer("collides_with", 0, kAll, kAll));
}

/// A free body needs a mass and a moment of inertia that can be divided by.
void checkMass(const TableReader& body, const BodyDef& def) {
  if (def.motion != Motion::Free) return;
  const double mass = def.density * def.shape->area(), inertia = def.density * def.shape->secondMoment();
  if (std::isnormal(mass) && std::isnormal(inertia) && std::isnormal(1.0 / mass) && std::isnormal(1.0 / inertia))
    return;
  body.fail(body.has("density") ? "density" : "shape",
            fmt::format("gives the free body a mass of {} kg and a moment of inertia of {} kg·m², right are a density "
                        "and a size that can be computed with",
                        show(mass), show(inertia)));
}

/// A hinged body turns about its hinge: unless a velocity is given, that of its centre of mass follows from its spin.
void turnAboutHinge(const TableReader& body, BodyDef& def) {
  if (!def.hinge || def.spin == 0.0 || body.has("velocity")) return;
  const Vec2 center = Transform::of(def.position, def.angle).toWorld(def.shape->centroid());
  def.velocity = def.spin * leftNormal(center - def.hinge->at);
}

/// Adds one body, after checking its name and that it touches the domain.
void addBody(TableReader& body, BodyDef def, double degrees, Draft& draft, std::set<std::string>& names,
             Node& resolved) {
  if (!names.insert(def.name).second)
    body.fail("name", fmt::format("\"{}\" is taken by an earlier body, right is a name of its own", def.name));
  const Box box = def.shape->transformed(Transform::of(def.position, def.angle)).bounds();
  const Box& domain = draft.scene.world.domain.box;
  if (!domain.overlaps(box)) {
    const std::string which =
        def.name == body.path().substr(body.path().find('.') + 1) ? "" : " (copy " + def.name + ")";
    body.fail(
        body.has("position") ? "position" : "shape",
        fmt::format("the body{} lies wholly outside the domain: x {} … {}, y {} … {} against x {} … {}, y {} … {}",
                    which, show(box.min.x()), show(box.max.x()), show(box.min.y()), show(box.max.y()),
                    show(domain.min.x()), show(domain.max.x()), show(domain.min.y()), show(domain.max.y())));
  }
  Node copy = body.resolved();
  copy.set("name", Node::of(def.name));
  copy.set("position", Node::of(def.position));
  copy.set("angle", Node::of(degrees));
  copy.set("velocity", Node::of(def.velocity));
  if (def.hinge) copy.find("hinge")->set("at", Node::of(def.hinge->at));
  resolved.items.push_back(std::move(copy));
  draft.bodyPlaces.push_back(body.place("shape"));
  draft.bodyPaths.push_back("body." + def.name);
  draft.scene.world.bodies.push_back(std::move(def));
}

void readBody(TableReader& body, std::size_t index, Draft& draft, std::set<std::string>& names, Node& resolved) {
  BodyDef def;
  def.name = body.text("name", "body" + std::to_string(index));
  checkBodyName(body, def.name);
  def.shape = readShape(body, "shape", draft);
  const Vec2 position = body.vector("position", Vec2(0.0, 0.0));
  const double degrees = body.number("angle", Range::any(), 0.0);
  if (body.word("origin", {"own", "centroid"}, "own") == "centroid") {
    def.shape = sharedShape(def.shape->transformed({-def.shape->centroid(), {}}), draft);
    body.resolved().set("shape", shapeNode(*def.shape));
    body.resolved().set("origin", Node::of("own"));
  }
  readMotion(body, def);
  readSurface(body, def);
  checkMass(body, def);
  const std::optional<Repeat> repeat = readRepeat(body);
  const Repeat r = repeat.value_or(Repeat{});
  for (std::int64_t k = 0; k < r.copies(); ++k) {
    BodyDef copy = def;
    if (repeat) copy.name += "." + std::to_string(k);
    copy.position = position + r.offset(k);
    const double turned = turnedBy(body, r, degrees, k);
    copy.angle = kDegrees * turned;
    if (repeat && def.hinge) {  // at the same place of the copy
      const Transform turn = Transform::of(copy.position, kDegrees * (turned - degrees));
      copy.hinge->at = turn.toWorld(def.hinge->at - position);
    }
    turnAboutHinge(body, copy);
    addBody(body, std::move(copy), turned, draft, names, resolved);
  }
}

}  // namespace

void readBodies(TableReader& root, Draft& draft) {
  Node resolved = Node::array();
  std::set<std::string> names;
  std::size_t index = 0;
  for (TableReader& body : root.tables(
           "body", {"name", "shape", "position", "origin", "angle", "motion", "density", "velocity", "spin", "friction",
                    "restitution", "slip", "surface_velocity", "group", "collides_with", "repeat", "script", "hinge"}))
    readBody(body, index++, draft, names, resolved);
  if (!resolved.items.empty()) root.resolved().set("body", std::move(resolved));
}

}  // namespace froude::scene
