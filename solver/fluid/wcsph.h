// Weakly compressible SPH with density diffusion and particle shifting: the fluid is a little elastic, and its pressure
// follows from its density. No system is solved; the steps are those of sound.
//
// Density diffusion: Antuono et al., "Free-surface flows solved by means of SPH schemes with numerical diffusive terms",
// Comput. Phys. Commun. 181 (2010). Shifting: Sun et al., "The δplus-SPH model", Comput. Methods Appl. Mech. Eng. 315
// (2017). What differs and why: docs/decisions/solver-wcsph.md.
#pragma once

#include <froude/solver/fluid/gradient_correction.h>
#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

/// A sub-step is one set of cells and walls for a number of acoustic steps, each symplectic: velocities by the
/// pressures, densities by these velocities, positions.
class Wcsph final : public ParticleFluid {
 public:
  Wcsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);
  StepBound stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const override;
  void archive(Archive& archive) override;
  std::size_t memoryBytes() const override;

 private:
  void solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) override;
  void findArrangement(const StepContext& context, ParticlePool& pool);
  void findWallGain(const StepContext& context);
  double acousticStep(double speed) const;
  void chooseSoundSpeed(const StepContext& context, const ParticlePool& pool);
  void start(const StepContext& context, ParticlePool& pool, int steps);
  void takePressures();
  void accelerate(const StepContext& context);
  void compress(const StepContext& context);
  void drift();
  void finish(const StepContext& context, ParticlePool& pool, int steps);

  double soundSpeed_ = 0.0;  // c [m/s]; 0 until the first sub-step
  float stiffness_ = 0.0f;   // (c dt/dx)² of an acoustic step
  float maxSpeed_ = 0.0f;    // [m/s] where kernels are full
  GradientCorrection correction_;
  AlignedArray<GradientCorrection::Place> place_;
  AlignedArray<float> momentXX_, momentXY_, momentYY_;  // M; κB during the steps
  AlignedArray<float> skewX_, skewY_;                   // S = Σ∇W
  AlignedArray<float> wallGain_;                        // what the walls' own motion adds to λ in an acoustic step
  AlignedArray<float> excess_, nextExcess_;             // ρ/ρ0 − 1
  AlignedArray<float> moveX_, moveY_;                   // velocity, as displacement in an acoustic step
  AlignedArray<float> wayX_, wayY_;                     // since the start of the sub-step
  AlignedArray<float> fallX_, fallY_;                   // gravity's share of `move` in an acoustic step
};

}  // namespace froude
