// Soft bodies of a world: making them, and what they tell.
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

void requireSoft(std::size_t index, std::size_t count) {
  if (index >= count) throw Error("there is no soft body " + std::to_string(index) + " of " + std::to_string(count));
}

}  // namespace

std::size_t World::Impl::addSoft(const SoftDef& definition) {
  if (def.domain.periodicX || def.domain.periodicY) {
    throw Error("soft body '" + definition.name + "': a domain with soft bodies has no periodic sides yet");
  }
  if (soft == nullptr) soft = std::make_unique<SoftBodies>(def.fluid.has_value());
  soft->add(definition);
  edited = true;
  ++version;
  return soft->count() - 1;
}

std::size_t World::addSoft(const SoftDef& def) {
  const CollisionFilter filter{def.group, def.collidesWith};
  const Obstacles& solids = impl_->solids();
  const Transform pose = Transform::of(def.position, def.angle);
  for (std::size_t k = 0; def.mesh != nullptr && k < def.mesh->points.size(); ++k) {
    if (std::find(def.pinned.begin(), def.pinned.end(), k) != def.pinned.end()) continue;
    const Vec2 at = pose.toWorld(def.mesh->points[k]);
    if (!impl_->def.domain.box.contains(at) || solids.distance(at, filter).distance < 0.5 * def.thickness - 1e-9) {
      throw Error("point " + std::to_string(k) + " of soft body '" + def.name + "' at (" + std::to_string(at.x()) +
                  ", " + std::to_string(at.y()) + ") lies inside a solid or outside the domain");
    }
  }
  return impl_->addSoft(def);
}

std::size_t World::softCount() const { return impl_->soft == nullptr ? 0 : impl_->soft->count(); }

const SoftDef& World::softDefinition(std::size_t index) const {
  requireSoft(index, softCount());
  return impl_->soft->body(index).def;
}

std::size_t World::softFirst(std::size_t index) const {
  requireSoft(index, softCount());
  return impl_->soft->first(index);
}

SoftState World::softState(std::size_t index) const {
  requireSoft(index, softCount());
  const SoftSums sums = impl_->soft->sumsOf(index);
  SoftState s;
  s.mass = sums.mass;
  s.area = impl_->soft->areaOf(index);
  s.kinetic = sums.kinetic;
  s.strain = sums.strain;
  s.center = sums.massCenter / sums.mass;
  s.momentum = sums.momentum;
  s.torn = impl_->soft->tornOf(index);
  return s;
}

void World::softStrain(std::size_t index, std::vector<double>& values) const {
  requireSoft(index, softCount());
  impl_->soft->strainOf(index, values);
}

const ParticlePool* World::soft() const { return impl_->soft == nullptr ? nullptr : &impl_->soft->pool(); }

ParticlePool* World::soft() {
  impl_->edited = true;
  ++impl_->version;
  return impl_->soft == nullptr ? nullptr : &impl_->soft->pool();
}

}  // namespace froude
