// Emitters: nozzles that let fluid or bullets in, at exact times between step ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <froude/base/api.h>
#include <froude/base/archive.h>
#include <froude/base/parallel.h>
#include <froude/base/random.h>
#include <froude/base/types.h>
#include <froude/particles/slot_table.h>

namespace froude {

/// Definition of a nozzle: the segment from … to; flow to its left normal (−dy, dx)/|(dx, dy)|.
struct EmitterDef {
  enum class Kind { Fluid, Bullet };
  Kind kind = Kind::Fluid;
  Vec2 from{0.0, 0.0}, to{0.0, 0.0};  ///< [m]
  double speed = 0.0;                 ///< along the flow [m/s], > 0 for fluids, ≥ 0 for bullets
  double rate = 0.0;                  ///< bullets only [1/s], > 0
  double spread = 0.0;                ///< bullets only: half-angle about the flow [rad], 0 … π
  double start = 0.0;                 ///< [s]
  double stop = kInfinity;            ///< [s], > start
  double lifetime = kInfinity;        ///< of what it emits [s], > 0
  std::size_t limit = 1000000;        ///< live particles of this emitter, ≥ 1, and beyond it (see `room` of emit):
  GrowthPolicy policy = GrowthPolicy::Fixed;  ///< Fixed refuses, Grow goes on, RecycleOldest takes its oldest away
  std::string name = "emitter";               ///< for errors and saved state
};

/// A definition that cannot work, in words.
class FROUDE_API EmitterError : public Error {
 public:
  using Error::Error;
};

/// Places what flows in during a step. Fluid comes in rows across the nozzle, floor(length/spacing) particles at
/// spacing dx, centred; a new row each time the jet has advanced by dx, the first at `start`. Bullets come at start +
/// k/rate, at a random place on the nozzle and a random angle within ±spread, by the counter of the bullet's number.
/// Each has moved on since its own instant by speed · (rest of the step), so that the jet does not depend on the steps:
/// positions agree to rounding however time is divided. State: the numbers of events (rows or bullets) and of refusals;
/// nothing else.
class FROUDE_API Emitter {
 public:
  using Place = FunctionRef<void(const Vec2& position, const Vec2& velocity)>;

  /// spacing: dx of the fluid [m] (bullets: not used). `index` tells the emitters of a scene apart: it is the stream of
  /// random numbers. EmitterError for a definition outside the ranges above or a nozzle shorter than dx.
  Emitter(EmitterDef def, double spacing, std::uint64_t seed, std::uint64_t index);

  /// Calls place for all that is due before t0 + dt [s] and has not come yet, oldest first, at most `room` times; what
  /// finds no room is refused for good. Returns how often it called. Times must not go back, except by loading a state.
  /// What fell into a gap between the end of one call and the t0 of the next is skipped.
  std::size_t emit(double t0, double dt, Place place, std::size_t room = static_cast<std::size_t>(-1));
  /// How many `emit` would place, given room.
  std::size_t pending(double t0, double dt) const;
  /// Room that the limit and its policy leave when `live` of its particles exist: unlimited unless Fixed.
  std::size_t room(std::size_t live) const;

  const EmitterDef& def() const { return def_; }
  Vec2 direction() const { return direction_; }
  /// Particles across the nozzle: of one row for fluids, 1 for bullets.
  std::size_t perEvent() const { return perEvent_; }
  /// Rows or bullets that have come so far.
  std::uint64_t events() const { return nextEvent_; }
  /// Particles that found no room so far.
  std::uint64_t refused() const { return refused_; }
  /// Expiry time of what enters at time t [s].
  double expiry(double t) const { return t + def_.lifetime; }

  void archive(Archive& archive);

 private:
  struct Span {
    std::uint64_t first, end;
  };
  double eventTime(std::uint64_t event) const;
  std::uint64_t firstEventAtOrAfter(double time) const;
  Span due(double t0, double dt) const;

  EmitterDef def_;
  std::string section_;  ///< of the saved state; unique although two emitters may share a name
  double spacing_;
  double interval_;  ///< between events [s]
  Vec2 direction_;   ///< unit vector of the flow
  std::size_t perEvent_;
  std::uint64_t seed_, index_;
  std::uint64_t nextEvent_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace froude
