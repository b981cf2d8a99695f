// Divergence-free SPH: an incompressible fluid by two solves a sub-step, one for velocities, one for positions.
//
// Bender & Koschier, "Divergence-free SPH for incompressible and viscous fluids", IEEE Trans. Vis. Comput. Graph. 23
// (2017), with three changes (docs/decisions/solver-dfsph.md): the solve for densities moves particles and leaves their
// velocities (Hu & Adams, J. Comput. Phys. 227 (2007)); gradients are corrected (gradient_correction.h); pressures may
// be negative inside the fluid, so that particles there are also drawn apart evenly (Lind et al., J. Comput. Phys. 231
// (2012)).
#pragma once

#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

class Dfsph final : public ParticleFluid {
 public:
  Dfsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);
  std::size_t memoryBytes() const override;

 private:
  void solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) override;
  void prepareSystem(const ParticlePool& pool);
  void warmStart(const StepContext& context, const ParticlePool& pool);
  void solveDivergence(const StepContext& context, ParticlePool& pool, StepStats& stats);
  void solveDensity(const StepContext& context, ParticlePool& pool);
  double runDivergence(const StepContext& context);
  void push(const StepContext& context, const float* pressure, float* kappa);
  void giveBack();
  void evenOut();

  double pace_ = 1.0;                    // of the sub-step: its length over the one that the flow asks for, at most 1
  AlignedArray<std::uint8_t> tense_;     // 1 where differences of pressure are felt, not sums
  AlignedArray<float> totalX_, totalY_;  // displacement in the sub-step
  AlignedArray<float> least_;            // lowest κ: none inside, else 0
};

}  // namespace froude
