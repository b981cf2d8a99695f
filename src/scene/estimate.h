// What a scene will cost, before it is run: a rough guess from the model's own bounds on its sub-step.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace froude::scene {

/// A bound on the sub-step at the speeds that are expected.
struct NamedBound {
  StepLimit limit = StepLimit::Requested;
  double dt = 0.0;  // [s]
};

struct Estimate {
  double speed = 0.0;              // expectedSpeed of all particles [m/s]
  std::vector<NamedBound> bounds;  // each that the scene has at that speed and before any pressure, shortest first
  double substep = 0.0;            // the shortest of them, at most the duration [s]
  double substeps = 0.0;           // over the scene's duration
  double acousticSteps = 0.0;      // of wcsph, over the scene's duration; else 0
  double particles = 0.0;          // placed, without what emitters add
  double bytes = 0.0;              // of the world
};

/// The speed of the fastest start and of free fall from the highest particle to the domain's lowest side, together
/// [m/s].
double expectedSpeed(const Scene& scene, bool bulletsToo);
/// Runs nothing. Cost: O(particles).
Estimate estimate(const Scene& scene);

}  // namespace froude::scene
