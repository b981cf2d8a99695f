// The sections of a scene that say where and for how long: header, domain, emitters, sinks.
#include <fmt/format.h>

#include <algorithm>

#include "scene/draft.h"

namespace froude::scene {

namespace {

constexpr double kDegrees = kPi / 180.0;

/// A component that varies is bound to its place and time when it is called.
VectorField asField(const std::array<Expression, 2>& components) {
  return [components](const Vec2& x, double t) {
    return Vec2(components[0].evaluate(x.x(), x.y(), t), components[1].evaluate(x.x(), x.y(), t));
  };
}

}  // namespace

void readHeader(TableReader& root, Draft& draft) {
  root.integer("format", 1, 1);
  draft.scene.title = root.text("title", "");
  draft.scene.world.seed =
      static_cast<std::uint64_t>(root.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  draft.scene.duration = root.number("duration", Range::positive());
  if (root.has("accuracy"))
    root.fail("accuracy",
              "planning by accuracy is not in this version, right is to leave it out and to choose [model] keys");
  const auto gravity = root.expressions("gravity", "xyt", {0.0, -9.81});
  WorldDef& world = draft.scene.world;
  if (gravity[0].isConstant() && gravity[1].isConstant()) {
    world.gravity = {gravity[0].evaluate(0, 0, 0), gravity[1].evaluate(0, 0, 0)};
    if (!world.gravity.allFinite()) root.fail("gravity", "is not finite, right are finite numbers [m/s²]");
  } else {
    world.gravity = {0.0, 0.0};
    world.gravityField = asField(gravity);
  }
}

void readDomain(TableReader& root, Draft& draft) {
  static const std::vector<std::string> kSides{"left", "right", "bottom", "top"};
  root.need("domain", "[domain] with box = [xmin, ymin, xmax, ymax]");
  TableReader domain = *root.table("domain", {"box", "walls", "wall_slip", "periodic"});
  DomainDef& def = draft.scene.world.domain;
  def.box = domain.box("box");
  const std::vector<std::string> periodic = domain.words("periodic", {"x", "y"}, {});
  for (const std::string& axis : periodic) (axis == "x" ? def.periodicX : def.periodicY) = true;
  const std::array<bool, 4> open{def.periodicX, def.periodicX, def.periodicY, def.periodicY};
  const Node* walls = domain.find("walls");
  if (walls != nullptr && walls->kind == Node::Kind::Array) {
    def.closed.fill(false);
    for (const std::string& side : domain.words("walls", kSides, {})) {
      const auto i = static_cast<std::size_t>(std::find(kSides.begin(), kSides.end(), side) - kSides.begin());
      if (open[i]) domain.fail("walls", fmt::format("\"{}\" is a periodic side, which has no wall", side));
      def.closed[i] = true;
    }
  } else {
    if (walls != nullptr && walls->kind != Node::Kind::Boolean)
      domain.fail("walls",
                  fmt::format("is {}, right is true, false or a list of {}", kindName(walls->kind), choice(kSides)));
    const bool all = domain.boolean("walls", true);
    for (std::size_t i = 0; i < 4; ++i) def.closed[i] = all && !open[i];
  }
  def.slip = domain.word("wall_slip", {"free", "no"}, "free") == "no" ? Slip::NoSlip : Slip::Free;
  draft.slipPlace = domain.place("wall_slip");
  root.resolved().set("domain", domain.resolved());
}

namespace {

void checkNozzle(const TableReader& emitter, const EmitterDef& def, const Box& domain) {
  if (def.from == def.to) emitter.fail("to", "the nozzle has no length, right is another point than `from`");
  for (const auto& [key, point] : {std::pair{"from", def.from}, std::pair{"to", def.to}})
    if (!domain.contains(point))
      emitter.fail(key,
                   fmt::format("the nozzle's end [{}, {}] is outside the domain", show(point.x()), show(point.y())));
}

EmitterDef readEmitter(TableReader& emitter, const Box& domain) {
  EmitterDef def;
  const bool bullets = emitter.word("kind", {"fluid", "bullet"}, std::nullopt) == "bullet";
  def.kind = bullets ? EmitterDef::Kind::Bullet : EmitterDef::Kind::Fluid;
  def.from = emitter.vector("from");
  def.to = emitter.vector("to");
  checkNozzle(emitter, def, domain);
  def.speed = emitter.number("speed", bullets ? Range::notNegative(1e6) : Range::positive(1e6));
  for (const char* key : {"rate", "spread"})
    if (!bullets && emitter.has(key)) emitter.fail(key, "belongs to bullets, right is to leave it out");
  if (bullets) def.rate = emitter.number("rate", Range::positive(1e12));
  if (bullets) def.spread = kDegrees * emitter.number("spread", Range::between(0.0, 180.0), 0.0);
  def.start = emitter.number("start", Range::notNegative(), 0.0);
  if (const auto stop = emitter.optionalNumber("stop", Range{def.start, 1e9, true, false})) def.stop = *stop;
  if (const auto lifetime = emitter.optionalNumber("lifetime", Range::positive())) def.lifetime = *lifetime;
  def.limit = static_cast<std::size_t>(emitter.integer("limit", 1, std::int64_t{1} << 31, 1000000));
  const std::string policy = emitter.word("policy", {"refuse", "recycle-oldest", "grow"}, "refuse");
  def.policy = policy == "refuse" ? GrowthPolicy::Fixed
               : policy == "grow" ? GrowthPolicy::Grow
                                  : GrowthPolicy::RecycleOldest;
  def.name = emitter.path();
  return def;
}

}  // namespace

void readEmitters(TableReader& root, Draft& draft) {
  Node resolved = Node::array();
  for (TableReader& emitter : root.tables("emitter", {"kind", "from", "to", "speed", "rate", "spread", "start", "stop",
                                                      "lifetime", "limit", "policy"})) {
    WorldDef& world = draft.scene.world;
    world.emitters.push_back(readEmitter(emitter, world.domain.box));
    draft.emitterPlaces.push_back(emitter.place("from"));
    (world.emitters.back().kind == EmitterDef::Kind::Fluid ? draft.fluidEmitted : draft.bulletsEmitted) = true;
    resolved.items.push_back(emitter.resolved());
  }
  if (!resolved.items.empty()) root.resolved().set("emitter", std::move(resolved));
}

void readSinks(TableReader& root, Draft& draft) {
  Node resolved = Node::array();
  for (TableReader& sink : root.tables("sink", {"shape"})) {
    draft.scene.world.sinks.push_back({readShape(sink, "shape", draft)});
    resolved.items.push_back(sink.resolved());
  }
  if (!resolved.items.empty()) root.resolved().set("sink", std::move(resolved));
}

}  // namespace froude::scene
