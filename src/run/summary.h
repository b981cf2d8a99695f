// summary.json: what a run was, what it cost and how far its numbers can be trusted.
#pragma once

#include <string>

#include <froude/solver/world.h>
#include "run/checkpoint.h"
#include "run/gauges.h"
#include "scene/scene.h"

namespace froude::run {

/// How a run stands; the words of the key `status`.
enum class Status { Running, Done, Unstable, Interrupted, Failed };
std::string_view name(Status status);

/// What a summary is made from. All references are to things of the run and outlive the call.
struct SummarySource {
  const scene::Scene& scene;
  const World& world;
  const GaugeSet& gauges;
  const RunRecord& record;
  int threads = 1;
};

/// The whole file as text. A number that is not finite is the string "nan", "inf" or "-inf". Cost: the fluid's area and
/// the state hash, so not for every step.
std::string summaryText(const SummarySource& source, Status status);

/// (area − expected)/max(area at the start, expected), expected being the start's area and what came in or went since,
/// at rest density. 0 without fluid.
double volumeError(const World& world, double fluidArea0);
/// |P − P0 − impulse from outside|/(M·v_max) over all particles; 0 for a world at rest.
double momentumError(const World& world);

/// "unstable at t = 0.1 s: compression 0.41 where 0.3 is the limit, at (0.2, 0.1)".
std::string describe(const StepReport& trouble, double time);

/// "Release", with "+assertions" where they are on and "(not optimised)" where that is so.
std::string buildType();
std::string compilerName();

}  // namespace froude::run
