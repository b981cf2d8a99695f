// What surface tension gives to particles and walls in a sub-step, and its work (docs/models/surface_tension.md).
#include <froude/solver/fluid/lattice.h>
#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

// As if it had been a part of the acceleration that was predicted, so that the pressures answer to it at once.
// Particles of a nozzle go their way; what they are spared is the nozzle's.
void ParticleFluid::pullSurface(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) {
  const std::size_t n = pool.size();
  tension_.find(context, frame(), walls_, {predictedX_.data(), n}, {predictedY_.data(), n});
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const double unit = tension_.unit() * context.dt;
  for (Carried& c : carried_) c.spared -= context.dt / unit_ * Vec2(vx[c.particle], vy[c.particle]);
  // Where the outline meets a wall is said by the positions that it was found at.
  tension_.forEachWallPull([&](const SurfaceTension::WallPull& p) {
    const Vec2 at = Vec2(predictedX_[p.particle], predictedY_[p.particle]) + unit_ * p.at;
    impulses.add(p.owner, at, -particleMass() * unit * p.pull, context.obstacles.velocityAt(p.owner, at));
  });
  auto give = [&](std::uint32_t i, const Vec2& pull) {
    vx[i] += unit * pull.x();
    vy[i] += unit * pull.y();
    predictedX_[i] = x[i] + context.dt * vx[i];
    predictedY_[i] = y[i] + context.dt * vy[i];
  };
  tension_.forEachPull([&](const SurfaceTension::Pull& p) {
    give(p.first, p.pull);
    give(p.second, -p.pull);
  });
  tension_.forEachWallPull([&](const SurfaceTension::WallPull& p) { give(p.particle, p.pull); });
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    c.spared += context.dt / unit_ * Vec2(vx[i], vy[i]);
    give(i, -unit_ / (context.dt * unit) * c.spared);
  }
  auto place = [&](std::uint32_t i) {
    latticeX_[i] = lattice::coordinate((predictedX_[i] - domain_.box.min.x()) / unit_);
    latticeY_[i] = lattice::coordinate((predictedY_[i] - domain_.box.min.y()) / unit_);
  };
  tension_.forEachPull([&](const SurfaceTension::Pull& p) {
    place(p.first);
    place(p.second);
  });
  tension_.forEachWallPull([&](const SurfaceTension::WallPull& p) { place(p.particle); });
}

// Along the displacements of the sub-step, those of walls taken off; where a surface shrinks it is what the surface
// loses.
double ParticleFluid::tensionWork(const StepContext& context, const ParticlePool& pool) const {
  const auto vx = pool.vx(), vy = pool.vy();
  double power = 0.0;
  tension_.forEachPull([&](const SurfaceTension::Pull& p) {
    power -= p.pull.dot(Vec2(vx[p.second] - vx[p.first], vy[p.second] - vy[p.first]));
  });
  tension_.forEachWallPull([&](const SurfaceTension::WallPull& p) {
    const Vec2 at = Vec2(pool.x()[p.particle], pool.y()[p.particle]) + unit_ * p.at;
    power += p.pull.dot(Vec2(vx[p.particle], vy[p.particle]) - context.obstacles.velocityAt(p.owner, at));
  });
  return particleMass() * tension_.unit() * context.dt * power;
}

}  // namespace froude
