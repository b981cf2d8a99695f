// Moves the free bodies through a step: gravity, outside forces, contacts, hinges, motors, sleep. Knows no particles.
#pragma once

#include <vector>

#include <froude/base/parallel.h>
#include <froude/solver/rigid/contact_list.h>
#include <froude/solver/rigid/contact_solver.h>
#include <froude/solver/rigid/islands.h>

namespace froude {

/// A step of the bodies. `gravity(x)` [m/s²] at a centre of mass.
struct RigidStep {
  double dt = 0.0;  // [s]
  FunctionRef<Vec2(const Vec2&)> gravity;
  double gravityScale = 0.0;  // largest |g| [m/s²]
};

/// What a step gave to the free bodies from outside.
struct RigidStats {
  Vec2 impulse{0, 0};        // of gravity, walls, fixed and scripted bodies, hinges [kg·m/s per metre]
  double work = 0.0;         // of scripted bodies, belts and motors [J/m]
  double gravityWork = 0.0;  // [J/m]
};

/// What a body felt of contacts and hinge over the last step.
struct BodyImpulse {
  Vec2 impulse{0, 0};   // [kg·m/s per metre]
  double moment = 0.0;  // about the frame's origin
};

/// Free bodies of a world. Throws nothing in a step.
class RigidSolver {
 public:
  explicit RigidSolver(const DomainDef& domain) : domain_(domain) {}

  /// Finds where all free bodies are after `step.dt`, contacts included, in sub-steps of at most 1/240 s: sets their
  /// velocities at the end (FreeState) and their mean motion over the step (BodyMotion). FreeState::pressure acts as a
  /// constant force. Scripted motions are those of BodySet::beginStep. The same bits on any number of threads.
  void advance(const RigidStep& step, BodySet& bodies, RigidStats& stats);

  /// The time in which some free body travels half of its own thickness [s].
  double travelTime(const BodySet& bodies) const;

  /// Of the last step, by body; not saved.
  const BodyImpulse& felt(std::size_t body) const { return felt_[body]; }

  /// Everything on which the future depends besides the bodies.
  void archive(const BodySet& bodies, Archive& a);

 private:
  void admitBodies(const BodySet& bodies);
  void findPoses(const RigidStep& step, const BodySet& bodies, Crew& crew);
  void wakeIslands(BodySet& bodies);
  void findFlying(const BodySet& bodies);
  Vec2 accelerationOf(const RigidStep& step, const BodySet& bodies, std::size_t body) const;
  void loadBodies(const BodySet& bodies, Crew& crew);
  void integrateVelocities(const RigidStep& step, const BodySet& bodies, double h, RigidStats& stats, Crew& crew);
  void solveHinges(const BodySet& bodies, double h, bool last, RigidStats& stats);
  void integratePositions(const RigidStep& step, const BodySet& bodies, double h, Crew& crew);
  void addSleeping(double dt);
  void turnHinged(const BodySet& bodies, double h, RigidStats& stats);
  void storeMotions(const RigidStep& step, BodySet& bodies, Crew& crew);
  void stopAtImpacts(const RigidStep& step, BodySet& bodies, Crew& crew);
  void findFastPairs(const RigidStep& step, const BodySet& bodies);
  bool stopFastPairs(const RigidStep& step, BodySet& bodies, Crew& crew);
  void fallAsleep(const RigidStep& step, BodySet& bodies, RigidStats& stats);

  DomainDef domain_;
  ContactList list_;
  Islands islands_;
  ContactSolver solver_;
  BodyPoses poses_;
  std::vector<SolverBody> bodies_;
  std::vector<std::uint8_t> free_, isHinged_;  // by body: of the definitions, which are far apart in memory
  std::vector<std::uint8_t> awake_, flies_;
  std::vector<std::array<double, 3>> gravityOf_;  // by block of bodies: impulse x, y, work
  std::vector<std::uint32_t> hinged_;
  std::vector<double> motorImpulse_;           // by hinged body, of the last sub-step
  std::vector<double> spinBefore_;             // by hinged body, at the start of the sub-step [rad/s]
  std::vector<std::array<double, 3>> onBody_;  // impulse x, y, moment
  std::vector<BodyImpulse> felt_;
  struct FastPair {
    std::uint32_t contact;
    double time;  // of impact [s]
  };
  std::vector<FastPair> fastPairs_;
  std::vector<double> impact_;                 // the first, by body [s]
  std::vector<double> travel_;                 // by body, at most [m]
  std::uint64_t version_ = ~std::uint64_t{0};  // of the bodies that the list was built from
};

}  // namespace froude
