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

/// A sink swallowed a particle. The handle is stale.
struct SinkEvent {
  Species species = Species::Fluid;
  ParticleHandle particle;
  std::uint32_t sink = 0;  // index into WorldDef::sinks
  Vec2 position{0, 0};     // where it was swallowed, at the end of a sub-step [m]
  double time = 0.0;       // of that end [s]
};

}  // namespace froude
