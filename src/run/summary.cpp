#include "run/summary.h"

#include <fmt/format.h>
#include <froude/base/assert.h>
#include <froude/version.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "run/machine.h"

namespace froude::run {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no word for these; leaving them out or writing null would hide a failure.
Json number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

std::string modelName(const WorldDef& def) {
  std::string all = def.fluid ? def.fluid->model : "";
  const auto add = [&](std::string_view model) { all += (all.empty() ? "" : " + ") + std::string(model); };
  if (def.bullet) add("ballistic");
  for (const auto& [word, model] : scene::softModelNames())
    if (std::any_of(def.soft.begin(), def.soft.end(), [&, m = model](const SoftDef& soft) { return soft.model == m; }))
      add(word);
  return all.empty() ? "none" : all;
}

std::size_t liveParticles(const World& world) {
  const ParticlePool* fluid = world.fluid();
  const ParticlePool* bullets = world.bullets();
  const ParticlePool* soft = world.soft();
  return (fluid != nullptr ? fluid->size() : 0) + (bullets != nullptr ? bullets->size() : 0) +
         (soft != nullptr ? soft->size() : 0);
}

void addBuild(Json& json) {
  json["schema"] = 1;
  json["froude_version"] = FROUDE_VERSION;
  json["git_commit"] = FROUDE_COMMIT;
  json["build_type"] = buildType();
  json["compiler"] = compilerName();
}

void addRun(Json& json, const SummarySource& s) {
  const WorldDef& def = s.world.definition();
  json["simd"] = name(def.simd);
  json["cpu"] = cpuName();
  json["command"] = s.record.command;
  json["scene"] = s.record.sceneFile;
  json["scene_sha256"] = s.record.sceneSha256;
  json["seed"] = def.seed;
  json["threads"] = s.threads;
  json["model"] = modelName(def);
  json["spacing"] = def.fluid ? number(def.fluid->spacing) : Json(nullptr);
}

void addCost(Json& json, const SummarySource& s) {
  const Ledger& ledger = s.world.ledger();
  const double wall = s.record.wallSeconds;
  json["particles"] = liveParticles(s.world);
  json["steps"] = ledger.steps;
  json["substeps"] = ledger.substeps;
  json["rejected_substeps"] = ledger.rejected;
  json["sweeps"] = ledger.sweeps;
  json["simulated_seconds"] = number(s.world.time());
  json["wall_seconds"] = number(wall);
  json["checkpoint_seconds"] = number(s.record.checkpointSeconds);
  json["checkpoint_bytes"] = s.record.checkpointBytes;
  json["particle_steps"] = ledger.particleSteps;
  json["particle_steps_per_second"] = number(wall > 0.0 ? static_cast<double>(ledger.particleSteps) / wall : 0.0);
  Json limits = Json::object();
  for (std::size_t i = 0; i < ledger.limits.size(); ++i) {
    limits[std::string(name(static_cast<StepLimit>(i)))] = ledger.limits[i];
  }
  json["step_limits"] = limits;
}

void addHonesty(Json& json, const SummarySource& s) {
  const Ledger& ledger = s.world.ledger();
  const double time = s.world.time();
  json["leaks"] = ledger.leaks;
  json["crushed"] = ledger.crushed;
  json["retired"] = ledger.retired;
  json["wall_hits"] = ledger.wallHits;
  json["quarantined"] = ledger.quarantined;
  json["emitted"] = ledger.emitted;
  json["sunk"] = ledger.sunk;
  json["expired"] = ledger.expired;
  json["recycled"] = ledger.recycled;
  json["refused"] = ledger.refused;
  json["max_density_error"] = number(ledger.maxDensityError);
  json["mean_density_error"] = number(time > 0.0 ? ledger.densityErrorTime / time : 0.0);
  json["volume_error"] = number(volumeError(s.world, s.record.fluidArea0));
  json["energy_drift"] = number(ledger.energyDrift);
  json["dissipation"] = number(ledger.dissipation);
  json["momentum_error"] = number(momentumError(s.world));
  json["max_speed"] = number(ledger.maxSpeed);
}

}  // namespace

std::string_view name(Status status) {
  constexpr std::array<std::string_view, 5> kNames{"running", "done", "unstable", "interrupted", "failed"};
  return kNames[static_cast<std::size_t>(status)];
}

double volumeError(const World& world, double fluidArea0) {
  if (!world.definition().fluid) return 0.0;
  const Ledger& ledger = world.ledger();
  const double expected = fluidArea0 + (ledger.massEmitted - ledger.massRetired) / world.definition().fluid->density;
  const double scale = std::max(fluidArea0, expected);
  return scale > 0.0 ? (GaugeSet::fluidArea(world) - expected) / scale : 0.0;
}

double momentumError(const World& world) {
  const Totals now = world.totals();
  const Ledger& ledger = world.ledger();
  if (!(now.mass > 0.0)) return 0.0;  // nothing is left: no scale to put the rest against
  // The ledger's largest speed is that of particles; bodies alone have the largest kinetic energy.
  const double scale = now.mass * std::max(ledger.maxSpeed, std::sqrt(2.0 * ledger.maxKinetic / now.mass));
  const Vec2 unexplained = now.momentum - ledger.momentum0 - ledger.impulse;
  return scale > 0.0 ? unexplained.norm() / scale : 0.0;
}

std::string describe(const StepReport& trouble, double time) {
  std::string text = fmt::format("unstable at t = {:.6g} s: {} {:.3g} where {:.3g} is the limit", time,
                                 name(trouble.trouble), trouble.troubleValue, trouble.troubleLimit);
  if (trouble.troubleAt.allFinite())
    text += fmt::format(", at ({:.4g}, {:.4g})", trouble.troubleAt.x(), trouble.troubleAt.y());
  return text;
}

std::string buildType() {
  std::string text = FROUDE_BUILD_TYPE;
  if (kAssertionsOn) text += "+assertions";
  if (!kOptimized) text += " (not optimised)";
  return text;
}

std::string compilerName() { return FROUDE_COMPILER; }

std::string summaryText(const SummarySource& source, Status status) {
  Json json;
  addBuild(json);
  addRun(json, source);
  addCost(json, source);
  addHonesty(json, source);
  Json units = Json::object();
  for (const GaugeColumn& column : source.gauges.columns()) units[column.name] = column.unit;
  json["gauges"] = units;
  json["frames"] = source.record.nextFrame;
  json["state_hash"] = source.world.stateHash();
  json["warnings"] = source.record.warnings;
  json["status"] = name(status);
  json["reason"] = source.record.reason;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace froude::run
