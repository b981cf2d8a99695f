#include "run/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "run/atomic_file.h"
#include "run/exit_codes.h"

namespace froude::run {
namespace {

using scene::Scene;

RunRecord recordOf(const Scene& scene, const World& world, const std::string& command) {
  RunRecord record;
  record.command = command;
  record.sceneFile = scene.file;
  record.sceneName = scene.name;
  record.sceneSha256 = scene.sha256;
  for (const scene::Warning& warning : scene.warnings) record.warnings.push_back(warning.line());
  record.fluidArea0 = GaugeSet::fluidArea(world);
  return record;
}

SimdTarget targetFor(const Checkpoint& checkpoint, const SessionOptions& session, const std::string& folder) {
  const std::optional<SimdTarget> saved = simdTarget(checkpoint.simd());
  const std::vector<SimdTarget> here = supportedSimdTargets();
  const bool runsHere = saved && std::find(here.begin(), here.end(), *saved) != here.end();
  const SimdTarget wanted = session.simd.value_or(runsHere ? *saved : bestSimdTarget());
  if (saved == wanted || session.force) return wanted;
  throw UsageError(
      fmt::format("{}: the run computes with {}, and {} would give other bits; resume it {}, or accept that "
                  "with --force",
                  folder, checkpoint.simd(), name(wanted), runsHere ? "without --simd" : "on a machine that has it"));
}

bool isDone(const RunFolder& folder) {
  const auto summary = nlohmann::json::parse(readWholeFile(folder.file("summary.json")), nullptr, false);
  return summary.is_object() && summary.value("status", "") == name(Status::Done);
}

}  // namespace

Session::Session(Scene scene, SessionOptions options) : options_(std::move(options)), scene_(std::move(scene)) {
  if (options_.simd) scene_.world.simd = *options_.simd;
  notes_ = scene_.notes;
  for (const scene::Warning& warning : scene_.warnings) notes_.push_back(warning.line());
  build();
  record_ = recordOf(scene_, *world_, options_.command);
}

Session::Session(RunFolder folder, SessionOptions options) : options_(std::move(options)), folder_(std::move(folder)) {
  const std::unique_ptr<Checkpoint> checkpoint = openCheckpoint(folder_->path(), notes_);
  scene_ = scene::load(folder_->file("scene.toml"));
  scene_.name = checkpoint->record().sceneName;  // pictures without a title carry it
  scene_.world.simd = targetFor(*checkpoint, options_, folder_->path());
  time_ = checkpoint->time();
  record_ = checkpoint->record();
  if (time_ >= end() && isDone(*folder_)) return;
  if (checkpoint->version() != buildVersion()) {
    notes_.push_back(
        fmt::format("warning: {}: the run was begun by Froude {}, this is {}: its bits may differ from here on",
                    folder_->path(), checkpoint->version(), buildVersion()));
  }
  build();
  take(*checkpoint);
  loop_.emplace(*folder_, scene_, *world_, *gauges_, record_, RunLoop::Start::Resumed);
}

// What the library refuses of a scene is wrong in the scene.
void Session::build() {
  try {
    world_.emplace(scene::makeWorld(scene_));
  } catch (const scene::SceneError&) {
    throw;
  } catch (const Error& e) {
    throw UsageError(scene_.file + ": " + e.what());
  }
  gauges_.emplace(scene_.gauges, *world_);
}

void Session::take(Checkpoint& checkpoint) {
  try {
    checkpoint.load(*world_, *gauges_);
  } catch (const InputError&) {
    throw;
  } catch (const Error& e) {
    throw InputError(fmt::format("{}: has {} been changed? The checkpoint was written by Froude {}", e.what(),
                                 folder_->file("scene.toml"), checkpoint.version()));
  }
}

void Session::begin(RunFolder folder) {
  folder_.emplace(std::move(folder));
  try {
    loop_.emplace(*folder_, scene_, *world_, *gauges_, record_, RunLoop::Start::New);
  } catch (...) {
    folder_->abandon();
    throw;
  }
}

LoopResult Session::advance(RunObserver& observer) { return loop_->run(end(), options_, observer); }

}  // namespace froude::run
