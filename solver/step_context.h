// What one sub-step is: the only holder of a time step. And what it reports.
#pragma once

#include <optional>
#include <vector>

#include <froude/base/simd.h>
#include <froude/particles/pool.h>
#include <froude/solver/coupling/obstacles.h>
#include <froude/solver/definitions.h>
#include <froude/solver/report.h>

namespace froude {

/// Gravity, constant or a field.
class Gravity {
 public:
  Gravity(const Vec2& constant, VectorField field) : constant_(constant), field_(std::move(field)) {}
  bool isConstant() const { return !field_; }
  const Vec2& constant() const { return constant_; }
  Vec2 at(const Vec2& x, double t) const { return field_ ? field_(x, t) : constant_; }

 private:
  Vec2 constant_;
  VectorField field_;
};

class LeakRecorder;
class FreeBodies;
class SoftWalls;

constexpr double kFreeStep = 0.01;  // [s] where nothing binds the step

/// Constant during a sub-step; handed to every stage.
struct StepContext {
  double time = 0.0;  // at the start [s]
  double dt = 0.0;    // [s]
  const Gravity& gravity;
  const Obstacles& obstacles;
  SimdTarget simd;
  /// Of the fluid's pool, in scenes with fluid nozzles: until when a nozzle carries a particle at its own velocity [s].
  std::optional<ColumnId<double>> carriedUntil = std::nullopt;
  /// Null where nobody listens: then bullets that overlapped nothing at the start are not checked for leaks.
  LeakRecorder* leaks = nullptr;
  /// Null in worlds without free bodies.
  FreeBodies* freeBodies = nullptr;
  /// Null where no fluid feels the outlines of soft bodies.
  SoftWalls* softWalls = nullptr;
  /// The scales of the state that it starts from: of all particles [m/s], of gravity and forces [m/s²].
  double maxSpeed = 0.0, acceleration = 0.0;
};

/// A particle met an obstacle.
struct ParticleContact {
  std::uint32_t particle;  // its index now
  int body;                // −1: the domain
  Vec2 point;              // [m]
  Vec2 normal;             // outward from the obstacle
  double approach;         // relative speed towards it before [m/s]
  double time;             // fraction of the sub-step
};

/// Who wants to hear of contacts. Called from one thread, in an order that does not depend on threads.
class ContactRecorder {
 public:
  virtual ~ContactRecorder() = default;
  virtual void add(const ParticleContact& contact) = 0;
};

/// A particle got into or through an obstacle.
struct ParticleLeak {
  std::uint32_t particle;  // its index now
  Vec2 from, to;           // at start and end of the sub-step [m]
  bool inside;             // its end is in an obstacle; else it went through
  int body;                // that it went through; −1: a wall of the domain
  Vec2 entered;            // start of the straight piece on which it did [m]
};

/// Who wants to hear of leaks. Called as ContactRecorder is.
class LeakRecorder {
 public:
  virtual ~LeakRecorder() = default;
  virtual void add(const ParticleLeak& leak) = 0;
};

/// What particles gave to the bodies during a sub-step; index 0 is the domain, body i stands at i + 1.
class ImpulseLedger {
 public:
  void reset(const BodySet& bodies) {
    entries_.assign(bodies.size() + 1, {});
    for (std::size_t i = 0; i < bodies.size(); ++i) entries_[i + 1].within = bodies.isFree(i);
    work_ = 0.0;
  }
  /// impulse [kg·m/s per metre of depth] on the owner (−1: the domain) at the point, where its surface moves at
  /// `surfaceVelocity` [m/s].
  void add(int owner, const Vec2& at, const Vec2& impulse, const Vec2& surfaceVelocity) {
    Entry& e = entries_[static_cast<std::size_t>(owner + 1)];
    e.impulse += impulse;
    e.moment += cross(at, impulse);
    if (!e.within) work_ -= impulse.dot(surfaceVelocity);
  }
  /// Null where nobody listens.
  ContactRecorder* recorder() const { return recorder_; }
  void setRecorder(ContactRecorder* recorder) { recorder_ = recorder; }
  /// Done by moving surfaces on particles, those of free bodies left out [J/m].
  double work() const { return work_; }
  const Vec2& impulse(int owner) const { return entries_[static_cast<std::size_t>(owner + 1)].impulse; }
  /// About the world's origin.
  double moment(int owner) const { return entries_[static_cast<std::size_t>(owner + 1)].moment; }
  /// What left the particles and free bodies for all others.
  Vec2 outside() const {
    Vec2 sum(0.0, 0.0);
    for (const Entry& e : entries_) {
      if (!e.within) sum += e.impulse;
    }
    return sum;
  }

 private:
  struct Entry {
    Vec2 impulse{0.0, 0.0};
    double moment = 0.0;
    bool within = false;  // a free body: part of what the accounts are about
  };
  std::vector<Entry> entries_;
  double work_ = 0.0;
  ContactRecorder* recorder_ = nullptr;
};

/// Numbers of one sub-step of one model.
struct StepStats {
  Trouble trouble = Trouble::None;
  double troubleValue = 0.0, troubleLimit = 0.0;
  Vec2 troubleAt{0.0, 0.0};
  double maxCompression = 0.0;    // largest ρ/ρ0 − 1, over-dense starts included
  double meanCompression = 0.0;   // mean of max(0, ρ/ρ0 − 1)
  double gravityWork = 0.0;       // of a gravity field; constant gravity is in the potential energy [J/m]
  double tensionWork = 0.0;       // what surface tension did for particles and free bodies [J/m]
  Vec2 gravityImpulse{0.0, 0.0};  // [kg/s]
  int sweeps = 0;
  std::uint64_t wallHits = 0;
  std::uint64_t leaks = 0;
  std::uint64_t crushed = 0;
  std::uint64_t softParts = 0;  // parts that the sub-step was divided into for soft bodies
};

}  // namespace froude
