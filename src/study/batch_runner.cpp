#include "study/batch_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "run/machine.h"
#include "run/threads.h"
#include "study/shares.h"

namespace froude::study {
namespace {

using Stage = RunTask::Stage;
constexpr std::chrono::milliseconds kBeat{100};  // between two looks at clock, signal and terminal
constexpr int kBarWidth = 20;                    // [characters]

}  // namespace

BatchRunner::BatchRunner(const BatchPlan& plan, const TaskSettings& tasks, const RunnerSettings& settings,
                         std::function<void(std::size_t, const RunResult&)> finished)
    : plan_(plan), tasks_(tasks), settings_(settings), finished_(std::move(finished)) {}

void BatchRunner::run(const std::vector<std::size_t>& which) {
  waiting_.assign(which.begin(), which.end());
  total_ = which.size();
  const run::ThreadLimit limit(std::max(settings_.cores, 2));
  while (true) {
    while (reap()) {
    }
    if (tasks_.signal() != 0) waiting_.clear();
    startNext();
    admit();
    deal();
    if (slots_.empty() && waiting_.empty()) break;
    draw();
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kBeat, [&] { return anyChange_; });
    anyChange_ = false;
  }
  lines_.clear();
}

void BatchRunner::wake() {
  const std::scoped_lock lock(mutex_);
  anyChange_ = true;
  changed_.notify_one();
}

// Takes one run that has ended out of its slot; false when there is none.
bool BatchRunner::reap() {
  const auto over =
      std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.task->stage() == Stage::Ended; });
  if (over == slots_.end()) return false;
  const Slot slot = std::move(*over);
  slots_.erase(over);
  ++ended_;
  tellEnd(slot);
  finished_(slot.index, slot.task->result());
  return true;
}

int BatchRunner::coresWanted() const {
  int wanted = 0;
  for (const Slot& slot : slots_) wanted += wantedCores(slot.task->particles(), settings_.cores);
  return wanted;
}

// One run at a time is loaded and waits, so that no memory is held by runs that cannot begin.
void BatchRunner::startNext() {
  if (waiting_.empty()) return;
  const bool oneWaits = std::any_of(slots_.begin(), slots_.end(), [](const Slot& s) {
    return s.task->stage() == Stage::Loading || s.task->stage() == Stage::Ready;
  });
  const bool full = settings_.jobs > 0 ? static_cast<int>(slots_.size()) >= settings_.jobs
                                       : !slots_.empty() && coresWanted() >= settings_.cores;
  if (oneWaits || full) return;
  const std::size_t index = waiting_.front();
  waiting_.pop_front();
  slots_.push_back({index, std::make_unique<RunTask>(plan_.runs[index], tasks_, [this] { wake(); })});
}

void BatchRunner::admit() {
  for (Slot& slot : slots_) {
    RunTask& task = *slot.task;
    if (task.stage() != Stage::Ready || task.cores() > 0) continue;
    if (tasks_.signal() != 0) {
      task.cancel();
      continue;
    }
    const bool alone = slots_.size() == 1;
    const bool fits = settings_.jobs > 0 || coresWanted() <= settings_.cores;  // its own are among them
    const auto free = static_cast<double>(run::availableMemoryBytes());
    const bool memory = free == 0.0 || task.memory() <= free;
    if (alone || (fits && memory)) task.share(1);
  }
}

void BatchRunner::deal() {
  std::vector<RunTask*> atWork;
  std::vector<std::size_t> particles;
  int cores = settings_.cores;
  for (const Slot& slot : slots_) {
    if (slot.task->stage() == Stage::Loading) --cores;  // it has one of its own
    if (slot.task->cores() == 0 || slot.task->stage() == Stage::Ended) continue;
    atWork.push_back(slot.task.get());
    particles.push_back(slot.task->particles());
  }
  const std::vector<int> shares = dealCores(particles, cores);
  for (std::size_t i = 0; i < atWork.size(); ++i)
    if (atWork[i]->cores() != shares[i]) atWork[i]->share(shares[i]);
}

void BatchRunner::draw() {
  if (settings_.quiet || !lines_.onTerminal()) return;
  std::vector<std::string> lines;
  for (const Slot& slot : slots_) {
    const RunTask& task = *slot.task;
    const std::string& name = plan_.runs[slot.index].folder;
    if (task.stage() != Stage::Running) {
      lines.push_back(fmt::format("{} {}: {}", run::bar(0.0, kBarWidth), name,
                                  task.stage() == Stage::Loading ? "reading the scene" : "waiting for cores"));
      continue;
    }
    lines.push_back(fmt::format("{} {}: {:.4g} of {:.4g} s, {} particles, {} core{}",
                                run::bar(task.progress(), kBarWidth), name, task.time(), task.end(), task.particles(),
                                task.cores(), task.cores() == 1 ? "" : "s"));
  }
  lines.push_back(fmt::format("{} of {} runs ended, {} at work", ended_, total_, slots_.size()));
  lines_.draw(lines);
}

void BatchRunner::tellEnd(const Slot& slot) {
  const RunResult& result = slot.task->result();
  if (settings_.quiet) return;
  const std::string& name = plan_.runs[slot.index].folder;
  for (const std::string& note : slot.task->notes()) lines_.say(name + ": " + note);
  const std::string how = result.reason.empty() ? result.status : result.status + ": " + result.reason;
  lines_.say(fmt::format("[{}/{}] {}: {}", ended_, total_, name, how));
}

}  // namespace froude::study
