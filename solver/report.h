// What a step says about itself: solvers are silent, numbers and trouble come out here.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <froude/base/api.h>
#include <froude/base/types.h>

namespace froude {

/// The bounds that a sub-step obeys. A step is charged to the bound that was the smallest.
enum class StepLimit : int {
  Literal,       // `time_step` of the scene
  Courant,       // v·dt against the support radius
  Acceleration,  // √(support radius / acceleration)
  Pressure,      // dx/√(p/ρ): the stiffness of the particles' arrangement under pressure
  Viscosity,     // dx²/ν
  Acoustic,      // dx/(speed of sound)
  Tension,       // √(ρ dx³/σ): the shortest waves of surface tension
  Spin,          // ω·dt ≤ 0.5 rad of a body
  Wall,          // a moving polygon's travel against the support radius
  Body,          // a free body's travel against its own thickness
  Bullet,        // a bullet's sub-step
  Soft,          // a soft body's travel against its spacing
  Requested,     // the caller asked for less
  Undone,        // halved after a bad step
  kCount
};
FROUDE_API std::string_view name(StepLimit limit);

enum class Trouble : int { None, NonFinite, Displacement, Compression, EnergyGain, Turn };
FROUDE_API std::string_view name(Trouble trouble);

/// One accepted sub-step, or the reason why none was.
struct StepReport {
  double dt = 0.0;                         // time advanced [s]
  int substeps = 0;                        // accepted sub-steps
  int rejected = 0;                        // undone and halved
  StepLimit limit = StepLimit::Requested;  // of the last sub-step; where none was accepted, of the first one tried
  Trouble trouble = Trouble::None;         // ≠ None: the state is the last sound one, and time stands
  double troubleValue = 0.0;               // what was measured …
  double troubleLimit = 0.0;               // … against what
  Vec2 troubleAt{0, 0};                    // where [m], when known
  bool ok() const { return trouble == Trouble::None; }
};

/// Totals since the start; saved with the state.
struct Ledger {
  std::uint64_t steps = 0;     // calls of step() or substep()
  std::uint64_t substeps = 0;  // accepted
  std::uint64_t rejected = 0;
  std::uint64_t particleSteps = 0;  // one particle in one sub-step
  std::uint64_t sweeps = 0;         // pressure sweeps
  std::uint64_t leaks = 0, crushed = 0, wallHits = 0, quarantined = 0;
  std::uint64_t retired = 0;  // left the domain
  std::uint64_t sunk = 0, expired = 0, emitted = 0, recycled = 0, refused = 0;
  std::uint64_t added = 0, killed = 0;  // by calls between steps, after the first one
  std::array<std::uint64_t, static_cast<std::size_t>(StepLimit::kCount)> limits{};
  double maxDensityError = 0.0;   // largest compression over particles and steps
  double densityErrorTime = 0.0;  // ∫ mean compression dt [s]
  double energy0 = 0.0;           // at the start [J/m]
  double maxKinetic = 0.0;        // [J/m]
  double work = 0.0;              // done from outside: scripted bodies, surface velocity, emission − retirement [J/m]
  double dissipation = 0.0;       // energy lost so far [J/m]
  double energyDrift = 0.0;       // largest (E − E0 − work)/scale so far, ≥ 0
  double massEmitted = 0.0, massRetired = 0.0;  // fluid [kg/m]
  Vec2 momentum0{0, 0};                         // at the start [kg/s]
  Vec2 impulse{0, 0};                           // ∫ gravity + walls + bodies + emission − retirement [kg/s]
  double maxSpeed = 0.0;                        // over particles and steps [m/s]
};

}  // namespace froude
