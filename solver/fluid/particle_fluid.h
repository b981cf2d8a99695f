// What all particle methods share: prediction, cells, walls, the pressure that is kept, paths to the end of a sub-step,
// nozzles, viscosity, drag and surface tension. A method adds how it finds its pressures.
#pragma once

#include <froude/base/aligned.h>
#include <froude/base/parallel.h>
#include <froude/particles/cell_grid.h>
#include <froude/solver/coupling/contact_log.h>
#include <froude/solver/fluid/arrangement.h>
#include <froude/solver/fluid/body_drag.h>
#include <froude/solver/fluid/body_response.h>
#include <froude/solver/fluid/coarse_pressure.h>
#include <froude/solver/fluid/fluid_model.h>
#include <froude/solver/fluid/kernel.h>
#include <froude/solver/fluid/pair_loops.h>
#include <froude/solver/fluid/surface_tension.h>
#include <froude/solver/fluid/wall_layer.h>

namespace froude {

/// Lengths of the solve are in units of half a kernel's support radius, which is the spacing dx but for wcsph;
/// pressures are κ = p·dt²/(ρ·unit²).
class ParticleFluid : public FluidModel {
 public:
  double supportRadius() const final;
  double particleMass() const final;
  bool feelsSoftWalls() const override { return true; }
  StepBound stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const override;
  void advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) final;
  std::size_t memoryBytes() const override;

 protected:
  /// What binds the sub-step of a method, and how much it smooths velocities.
  struct Settings {
    double courant;  // of the support radius a sub-step
    // Largest κ, of twice the typical pressure and of the highest one: beyond, the arrangement of the particles rings.
    double typicalStiffness, largestStiffness;
    double smoothing;  // XSPH, times √κ: a viscosity of smoothing·dx·√p on any step
    kernel::Kind kernel = kernel::Kind::Blend;
  };
  ParticleFluid(const FluidDef& def, const DomainDef& domain, ParticlePool& pool, const Settings& settings);

  /// Finds κ and the displacement that it makes, shift and, of that, what counts as velocity, solved; tells free bodies
  /// of it and leaves the densities at the end.
  virtual void solvePressure(const StepContext& context, ParticlePool& pool, StepStats& stats) = 0;

  PairFrame frame() const;
  /// Runs a loop over all cells, adds up what its tasks return.
  template <typename Loop>
  double sumOverCells(Loop&& loop) {
    excess_.resize(blockCount(occupied_.size(), kCellBlock));
    parallelFor(occupied_.size(), kCellBlock,
                [&](std::size_t begin, std::size_t end) { excess_[begin / kCellBlock] = loop(begin, end); });
    double sum = 0.0;
    for (const double part : excess_) sum += part;
    return sum;
  }
  double runDensity(const StepContext& context, const DensityLoop& loop);
  /// With the walls as they are, at the present coordinates.
  DensityLoop densityLoop(float* density, float* diagonal, const PressureUpdate& update) const;
  void runDisplacement(const StepContext& context, const float* pressure, float* kappa, bool asVelocity = true);
  /// What a nozzle carries goes back to where it was predicted; what it was to move by is booked as velocity, or not.
  void holdCarried(bool asVelocity);
  /// For methods that use it: fills `near_`.
  void findNear(const StepContext& context);
  /// For methods that use it: fills `arrangement_`, and by particle the density Σ W + λ and Σ|∇W|².
  void findArrangement(const StepContext& context, float* density, float* squares);
  /// For methods that use it: fills `wallGain_` with what the walls' own motion adds to λ in a time.
  void findWallGain(const StepContext& context, double time);
  /// The coarse level of a pressure solve: which cells are full, by density; then, to `change_`, the κ that takes away
  /// what is in excess, by particle.
  void buildCoarse(const StepContext& context, const float* density);
  void solveCoarse(const float* excess);
  void dropCoarse() { coarse_ = CoarsePressure(); }
  void liftFromCoarse(const StepContext& context, const ParticlePool& pool, const float* excess);
  void judgeDensity(const StepContext& context, ParticlePool& pool, StepStats& stats);
  double pressureUnit(double dt) const;  // κ of one m²/s²: dt²/dx²
  /// What binds the sub-step but viscosity; speed [m/s] and acceleration [m/s²] are the largest.
  StepBound flowBound(const ParticlePool& pool, double maxSpeed, double acceleration) const;

  static constexpr float kNever = 1e6f;           // density at which a film bears
  static constexpr std::size_t kCellBlock = 128;  // cells a task, about 500 particles
  static constexpr float kLoose = 0.02f;          // below 1 − this a particle is free to be compressed
  static constexpr double kRelaxation = 0.6;      // of a Jacobi sweep; its spectral radius is 2.5 (walls included)

  FluidDef def_;
  DomainDef domain_;
  double unit_;    // [m]
  double volume_;  // of a particle in units², over the kernel's sum on its lattice
  // Share of a velocity's Laplacian that Morris' term feels.
  double laplacianMoment_ = kernel::kLaplacianMoment;
  double pairViscosity_ = 0.0;  // between particles, on top of the fluid's own [m²/s]
  ColumnId<float> pressure_, density_;
  CellGrid grid_;
  WallLayer walls_;
  BodyResponse bodies_;
  SurfaceTension tension_;
  // Scratch of a sub-step, by index; lengths in spacings where not said otherwise.
  AlignedArray<double> predictedX_, predictedY_;  // [m]
  AlignedArray<std::int32_t> latticeX_, latticeY_, nextX_, nextY_;
  AlignedArray<float> shiftX_, shiftY_, solvedX_, solvedY_, kappa_, change_, target_, diagonal_;
  Arrangement arrangement_;
  AlignedArray<float> wallGain_;
  AlignedArray<std::uint8_t> near_;  // rows of neighbours for the loops that use them; empty: none
  AlignedArray<float> velocityX_, velocityY_, smoothX_, smoothY_;  // [m/s]
  double largestPressure_ = 0.0;  // |p/ρ| at the start of a sub-step, at its end once it is judged [m²/s²]
  struct Carried {
    std::uint32_t particle;
    Vec2 spared;  // displacement that it did not make [dx]
  };
  std::vector<Carried> carried_;  // by a nozzle
  std::vector<std::uint32_t> occupied_;

 private:
  void predict(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);
  void sortByCell(const StepContext& context, ParticlePool& pool);
  void meetWalls(const StepContext& context);
  void linkBodies(const StepContext& context);
  // particle_tension.cpp
  void pullSurface(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses);
  double tensionWork(const StepContext& context, const ParticlePool& pool) const;
  void finishPositions(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);
  // particle_viscosity.cpp
  void tightenByViscosity(const ParticlePool& pool, StepBound& bound) const;
  void applyViscosity(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses);
  void smoothVelocities(ParticlePool& pool);
  void dragAlongWalls(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses) const;
  void startVelocitySolve(const StepContext& context, const ParticlePool& pool, float share);
  void solveVelocities(const StepContext& context, const ViscosityLoop& loop);
  void spreadResidual();
  void takeSolvedVelocities(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses);
  void runViscosity(const StepContext& context, const ViscosityLoop& loop);
  void spareCarried(const StepContext& context, const float* changeX, const float* changeY);

  CollisionFilter filter() const { return {def_.group, def_.collidesWith}; }
  void addFieldGravity(const StepContext& context, const ParticlePool& pool, StepStats& stats) const;
  void wrapPeriodic(ParticlePool& pool);
  void findCarried(const StepContext& context, const ParticlePool& pool);
  void bookCarried(const StepContext& context, const ParticlePool& pool, ImpulseLedger& impulses) const;
  void resizeScratch(std::size_t n);
  BodyResponse::Units bodyUnits(double dt) const { return {unit_, particleMass(), particleMass() * unit_ / dt}; }
  /// p/ρ [m²/s²].
  struct PressureScale {
    double largest, typical;
  };
  PressureScale pressureScale(const ParticlePool& pool) const;

  Settings settings_;
  CoarsePressure coarse_;
  BodyDrag dragged_;
  AlignedArray<CellRuns> runs_;
  std::vector<double> excess_;  // one a task
  ContactLog contacts_;
  std::vector<std::uint32_t> crushed_;            // counts, one a block
  std::vector<std::vector<ParticleLeak>> leaks_;  // lists, one a block; empty but for what went wrong
};

}  // namespace froude
