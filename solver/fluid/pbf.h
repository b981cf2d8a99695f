// Position based fluids: an incompressible fluid by density constraints at the positions, with pressures that are kept.
//
// Macklin & Müller, "Position based fluids", ACM Trans. Graph. 32 (2013), in the form of an implicit pressure solve:
// the accumulated multiplier of a constraint is the pressure p, its displacement dt²·a(p). Keeping p from step to step
// (warm start) makes the sweeps of all past steps count, which is what a deep fluid needs from a local method.
#pragma once

#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

class Pbf final : public ParticleFluid {
 public:
  Pbf(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);
  double pressureFactor() const override;

 private:
  void solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) override;
  void warmStart(const StepContext& context, ParticlePool& pool);
  void solveDensity(const StepContext& context, ParticlePool& pool, StepStats& stats);
  DensityLoop withBodies(DensityLoop loop) const;
  bool solved(double excess, int sweep, bool fresh) const;
  void stabilize(const StepContext& context, ParticlePool& pool);
};

}  // namespace froude
