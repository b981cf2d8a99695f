#include "run/run.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/run_loop.h"
#include "run/threads.h"

namespace froude::run {
namespace {

using scene::Scene;

void tellSceneNotes(const Scene& scene, bool quiet) {
  if (quiet) return;
  for (const std::string& note : scene.notes) fmt::print(stderr, "{}\n", note);
  for (const scene::Warning& warning : scene.warnings) fmt::print(stderr, "{}\n", warning.line());
}

// What the library refuses of a scene is wrong in the scene.
World buildWorld(const Scene& scene) {
  try {
    return scene::makeWorld(scene);
  } catch (const scene::SceneError&) {
    throw;
  } catch (const Error& e) {
    throw UsageError(scene.file + ": " + e.what());
  }
}

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

// What to change, by what bound the step that failed.
std::string advice(const World& world, const StepReport& report) {
  if (world.definition().timeStep) {
    return fmt::format(
        "`model.time_step` is {} s: leave it out for adaptive steps, or come nearer to theirs: too long or far too "
        "short, it is unstable",
        *world.definition().timeStep);
  }
  switch (report.trouble) {
    case Trouble::NonFinite:
      return "look for an expression of the scene (gravity, script, velocity) that is not finite there";
    case Trouble::Compression:
      return "look for fluid that is pressed together there: overlapping blocks, a body that moves into the fluid, a "
             "gap narrower than a few spacings; a smaller `model.spacing` resolves it";
    case Trouble::Turn:
      return "a free body there is spun up within one step: it is thin or light against the fluid's particles; make it "
             "heavier or thicker, or `model.spacing` smaller";
    default:
      return "look for what is fastest there: a block's or an emitter's velocity, a body; a smaller "
             "`model.spacing` makes the adaptive steps shorter";
  }
}

void tellInstability(const World& world, const StepReport& report, const std::string& folder) {
  fmt::print(stderr,
             "{}the simulation went unstable at t = {:.6g} s and was stopped: {} {:.3g} where {:.3g} is the limit",
             label("error"), world.time(), name(report.trouble), report.troubleValue, report.troubleLimit);
  if (report.troubleAt.allFinite()) {
    fmt::print(stderr, ", at ({:.4g}, {:.4g})", report.troubleAt.x(), report.troubleAt.y());
  }
  fmt::print(stderr, "; the step was set by {}", name(report.limit));
  if (report.rejected > 1) fmt::print(stderr, " and {} shorter ones were tried", report.rejected - 1);
  fmt::print(stderr, ".\n{}.\nThe last sound state is in {}/checkpoint.h5.\n", advice(world, report), folder);
}

void tellResult(const Scene& scene, const World& world, const RunRecord& record, const LoopResult& result,
                const std::string& folder) {
  const Ledger& ledger = world.ledger();
  fmt::print("{}: {:.6g} s simulated in {} of wall time, {} sub-steps, {} leaks\n", name(result.status), world.time(),
             durationInWords(record.wallSeconds), ledger.substeps, ledger.leaks);
  if (world.definition().fluid) {
    fmt::print("volume {:+.3g} %, largest compression {:.3g} %\n", 100.0 * volumeError(world, record.fluidArea0),
               100.0 * ledger.maxDensityError);
  }
  fmt::print("state {}\n", world.stateHash());
  if (scene.output.png) fmt::print("pictures: {}/frame_*.png ({})\n", folder, record.nextFrame);
  if (scene.output.vdb) fmt::print("grids: {}/frame_*.vdb ({})\n", folder, record.nextFrame);
  if (!result.film.empty()) fmt::print("film: {}\n", result.film);
  if (!result.filmNote.empty()) fmt::print(stderr, "{}\n", result.filmNote);
}

// The last line of all that has a folder, however it ended.
int endWith(int code, const std::string& folder) {
  fmt::print("{}\n", folder);
  if (std::fflush(stdout) == 0) return code;
  fmt::print(stderr, "{}standard output cannot be written\n", label("error"));
  return code == kDone ? kOutputError : code;
}

int exitCodeOf(const LoopResult& result) {
  switch (result.status) {
    case Status::Done:
      return kDone;
    case Status::Unstable:
      return kUnstable;
    case Status::Interrupted:
      return result.signal == SIGTERM ? kTerminated : kInterrupted;
    default:
      return kInternalError;
  }
}

// From the open loop to the exit code. Whatever is thrown from here on belongs to a run that has begun.
int drive(RunLoop& loop, const Scene& scene, const World& world, const SessionOptions& options,
          const std::string& folder, const SignalGuard& signals) {
  int code = kInternalError;
  try {
    const LoopResult result = loop.run(options.until.value_or(scene.duration), options, signals);
    if (result.status == Status::Unstable) tellInstability(world, result.report, folder);
    if (result.status == Status::Interrupted && !options.quiet) {
      fmt::print(stderr, "stopped by a signal at t = {:.6g} s; `froude resume {}` goes on\n", world.time(), folder);
    }
    if (!options.quiet) tellResult(scene, world, loop.record(), result, folder);
    code = exitCodeOf(result);
  } catch (const exporting::OutputError& e) {
    fmt::print(stderr, "{}{}\n", label("error"), e.what());
    code = kOutputError;
    loop.markFailed();
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}internal: {}\n", label("error"), e.what());
    loop.markFailed();
  }
  return endWith(code, folder);
}

int runInArena(const RunOptions& options) {
  const SessionOptions& session = options.session;
  Scene scene = scene::load(options.scene, options.overrides);
  if (session.simd) scene.world.simd = *session.simd;
  tellSceneNotes(scene, session.quiet);
  World world = buildWorld(scene);
  GaugeSet gauges(scene.gauges, world);
  RunRecord record = recordOf(scene, world, session.command);

  const SignalGuard signals;
  RunFolder folder = RunFolder::create(options.folder, scene.name, session.force);
  std::optional<RunLoop> loop;
  try {
    loop.emplace(folder, scene, world, gauges, std::move(record), RunLoop::Start::New);
  } catch (...) {
    loop.reset();
    folder.abandon();
    throw;
  }
  return drive(*loop, scene, world, session, folder.path(), signals);
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

std::unique_ptr<Checkpoint> findCheckpoint(const RunFolder& folder) {
  const std::string file = folder.file("checkpoint.h5");
  struct stat status = {};
  if (stat(file.c_str(), &status) != 0) {
    throw UsageError(
        fmt::format("{0}: it has no checkpoint.h5, so there is nothing to go on from; start again with "
                    "`froude run {0}/scene.toml`",
                    folder.path()));
  }
  return std::make_unique<Checkpoint>(file);
}

void loadState(Checkpoint& checkpoint, World& world, GaugeSet& gauges, const RunFolder& folder) {
  try {
    checkpoint.load(world, gauges);
  } catch (const InputError&) {
    throw;
  } catch (const Error& e) {
    throw InputError(fmt::format("{}: has {} been changed? The checkpoint was written by Froude {}", e.what(),
                                 folder.file("scene.toml"), checkpoint.version()));
  }
}

int resumeInArena(const ResumeOptions& options) {
  const SessionOptions& session = options.session;
  const SignalGuard signals;
  const RunFolder folder = RunFolder::open(options.folder);
  const std::unique_ptr<Checkpoint> checkpoint = findCheckpoint(folder);
  Scene scene = scene::load(folder.file("scene.toml"));
  scene.name = checkpoint->record().sceneName;  // pictures without a title carry it
  scene.world.simd = targetFor(*checkpoint, session, folder.path());
  const double end = session.until.value_or(scene.duration);
  if (checkpoint->time() >= end && isDone(folder)) {
    if (!session.quiet) {
      fmt::print(stderr, "{}: the run is done: t = {:.6g} s of {:.6g} s; there is nothing to resume\n", folder.path(),
                 checkpoint->time(), end);
    }
    return endWith(kDone, folder.path());
  }
  if (checkpoint->version() != buildVersion() && !session.quiet) {
    fmt::print(stderr, "{}{}: the run was begun by Froude {}, this is {}: its bits may differ from here on\n",
               label("warning"), folder.path(), checkpoint->version(), buildVersion());
  }
  World world = buildWorld(scene);
  GaugeSet gauges(scene.gauges, world);
  loadState(*checkpoint, world, gauges, folder);
  RunLoop loop(folder, scene, world, gauges, checkpoint->record(), RunLoop::Start::Resumed);
  return drive(loop, scene, world, session, folder.path(), signals);
}

}  // namespace

int runScene(const RunOptions& options) {
  int code = kInternalError;
  const int threads = options.session.threads > 0 ? options.session.threads : usableCores();
  withThreads(threads, [&] { code = runInArena(options); });
  return code;
}

int resumeRun(const ResumeOptions& options) {
  int code = kInternalError;
  const int threads = options.session.threads > 0 ? options.session.threads : usableCores();
  withThreads(threads, [&] { code = resumeInArena(options); });
  return code;
}

}  // namespace froude::run
