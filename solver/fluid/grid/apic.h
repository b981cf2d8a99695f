// Affine particle-in-cell: particles carry velocity and its gradient, a staggered grid under them carries the pressure.
// One global solve a step, so that the cost does not grow with the fluid's depth.
//
// C. Jiang et al., "The affine particle-in-cell method", ACM Trans. Graph. 34(4), 2015. What differs and why:
// docs/decisions/solver-apic.md.
#pragma once

#include <froude/solver/coupling/contact_log.h>
#include <froude/solver/fluid/fluid_model.h>
#include <froude/solver/fluid/grid/grid_pressure.h>
#include <froude/solver/fluid/grid/grid_viscosity.h>

namespace froude {

/// Cells of two spacings, four particles each. Memory and work follow the fluid.
class Apic final : public FluidModel {
 public:
  /// Adds its columns to the pool. Error for a fluid or a domain that it cannot do.
  Apic(const FluidDef& def, const DomainDef& domain, ParticlePool& pool);

  double supportRadius() const override;
  double farthestTravel() const override;
  /// Of the fluid as a whole: where drops meet blocks are over-full for a few sub-steps, however short those are.
  double judgedCompression(const StepStats&) const override { return overFull_; }
  double particleMass() const override;
  StepBound stepBound(const ParticlePool& pool, double maxSpeed, double gravity) const override;
  void advance(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats) override;
  std::size_t memoryBytes() const override;

 private:
  void sortParticles(ParticlePool& pool);
  void loadParticles(const ParticlePool& pool);
  void cutCells(const StepContext& context);
  void findCarried(const StepContext& context, const ParticlePool& pool);
  Vec2 addGravity(const StepContext& context, const ParticlePool& pool);
  void addGravityWork(const StepContext& context, const ParticlePool& pool, StepStats& stats) const;
  Vec2 takeVelocities(ParticlePool& pool) const;
  void holdCarried(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses);
  void startPressure(const StepContext& context, const ParticlePool& pool);
  double cellReynolds(double speed, double acceleration) const;
  int rub(const StepContext& context);
  void spreadChange();
  Obstacles::Distance wallBehind(const Obstacles& obstacles, const Vec2& at) const;
  void holdWalls(const StepContext& context);
  float heldBySticking(const FaceComponent& c, std::size_t place, int axis, const Obstacles::Distance& wall,
                       const Vec2& surface, float without) const;
  void keepDifferences(const StepContext& context, const ParticlePool& pool);
  void addDifferences();
  void moveParticles(const StepContext& context, ParticlePool& pool);
  void meetWalls(const StepContext& context, ParticlePool& pool, ImpulseLedger& impulses, StepStats& stats);
  void bookWalls(const StepContext& context, const Vec2& gained, ImpulseLedger& impulses);
  void takePressure(const StepContext& context, ParticlePool& pool);
  CollisionFilter filter() const { return {def_.group, def_.collidesWith}; }
  GridParticles columns() const;

  FluidDef def_;
  DomainDef domain_;
  CutGrid grid_;
  ColumnId<float> pressure_, density_;
  std::array<ColumnId<float>, 4> gradient_;  // [1/s]
  CutCells cuts_;
  std::uint64_t fixedVersion_ = 0;
  std::vector<CutOutline> outlines_;
  std::vector<Vec2> centers_;
  ParticleTiles particles_;
  FaceField faces_;
  GridPressure solver_;
  GridViscosity viscosity_;
  double overFull_ = 0.0;  // density of all cells of fluid together, less 1
  bool rubbed_ = false;    // in this sub-step
  // Scratch of a sub-step, by index.
  AlignedArray<float> x_, y_, u_, v_, dx_, dy_;  // [cells] and [m/s]
  std::array<AlignedArray<float>, 4> gradientScratch_;
  AlignedArray<float> keptX_, keptY_;  // of what FLIP keeps, by particle [m/s]
  struct Carried {
    std::uint32_t particle;
    Vec2 velocity;  // [m/s]
  };
  std::vector<Carried> carried_;       // by a nozzle
  AlignedArray<float> heldX_, heldY_;  // by face [m/s]
  ContactLog contacts_;
  std::vector<std::uint32_t> crushed_;
  std::vector<std::vector<ParticleLeak>> leaks_;
};

}  // namespace froude
