// The sections of a scene that say what moves: [model], [fluid], [bullet] and their blocks.
#include <fmt/format.h>
#include <froude/solver/model_card.h>

#include "scene/draft.h"

namespace froude::scene {

namespace {

constexpr double kDegrees = kPi / 180.0;
const Node kEmptyTable;

void readFilter(TableReader& table, std::uint32_t& group, std::uint32_t& collidesWith) {
  constexpr std::int64_t kAll = 0xFFFFFFFF;
  group = static_cast<std::uint32_t>(table.integer("group", 0, kAll, 1));
  collidesWith = static_cast<std::uint32_t>(table.integer("collides_with", 0, kAll, kAll));
}

/// A table of the root, or an empty one where the file leaves it out.
TableReader tableOrEmpty(TableReader& root, const std::string& key, const std::vector<std::string>& keys) {
  if (!root.has(key)) return {root.file(), kEmptyTable, key, keys};
  return *root.table(key, keys);
}

/// Reads [[fluid.block]] or [[bullet.block]]; returns their resolved tables.
Node readBlocks(TableReader& species, bool bullets, std::vector<BlockDraft>& blocks, Draft& draft) {
  Node resolved = Node::array();
  for (TableReader& block : species.tables("block", {"shape", "velocity", bullets ? "count" : "cut"})) {
    BlockDraft b;
    b.shape = readShape(block, "shape", draft);
    if (bullets) b.count = static_cast<std::size_t>(block.integer("count", 1, std::int64_t{1} << 50));
    b.velocity = block.expressions("velocity", "xy", {0.0, 0.0});
    if (!bullets) b.cut = block.boolean("cut", true);
    b.place = block.place("shape");
    b.velocityPlace = block.place("velocity");
    if (bullets) b.countPlace = block.place("count");
    b.path = block.path();
    blocks.push_back(std::move(b));
    resolved.items.push_back(block.resolved());
  }
  return resolved;
}

/// Documented in docs/scene-format.md: a hundredth of the larger side of the largest block; without blocks a twentieth
/// of the longest fluid nozzle.
double defaultSpacing(const Draft& draft) {
  double side = 0.0, nozzle = 0.0;
  for (const BlockDraft& block : draft.fluidBlocks) side = std::max(side, block.shape->bounds().size().maxCoeff());
  for (const EmitterDef& emitter : draft.scene.world.emitters)
    if (emitter.kind == EmitterDef::Kind::Fluid) nozzle = std::max(nozzle, (emitter.to - emitter.from).norm());
  return side > 0.0 ? side / 100.0 : nozzle / 20.0;
}

FluidDef readFluidDef(TableReader& fluid) {
  FluidDef def;
  def.density = fluid.number("density", Range::positive(1e12), 1000.0);
  def.viscosity = fluid.number("viscosity", Range::notNegative(1e6), 1.0e-6);
  def.surfaceTension = fluid.number("surface_tension", Range::notNegative(1e6), 0.0);
  def.contactAngle = kDegrees * fluid.number("contact_angle", Range::between(0.0, 180.0), 90.0);
  readFilter(fluid, def.group, def.collidesWith);
  return def;
}

constexpr std::array kCompressibleKeys{
    "support", "sound_speed", "density_diffusion", "artificial_viscosity", "background_pressure", "equation_of_state"};

void readCompressible(TableReader& model, CompressibleDef& def) {
  def.support = model.number("support", Range::between(2.0, 6.0), def.support);
  if (const auto c = model.optionalNumber("sound_speed", Range::positive(1e6))) def.soundSpeed = *c;
  def.densityDiffusion = model.number("density_diffusion", Range::between(0.0, 1.0), def.densityDiffusion);
  def.artificialViscosity = model.number("artificial_viscosity", Range::between(0.0, 1.0), 0.0);
  def.backgroundPressure = model.number("background_pressure", Range::notNegative(1e12), 0.0);
  def.equation = model.word("equation_of_state", {"linear", "tait"}, "linear") == "tait" ? EquationOfState::Tait
                                                                                         : EquationOfState::Linear;
}

void refuseWhatApicLacks(TableReader& model, const FluidDef& def) {
  if (def.surfaceTension > 0.0) {
    model.fail("fluid",
               "apic has no surface tension in this version, right are pbf, dfsph and wcsph, or surface_tension = 0");
  }
  for (const char* key : {"sweeps", "viscosity_solver"}) {
    if (model.has(key)) model.fail(key, "a key of particle methods, right is to leave it out");
  }
}

void readSweeps(TableReader& model, FluidDef& def) {
  if (model.has("sweeps")) def.sweeps = static_cast<int>(model.integer("sweeps", 1, 1000));
  const std::string solver = model.word("viscosity_solver", {"auto", "explicit", "implicit"}, "auto");
  def.viscositySolver = solver == "auto"       ? ViscositySolver::Auto
                        : solver == "explicit" ? ViscositySolver::Explicit
                                               : ViscositySolver::Implicit;
}

void readModel(TableReader& model, bool fluidUsed, Draft& draft, FluidDef& def) {
  std::vector<std::string> here, absent;
  for (const char* name : {"pbf", "dfsph", "wcsph", "apic"})
    (findModelCard(name) != nullptr ? here : absent).emplace_back(name);
  def.model = model.word("fluid", here, "pbf", absent);
  const Range spacing{1e-9, 1e6, false, false};
  if (fluidUsed) {
    def.spacing = model.number("spacing", spacing, defaultSpacing(draft));
  } else {
    model.optionalNumber("spacing", spacing);
  }
  const double most = def.model == "apic" ? 7.0 : 1.0;
  if (const auto courant = model.optionalNumber("courant", Range::between(0.01, most))) def.courant = *courant;
  if (const auto flip = model.optionalNumber("flip", Range::between(0.0, 1.0))) {
    if (def.model != "apic") model.fail("flip", "a key of apic, right is to leave it out");
    def.flip = *flip;
  }
  if (def.model == "apic") {
    refuseWhatApicLacks(model, def);
  } else {
    readSweeps(model, def);
  }
  if (def.model == "wcsph") {
    readCompressible(model, def.compressible);
  } else {
    for (const char* key : kCompressibleKeys) {
      if (model.has(key)) model.fail(key, "a key of wcsph alone, right is to leave it out or fluid = \"wcsph\"");
    }
  }
  SoftSettings& soft = draft.scene.world.softSettings;
  if (model.has("soft_substeps")) soft.substeps = static_cast<int>(model.integer("soft_substeps", 1, 1000000));
  if (const auto tolerance = model.optionalNumber("soft_tolerance", Range::positive(1.0))) soft.tolerance = *tolerance;
  draft.scene.world.timeStep = model.optionalNumber("time_step", Range::positive(1e6));
  draft.timeStepPlace = model.place("time_step");
  if (model.has("spacing")) draft.spacingPlace = model.place("spacing");
}

}  // namespace

void readBullets(TableReader& root, Draft& draft) {
  TableReader table =
      tableOrEmpty(root, "bullet", {"radius", "density", "friction", "restitution", "group", "collides_with", "block"});
  BulletDef bullet;
  bullet.radius = table.number("radius", Range::positive(1e6), 0.002);
  bullet.density = table.number("density", Range::positive(1e12), 1000.0);
  bullet.friction = table.number("friction", Range::notNegative(1e3), 0.0);
  bullet.restitution = table.number("restitution", Range::between(0.0, 1.0), 0.5);
  readFilter(table, bullet.group, bullet.collidesWith);
  Node blocks = readBlocks(table, true, draft.bulletBlocks, draft);
  const bool used = !draft.bulletBlocks.empty() || draft.bulletsEmitted;
  if (!used && root.has("bullet"))
    draft.scene.notes.push_back("bullet: no [[bullet.block]] and no bullet emitter, so no bullets are modelled");
  if (!used) return;
  draft.scene.world.bullet = bullet;
  if (!blocks.items.empty()) table.resolved().set("block", std::move(blocks));
  root.resolved().set("bullet", table.resolved());
}

void readFluid(TableReader& root, Draft& draft) {
  if (const Node* node = root.find("fluid");
      node != nullptr && node->kind == Node::Kind::Array && node->items.size() > 1)
    root.fail(node->items[1], "fluid", "a second fluid, one fluid per scene is right (its blocks are [[fluid.block]])");
  TableReader table = tableOrEmpty(
      root, "fluid", {"density", "viscosity", "surface_tension", "contact_angle", "group", "collides_with", "block"});
  FluidDef fluid = readFluidDef(table);
  Node blocks = readBlocks(table, false, draft.fluidBlocks, draft);
  const bool used = !draft.fluidBlocks.empty() || draft.fluidEmitted;
  if (!used && root.has("fluid"))
    draft.scene.notes.push_back("fluid: no [[fluid.block]] and no fluid emitter, so no fluid is modelled");
  TableReader model = tableOrEmpty(root, "model",
                                   {"fluid", "spacing", "time_step", "sweeps", "courant", "flip", "viscosity_solver",
                                    "support", "sound_speed", "density_diffusion", "artificial_viscosity",
                                    "background_pressure", "equation_of_state", "soft_substeps", "soft_tolerance"});
  readModel(model, used, draft, fluid);
  root.resolved().set("model", model.resolved());
  if (!used) return;
  draft.scene.world.fluid = fluid;
  if (!blocks.items.empty()) table.resolved().set("block", std::move(blocks));
  root.resolved().set("fluid", table.resolved());
}

}  // namespace froude::scene
