// The inside of World, shared by the files that step it, account for it and answer questions.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <froude/particles/emitter.h>
#include <froude/particles/sink.h>
#include <froude/solver/bullet/ballistic.h>
#include <froude/solver/coupling/free_bodies.h>
#include <froude/solver/event_log.h>
#include <froude/solver/fluid/fluid_model.h>
#include <froude/solver/fluid/fluid_query.h>
#include <froude/solver/rigid/body_set.h>
#include <froude/solver/rigid/rigid_solver.h>
#include <froude/solver/soft/soft_bodies.h>
#include <froude/solver/world.h>

namespace froude {

/// Mechanical state of all particles, for the ledger.
struct Balance {
  double kinetic = 0.0, potential = 0.0;  // [J/m]
  double strain = 0.0;                    // [J/m]
  Vec2 momentum{0.0, 0.0};                // [kg/s]
  double mass = 0.0;                      // [kg/m]
  double maxSpeed = 0.0;                  // [m/s]
  bool finite = true;
  double energy() const { return kinetic + potential + strain; }
};

/// visit(shift) for a point and its copies one period away along periodic axes; stops where visit returns true.
template <typename Visit>
void visitImages(const DomainDef& domain, Visit&& visit) {
  const Vec2 period = domain.box.size();
  const int nx = domain.periodicX ? 1 : 0, ny = domain.periodicY ? 1 : 0;
  for (int i = -nx; i <= nx; ++i) {
    for (int j = -ny; j <= ny; ++j) {
      if (visit(Vec2(i * period.x(), j * period.y()))) return;
    }
  }
}

struct World::Impl {
  explicit Impl(const WorldDef& definition);

  // Stages of a sub-step, in order (world_step.cpp).
  StepBound chooseStep(double maxDt) const;
  void quarantine();
  void advance(double dt, StepStats& stats);
  void moveBodies(double dt);
  void pushBodies(double dt);
  void explainLeaks(double dt);
  void judge(StepStats& stats, double dt);
  void retire();
  void tellSinks(const ParticlePool& pool);
  void emit(double dt);
  void findMouth(const EmitterDef& nozzle, double dt);
  bool hasRoom(const Vec2& at);
  Vec2 centerArmBefore(std::size_t body, double dt) const;
  void publishBodies(double dt);
  BodyState stateOf(std::size_t body) const;
  void account(const StepStats& stats, double dt);
  bool needsUndo() const {
    return fluidModel != nullptr || soft != nullptr || (bullets != nullptr && bodies.anyFree());
  }
  bool anyParticles() const { return fluid != nullptr || bullets != nullptr || soft != nullptr; }
  void archive(Archive& a);

  // The caller's force (world_force.cpp).
  void feelForce();
  void pushByForce(double dt, StepStats& stats);
  void finishForce(double dt, StepStats& stats);
  double accelerationScale() const { return gravityScale + forceScale; }

  std::size_t addSoft(const SoftDef& definition);  // world_soft.cpp

  // What callers change between steps (world_edit.cpp).
  void admitEdits();
  void bodiesChanged();
  const Obstacles& solids() const;
  std::size_t requireBody(BodyId id) const;
  void crushUnder(std::size_t body);
  std::size_t dropMarked(ParticlePool& pool, std::uint64_t& counter);
  std::size_t bookRemoved(const ParticlePool& pool, std::size_t count, std::uint64_t& counter);
  ParticlePool& requirePool(Species species) const;
  CollisionFilter filterOf(Species species) const;
  double massOf(const ParticlePool& pool) const {
    return &pool == fluid.get() ? fluidModel->particleMass() : ballistic->mass();
  }

  // Accounts (world_account.cpp).
  void openAccounts();
  double outsideWork(const StepStats& stats, const Balance& after, double dt) const;
  Vec2 fastestParticle() const;
  Totals totalsOf(const ParticlePool& pool, double mass) const;
  Totals bodyTotals() const;
  Totals softTotals() const;
  Balance balance() const;
  double potentialOf(const Vec2& x) const;  // per mass [J/kg]
  void remove(ParticlePool& pool, double mass, std::uint64_t& counter);
  double energyScale() const;

  WorldDef def;
  Gravity gravity;
  BodySet bodies;
  std::unique_ptr<ParticlePool> fluid, bullets;
  ColumnId<double> fluidExpires, bulletExpires;
  std::optional<ColumnId<double>> fluidCarried;
  ColumnId<std::uint32_t> fluidSource, bulletSource;
  std::unique_ptr<FluidModel> fluidModel;
  std::unique_ptr<Ballistic> ballistic;
  std::unique_ptr<SoftBodies> soft;
  std::unique_ptr<Obstacles> obstacles;
  RigidSolver rigid;
  RigidStats rigidStats;                 // of the present sub-step
  std::vector<Wrench> pressureBefore;    // impulse of the pressure that bodies were moved with, by body
  mutable bool obstaclesStale = false;   // bodies came, went or were put elsewhere
  mutable bool obstaclesBehind = false;  // bodies have moved where no particle asks for them
  std::vector<Emitter> emitters;
  SinkSet sinks;
  MemorySnapshot snapshot;
  AlignedArray<double> flat;  // work space of archive
  ImpulseLedger impulses;
  std::vector<BodyState> bodyStates;
  Ledger ledger;
  double time = 0.0;
  double gravityScale = 0.0;      // largest |g| seen [m/s²]
  Balance present;                // of the state as it stands
  std::vector<Vec2> mouth;        // work space of emit: places that are taken
  std::optional<Balance> judged;  // of the state that judge() saw, and whether particles came or went since
  bool membersChanged = false;
  bool anyLifetime = false;
  bool insideStep = false;    // substep() is called by step(), which counts
  bool started = false;       // the accounts hold the start's energy and momentum
  bool edited = false;        // particles may differ from those that `present` was taken of
  std::uint64_t version = 0;  // of the particles' places, for queries between steps
  EventLog events;
  // The force's acceleration at the start of the sub-step, and at its end [m/s²].
  std::array<AlignedArray<double>, 2> fluidPush, bulletPush, bulletEndPush;
  double forceScale = 0.0;  // its largest [m/s²]
  mutable FluidQuery query;
};

}  // namespace froude
