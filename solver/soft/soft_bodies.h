// Deformable bodies of a world: their particles, and how a sub-step moves them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <froude/base/archive.h>
#include <froude/particles/pool.h>
#include <froude/solver/coupling/soft_walls.h>
#include <froude/solver/soft/soft_body.h>
#include <froude/solver/soft/soft_pairs.h>
#include <froude/solver/step_context.h>

namespace froude {

/// Sums over soft particles.
struct SoftSums {
  double mass = 0.0, kinetic = 0.0, strain = 0.0;  // [kg/m], [J/m]
  Vec2 momentum{0, 0}, massCenter{0, 0};           // [kg/s], Σ m x [kg]
  double angular = 0.0, maxSpeed = 0.0;            // about the world's origin; [m/s]
};

/// The soft bodies. Their particles stand in a pool of their own, body by body in the order of the mesh's points, and
/// are never sorted: elements name them by index, masses differ, and none comes or goes alone.
///
/// A sub-step of the world is divided so that the fastest wave crosses no element within a part (kPartOfBound). In each
/// part the elastic forces and gravity predict where the points go (symplectic Euler), then one XPBD sweep that starts
/// from these forces' multipliers corrects it towards the implicit step: a state in balance is left as it is whatever
/// the part, slow motions are hardly damped, and what would be unstable is. Sources: Macklin, Müller & Chentanez 2016
/// (XPBD); Macklin et al. 2019 (small steps); Macklin & Müller 2021 (neo-Hookean).
class SoftBodies {
 public:
  /// wet: a fluid's pressure may act on them.
  explicit SoftBodies(bool wet);
  SoftBodies(const SoftBodies&) = delete;
  SoftBodies& operator=(const SoftBodies&) = delete;

  /// Appends a body. Throws Error for a definition that cannot work; nothing is changed then.
  void add(SoftDef def);

  std::size_t count() const { return bodies_.size(); }
  const SoftBody& body(std::size_t i) const { return *bodies_[i]; }
  /// Pool index of its first particle.
  std::size_t first(std::size_t i) const { return first_[i]; }
  ParticlePool& pool() { return pool_; }
  const ParticlePool& pool() const { return pool_; }
  ColumnId<double> massColumn() const { return mass_; }

  /// Parts that a sub-step of dt [s] is divided into.
  int partsOf(double dt, const SoftSettings& settings) const;
  /// Their outlines as they are to a fluid in a sub-step of dt [s] that looks `reach` [m] far, ropes left out; what it
  /// gives them acts evenly in the parts of the `advance` that follows.
  SoftWalls& showWalls(double dt, double reach);
  double totalMass() const { return totalMass_; }  // [kg/m]
  /// Smallest distance of neighbours in any body [m].
  double spacing() const { return spacing_; }
  /// One sub-step. Particles meet fixed and scripted polygons, and free ones by what their motion is.
  /// Free bodies are pushed within the sub-step as if they were a part of it, and moved by that; their velocities are
  /// to be changed by the impulses.
  /// A fluid's particles that reach the outlines are parted from them by their masses; its pressure does not see them.
  void advance(const StepContext& context, const SoftSettings& settings, BodySet& bodies, const MetFluid* fluid,
               ImpulseLedger& impulses, StepStats& stats);

  /// Largest speed of any point [m/s].
  double fastest() const;
  SoftSums sums() const;
  SoftSums sumsOf(std::size_t i) const;
  /// As World::softStrain; and how many triangles or links are torn.
  void strainOf(std::size_t i, std::vector<double>& values) const;
  std::size_t tornOf(std::size_t i) const;
  /// Σ over its triangles [m²]; a rope has none.
  double areaOf(std::size_t i) const;

  void archive(Archive& a);

 private:
  // A point that met a free body, to be parted from it in order.
  struct Meeting {
    std::size_t point;
    int body;
  };
  // One part of the sub-step: shares [begin, end] of it.
  struct Part {
    double dt, begin, end;
  };
  NodeColumns columnsOf(std::size_t i);
  std::size_t offset(std::size_t i) const { return first_[i] + i; }  // into the work columns, with a dummy a body
  void load(const StepContext& context);
  void store();
  void move(const StepContext& context, const Part& part, double tolerance, std::size_t i);
  void feelStrain(const StepContext& context, std::size_t i);
  int correct(const StepContext& context, std::size_t i, double dt, double tolerance);
  void project(const StepContext& context, std::size_t i, double dt);
  void inflate(std::size_t i);
  void addWalls(std::size_t i);
  void takePressure(double dt);
  void rememberMiddle();
  void foresee(double dt, int parts);
  double strainEnergyOf(std::size_t i) const;
  void meetObstacles(const StepContext& context, const Part& part, std::size_t i);
  void meetFreeBodies(const StepContext& context, const Part& part, std::size_t i);
  void meetFree(const StepContext& context, const Part& part, std::size_t i, const Meeting& meeting);
  void finish(const StepContext& context, const Part& part, std::size_t i);
  void tear(std::size_t i);
  void report(ImpulseLedger& impulses, StepStats& stats);
  template <typename Visit>
  void forEachBody(Visit&& visit);
  SoftColumns columns();
  void meet(const StepContext& context, const Part& part, std::size_t i, std::size_t node);
  void damp(std::size_t i, double keep);
  void untangle(std::size_t i);
  void book(ImpulseLedger& impulses);

  ParticlePool pool_;
  ColumnId<double> mass_;
  ColumnId<std::uint32_t> bodyOf_;
  // Of worlds with a fluid: its force on each point [N/m], and the velocity that is expected in the next sub-step
  // [m/s].
  struct Wet {
    ColumnId<double> forceX, forceY, nextX, nextY;
  };
  std::optional<Wet> wet_;
  SoftWalls walls_;
  struct Inertia {
    double own, rate, most;  // [kg/m], its growth [kg/(m·s)], its limit [kg/m]
  };
  std::vector<Inertia> wallInertia_;      // by node of the walls
  std::vector<std::uint32_t> wallPoint_;  // by node of the walls: index in the pool
  std::vector<std::unique_ptr<SoftBody>> bodies_;
  std::vector<std::size_t> first_;
  double frequencySquared_ = 0.0, spacing_ = kInfinity, totalMass_ = 0.0;
  // Work columns: position, velocity, force, position at the start of the part and of the sub-step, and in its middle.
  AlignedArray<double> x_, y_, vx_, vy_, fx_, fy_, fromX_, fromY_, startX_, startY_, middleX_, middleY_, inverseMass_,
      free_;
  std::vector<std::vector<PairTouch>> touches_;  // by body, of one part
  std::vector<std::vector<Meeting>> meetings_;   // by body, of one part
  std::vector<PairTouch> pairTouches_;           // of one part
  SoftPairs pairs_;
  PushedBodies pushed_;
  std::vector<Vec2> gravityImpulse_, touchImpulse_, pressureImpulse_,
      momentumBefore_;               // by body, of the sub-step [kg/s]
  std::vector<int> sweeps_;          // by body, of the sub-step
  std::vector<double> gravityWork_;  // by body [J/m]
};

}  // namespace froude
