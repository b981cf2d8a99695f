// Divergence-free SPH: an incompressible fluid by two linear solves a sub-step, one for velocities, one for positions.
//
// Bender & Koschier, "Divergence-free SPH for incompressible and viscous fluids", IEEE Trans. Vis. Comput. Graph. 23
// (2017). The velocities are made free of divergence where the particles come to be; what their densities then are too
// high or too low is shifted away, which is no velocity (Hu & Adams, J. Comput. Phys. 227 (2007)).
#pragma once

#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

class Dfsph final : public ParticleFluid {
 public:
  Dfsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);
  std::size_t memoryBytes() const override;

 private:
  void solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) override;
  void prepare(const StepContext& context, ParticlePool& pool);
  void solveDivergence(const StepContext& context, ParticlePool& pool, StepStats& stats);
  void solveDensity(const StepContext& context, ParticlePool& pool, StepStats& stats);
  void push(const StepContext& context, const float* pressure, float* kappa);
  void findWallGain(const StepContext& context);

  AlignedArray<float> totalX_, totalY_;  // displacement in the sub-step
  AlignedArray<float> skewX_, skewY_;
  struct Field {
    AlignedArray<float> xx, xy, yy;
    Matrices<float> out() { return {xx.data(), xy.data(), yy.data()}; }
    Matrices<const float> in() const { return {xx.data(), xy.data(), yy.data()}; }
  };
  Field correction_, scaled_;            // B, κB
  AlignedArray<float> least_;            // lowest κ: 0 at a free surface, else none
  AlignedArray<float> wallGain_;         // what the walls' own motion adds to λ
};

}  // namespace froude
