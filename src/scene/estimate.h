// What a scene will cost, before it is run: a rough guess from the model's own bounds on its sub-step.
#pragma once

#include <string>

#include "scene/scene.h"

namespace froude::scene {

struct Estimate {
  double speed = 0.0;    // expectedSpeed of all particles [m/s]
  double substep = 0.0;  // at that speed [s]; 0: nothing moves
  StepLimit limit = StepLimit::Requested;
  double substeps = 0.0;   // over the scene's duration
  double particles = 0.0;  // placed, without what emitters add
  double bytes = 0.0;      // of the world
};

/// The speed of the fastest start and of free fall from the highest particle to the domain's lowest side, together
/// [m/s].
double expectedSpeed(const Scene& scene, bool bulletsToo);
/// Runs nothing. Cost: O(particles).
Estimate estimate(const Scene& scene);

}  // namespace froude::scene
