// Questions between steps: rays, areas, and what the last step told.
#include <froude/base/parallel.h>
#include <froude/solver/world_impl.h>

namespace froude {
namespace {

// Cost: the polygon's edges.
Vec2 nearestOnBoundary(const Polygon& polygon, const Vec2& p) {
  Vec2 nearest(kInfinity, kInfinity);
  double least = kInfinity;
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    const Vec2& a = polygon.edgeStart(e);
    const Vec2 along = polygon.edgeEnd(e) - a;
    const Vec2 on = a + std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
    if ((on - p).squaredNorm() >= least) continue;
    least = (on - p).squaredNorm();
    nearest = on;
  }
  return nearest;
}

}  // namespace

RayHit World::castRay(const Vec2& from, const Vec2& to, const CollisionFilter& filter) const {
  const Obstacles::RayHit hit = impl_->solids().ray(from, to, filter);
  const double length = (to - from).norm();
  if (!hit.hit) return {false, {}, to, {0.0, 0.0}, length, false};
  const BodyId body = hit.body >= 0 ? impl_->bodies.id(static_cast<std::size_t>(hit.body)) : BodyId{};
  return {true, body, hit.point, hit.normal, hit.share * length, hit.startedInside};
}

void World::find(Species species, const Area& area, std::vector<std::uint32_t>& indices) const {
  const ParticlePool& pool = impl_->requirePool(species);
  const auto x = pool.x(), y = pool.y();
  auto inside = [&](std::size_t i) { return area.contains({x[i], y[i]}); };
  // Counted block by block, then written: the order is that of the columns on any number of threads.
  std::vector<std::size_t> start(blockCount(pool.size()) + 1, 0);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += inside(i) ? 1 : 0;
    start[begin / kBlockSize + 1] = count;
  });
  for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
  indices.resize(start.back());
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t at = start[begin / kBlockSize];
    if (at == start[begin / kBlockSize + 1]) return;
    for (std::size_t i = begin; i < end; ++i) {
      if (inside(i)) indices[at++] = static_cast<std::uint32_t>(i);
    }
  });
}

void World::findBodies(const Area& area, std::vector<BodyId>& found, const CollisionFilter& filter) const {
  found.clear();
  for (std::size_t i = 0; i < bodyCount(); ++i) {
    const BodyDef& def = impl_->bodies.definition(i);
    if (!filter.accepts(def.group, def.collidesWith)) continue;
    if (area.meets(*def.shape, impl_->bodyStates[i].transform)) found.push_back(impl_->bodies.id(i));
  }
}

BodyId World::bodyAt(const Vec2& point, const CollisionFilter& filter) const {
  const Obstacles::Distance nearest = impl_->solids().distance(point, filter);
  const DomainDef& domain = impl_->def.domain;
  // A body that reaches across a periodic side is told near that side only by the fields.
  if (nearest.distance > 0.0 && !domain.periodicX && !domain.periodicY) return {};
  if (nearest.distance <= 0.0 && nearest.body >= 0) return impl_->bodies.id(static_cast<std::size_t>(nearest.body));
  // Deeper than the fields are exact, or beyond a wall of the domain.
  BodyId holder;
  for (std::size_t i = 0; i < bodyCount() && holder.isNull(); ++i) {
    const BodyDef& def = impl_->bodies.definition(i);
    if (!filter.accepts(def.group, def.collidesWith)) continue;
    visitImages(domain, [&](const Vec2& shift) {
      if (!def.shape->contains(impl_->bodyStates[i].transform.toLocal(point + shift))) return false;
      holder = impl_->bodies.id(i);
      return true;
    });
  }
  return holder;
}

bool World::insideSolid(const Vec2& point, const CollisionFilter& filter) const {
  return impl_->solids().distance(point, filter).distance < 0.0;
}

// What a leaked particle is in, by exact location in every body: the fields know neither depth nor owner deep inside.
void World::Impl::explainLeaks(double dt) {
  for (LeakEvent& leak : events.freshLeaks()) {
    if (!leak.inside) continue;
    const CollisionFilter filter = filterOf(leak.species);
    leak.depth = kInfinity;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!filter.accepts(bodies.definition(i).group, bodies.definition(i).collidesWith)) continue;
      const Polygon& shape = *bodies.shape(i);
      const BodyMotion& m = bodies.motion(i);
      const Transform pose = Transform::of(m.position + dt * m.velocity, m.angle + dt * m.spin);
      visitImages(def.domain, [&](const Vec2& shift) {
        const Vec2 local = pose.toLocal(leak.position + shift);
        if (!shape.contains(local)) return false;
        const Vec2 boundary = nearestOnBoundary(shape, local);
        if ((boundary - local).norm() >= leak.depth) return false;
        leak.depth = (boundary - local).norm();
        leak.boundary = pose.toWorld(boundary) - shift;
        leak.body = bodies.id(i);
        return false;
      });
    }
    if (!leak.body.isNull()) continue;
    const Box& box = def.domain.box;
    leak.boundary = leak.position.cwiseMax(box.min).cwiseMin(box.max);
    leak.depth = (leak.position - leak.boundary).norm();
  }
}

std::span<const ContactEvent> World::contacts() const { return impl_->events.contacts(); }
std::span<const SinkEvent> World::swallowed() const { return impl_->events.sinks(); }
std::span<const LeakEvent> World::leaks() const { return impl_->events.leaks(); }

}  // namespace froude
