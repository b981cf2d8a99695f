#include "run/run.h"

#include <fmt/format.h>
#include <signal.h>

#include <cstdio>
#include <string_view>

#include "run/exit_codes.h"
#include "run/machine.h"
#include "run/progress.h"
#include "run/session.h"
#include "run/signals.h"
#include "run/threads.h"

namespace froude::run {
namespace {

using scene::Scene;

void tellNotes(const Session& session) {
  if (session.options().quiet) return;
  constexpr std::string_view kWarning = "warning: ";
  for (const std::string& note : session.notes()) {
    const bool labelled = note.starts_with(kWarning);
    fmt::print(stderr, "{}{}\n", labelled ? label("warning") : "", labelled ? note.substr(kWarning.size()) : note);
  }
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
  fmt::print(stderr, "{}the simulation was stopped, {}", label("error"), describe(report, world.time()));
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
  fmt::print("page: {}/index.html\n", folder);
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

// A run on the terminal: a bar, and signals.
class TerminalObserver : public RunObserver {
 public:
  TerminalObserver(const Session& session, const SignalGuard& signals)
      : signals_(signals), progress_(session.time(), session.end(), session.options().quiet) {}
  int pendingSignal() const override { return signals_.pending(); }
  void update(double time, std::size_t particles) override { progress_.update(time, particles); }
  void say(const std::string& line) override { progress_.say(line); }

 private:
  const SignalGuard& signals_;
  Progress progress_;
};

LoopResult advanceOnTerminal(Session& session, const SignalGuard& signals) {
  TerminalObserver observer(session, signals);
  return session.advance(observer);
}

// From the first step to the exit code.
int drive(Session& session, const SignalGuard& signals) {
  const bool quiet = session.options().quiet;
  const std::string& folder = session.folder();
  int code = kInternalError;
  try {
    const LoopResult result = advanceOnTerminal(session, signals);
    const World& world = session.world();
    if (result.status == Status::Unstable) tellInstability(world, result.report, folder);
    if (result.status == Status::Interrupted && !quiet) {
      fmt::print(stderr, "stopped by a signal at t = {:.6g} s; `froude resume {}` goes on\n", world.time(), folder);
    }
    if (!quiet) tellResult(session.scene(), world, session.record(), result, folder);
    code = exitCodeOf(result);
  } catch (const exporting::OutputError& e) {
    fmt::print(stderr, "{}{}\n", label("error"), e.what());
    code = kOutputError;
    session.markFailed(e.what());
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}internal: {}\n", label("error"), e.what());
    session.markFailed(std::string("internal: ") + e.what());
  }
  return endWith(code, folder);
}

int runInArena(const RunOptions& options) {
  Session session(scene::load(options.scene, options.overrides), options.session);
  tellNotes(session);
  const SignalGuard signals;
  session.begin(RunFolder::create(options.folder, session.scene().name, options.session.force));
  return drive(session, signals);
}

int resumeInArena(const ResumeOptions& options) {
  const SignalGuard signals;
  Session session(RunFolder::open(options.folder), options.session);
  if (session.nothingLeft()) {
    if (!options.session.quiet) {
      fmt::print(stderr, "{}: the run is done: t = {:.6g} s of {:.6g} s; there is nothing to resume\n",
                 session.folder(), session.time(), session.end());
    }
    return endWith(kDone, session.folder());
  }
  tellNotes(session);
  return drive(session, signals);
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
