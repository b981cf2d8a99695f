#include "run/run_loop.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "run/atomic_file.h"

namespace froude::run {
namespace {

constexpr std::uint64_t kVerboseEvery = 100;  // [sub-steps]
constexpr std::size_t kMostLeaksTold = 20;    // a sub-step, on stderr; leaks.csv has all

}  // namespace

RunLoop::RunLoop(const RunFolder& folder, const scene::Scene& scene, World& world, GaugeSet& gauges, RunRecord record,
                 Start start)
    : folder_(folder), scene_(scene), world_(world), gauges_(gauges), record_(std::move(record)), start_(start) {
  if (start == Start::New) writeWholeFile(folder.file("scene.toml"), scene.resolved);
  writeSummary(Status::Running);
  if (!gauges.columns().empty()) {
    const std::string file = folder.file("gauges.csv");
    if (start == Start::New) {
      gaugeLog_.emplace(file, gauges.header());
    } else {
      gaugeLog_.emplace(file, record_.gaugeBytes);
    }
  }
  frames_.emplace(folder.path(), scene, world, record_.nextFrame);
  page_.emplace(folder.path(), scene, record_.nextFrame);
  lastMoment_ = lastCheckpoint_ = Clock::now();
  if (start == Start::New) takeOutput();
}

LoopResult RunLoop::run(double end, const SessionOptions& options, RunObserver& observer) {
  if (!begun_) openLeakLog(options);
  begun_ = true;
  const std::chrono::duration<double> interval(scene_.output.checkpoint);
  while (world_.time() < end) {
    if (const int signal = observer.pendingSignal(); signal != 0)
      return finish({Status::Interrupted, signal, {}, {}, {}});
    if (observer.wantsPause()) return {Status::Running, 0, {}, {}, {}};
    const double before = world_.time();
    const StepReport report = world_.substep();
    if (!report.ok()) return finish({Status::Unstable, 0, report, {}, {}});
    if (!(world_.time() > before)) throw Error(fmt::format("the step at t = {} s did not move time on", before));
    trace(report, options, observer);
    takeOutput();
    observer.update(world_.time(), liveParticles());
    if (Clock::now() - lastCheckpoint_ >= interval) {
      checkpoint();
      writeSummaryAndPage(Status::Running);
    }
  }
  return finish({Status::Done, 0, {}, {}, {}});
}

void RunLoop::takeOutput() {
  rows_.clear();
  gauges_.afterStep(world_, rows_);
  if (gaugeLog_) gaugeLog_->append(rows_);
  // A step that is longer than the interval is the frame of several times: numbers stay multiples of the interval.
  while (record_.nextFrame * scene_.output.every <= world_.time()) {
    frames_->write(world_, record_.nextFrame);
    page_->take(world_, record_.nextFrame);
    ++record_.nextFrame;
  }
}

void RunLoop::checkpoint() {
  frames_->closeSegment();
  page_->sync();
  if (gaugeLog_) {
    gaugeLog_->sync();
    record_.gaugeBytes = gaugeLog_->bytes();
  }
  if (leakLog_) leakLog_->sync();
  countWallTime();
  const Clock::time_point begin = Clock::now();
  record_.checkpointBytes = saveCheckpoint(folder_.path(), world_, gauges_, record_);
  lastCheckpoint_ = Clock::now();
  record_.checkpointSeconds = std::chrono::duration<double>(lastCheckpoint_ - begin).count();
}

LoopResult RunLoop::finish(LoopResult result) {
  checkpoint();
  if (result.status == Status::Unstable) record_.reason = describe(result.report, world_.time());
  if (result.status == Status::Done) {
    // Behind the checkpoint: a run that is resumed with a later end must not keep the row of this one.
    rows_.clear();
    gauges_.atEnd(world_, rows_);
    if (gaugeLog_) gaugeLog_->append(rows_);
    if (scene_.output.png) result.film = frames_->makeFilm();
    result.filmNote = frames_->filmNote();
  }
  countWallTime();
  writeSummaryAndPage(result.status);
  return result;
}

// A run that was traced goes on to be traced, or its list would end where it was stopped.
void RunLoop::openLeakLog(const SessionOptions& options) {
  const std::string file = folder_.file("leaks.csv");
  const bool resumed = start_ == Start::Resumed;
  if (!options.traceLeaks && !(resumed && std::filesystem::exists(file))) return;
  leakLog_.emplace(file, resumed ? std::optional<double>(world_.time()) : std::nullopt);
  EventSettings settings;
  settings.leaks = true;
  world_.record(settings);
}

void RunLoop::trace(const StepReport& report, const SessionOptions& options, RunObserver& observer) {
  const Ledger& ledger = world_.ledger();
  if (options.verbose && (ledger.substeps % kVerboseEvery == 0 || report.rejected > 0)) {
    observer.say(fmt::format("sub-step {}: t = {:.6g} s, dt = {:.3g} s by {}, {} particles{}", ledger.substeps,
                             world_.time(), report.dt, name(report.limit), liveParticles(),
                             report.rejected > 0 ? fmt::format(", undone {} times", report.rejected) : ""));
  }
  if (!leakLog_ || world_.leaks().empty()) return;
  leakLog_->append(world_);
  for (const std::string& line : leakLines(world_, kMostLeaksTold)) observer.say(line);
}

void RunLoop::markFailed(const std::string& reason) noexcept {
  try {
    countWallTime();
    record_.reason = reason;
    writeSummaryAndPage(Status::Failed);
  } catch (...) {  // the disk that failed the run may fail this as well; the first error is the one to tell
  }
}

std::string RunLoop::summaryNow(Status status) const {
  return summaryText({scene_, world_, gauges_, record_, concurrency()}, status);
}

void RunLoop::writeSummary(Status status) { writeWholeFile(folder_.file("summary.json"), summaryNow(status)); }

// The page is made of the same text, and the summary that says "done" comes last.
void RunLoop::writeSummaryAndPage(Status status) {
  const std::string summary = summaryNow(status);
  if (page_ && status != Status::Failed) page_->write(world_, summary);
  writeWholeFile(folder_.file("summary.json"), summary);
  if (page_ && status == Status::Failed) page_->write(world_, summary);  // may fail as well: the summary goes first
}

void RunLoop::countWallTime() {
  const Clock::time_point now = Clock::now();
  record_.wallSeconds += std::chrono::duration<double>(now - lastMoment_).count();
  lastMoment_ = now;
}

std::size_t RunLoop::liveParticles() const {
  return (world_.fluid() != nullptr ? world_.fluid()->size() : 0) +
         (world_.bullets() != nullptr ? world_.bullets()->size() : 0) +
         (world_.soft() != nullptr ? world_.soft()->size() : 0);
}

}  // namespace froude::run
