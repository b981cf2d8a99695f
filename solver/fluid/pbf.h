// Position based fluids: an incompressible fluid by density constraints at the positions, with pressures that are kept.
//
// Macklin & Müller, "Position based fluids", ACM Trans. Graph. 32 (2013), in the form of an implicit pressure solve:
// the accumulated multiplier of a constraint is the pressure p, its displacement dt²·a(p). Keeping p from step to step
// (warm start) makes the sweeps of all past steps count, which is what a deep fluid needs from a local method.
#pragma once

#include <froude/base/aligned.h>
#include <froude/particles/cell_grid.h>
#include <froude/solver/coupling/contact_log.h>
#include <froude/solver/fluid/body_response.h>
#include <froude/solver/fluid/coarse_pressure.h>
#include <froude/solver/fluid/fluid_model.h>
#include <froude/solver/fluid/pair_loops.h>
#include <froude/solver/fluid/wall_layer.h>

namespace froude {

class Pbf final : public FluidModel {
 public:
  Pbf(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);

  double supportRadius() const override;
  double particleMass() const override;
  StepBound stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const override;
  void advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) override;
  std::size_t memoryBytes() const override;

 private:
  // The paper's steps (Algorithm 1), in order.
  void predict(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);
  void sortByCell(const StepContext& context, ParticlePool& pool);
  void meetWalls(const StepContext& context);
  void warmStart(const StepContext& context, ParticlePool& pool);
  void solveDensity(const StepContext& context, ParticlePool& pool, StepStats& stats);
  void liftFromCoarse(const StepContext& context, const ParticlePool& pool);
  bool solved(double excess, int sweep, bool fresh) const;
  void stabilize(const StepContext& context, ParticlePool& pool);
  void judgeDensity(const StepContext& context, ParticlePool& pool, StepStats& stats);
  void finishPositions(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);
  void smoothVelocities(const StepContext& context, ParticlePool& pool);
  void dragAlongWalls(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) const;

  CollisionFilter filter() const { return {def_.group, def_.collidesWith}; }
  void addFieldGravity(const StepContext& context, const ParticlePool& pool, StepStats& stats) const;
  void wrapPeriodic(ParticlePool& pool);
  void findCarried(const StepContext& context, const ParticlePool& pool);
  void holdCarried(bool asVelocity);
  void bookCarried(const StepContext& context, const ParticlePool& pool, ImpulseLedger& impulses) const;
  PairFrame frame() const;
  double runDensity(const StepContext& context, float* density, float* diagonal, const PressureUpdate& update);
  void runDisplacement(const StepContext& context, const float* pressure, float* kappa, bool asVelocity = true);
  void resizeScratch(std::size_t n);
  /// p/ρ [m²/s²].
  struct PressureScale {
    double largest, typical;
  };
  PressureScale pressureScale(const ParticlePool& pool) const;
  BodyResponse::Units bodyUnits(double dt) const { return {dx_, particleMass(), particleMass() * dx_ / dt}; }
  double pressureUnit(double dt) const;  // κ of one m²/s²: dt²/dx²

  FluidDef def_;
  DomainDef domain_;
  double dx_;
  double courant_;
  ColumnId<float> pressure_, density_;
  CellGrid grid_;
  WallLayer walls_;
  BodyResponse bodies_;
  CoarsePressure coarse_;
  std::vector<std::uint32_t> occupied_;
  AlignedArray<CellRuns> runs_;
  // Scratch of a sub-step, by index; lengths in spacings where not said otherwise.
  AlignedArray<double> predictedX_, predictedY_;  // [m]
  AlignedArray<std::int32_t> latticeX_, latticeY_, nextX_, nextY_;
  AlignedArray<float> shiftX_, shiftY_, solvedX_, solvedY_, kappa_, change_, correction_, target_, diagonal_;
  AlignedArray<float> velocityX_, velocityY_, smoothX_, smoothY_;  // [m/s]
  std::vector<double> excess_;                                     // one a task
  double largestPressure_ = 0.0;  // p/ρ at the start of a sub-step, at its end once it is judged [m²/s²]
  struct Carried {
    std::uint32_t particle;
    Vec2 spared;  // displacement that it did not make [dx]
  };
  std::vector<Carried> carried_;  // by a nozzle
  ContactLog contacts_;
  std::vector<std::uint32_t> crushed_;            // counts, one a block
  std::vector<std::vector<ParticleLeak>> leaks_;  // lists, one a block; empty but for what went wrong
};

}  // namespace froude
