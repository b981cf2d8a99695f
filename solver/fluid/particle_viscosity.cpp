// Viscosity of particle methods: smoothing, the laminar term, and the drag of walls that stick; explicit, or by a solve
// for the velocities at the end of the sub-step where an explicit term would ask for a shorter one
// (docs/models/viscosity.md).
#include <froude/base/parallel.h>
#include <froude/solver/fluid/fluid_extent.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/particle_fluid.h>

namespace froude {
namespace {

// Measurements: docs/decisions/solver-viscosity.md.
constexpr double kExplicit = 0.125;       // largest ν·dt/dx² of an explicit term
constexpr double kWorthwhile = 2.0;       // times that a solve must lengthen the step
constexpr double kResolved = 0.0025;      // largest ν·dt/H² of a solve, H the smaller extent of the fluid
constexpr double kRounding = 1.0 + 1e-9;  // a step at the bound is explicit
constexpr double kTolerance = 1e-4;       // velocity left to be found, of what one sweep would change
constexpr int kMostIterations = 200;

// Σ of the loop's weights over the neighbours on the square lattice, for weights a and b.
double fullShare(float a, float b) {
  const double steep = -4.0 * (kernel::gradientFactor(1.0) + kernel::gradientFactor(2.0));
  return static_cast<double>(a) * (1.0 - kernel::value(0.0)) + static_cast<double>(b) * steep;
}

Vec2 surfaceVelocity(const StepContext& context, const WallLink& link, const Vec2& at) {
  return context.obstacles.surfaceVelocityAt(link.owner, at, Vec2(link.normalX, link.normalY));
}

}  // namespace

// A solve follows the diffusion across the whole fluid in time; what is smaller follows the flow around it.
void ParticleFluid::tightenByViscosity(const ParticlePool& pool, StepBound& bound) const {
  if (def_.viscosity == 0.0) return;
  const double term = kExplicit * unit_ * unit_ / def_.viscosity;
  const bool solves = def_.viscositySolver == ViscositySolver::Implicit ||
                      (def_.viscositySolver == ViscositySolver::Auto && bound.dt > kWorthwhile * term);
  if (!solves) return bound.tighten(term, StepLimit::Viscosity);
  const double extent = smallerExtent(pool, domain_, unit_);
  bound.tighten(std::max(kWorthwhile * term, kResolved * extent * extent / def_.viscosity), StepLimit::Viscosity);
}

void ParticleFluid::applyViscosity(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) {
  const auto vx = pool.vx(), vy = pool.vy();
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      velocityX_[i] = static_cast<float>(vx[i]);
      velocityY_[i] = static_cast<float>(vy[i]);
    }
  });
  const double stiffness = pressureUnit(context.dt) * largestPressure_;
  const double viscous = std::max(def_.viscosity, tension_.viscosity()) * context.dt / (unit_ * unit_);
  const double pairs = pairViscosity_ * context.dt / (unit_ * unit_);
  const ViscosityLoop loop{velocityX_.data(),
                           velocityY_.data(),
                           static_cast<float>(settings_.smoothing * std::sqrt(stiffness) * volume_),
                           static_cast<float>(2.0 * (viscous + pairs) * volume_ / laplacianMoment_),
                           smoothX_.data(),
                           smoothY_.data()};
  runViscosity(context, loop);
  const double least = def_.viscositySolver == ViscositySolver::Auto       ? kRounding * kExplicit
                       : def_.viscositySolver == ViscositySolver::Implicit ? 0.0
                                                                           : kInfinity;
  if (viscous > least) {
    startVelocitySolve(context, pool, static_cast<float>(fullShare(loop.a, loop.b)));
    solveVelocities(context, loop);
    takeSolvedVelocities(context, pool, impulses);
  } else {
    spareCarried(context, smoothX_.data(), smoothY_.data());
    smoothVelocities(pool);
    dragAlongWalls(context, pool, impulses);
  }
}

void ParticleFluid::runViscosity(const StepContext& context, const ViscosityLoop& loop) {
  const PairFrame pairs = frame();
  const PairLoops& loops = pairLoops(context.simd);
  parallelFor(occupied_.size(), kCellBlock,
              [&](std::size_t begin, std::size_t end) { loops.viscosity(pairs, loop, begin, end); });
}

// change [m/s]: what their neighbours would have made of them.
void ParticleFluid::spareCarried(const StepContext& context, const float* changeX, const float* changeY) {
  for (Carried& c : carried_) {
    const std::uint32_t i = c.particle;
    if (walls_.tangent()[i] > 0.0f) {  // of its way along a wall the share λ is the wall's
      const Vec2 along = leftNormal(Vec2(walls_.gradientX()[i], walls_.gradientY()[i]).normalized());
      c.spared -= static_cast<double>(walls_.lambda()[i]) * along.dot(c.spared) * along;
    }
    c.spared += context.dt / unit_ * Vec2(static_cast<double>(changeX[i]), static_cast<double>(changeY[i]));
  }
}

void ParticleFluid::smoothVelocities(ParticlePool& pool) {
  const auto vx = pool.vx(), vy = pool.vy();
  for (const Carried& c : carried_) smoothX_[c.particle] = smoothY_[c.particle] = 0.0f;
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vx[i] += static_cast<double>(smoothX_[i]);
      vy[i] += static_cast<double>(smoothY_[i]);
    }
  });
}

// Implicit, v = (v + Σ c v_wall)/(1 + Σ c): a particle on a wall moves with it, on any step.
void ParticleFluid::dragAlongWalls(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) const {
  if (def_.viscosity == 0.0 || !context.obstacles.anySticks()) return;
  const double unit = 2.0 * def_.viscosity * context.dt / (unit_ * unit_);
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  walls_.forEachParticle([&](std::span<const WallLink> links) {
    const std::uint32_t i = links.front().particle;
    const Vec2 at(x[i], y[i]);
    double total = 0.0;
    Vec2 pull(vx[i], vy[i]);
    for (const WallLink& link : links) {
      const double c = unit * static_cast<double>(link.drag);
      total += c;
      if (c > 0.0) pull += c * surfaceVelocity(context, link, at);
    }
    if (total == 0.0) return;
    const Vec2 v = pull / (1.0 + total);
    for (const WallLink& link : links) {
      const double c = unit * static_cast<double>(link.drag);
      const Vec2 wall = surfaceVelocity(context, link, at);
      if (c > 0.0) impulses.add(link.owner, at, particleMass() * c * (v - wall), wall);
    }
    vx[i] = v.x();
    vy[i] = v.y();
  });
}

// The solve: (1 + C)·d − L d = L v + Σ c (w − v) for the change d of the velocities v, L the sum over pairs, c the drag
// of a wall that moves at w and C = Σ c; free bodies give way (body_drag.h). For the change, because its rounding is
// then that of the change. What the sub-step no longer needs holds its vectors: shift the change, solved the residual,
// kappa C, diagonal the preconditioner, velocity the direction and smooth the direction's image.

// share: Σ of the weights of a full neighbourhood. Preconditioned by the diagonal of one, which only C makes vary much;
// carried particles have 0 there, so that they never change.
void ParticleFluid::startVelocitySolve(const StepContext& context, const ParticlePool& pool, float share) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      shiftX_[i] = shiftY_[i] = kappa_[i] = 0.0f;
      solvedX_[i] = smoothX_[i];
      solvedY_[i] = smoothY_[i];
      diagonal_[i] = 1.0f / (1.0f + share);
    }
  });
  for (const Carried& c : carried_) diagonal_[c.particle] = 0.0f;
  dragged_.begin(context.freeBodies, unit_, particleMass());
  if (!context.obstacles.anySticks()) return;
  const double unit = 2.0 * def_.viscosity * context.dt / (unit_ * unit_);
  walls_.forEachLink([&](const WallLink& link) {
    const std::uint32_t i = link.particle;
    if (link.drag == 0.0f || diagonal_[i] == 0.0f) return;
    const double c = unit * static_cast<double>(link.drag);
    const Vec2 at(x[i], y[i]), u = Vec2(vx[i], vy[i]) - surfaceVelocity(context, link, at);
    solvedX_[i] -= static_cast<float>(c * u.x());
    solvedY_[i] -= static_cast<float>(c * u.y());
    kappa_[i] += static_cast<float>(c);
    diagonal_[i] = 1.0f / (1.0f + share + kappa_[i]);
    if (dragged_.isFree(link.owner)) dragged_.add(i, link.owner, at, c, u);
  });
  dragged_.start(solvedX_.data(), solvedY_.data());
}

// Conjugate gradients, x and y as one system: the answer does not depend on how the axes lie.
void ParticleFluid::solveVelocities(const StepContext& context, const ViscosityLoop& loop) {
  const std::size_t n = grid_.size();
  struct Part {
    double energy, square;
  };
  auto sum = [&](auto&& body) {
    return reduceBlocks<Part>(n, {0.0, 0.0}, body, [](const Part& a, const Part& b) {
      return Part{a.energy + b.energy, a.square + b.square};
    });
  };
  const auto start = sum([&](std::size_t begin, std::size_t end) {
    Part part{0.0, 0.0};
    for (std::size_t i = begin; i < end; ++i) {
      velocityX_[i] = diagonal_[i] * solvedX_[i];
      velocityY_[i] = diagonal_[i] * solvedY_[i];
      part.energy += static_cast<double>(velocityX_[i] * solvedX_[i] + velocityY_[i] * solvedY_[i]);
      part.square += static_cast<double>(velocityX_[i] * velocityX_[i] + velocityY_[i] * velocityY_[i]);
    }
    return part;
  });
  const double enough = kTolerance * kTolerance * start.square;
  double energy = start.energy;
  for (int k = 0; k < kMostIterations; ++k) {
    runViscosity(context, loop);
    if (dragged_.any()) dragged_.answer(velocityX_.data(), velocityY_.data(), smoothX_.data(), smoothY_.data());
    const auto along = sum([&](std::size_t begin, std::size_t end) {
      Part part{0.0, 0.0};
      for (std::size_t i = begin; i < end; ++i) {
        smoothX_[i] = (1.0f + kappa_[i]) * velocityX_[i] - smoothX_[i];
        smoothY_[i] = (1.0f + kappa_[i]) * velocityY_[i] - smoothY_[i];
        part.energy += static_cast<double>(velocityX_[i] * smoothX_[i] + velocityY_[i] * smoothY_[i]);
      }
      return part;
    });
    if (!(along.energy > 0.0)) return;  // nothing is left to do
    const auto alpha = static_cast<float>(energy / along.energy);
    const auto left = sum([&](std::size_t begin, std::size_t end) {
      Part part{0.0, 0.0};
      for (std::size_t i = begin; i < end; ++i) {
        shiftX_[i] += alpha * velocityX_[i];
        shiftY_[i] += alpha * velocityY_[i];
        solvedX_[i] -= alpha * smoothX_[i];
        solvedY_[i] -= alpha * smoothY_[i];
        const float square = solvedX_[i] * solvedX_[i] + solvedY_[i] * solvedY_[i], own = 1.0f + kappa_[i];
        part.energy += static_cast<double>(diagonal_[i] * square);
        part.square += diagonal_[i] > 0.0f ? static_cast<double>(square / (own * own)) : 0.0;
      }
      return part;
    });
    if (left.square <= enough) return;
    const auto beta = static_cast<float>(left.energy / energy);
    energy = left.energy;
    parallelFor(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        velocityX_[i] = diagonal_[i] * solvedX_[i] + beta * velocityX_[i];
        velocityY_[i] = diagonal_[i] * solvedY_[i] + beta * velocityY_[i];
      }
    });
  }
  spreadResidual();
}

// A literal step that asks for more than all iterations give: what is left is no small change where it lies, but its
// sum belongs to the books, and is given to all particles alike.
void ParticleFluid::spreadResidual() {
  struct Part {
    double x, y, own;
  };
  const auto all = reduceBlocks<Part>(
      grid_.size(), {0.0, 0.0, 0.0},
      [&](std::size_t begin, std::size_t end) {
        Part part{0.0, 0.0, 0.0};
        for (std::size_t i = begin; i < end; ++i) {
          if (diagonal_[i] == 0.0f) continue;
          part.x += static_cast<double>(solvedX_[i]);
          part.y += static_cast<double>(solvedY_[i]);
          part.own += 1.0 + static_cast<double>(kappa_[i]);
        }
        return part;
      },
      [](const Part& a, const Part& b) {
        return Part{a.x + b.x, a.y + b.y, a.own + b.own};
      });
  if (all.own == 0.0) return;
  const auto x = static_cast<float>(all.x / all.own), y = static_cast<float>(all.y / all.own);
  parallelFor(grid_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (diagonal_[i] == 0.0f) continue;
      solvedX_[i] = (1.0f + kappa_[i]) * x;
      solvedY_[i] = (1.0f + kappa_[i]) * y;
    }
  });
}

// v + d + r/(1 + C), which is what pairs at v + d and the walls at the end make of v: with the residual r the books
// close exactly, whatever is left of it.
void ParticleFluid::takeSolvedVelocities(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  spareCarried(context, solvedX_.data(), solvedY_.data());
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (diagonal_[i] == 0.0f) continue;
      const float own = 1.0f + kappa_[i];
      vx[i] += static_cast<double>(shiftX_[i] + solvedX_[i] / own);
      vy[i] += static_cast<double>(shiftY_[i] + solvedY_[i] / own);
    }
  });
  if (!context.obstacles.anySticks()) return;
  const double unit = 2.0 * def_.viscosity * context.dt / (unit_ * unit_) * particleMass();
  dragged_.take(shiftX_.data(), shiftY_.data());
  std::size_t toBodies = 0;
  walls_.forEachLink([&](const WallLink& link) {
    const std::uint32_t i = link.particle;
    if (link.drag == 0.0f || diagonal_[i] == 0.0f) return;
    const Vec2 at(x[i], y[i]);
    Vec2 wall = surfaceVelocity(context, link, at);
    if (dragged_.isFree(link.owner)) wall += dragged_.gained(toBodies++);
    impulses.add(link.owner, at, unit * static_cast<double>(link.drag) * (Vec2(vx[i], vy[i]) - wall), wall);
  });
}

}  // namespace froude
