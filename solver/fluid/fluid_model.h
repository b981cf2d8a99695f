// The one interface of all fluid methods.
#pragma once

#include <memory>

#include <froude/base/api.h>
#include <froude/particles/pool.h>
#include <froude/solver/step_context.h>

namespace froude {

/// Reach of a particle of that model [m].
FROUDE_API double supportOf(const FluidDef& def);

/// A bound on the sub-step and its name.
struct StepBound {
  double dt = kInfinity;  // [s]
  StepLimit limit = StepLimit::Requested;
  void tighten(double other, StepLimit why) {
    if (other < dt) *this = {other, why};
  }
};

/// Moves the fluid particles of a pool. Silent: it neither prints nor throws inside a step.
class FluidModel {
 public:
  virtual ~FluidModel() = default;

  /// Reach of a particle [m].
  virtual double supportRadius() const = 0;
  /// How far a particle may go in a sub-step before it counts as unstable [m].
  virtual double farthestTravel() const { return supportRadius(); }
  /// Of a sub-step's compression what decides whether it is undone: the largest, where that does not pass of itself.
  virtual double judgedCompression(const StepStats& stats) const { return stats.maxCompression; }
  /// Mass of a particle [kg/m].
  virtual double particleMass() const = 0;
  /// Does its pressure know the outlines of soft bodies (StepContext::softWalls)?
  virtual bool feelsSoftWalls() const { return false; }
  /// What its column "pressure" is times to be p/ρ: the share of a pressure gradient that its particles feel.
  virtual double pressureFactor() const { return 1.0; }
  /// The bounds that the present state puts on the next sub-step. maxSpeed [m/s] over all particles.
  virtual StepBound stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const = 0;
  /// One sub-step: velocities and positions to the end of it. The pool comes out sorted by cell.
  virtual void advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) = 0;
  /// State beside the pool's columns, if there is any.
  virtual void archive(Archive&) {}
  virtual std::size_t memoryBytes() const = 0;
};

/// Makes the model of that name and adds its columns to the pool. Throws Error for an unknown name.
FROUDE_API std::unique_ptr<FluidModel> makeFluidModel(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);

}  // namespace froude
