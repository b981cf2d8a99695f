// What callers change between steps: bodies that come, go and are moved, particles that are added and taken away.
#include <array>

#include <froude/base/parallel.h>
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

// Distance of a point to the polygon's boundary [m]. Cost: its edges.
double boundaryDistance(const Polygon& polygon, const Vec2& p) {
  double least = kInfinity;
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    const Vec2& a = polygon.edgeStart(e);
    const Vec2 along = polygon.edgeEnd(e) - a;
    const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (a + share * along - p).squaredNorm());
  }
  return std::sqrt(least);
}

void requireFinite(const Vec2& v, double w, const char* what) {
  if (!v.allFinite() || !std::isfinite(w)) throw Error(std::string(what) + " of a body must be finite");
}

void requireIndex(std::size_t index, std::size_t count) {
  if (index >= count) throw Error("there is no body " + std::to_string(index) + " of " + std::to_string(count));
}

}  // namespace

// ---- bodies

std::size_t World::Impl::requireBody(BodyId id) const {
  const std::optional<std::size_t> index = bodies.indexOf(id);
  if (index) return *index;
  if (id.isNull()) throw Error("the body's id is null");
  throw Error("the body of id {" + std::to_string(id.slot) + ", " + std::to_string(id.generation) +
              "} is not in this world, or no longer");
}

void World::Impl::bodiesChanged() {
  obstaclesStale = true;
  ++version;
}

// Rebuilt when somebody looks, so that a hundred bodies are created at the price of one field.
const Obstacles& World::Impl::solids() const {
  if (obstaclesStale) {
    obstacles->rebuild(bodies);
  } else if (obstaclesBehind) {
    obstacles->beginStep(bodies, 0.0, 0.0);
  }
  obstaclesStale = obstaclesBehind = false;
  return *obstacles;
}

// What stands where a body was put has no place any more.
void World::Impl::crushUnder(std::size_t body) {
  const BodyDef& shape = bodies.definition(body);
  const Transform pose = bodies.motion(body).transform();
  auto crush = [&](ParticlePool& pool, Species species, double radius) {
    const CollisionFilter filter = filterOf(species);
    if (!filter.accepts(shape.group, shape.collidesWith)) return;
    const Polygon& polygon = *bodies.shape(body);
    const Box local = polygon.bounds().grown(radius);
    const auto x = pool.x(), y = pool.y();
    parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        visitImages(def.domain, [&](const Vec2& shift) {
          const Vec2 p = pose.toLocal(Vec2(x[i], y[i]) + shift);
          if (!local.contains(p)) return false;
          const bool under = polygon.contains(p) || boundaryDistance(polygon, p) < radius;
          if (under) pool.kill(static_cast<std::uint32_t>(i));
          return under;
        });
      }
    });
    dropMarked(pool, ledger.crushed);
  };
  if (fluid != nullptr) crush(*fluid, Species::Fluid, 0.0);
  if (bullets != nullptr) crush(*bullets, Species::Bullet, def.bullet->radius);
}

BodyId World::createBody(const BodyDef& def) {
  const BodyId id = impl_->bodies.add(def);
  const std::size_t i = impl_->bodies.size() - 1;
  impl_->bodyStates.push_back(impl_->stateOf(i));
  impl_->edited = impl_->edited || def.motion == Motion::Free;
  impl_->bodiesChanged();
  impl_->crushUnder(i);
  return id;
}

void World::destroyBody(BodyId id) {
  const std::size_t i = impl_->requireBody(id);
  impl_->edited = impl_->edited || impl_->bodies.isFree(i);
  impl_->bodies.remove(i);
  impl_->bodyStates.erase(impl_->bodyStates.begin() + static_cast<std::ptrdiff_t>(i));
  impl_->bodiesChanged();
}

void World::placeBody(BodyId id, const Vec2& position, double angle) {
  const std::size_t i = impl_->requireBody(id);
  requireFinite(position, angle, "the new pose");
  impl_->bodies.place(i, position, angle);
  impl_->edited = impl_->edited || impl_->bodies.isFree(i);
  impl_->bodyStates[i].transform = Transform::of(position, angle);
  impl_->bodyStates[i].angle = angle;
  impl_->bodiesChanged();
  impl_->crushUnder(i);
}

void World::setBodyVelocity(BodyId id, const Vec2& velocity, double spin) {
  const std::size_t i = impl_->requireBody(id);
  requireFinite(velocity, spin, "the new velocity");
  const BodyDef& def = impl_->bodies.definition(i);
  if (def.motion == Motion::Fixed) {
    throw Error("body '" + def.name +
                "' is fixed and has no velocity; make it scripted or free, or place it elsewhere");
  }
  impl_->edited = impl_->edited || def.motion == Motion::Free;
  if (!def.script.empty()) throw Error("body '" + def.name + "' gets its velocity from its script; leave that empty");
  impl_->bodies.setVelocity(i, velocity, spin);
  impl_->bodyStates[i].velocity = velocity;
  impl_->bodyStates[i].spin = spin;
}

void World::steerBody(BodyId id, const Vec2& position, double angle, double duration) {
  if (!(duration > 0.0)) throw Error("the duration of a body's way must be positive");
  const std::size_t i = impl_->requireBody(id);
  const BodyMotion& m = impl_->bodies.motion(i);
  const Vec2 wanted = Transform::of(position, angle).toWorld(impl_->bodies.frameOrigin(i));
  setBodyVelocity(id, (wanted - m.position) / duration, (angle - m.angle) / duration);
}

std::size_t World::bodyCount() const { return impl_->bodies.size(); }
bool World::isAlive(BodyId id) const { return impl_->bodies.indexOf(id).has_value(); }
BodyId World::bodyId(std::size_t index) const {
  requireIndex(index, bodyCount());
  return impl_->bodies.id(index);
}
std::size_t World::bodyIndex(BodyId id) const { return impl_->requireBody(id); }
const BodyState& World::body(std::size_t index) const {
  requireIndex(index, bodyCount());
  return impl_->bodyStates[index];
}
const BodyState& World::body(BodyId id) const { return impl_->bodyStates[impl_->requireBody(id)]; }
const BodyDef& World::bodyDefinition(std::size_t index) const {
  requireIndex(index, bodyCount());
  return impl_->bodies.definition(index);
}
const BodyDef& World::bodyDefinition(BodyId id) const { return impl_->bodies.definition(impl_->requireBody(id)); }

std::size_t World::bodyIndex(std::string_view name) const {
  std::string known;
  for (std::size_t i = 0; i < bodyCount(); ++i) {
    const std::string& own = impl_->bodies.definition(i).name;
    if (own == name) return i;
    if (i < 10) known += (i > 0 ? ", " : "") + own;
  }
  throw Error("no body is named '" + std::string(name) + "'; there are: " + (known.empty() ? "none" : known));
}

// ---- particles

CollisionFilter World::Impl::filterOf(Species species) const {
  if (species == Species::Fluid) {
    return def.fluid ? CollisionFilter{def.fluid->group, def.fluid->collidesWith} : CollisionFilter{};
  }
  return def.bullet ? CollisionFilter{def.bullet->group, def.bullet->collidesWith} : CollisionFilter{};
}

ParticlePool& World::Impl::requirePool(Species species) const {
  if (species == Species::Soft) throw Error("particles of a soft body do not come or go alone");
  ParticlePool* pool = species == Species::Fluid ? fluid.get() : bullets.get();
  if (pool != nullptr) return *pool;
  throw Error(species == Species::Fluid ? "this world has no fluid; set WorldDef::fluid"
                                        : "this world has no bullets; set WorldDef::bullet");
}

// `present` is what the last sub-step left. What callers did since is work and impulse from outside.
void World::Impl::admitEdits() {
  if (obstaclesStale || anyParticles()) static_cast<void>(solids());
  if (!edited) return;
  edited = false;
  if (!started) return;
  const Balance now = balance();
  const double work = now.energy() - present.energy();
  const Vec2 impulse = now.momentum - present.momentum;
  if (work != 0.0) ledger.work += work;
  if (impulse.squaredNorm() != 0.0) ledger.impulse += impulse;
  ledger.maxKinetic = std::max(ledger.maxKinetic, now.kinetic);
  present = now;
}

std::size_t World::Impl::dropMarked(ParticlePool& pool, std::uint64_t& counter) {
  return bookRemoved(pool, pool.compact(), counter);
}

// Before the first step there are no accounts: what is there then is the start.
std::size_t World::Impl::bookRemoved(const ParticlePool& pool, std::size_t count, std::uint64_t& counter) {
  if (count == 0) return 0;
  edited = true;
  ++version;
  if (!started) return count;
  counter += count;
  if (&pool == fluid.get()) ledger.massRetired += static_cast<double>(count) * massOf(pool);
  return count;
}

std::vector<ParticleHandle> World::add(Species species, std::span<const Vec2> positions,
                                       std::span<const Vec2> velocities) {
  Impl& w = *impl_;
  ParticlePool& pool = w.requirePool(species);
  if (positions.size() != velocities.size()) throw Error("as many velocities as positions are needed");
  const CollisionFilter filter = w.filterOf(species);
  const Obstacles& solids = w.solids();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!velocities[i].allFinite()) throw Error("the velocity of particle " + std::to_string(i) + " is not finite");
    if (!w.def.domain.box.contains(positions[i]) || solids.distance(positions[i], filter).distance < 0.0) {
      throw Error("particle " + std::to_string(i) + " at (" + std::to_string(positions[i].x()) + ", " +
                  std::to_string(positions[i].y()) + ") lies inside a solid or outside the domain");
    }
  }
  pool.reserve(pool.size() + positions.size());
  const auto expires = species == Species::Fluid ? w.fluidExpires : w.bulletExpires;
  std::vector<ParticleHandle> handles;
  handles.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    handles.push_back(pool.create());
    const std::size_t k = pool.size() - 1;
    pool.x()[k] = positions[i].x();
    pool.y()[k] = positions[i].y();
    pool.vx()[k] = velocities[i].x();
    pool.vy()[k] = velocities[i].y();
    pool.column(expires)[k] = kInfinity;
  }
  w.edited = true;
  ++w.version;
  if (w.started) {
    w.ledger.added += positions.size();
    if (species == Species::Fluid) w.ledger.massEmitted += static_cast<double>(positions.size()) * w.massOf(pool);
  }
  return handles;
}

std::vector<ParticleHandle> World::addFluid(std::span<const Vec2> positions, std::span<const Vec2> velocities) {
  return add(Species::Fluid, positions, velocities);
}

std::vector<ParticleHandle> World::addBullets(std::span<const Vec2> positions, std::span<const Vec2> velocities) {
  return add(Species::Bullet, positions, velocities);
}

bool World::kill(Species species, ParticleHandle particle) {
  ParticlePool& pool = impl_->requirePool(species);
  return pool.tryRelease(particle) && impl_->bookRemoved(pool, 1, impl_->ledger.killed) > 0;
}

std::size_t World::kill(Species species, const Area& area) {
  ParticlePool& pool = impl_->requirePool(species);
  const auto x = pool.x(), y = pool.y();
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (area.contains({x[i], y[i]})) pool.kill(static_cast<std::uint32_t>(i));
    }
  });
  return impl_->dropMarked(pool, impl_->ledger.killed);
}

void World::setForce(ForceCallback force) { impl_->def.force = std::move(force); }
void World::record(const EventSettings& settings) {
  impl_->events.settings = settings;
  impl_->events.clear();
}

// Who may write into columns may have written.
ParticlePool* World::fluid() {
  impl_->edited = true;
  ++impl_->version;
  return impl_->fluid.get();
}
ParticlePool* World::bullets() {
  impl_->edited = true;
  ++impl_->version;
  return impl_->bullets.get();
}

}  // namespace froude
