// What happened during a step, for callers that asked to be told: contacts with bodies, particles swallowed by sinks.
#pragma once

#include <froude/particles/pool.h>
#include <froude/solver/definitions.h>

namespace froude {

/// What is recorded. Nothing, unless it is asked for; recording changes no bit of the state.
struct EventSettings {
  bool bulletContacts = false;
  bool fluidContacts = false;
  bool sinks = false;
  double slowestContact =
      0.0;  // slower approaches are not recorded [m/s]: what lies on a floor touches it all the time
  /// Also lets the path of every bullet be checked, which else are only looked for inside solids: about a fifth more of
  /// a step of bullets. The state is the same but for bullets that leak, which are then found and taken out at once.
  bool leaks = false;
};

/// A particle met a body or a closed side of the domain. Of a fluid particle and one obstacle only the first contact of
/// a sub-step is told; bullets tell of every bounce.
struct ContactEvent {
  Species species = Species::Bullet;
  ParticleHandle particle;  // stale if the particle has gone since
  BodyId body;              // null: a wall of the domain
  Vec2 point{0, 0};         // on the boundary [m]
  Vec2 normal{0, 0};        // outward from the body, unit
  double speed = 0.0;       // of approach along the normal, relative to the body's surface, before the contact [m/s]
  double time = 0.0;        // [s]
};

/// A particle leaked in an accepted sub-step: its centre was found inside a solid at the end, or had gone through one,
/// though it was not squeezed. It has been taken out and counted; the handle is stale.
struct LeakEvent {
  Species species = Species::Fluid;
  ParticleHandle particle;
  BodyId body;          // that it is in, the nearest boundary's of several, or went through; null: a wall of the domain
  Vec2 from{0, 0};      // where it was at the start of the sub-step [m]
  Vec2 position{0, 0};  // where it was found [m]
  Vec2 boundary{0, 0};  // the point of the boundary nearest to that; of what went through: from where it did [m]
  double depth = 0.0;   // below that boundary [m]; 0 of what went through
  double time = 0.0;    // of the sub-step's end [s]
  bool inside = true;   // at that end; false: it went through
};

/// A sink swallowed a particle. The handle is stale.
struct SinkEvent {
  Species species = Species::Fluid;
  ParticleHandle particle;
  std::uint32_t sink = 0;  // index into WorldDef::sinks
  Vec2 position{0, 0};     // where it was swallowed, at the end of a sub-step [m]
  double time = 0.0;       // of that end [s]
};

}  // namespace froude
