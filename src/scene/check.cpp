// froude check: reads and judges scenes, runs nothing.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "run/machine.h"
#include "scene/estimate.h"
#include "scene/scene.h"

namespace froude::scene {

namespace {

struct Verdict {
  std::string label;
  std::vector<std::string> errors;
  nlohmann::json errorDetails = nlohmann::json::array();
  std::optional<Scene> scene;
  Estimate cost;
};

Verdict judgeItem(const CheckItem& item) {
  Verdict verdict;
  verdict.label = item.label;
  try {
    Scene scene = load(item.file, item.changes);
    verdict.cost = estimate(scene);
    verdict.scene = std::move(scene);
  } catch (const SceneError& error) {
    verdict.errors.push_back(error.what());
    verdict.errorDetails.push_back({{"line", error.place().line},
                                    {"column", error.place().column},
                                    {"key", error.key()},
                                    {"message", error.what()}});
  } catch (const Error& error) {
    verdict.errors.push_back(item.file + ":0:0: scene: " + error.what());
    verdict.errorDetails.push_back({{"line", 0}, {"column", 0}, {"key", "scene"}, {"message", verdict.errors.back()}});
  }
  return verdict;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// 1254.3 → 1300: no more digits than an estimate has.
double twoDigits(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return unit < 1.0 ? std::round(value) : std::round(value / unit) * unit;
}

std::string softWords(const Scene& scene) {
  if (scene.world.soft.empty()) return "";
  return ", " + counted(scene.world.soft.size(), "soft body", "soft bodies") + " of " +
         counted(scene.softPoints(), "point", "points");
}

std::string sentence(const Verdict& verdict) {
  if (!verdict.scene) return "wrong";
  const Scene& scene = *verdict.scene;
  const std::string soundness =
      scene.warnings.empty() ? "sound" : "runs, with " + counted(scene.warnings.size(), "warning", "warnings");
  return fmt::format("{}: {}, {}, {}, {}, about {:.0f} sub-steps for {} s", soundness,
                     counted(scene.fluidParticles(), "fluid particle", "fluid particles"),
                     counted(scene.bulletCount(), "bullet", "bullets"),
                     counted(scene.world.bodies.size(), "body", "bodies") + softWords(scene),
                     run::bytesInWords(verdict.cost.bytes), twoDigits(verdict.cost.substeps), scene.duration);
}

nlohmann::json report(const Verdict& verdict) {
  nlohmann::json out{{"file", verdict.label}, {"ok", verdict.errors.empty()}, {"errors", verdict.errorDetails}};
  out["warnings"] = nlohmann::json::array();
  if (!verdict.scene) return out;
  const Scene& scene = *verdict.scene;
  for (const Warning& warning : scene.warnings)
    out["warnings"].push_back({{"line", warning.place.line},
                               {"column", warning.place.column},
                               {"key", warning.key},
                               {"message", warning.line()}});
  out["notes"] = scene.notes;
  out["title"] = scene.title;
  out["scene_sha256"] = scene.sha256;
  out["duration"] = scene.duration;
  out["fluid_particles"] = scene.fluidParticles();
  out["bullets"] = scene.bulletCount();
  out["bodies"] = scene.world.bodies.size();
  out["soft_bodies"] = scene.world.soft.size();
  out["soft_points"] = scene.softPoints();
  out["memory_bytes"] = static_cast<std::uint64_t>(verdict.cost.bytes);
  out["estimated_substeps"] = verdict.cost.substeps;
  return out;
}

void printProblems(const Verdict& verdict) {
  for (const std::string& error : verdict.errors) fmt::print(stderr, "{}\n", error);
  if (!verdict.scene) return;
  for (const Warning& warning : verdict.scene->warnings) fmt::print(stderr, "{}\n", warning.line());
  for (const std::string& note : verdict.scene->notes) fmt::print(stderr, "{}: note: {}\n", verdict.label, note);
}

}  // namespace

int checkCommand(const std::vector<CheckItem>& items, bool strict, bool json) {
  bool wrong = false;
  nlohmann::json reports = nlohmann::json::array();
  for (const CheckItem& item : items) {
    const Verdict verdict = judgeItem(item);
    const bool warned = verdict.scene && !verdict.scene->warnings.empty();
    wrong = wrong || !verdict.errors.empty() || (strict && warned);
    printProblems(verdict);
    if (json) {
      reports.push_back(report(verdict));
    } else {
      fmt::print("{}: {}\n", item.label, sentence(verdict));
    }
  }
  // File names may hold any bytes; JSON may not.
  if (json) fmt::print("{}\n", reports.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  std::fflush(stdout);
  return wrong ? 2 : 0;
}

}  // namespace froude::scene
