#include "study/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "export/frames.h"
#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/folder_lock.h"
#include "run/machine.h"
#include "run/signals.h"
#include "study/baseline.h"
#include "study/batch_file.h"
#include "study/batch_page.h"
#include "study/batch_runner.h"
#include "study/results.h"
#include "study/slurm.h"

namespace froude::study {
namespace {

namespace fs = std::filesystem;
using run::UsageError;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kTableEvery{5};  // while runs are at work

std::string planFile(const std::string& folder) { return folder + "/batch.json"; }

// A scene that cannot be run in any way is a slip of the hand, to be told before anything is written. One way is
// enough.
void requireOneReadable(const BatchPlan& plan) {
  std::optional<scene::SceneError> first;
  for (const PlannedRun& run : plan.runs) {
    try {
      scene::load(run.scene, run.changes);
      return;
    } catch (const scene::SceneError& e) {
      if (!first) first = e;
    }
  }
  if (first) throw *first;
}

bool isEmptyOrAbsent(const std::string& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return true;
  if (!fs::is_directory(folder, error))
    throw UsageError("-o " + folder + ": this is a file; name a folder that is absent or empty");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().filename() != run::FolderLock::kName) return false;
  return true;
}

BatchPlan askedPlan(const BatchOptions& options) {
  BatchPlan plan = makePlan(options.input);
  plan.command = options.session.command;
  plan.until = options.session.until;
  plan.simd = std::string(name(options.session.simd.value_or(bestSimdTarget())));
  return plan;
}

BatchPlan begunPlan(const std::string& folder) {
  std::error_code error;
  if (!fs::exists(planFile(folder), error))
    throw UsageError(folder + ": this is not the folder of a batch (it has no batch.json)");
  return planFromJson(run::readWholeFile(planFile(folder)), planFile(folder));
}

// Scenes may have been changed since: runs that have not begun would be of others.
void requireUnchanged(const BatchPlan& plan, const std::string& folder) {
  for (const auto& [file, checksum] : plan.scenes) {
    std::error_code error;
    if (fs::exists(file, error) && checksumOf(file) != checksum)
      throw UsageError(fmt::format("{}: {} has been changed since; put it back, or begin another batch with another -o",
                                   folder, file));
  }
}

BatchPlan newPlan(const BatchOptions& options) {
  const std::string& folder = options.folder;
  if (!isEmptyOrAbsent(folder))
    throw UsageError("-o " + folder +
                     ": the folder holds files that are not a batch's; name one that is absent or empty");
  if (options.input.files.empty()) throw UsageError(folder + ": there is no batch to resume; name its scenes");
  BatchPlan plan = askedPlan(options);
  requireOneReadable(plan);
  return plan;
}

// Of the batch that was begun in the folder, if it is the one that is asked for.
BatchPlan oldPlan(const BatchOptions& options) {
  const std::string& folder = options.folder;
  if (!options.resume)
    throw UsageError("-o " + folder + ": the folder holds a batch; --resume goes on with it, another -o keeps it");
  BatchPlan plan = begunPlan(folder);
  if (options.input.files.empty()) {
    const run::SessionOptions& session = options.session;
    if (session.until && session.until != plan.until)
      throw UsageError("--until belongs to the batch: all its runs have the same; leave it out to resume");
    if (session.simd && name(*session.simd) != plan.simd)
      throw UsageError("--simd: the batch computes with " + plan.simd + "; leave it out to resume");
    requireUnchanged(plan, folder);
    return plan;
  }
  if (const std::string why = difference(plan, askedPlan(options)); !why.empty())
    throw UsageError(
        fmt::format("-o {}: another batch was begun there: {}; --resume without scenes goes on with it, "
                    "another -o begins anew",
                    folder, why));
  return plan;
}

std::vector<RunResult> readResults(const BatchPlan& plan, const std::string& folder) {
  std::vector<RunResult> results;
  for (const PlannedRun& run : plan.runs) results.push_back(readResult(folder + "/" + run.folder));
  return results;
}

void tell(const BatchOptions& options, const BatchPlan& plan, const std::vector<RunResult>& results,
          const std::optional<CsvTable>& baseline) {
  if (options.session.quiet) return;
  std::vector<std::string> marks;
  std::string changes;
  if (baseline) {
    const std::vector<Comparison> comparisons = compare(*baseline, plan, results);
    for (const Comparison& c : comparisons)
      marks.push_back(c.mark() + (c.speed > 0.0 ? fmt::format(", {:.2f} x the speed", c.speed) : ""));
    changes = changesText(plan, comparisons);
  }
  fmt::print("{}", resultsTable(plan, results, marks));
  if (!changes.empty()) fmt::print("changed against {}:\n{}", options.baseline, changes);
  const auto done = std::count_if(results.begin(), results.end(), [](const RunResult& r) { return r.done(); });
  fmt::print("{} of {} runs done; {}/results.csv\n", done, results.size(), options.folder);
}

int exitCodeOf(const std::vector<RunResult>& results) {
  return std::all_of(results.begin(), results.end(), [](const RunResult& r) { return r.done(); }) ? run::kDone
                                                                                                  : run::kNotAllDone;
}

void writeTable(const BatchOptions& options, const BatchPlan& plan, const std::vector<RunResult>& results) {
  run::writeWholeFile(options.folder + "/results.csv", resultsCsv(plan, results));
}

// Table, and the folder as the last line.
int endWith(int code, const BatchOptions& options, const BatchPlan& plan, const std::vector<RunResult>& results,
            const std::optional<CsvTable>& baseline) {
  tell(options, plan, results, baseline);
  writeTable(options, plan, results);
  writeBatchPage(options.folder, plan, results);
  fmt::print("{}\n", options.folder);
  return code;
}

std::optional<CsvTable> readBaseline(const std::string& file) {
  if (file.empty()) return std::nullopt;
  CsvTable table = parseCsv(run::readWholeFile(file), file);
  if (std::find(table.columns.begin(), table.columns.end(), "state_hash") == table.columns.end())
    throw UsageError("--baseline " + file + ": this is not the results.csv of a batch (it has no state_hash)");
  return table;
}

// Runs what of the wanted is not settled yet. `results` are those of the folder, and are kept up to date, on disk too.
void carryOut(const BatchOptions& options, const BatchPlan& plan, const std::vector<std::size_t>& wanted,
              std::vector<RunResult>& results, const run::SignalGuard& signals) {
  TaskSettings tasks{options.folder, options.session, [&] { return signals.pending(); }};
  tasks.session.quiet = true;
  tasks.session.until = plan.until;
  tasks.session.simd = simdTarget(plan.simd);
  RunnerSettings settings;
  settings.cores = options.session.threads > 0 ? options.session.threads : run::usableCores();
  settings.jobs = options.jobs;
  settings.quiet = options.session.quiet;
  std::vector<std::size_t> which;
  for (const std::size_t i : wanted)
    if (!results[i].settled()) which.push_back(i);
  Clock::time_point written = Clock::now();
  BatchRunner runner(plan, tasks, settings, [&](std::size_t index, const RunResult& result) {
    results[index] = result;
    if (options.task >= 0 || Clock::now() - written < kTableEvery) return;
    written = Clock::now();
    try {
      writeTable(options, plan, results);
    } catch (const exporting::OutputError&) {  // no reason to end the runs at work; the last table will say it
    }
  });
  runner.run(which);
}

int collect(const BatchOptions& options, const std::optional<CsvTable>& baseline) {
  const BatchPlan plan = begunPlan(options.folder);
  const std::vector<RunResult> results = readResults(plan, options.folder);
  return endWith(exitCodeOf(results), options, plan, results, baseline);
}

// The runs that are not settled, by number.
std::vector<std::size_t> unsettled(const std::vector<RunResult>& results) {
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < results.size(); ++i)
    if (!results[i].settled()) which.push_back(i);
  return which;
}

int handIn(const BatchOptions& options, const BatchPlan& plan, const std::vector<RunResult>& results) {
  const std::vector<std::size_t> which = unsettled(results);
  if (which.empty()) {
    if (!options.session.quiet) fmt::print(stderr, "all runs are settled; nothing was handed in\n");
    return endWith(exitCodeOf(results), options, plan, results, std::nullopt);
  }
  const std::string folder = fs::absolute(options.folder).lexically_normal().string(), script = folder + "/job.sh";
  run::writeWholeFile(script, jobScript(run::programPath(), folder, which, options.session.threads));
  const std::string job = submit(script);
  if (!options.session.quiet)
    fmt::print("job {}: {} tasks, which compute with {}; `froude batch --collect {}` gathers the table\n", job,
               which.size(), plan.simd, options.folder);
  fmt::print("{}\n", options.folder);
  return run::kDone;
}

// One run of a job array: the folder of the run is locked, that of the batch is shared with the other tasks.
int runTask(const BatchOptions& options) {
  const BatchPlan plan = begunPlan(options.folder);
  const auto index = static_cast<std::size_t>(options.task);
  if (index >= plan.runs.size())
    throw UsageError(fmt::format("--task {}: the batch has runs 0 to {}", options.task, plan.runs.size() - 1));
  requireUnchanged(plan, options.folder);
  const run::SignalGuard signals;
  std::vector<RunResult> results = readResults(plan, options.folder);
  carryOut(options, plan, {index}, results, signals);
  const RunResult& result = results[index];
  if (!result.done() && !result.reason.empty()) fmt::print(stderr, "{}\n", result.reason);
  fmt::print("{}/{}\n", options.folder, plan.runs[index].folder);
  if (signals.pending() != 0 && !result.settled()) return 128 + signals.pending();
  if (result.done()) return run::kDone;
  if (result.status == "refused") return run::kUsageError;
  return result.status == "unstable" ? run::kUnstable : run::kOutputError;
}

}  // namespace

int runBatch(const BatchOptions& options) {
  const std::optional<CsvTable> baseline = readBaseline(options.baseline);
  if (options.collect) return collect(options, baseline);
  if (options.task >= 0) return runTask(options);
  if (options.slurm) requireSlurm();
  const run::SignalGuard signals;
  std::error_code error;
  std::optional<run::FolderLock> lock;
  BatchPlan plan;
  if (fs::exists(planFile(options.folder), error)) {
    lock.emplace(options.folder, "batch");
    plan = oldPlan(options);
  } else {
    plan = newPlan(options);
    fs::create_directories(options.folder, error);
    if (error) throw exporting::OutputError(options.folder + ": cannot be made: " + error.message());
    lock.emplace(options.folder, "batch");
    if (fs::exists(planFile(options.folder), error))
      throw UsageError("-o " + options.folder + ": another batch has been begun there in the meantime");
    run::writeWholeFile(planFile(options.folder), toJson(plan));
  }
  std::vector<RunResult> results = readResults(plan, options.folder);
  if (options.slurm) return handIn(options, plan, results);
  carryOut(options, plan, unsettled(results), results, signals);
  const int code = signals.pending() != 0 ? 128 + signals.pending() : exitCodeOf(results);
  return endWith(code, options, plan, results, baseline);
}

std::vector<scene::CheckItem> itemsToCheck(const std::vector<std::string>& files) {
  std::vector<scene::CheckItem> items;
  for (const std::string& file : files) {
    bool batch = false;
    try {
      batch = isBatchFile(file);
    } catch (const scene::SceneError&) {  // `froude check` says it, as of any scene
    }
    if (!batch) {
      items.push_back({file, file, {}});
      continue;
    }
    for (const PlannedRun& run : makePlan({{file}, {}, {}}).runs)
      items.push_back({fmt::format("{}: {}", file, run.folder), run.scene, run.changes});
  }
  return items;
}

}  // namespace froude::study
