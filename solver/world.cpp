#include <froude/solver/world.h>

#include <array>

#include <froude/base/parallel.h>
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

std::unique_ptr<ParticlePool> makePool(const std::string& name) {
  return std::make_unique<ParticlePool>(PoolSettings{4096, GrowthPolicy::Grow, name});
}

double reachOf(const WorldDef& def) {
  const double fluid = def.fluid ? supportOf(*def.fluid) : 0.0;
  const double bullet = def.bullet ? 2.0 * def.bullet->radius : 0.0;
  const double domain = 1e-3 * def.domain.box.size().norm();  // a world without particles still has fields
  return std::max(fluid, bullet) > 0.0 ? std::max(fluid, bullet) : domain;
}

// A particle must not be its own neighbour's neighbour twice; found in a step, this would be an exception there.
void checkPeriod(const WorldDef& def) {
  const Vec2 size = def.domain.box.size();
  const double least = 4.0 * supportOf(*def.fluid);
  if ((def.domain.periodicX && size.x() < least) || (def.domain.periodicY && size.y() < least)) {
    throw Error(
        "a fluid's domain must be at least four kernel radii long (8 spacings; with wcsph 4 times its support) along a "
        "periodic axis");
  }
}

}  // namespace

World::Impl::Impl(const WorldDef& definition)
    : def(definition),
      gravity(definition.gravity, definition.gravityField),
      bodies(definition.bodies),
      rigid(definition.domain) {
  if (def.domain.box.empty() || !(def.domain.box.size().minCoeff() > 0.0)) {
    throw Error("domain.box is empty; give [xmin, ymin, xmax, ymax] with min < max");
  }
  if (!def.gravity.allFinite()) throw Error("gravity must be finite");
  if (def.timeStep && !(*def.timeStep > 0.0)) throw Error("timeStep must be a positive number of seconds");
  if (def.fluid) {
    if (!(def.fluid->spacing > 0.0)) throw Error("fluid spacing must be a positive length");
    if (!(def.fluid->density > 0.0)) throw Error("fluid density must be positive");
    if (!(def.fluid->viscosity >= 0.0) || !std::isfinite(def.fluid->viscosity)) {
      throw Error("fluid viscosity must be at least 0 m²/s");
    }
    if (!(def.fluid->surfaceTension >= 0.0) || !std::isfinite(def.fluid->surfaceTension)) {
      throw Error("fluid surface tension must be at least 0 N");
    }
    if (!(def.fluid->contactAngle >= 0.0 && def.fluid->contactAngle <= kPi)) {
      throw Error("the contact angle must be between 0 and pi rad");
    }
    checkPeriod(def);
    fluid = makePool("fluid");
    fluidModel = makeFluidModel(*def.fluid, def.domain, *fluid);
    fluidExpires = fluid->addColumn<double>("expires", ColumnKind::State);
    fluidSource = fluid->addColumn<std::uint32_t>("source", ColumnKind::State);
    const bool nozzles = std::any_of(def.emitters.begin(), def.emitters.end(),
                                     [](const EmitterDef& e) { return e.kind == EmitterDef::Kind::Fluid; });
    if (nozzles) fluidCarried = fluid->addColumn<double>("carried_until", ColumnKind::State);
  }
  if (def.bullet) {
    if (!(def.bullet->radius > 0.0)) throw Error("bullet radius must be a positive length");
    if (!(def.bullet->density > 0.0)) throw Error("bullet density must be positive");
    if (!(def.bullet->friction >= 0.0)) throw Error("bullet friction must be at least 0");
    if (!(def.bullet->restitution >= 0.0 && def.bullet->restitution <= 1.0)) {
      throw Error("bullet restitution must be between 0 and 1");
    }
    bullets = makePool("bullets");
    ballistic = std::make_unique<Ballistic>(*def.bullet);
    bulletExpires = bullets->addColumn<double>("expires", ColumnKind::State);
    bulletSource = bullets->addColumn<std::uint32_t>("source", ColumnKind::State);
  }
  for (std::size_t k = 0; k < def.emitters.size(); ++k) {
    const EmitterDef& e = def.emitters[k];
    const bool isFluid = e.kind == EmitterDef::Kind::Fluid;
    if (isFluid ? fluid == nullptr : bullets == nullptr) {
      throw Error("emitter '" + e.name + "' emits " + (isFluid ? "fluid" : "bullets") + ", but the world has none");
    }
    emitters.emplace_back(e, def.fluid ? def.fluid->spacing : 0.0, def.seed, k);
    anyLifetime = anyLifetime || std::isfinite(e.lifetime);
  }
  for (std::size_t k = 0; k < def.sinks.size(); ++k) {
    if (def.sinks[k].shape == nullptr) throw Error("sink " + std::to_string(k) + " has no shape");
    sinks.add(*def.sinks[k].shape);
  }
  obstacles = std::make_unique<Obstacles>(def.domain, bodies, reachOf(def));
  bodyStates.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) bodyStates[i] = stateOf(i);
  gravityScale = def.gravity.norm();
  if (!gravity.isConstant()) {  // the largest on a 5 × 5 sample of the domain at the start
    gravityScale = 0.0;
    for (int k = 0; k < 25; ++k) {
      const Vec2 p = def.domain.box.min + def.domain.box.size().cwiseProduct(Vec2(0.25 * (k % 5), 0.25 * (k / 5)));
      gravityScale = std::max(gravityScale, gravity.at(p, 0.0).norm());
    }
  }
}

World::World(const WorldDef& def) : impl_(std::make_unique<Impl>(def)) {
  for (const SoftDef& soft : def.soft) addSoft(soft);
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

double World::time() const { return impl_->time; }
const WorldDef& World::definition() const { return impl_->def; }
const Ledger& World::ledger() const { return impl_->ledger; }
const ParticlePool* World::fluid() const { return impl_->fluid.get(); }
const ParticlePool* World::bullets() const { return impl_->bullets.get(); }
double World::fluidMass() const { return impl_->fluidModel ? impl_->fluidModel->particleMass() : 0.0; }
double World::bulletMass() const { return impl_->ballistic ? impl_->ballistic->mass() : 0.0; }

Totals World::totals(std::optional<Species> species) const {
  Totals all;
  auto addTotals = [&](const Totals& t) {
    all.count += t.count;
    all.mass += t.mass;
    all.kinetic += t.kinetic;
    all.potential += t.potential;
    all.strain += t.strain;
    all.momentum += t.momentum;
    all.angular += t.angular;
    all.maxSpeed = std::max(all.maxSpeed, t.maxSpeed);
  };
  auto add = [&](const ParticlePool* pool, double mass) {
    if (pool == nullptr) return;
    addTotals(impl_->totalsOf(*pool, mass));
  };
  if (!species || *species == Species::Fluid) add(impl_->fluid.get(), fluidMass());
  if (!species || *species == Species::Bullet) add(impl_->bullets.get(), bulletMass());
  if (impl_->soft != nullptr && (!species || *species == Species::Soft)) addTotals(impl_->softTotals());
  if (!species) addTotals(impl_->bodyTotals());
  return all;
}

void World::filledFraction(std::span<const Vec2> points, std::span<double> phi) const {
  if (impl_->fluid == nullptr) {
    std::fill(phi.begin(), phi.end(), 0.0);
    return;
  }
  impl_->query.update(*impl_->fluid, impl_->def.domain, impl_->def.fluid->spacing, impl_->version);
  const CollisionFilter filter = impl_->filterOf(Species::Fluid);
  const Obstacles& solids = impl_->solids();
  parallelFor(points.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) phi[i] = impl_->query.filledFraction(solids, filter, points[i]);
  });
}

double World::pressureAt(const Vec2& point) const {
  if (impl_->fluid == nullptr) return std::nan("");
  impl_->query.update(*impl_->fluid, impl_->def.domain, impl_->def.fluid->spacing, impl_->version);
  const auto pressure = impl_->fluid->column(*impl_->fluid->findColumn<float>("pressure"));
  return impl_->fluidModel->pressureFactor() * impl_->def.fluid->density *
         impl_->query.mean(point, [&](std::uint32_t i) { return static_cast<double>(pressure[i]); });
}

Vec2 World::velocityAt(const Vec2& point) const {
  if (impl_->fluid == nullptr) return {std::nan(""), std::nan("")};
  impl_->query.update(*impl_->fluid, impl_->def.domain, impl_->def.fluid->spacing, impl_->version);
  const ParticlePool& pool = *impl_->fluid;
  return {impl_->query.mean(point, [&](std::uint32_t i) { return pool.vx()[i]; }),
          impl_->query.mean(point, [&](std::uint32_t i) { return pool.vy()[i]; })};
}

std::string World::stateHash() const {
  HashingArchive hashing;
  impl_->archive(hashing);
  return hashing.hash().hex();
}

void World::archive(Archive& a) {
  // What is saved takes memory of its own: the copy for undoing and the cells of questions make room for it.
  impl_->snapshot = MemorySnapshot();
  impl_->query = FluidQuery();
  impl_->archive(a);
  if (!a.loading()) return;
  ++impl_->version;
  impl_->events.clear();
}

}  // namespace froude
