// Viscosity of particle methods: smoothing, the laminar term, and the drag of walls that stick.
#include <froude/base/parallel.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

void ParticleFluid::smoothVelocities(const StepContext& context, ParticlePool& pool) {
  const auto vx = pool.vx(), vy = pool.vy();
  const std::size_t n = pool.size();
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      velocityX_[i] = static_cast<float>(vx[i]);
      velocityY_[i] = static_cast<float>(vy[i]);
    }
  });
  const PairFrame pairs = frame();
  const double stiffness = pressureUnit(context.dt) * largestPressure_;
  const double viscousUnit = 2.0 * def_.viscosity * context.dt / (dx_ * dx_);
  const ViscosityLoop loop{velocityX_.data(),
                           velocityY_.data(),
                           static_cast<float>(settings_.smoothing * std::sqrt(stiffness)),
                           static_cast<float>(viscousUnit / kernel::kLaplacianMoment),
                           smoothX_.data(),
                           smoothY_.data()};
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.viscosity(pairs, loop, begin, end); });
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    if (walls_.tangent()[i] > 0.0f) {  // of its way along a wall the share λ is the wall's
      const Vec2 along = leftNormal(Vec2(walls_.gradientX()[i], walls_.gradientY()[i]).normalized());
      c.spared -= static_cast<double>(walls_.lambda()[i]) * along.dot(c.spared) * along;
    }
    c.spared += context.dt / dx_ * Vec2(static_cast<double>(smoothX_[i]), static_cast<double>(smoothY_[i]));
    smoothX_[i] = smoothY_[i] = 0.0f;
  }
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vx[i] += static_cast<double>(smoothX_[i]);
      vy[i] += static_cast<double>(smoothY_[i]);
    }
  });
}

// Implicit, v = (v + Σ c v_wall)/(1 + Σ c): a particle on a wall moves with it, on any step.
void ParticleFluid::dragAlongWalls(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) const {
  if (def_.viscosity == 0.0 || !context.obstacles.anySticks()) return;
  const double unit = 2.0 * def_.viscosity * context.dt / (dx_ * dx_);
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  walls_.forEachParticle([&](std::span<const WallLink> links) {
    const std::uint32_t i = links.front().particle;
    const Vec2 at(x[i], y[i]);
    auto wall = [&](const WallLink& link) {
      return context.obstacles.surfaceVelocityAt(link.owner, at, Vec2(link.normalX, link.normalY));
    };
    double total = 0.0;
    Vec2 pull(vx[i], vy[i]);
    for (const WallLink& link : links) {
      const double c = unit * static_cast<double>(link.drag);
      total += c;
      if (c > 0.0) pull += c * wall(link);
    }
    if (total == 0.0) return;
    const Vec2 v = pull / (1.0 + total);
    for (const WallLink& link : links) {
      const double c = unit * static_cast<double>(link.drag);
      if (c > 0.0) impulses.add(link.owner, at, particleMass() * c * (v - wall(link)), wall(link));
    }
    vx[i] = v.x();
    vy[i] = v.y();
  });
}

}  // namespace froude
