// Weakly compressible SPH with density diffusion and particle shifting: the fluid is a little elastic, and its pressure
// follows from its density. No system is solved; the steps are those of sound.
//
// Density diffusion: Antuono et al., "Free-surface flows solved by means of SPH schemes with numerical diffusive
// terms", Comput. Phys. Commun. 181 (2010). Shifting: Sun et al., "The δplus-SPH model", Comput. Methods Appl. Mech.
// Eng. 315 (2017). What differs and why: docs/decisions/solver-wcsph.md.
#pragma once

#include <froude/base/api.h>
#include <froude/solver/fluid/particle_fluid.h>

namespace froude {

/// The acoustic step [s] where the fastest moves at `speed` > 0 [m/s], and sound at ten times that or the shortest
/// capillary waves, or as defined. For predictions.
FROUDE_API double acousticStepAt(const FluidDef& def, double speed);

/// A sub-step is one set of cells and walls for a number of acoustic steps, each symplectic: velocities by the
/// pressures, densities by these velocities, positions. The column "density" is what was integrated, not a sum.
class Wcsph final : public ParticleFluid {
 public:
  Wcsph(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);
  StepBound stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const override;
  bool feelsSoftWalls() const override { return false; }  // it drives light ones: docs/decisions/solver-soft.md
  void archive(Archive& archive) override;
  std::size_t memoryBytes() const override;

 private:
  void solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) override;
  double acousticStep(double speed) const;
  void chooseSoundSpeed(const StepContext& context, const ParticlePool& pool);
  void start(const StepContext& context, const ParticlePool& pool, int steps, bool fresh);
  void spreadTension(const StepContext& context, int steps);
  void findDiagonal();
  void limitStiffness();
  void giveBack();
  // wcsph_start.cpp
  void findTurning(const StepContext& context);
  void findStartPressure(const StepContext& context);
  bool liftStartPressure(const StepContext& context);
  bool sweepStartPressure(const StepContext& context);
  void startFromNothing(float step);
  void findStartRates(const StepContext& context);
  double liftStart(const StepContext& context);
  double sweepStart(const StepContext& context, float momentum);
  void takePressures(bool byEquation);
  ForceLoop forceLoop(float* ux, float* uy);
  RateLoop rateLoop(const float* ux, const float* uy);
  void accelerate(const StepContext& context, const ForceLoop& loop);
  void kick(const StepContext& context, int step, int steps);
  void compress(const StepContext& context, const RateLoop& loop);
  void compressAndDrift(const StepContext& context, int steps, bool last);
  void quietFilms();
  void finish(const StepContext& context, ParticlePool& pool, int steps);

  double soundSpeed_ = 0.0;                  // c [m/s]; 0 until the first sub-step
  double flowSpeed_ = 0.0;                   // largest where kernels are full [m/s]
  float stiffness_ = 0.0f;                   // (c dt/unit)² of an acoustic step
  float background_ = 0.0f;                  // ρ' that makes the background pressure
  AlignedArray<float> excess_, nextExcess_;  // ρ/ρ0 − 1
  // Velocity, as displacement in an acoustic step, and gravity's share of it: what the viscosity needs comes after.
  AlignedArray<float>&moveX_ = velocityX_, &moveY_ = velocityY_;
  AlignedArray<float>&fallX_ = smoothX_, &fallY_ = smoothY_;
  AlignedArray<float> turning_;                  // of the start alone
  AlignedArray<float> least_;                    // ρ' that a particle may have: 0 for one that is alone
  AlignedArray<float> sign_;                     // −1 where differences of pressure are felt, else 1
  std::vector<std::array<double, 2>> pairSums_;  // by task
  Vec2 taken_{0.0, 0.0};       // by those in tension, of the momentum of all [units in an acoustic step]
  AlignedArray<float> share_;  // of a gain of density
};

}  // namespace froude
