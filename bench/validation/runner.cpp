#include "validation/runner.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include <froude/solver/fluid/fluid_model.h>
#include <froude/solver/model_card.h>

namespace froude::validation {
namespace {

constexpr double kRounding = 1e-12;  // errors below it have no order

using Clock = std::chrono::steady_clock;

/// Steps to the scene's end; what went wrong in words, or nothing.
std::string stepToEnd(World& world, const scene::Scene& scene, double every, const Patience& patience, Measure& measure,
                      double& wall) {
  double due = 0.0;
  double lastRead = -1.0;
  const auto readAt = [&](double time) {
    measure.read(world, time);
    lastRead = time;
    due = every > 0.0 ? every * (std::floor(time / every * (1.0 + 1e-12)) + 1.0) : 0.0;
  };
  readAt(0.0);
  while (world.time() < scene.duration * (1.0 - 1e-12)) {
    const double before = world.time();
    const Clock::time_point start = Clock::now();
    const StepReport report = world.substep();
    wall += std::chrono::duration<double>(Clock::now() - start).count();
    if (!report.ok())
      return fmt::format("unstable: {} {:.3g}, at most {:.3g}, at t = {:.4g} s", name(report.trouble),
                         report.troubleValue, report.troubleLimit, world.time());
    if (!(world.time() > before)) return fmt::format("unstable: time stands at t = {:.4g} s", before);
    if (patience.stop && patience.stop()) return fmt::format("stopped: at t = {:.4g} s", world.time());
    if (wall > patience.seconds) return fmt::format("stopped: took {:.3g} s up to t = {:.4g} s", wall, world.time());
    if (world.time() >= due * (1.0 - 1e-12)) readAt(world.time());
  }
  if (lastRead < world.time()) readAt(world.time());
  return "";
}

}  // namespace

Outcome runOnce(const Case& entry, const std::string& method, double spacing,
                const std::vector<scene::Override>& overrides, const Patience& patience) {
  Outcome outcome;
  outcome.spacing = spacing;
  const bool soft = !entry.softModels.empty();
  const std::vector<scene::Override> own{{soft ? "soft.0.model" : "model.fluid", method},
                                         {soft ? "soft.0.spacing" : "model.spacing", fmt::format("{:.17g}", spacing)}};
  std::vector<scene::Override> all = soft ? overrides : own;
  all.insert(all.end(), soft ? own.begin() : overrides.begin(), soft ? own.end() : overrides.end());
  try {
    const scene::Scene scene = scene::load(scenePath(entry.scene), all);
    World world = scene::makeWorld(scene);
    if (entry.prepare) entry.prepare(world);
    const std::unique_ptr<Measure> measure = entry.measure(scene);
    const std::string trouble = stepToEnd(world, scene, entry.every, patience, *measure, outcome.wall);
    for (const ParticlePool* pool : {world.fluid(), world.soft()})
      if (pool != nullptr) outcome.particles += pool->size();
    outcome.ledger = world.ledger();
    outcome.simulated = world.time();
    if (!trouble.empty()) {
      outcome.state = trouble;
    } else {
      outcome.metrics = measure->results();
    }
  } catch (const Error& e) {
    outcome.state = std::string("refused: ") + e.what();
  }
  return outcome;
}

std::vector<std::string> fluidMethods() {
  std::vector<std::string> names;
  for (const ModelCard& card : modelCards()) {
    FluidDef def;
    def.model = card.name;
    ParticlePool pool{PoolSettings{}};
    try {
      makeFluidModel(def, DomainDef{}, pool);
      names.push_back(card.name);
    } catch (const Error&) {  // a card of something else: bullets, rigid bodies
    }
  }
  return names;
}

std::vector<std::string> methodsOf(const Case& entry) {
  return entry.softModels.empty() ? fluidMethods() : entry.softModels;
}

double order(const std::vector<Outcome>& outcomes, const std::string& metric) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const Outcome& outcome : outcomes) {
    for (const Metric& m : outcome.metrics) {
      if (m.name != metric || std::abs(m.error) < kRounding || !m.converges) continue;
      const double x = std::log(outcome.spacing), y = std::log(std::abs(m.error));
      n += 1.0;
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
  }
  const double spread = n * sxx - sx * sx;
  const double slope = spread > 0.0 ? (n * sxy - sx * sy) / spread : std::nan("");
  return std::isfinite(slope) ? slope : std::nan("");
}

}  // namespace froude::validation
