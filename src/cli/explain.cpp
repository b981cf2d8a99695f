#include "cli/explain.h"

#include <fmt/format.h>
#include <froude/solver/model_card.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/progress.h"
#include "run/threads.h"
#include "scene/estimate.h"
#include "scene/scene.h"

namespace froude::cli {
namespace {

using Json = nlohmann::ordered_json;

/// One thing of a scene, and why it is modelled, or not.
struct Item {
  std::string what, why;
  const ModelCard* card = nullptr;
};

/// What a run will take, from the model's own step bounds and a short measurement.
struct Prediction {
  double substeps = 0.0;
  double acousticSteps = 0.0;      // of wcsph; else 0
  double secondsPerSubstep = 0.0;  // 0: nothing could be measured
  double sweepsPerSubstep = 0.0;   // in what was measured
  double bytes = 0.0;
  int threads = 1;
  // The first sub-steps of wcsph are many acoustic steps long: it is these that take the time.
  double wallSeconds() const {
    return acousticSteps > 0.0 && sweepsPerSubstep > 0.0 ? acousticSteps * secondsPerSubstep / sweepsPerSubstep
                                                         : substeps * secondsPerSubstep;
  }
};

constexpr double kMeasured = 1.0;   // wall time spent on measuring at most [s]
constexpr int kMeasuredSteps = 50;  // sub-steps measured at most
constexpr const char* kNoError = "not predicted in this version: the page of each model says what was measured";

std::string plural(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

bool emits(const WorldDef& def, EmitterDef::Kind kind) {
  return std::any_of(def.emitters.begin(), def.emitters.end(), [=](const EmitterDef& e) { return e.kind == kind; });
}

std::size_t bodiesThat(const WorldDef& def, Motion motion) {
  return static_cast<std::size_t>(
      std::count_if(def.bodies.begin(), def.bodies.end(), [=](const BodyDef& b) { return b.motion == motion; }));
}

std::string_view viscosityWords(ViscositySolver solver) {
  switch (solver) {
    case ViscositySolver::Explicit:
      return "as an explicit term that binds the sub-step";
    case ViscositySolver::Implicit:
      return "by a solve for the velocities in every sub-step";
    case ViscositySolver::Auto:
      break;
  }
  return "by a solve for the velocities where an explicit term would at least halve the sub-step";
}

void sortFluid(const scene::Scene& scene, std::vector<Item>& in, std::vector<Item>& out) {
  const WorldDef& def = scene.world;
  if (!def.fluid) {
    out.push_back({"fluid", "the scene has no block or emitter of fluid: no neighbour search, no pressure"});
    return;
  }
  const std::string source = emits(def, EmitterDef::Kind::Fluid) ? "blocks and emitters" : "blocks";
  in.push_back(
      {fmt::format("{} of fluid by `{}`, spacing {} m", plural(scene.fluidParticles(), "particle", "particles"),
                   def.fluid->model, def.fluid->spacing),
       "the scene has " + source + " of fluid and `model.fluid` names the model", findModelCard(def.fluid->model)});
  if (def.fluid->viscosity > 0.0) {
    in.push_back(
        {fmt::format("viscosity {} m²/s, {}", def.fluid->viscosity, viscosityWords(def.fluid->viscositySolver)),
         "`fluid.viscosity` is not 0; `model.viscosity_solver` chooses"});
  } else {
    out.push_back({"viscosity", "`fluid.viscosity` is 0"});
  }
  if (def.fluid->surfaceTension > 0.0) {
    in.push_back({fmt::format("surface tension {} N, contact angle {:.6g} degrees", def.fluid->surfaceTension,
                              def.fluid->contactAngle * 180.0 / kPi),
                  "`fluid.surface_tension` is not 0"});
  } else {
    out.push_back({"surface tension", "`fluid.surface_tension` is 0"});
  }
}

void sortBullets(const scene::Scene& scene, std::vector<Item>& in, std::vector<Item>& out) {
  const WorldDef& def = scene.world;
  if (!def.bullet) {
    out.push_back({"bullets", "the scene has no block or emitter of bullets"});
    return;
  }
  in.push_back({fmt::format("{} of radius {} m", plural(scene.bulletCount(), "bullet", "bullets"), def.bullet->radius),
                "the scene has bullets: their paths are swept against the polygons", findModelCard("ballistic")});
}

void sortFreeBodies(const WorldDef& def, std::vector<Item>& in, std::vector<Item>& out) {
  const std::size_t free = bodiesThat(def, Motion::Free);
  if (free == 0) {
    out.push_back({"contacts between bodies", "no body has motion = \"free\": no contact solver"});
    return;
  }
  in.push_back({plural(free, "free polygon", "free polygons"),
                "`motion` is \"free\": gravity, contacts, particles and fluid move them; contacts have friction and "
                "restitution and "
                "are solved in small sub-steps, and what rests falls asleep",
                findModelCard("rigid")});
  const auto hinged = std::count_if(def.bodies.begin(), def.bodies.end(), [](const BodyDef& b) { return b.hinge; });
  const auto driven =
      std::count_if(def.bodies.begin(), def.bodies.end(), [](const BodyDef& b) { return b.hinge && b.hinge->motor; });
  if (hinged > 0) {
    in.push_back({fmt::format("{}, {}", plural(static_cast<std::size_t>(hinged), "hinge", "hinges"),
                              driven > 0 ? plural(static_cast<std::size_t>(driven), "motor", "motors") : "no motor"),
                  "`hinge` holds a point of a free body where it is in the world"});
  } else {
    out.push_back({"hinges and motors", "no body has a `hinge`"});
  }
  out.push_back({"contacts among fixed and scripted bodies", "neither would move by them"});
  out.push_back({"joints between bodies, springs, breaking", "the scene format has hinges to the world only"});
}

void sortBodies(const WorldDef& def, std::vector<Item>& in, std::vector<Item>& out) {
  const std::size_t fixed = bodiesThat(def, Motion::Fixed), scripted = bodiesThat(def, Motion::Scripted);
  if (def.bodies.empty()) out.push_back({"bodies", "the scene has none"});
  if (fixed > 0) {
    in.push_back(
        {plural(fixed, "fixed polygon", "fixed polygons"), "they are baked into one field: one look-up for all"});
  }
  if (scripted > 0) in.push_back({plural(scripted, "scripted polygon", "scripted polygons"), "their motion is given"});
  sortFreeBodies(def, in, out);
}

void sortSoft(const WorldDef& def, std::vector<Item>& in, std::vector<Item>& out) {
  if (def.soft.empty()) out.push_back({"soft bodies", "the scene has none"});
  for (const auto& [name, model] : scene::softModelNames()) {
    std::size_t bodies = 0, points = 0, triangles = 0;
    double least = kInfinity, largest = 0.0;
    for (const SoftDef& soft : def.soft) {
      if (soft.model != model) continue;
      ++bodies;
      points += soft.mesh->points.size();
      triangles += soft.mesh->triangles.size();
      least = std::min(least, soft.spacing);
      largest = std::max(largest, soft.spacing);
    }
    if (bodies == 0) continue;
    const std::string spacing = least < largest ? fmt::format("{} to {}", least, largest) : fmt::format("{}", least);
    const std::string cells = triangles > 0 ? ", " + plural(triangles, "triangle", "triangles") : "";
    in.push_back({fmt::format("{} by `{}`: {}{}, spacing {} m", plural(bodies, "soft body", "soft bodies"), name,
                              plural(points, "point", "points"), cells, spacing),
                  "`soft` names them and `model` how they resist", findModelCard(name)});
  }
}

void sortRest(const WorldDef& def, std::vector<Item>& in, std::vector<Item>& out) {
  if (def.timeStep) {
    in.push_back(
        {fmt::format("the literal sub-step {} s", *def.timeStep), "`model.time_step` is given and is not changed"});
  } else {
    in.push_back({"adaptive sub-steps", "`model.time_step` is left out: each is as long as its bounds allow"});
  }
  if (!def.emitters.empty()) in.push_back({plural(def.emitters.size(), "emitter", "emitters"), "the scene has them"});
  if (!def.sinks.empty()) in.push_back({plural(def.sinks.size(), "sink", "sinks"), "the scene has them"});
  if (def.gravityField) in.push_back({"gravity as a field", "`gravity` is an expression"});
  if (!def.gravityField && def.gravity.norm() == 0.0) out.push_back({"gravity", "`gravity` is 0"});
}

// What the library refuses of a scene is wrong in the scene.
World worldOf(const scene::Scene& scene) {
  try {
    return scene::makeWorld(scene);
  } catch (const Error& e) {
    throw run::UsageError(scene.file + ": " + e.what());
  }
}

// Steps a world that is thrown away; a mean over its first moments, without the very first sub-step, which allocates.
void measureSubstep(const scene::Scene& scene, Prediction& p) {
  using Clock = std::chrono::steady_clock;
  World world = worldOf(scene);
  if (!world.substep().ok()) return;
  const std::uint64_t sweeps = world.ledger().sweeps;
  const Clock::time_point start = Clock::now();
  double elapsed = 0.0;
  int steps = 0;
  while (steps < kMeasuredSteps && elapsed < kMeasured && world.time() < scene.duration && world.substep().ok()) {
    ++steps;
    elapsed = std::chrono::duration<double>(Clock::now() - start).count();
  }
  if (steps == 0) return;
  p.secondsPerSubstep = elapsed / steps;
  p.sweepsPerSubstep = static_cast<double>(world.ledger().sweeps - sweeps) / steps;
}

Prediction predict(const scene::Scene& scene) {
  Prediction p;
  const scene::Estimate cost = scene::estimate(scene);
  p.substeps = cost.substeps;
  p.acousticSteps = cost.acousticSteps;
  p.bytes = cost.bytes;
  p.threads = run::usableCores();
  run::withThreads(p.threads, [&] { measureSubstep(scene, p); });
  return p;
}

std::string joined(const std::vector<std::string>& lines) { return fmt::format("{}", fmt::join(lines, "; ")); }

Json toJson(const Item& item) {
  Json json{{"what", item.what}, {"why", item.why}};
  if (item.card == nullptr) return json;
  json["model"] = {{"name", item.card->name},
                   {"title", item.card->title},
                   {"models", item.card->models},
                   {"does_not_model", item.card->doesNotModel},
                   {"step_bounds", item.card->stepBounds},
                   {"known_failures", item.card->knownFailures},
                   {"references", item.card->references}};
  return json;
}

void printJson(const scene::Scene& scene, const std::vector<Item>& in, const std::vector<Item>& out,
               const Prediction& p) {
  Json json;
  json["scene"] = scene.file;
  json["title"] = scene.title;
  json["duration"] = scene.duration;
  json["modelled"] = Json::array();
  for (const Item& item : in) json["modelled"].push_back(toJson(item));
  json["not_modelled"] = Json::array();
  for (const Item& item : out) json["not_modelled"].push_back(toJson(item));
  Json prediction;
  prediction["substeps"] = p.substeps;
  if (p.acousticSteps > 0.0) prediction["acoustic_steps"] = p.acousticSteps;
  prediction["threads"] = p.threads;
  prediction["wall_seconds"] = p.secondsPerSubstep > 0.0 ? Json(p.wallSeconds()) : Json(nullptr);
  prediction["memory_bytes"] = p.bytes;
  prediction["error"] = nullptr;
  prediction["error_note"] = kNoError;
  json["predicted"] = prediction;
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

void printItem(const Item& item) {
  fmt::print("  {}\n    because {}\n", item.what, item.why);
  if (item.card == nullptr) return;
  fmt::print("    {}: {}\n    leaves out: {}\n    sub-step bounds: {}\n", item.card->title, item.card->models,
             item.card->doesNotModel, joined(item.card->stepBounds));
  fmt::print("    known to fail: {}\n    from: {}\n", joined(item.card->knownFailures), joined(item.card->references));
}

void printText(const scene::Scene& scene, const std::vector<Item>& in, const std::vector<Item>& out,
               const Prediction& p) {
  fmt::print("{}{}\n\nModelled\n", scene.file, scene.title.empty() ? "" : ": " + scene.title);
  for (const Item& item : in) printItem(item);
  fmt::print("\nNot modelled\n");
  for (const Item& item : out) printItem(item);
  const std::string time = p.secondsPerSubstep > 0.0
                               ? fmt::format("{} on {}", run::durationInWords(p.wallSeconds()),
                                             plural(static_cast<std::size_t>(p.threads), "thread", "threads"))
                               : "unknown, the first sub-step fails";
  const std::string acoustic =
      p.acousticSteps > 0.0 ? fmt::format(", {:.2g} acoustic steps in them", p.acousticSteps) : "";
  fmt::print("\nPredicted, roughly, without output\n  sub-steps: {:.2g} for {} s{}\n  time: {}\n", p.substeps,
             scene.duration, acoustic, time);
  fmt::print("  memory: {}\n  error: {}\n", run::bytesInWords(p.bytes), kNoError);
}

}  // namespace

int explainCommand(const std::string& file, bool json) {
  const scene::Scene scene = scene::load(file);
  for (const std::string& note : scene.notes) fmt::print(stderr, "{}\n", note);
  for (const scene::Warning& warning : scene.warnings) fmt::print(stderr, "{}\n", warning.line());
  std::vector<Item> in, out;
  sortFluid(scene, in, out);
  sortBullets(scene, in, out);
  sortBodies(scene.world, in, out);
  sortSoft(scene.world, in, out);
  sortRest(scene.world, in, out);
  const Prediction prediction = predict(scene);
  (json ? printJson : printText)(scene, in, out, prediction);
  return run::kDone;
}

}  // namespace froude::cli
