#include "study/run_task.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <new>
#include <utility>

#include "export/frames.h"
#include "run/exit_codes.h"
#include "run/threads.h"
#include "scene/estimate.h"

namespace froude::study {

namespace fs = std::filesystem;

namespace {

// As it was named, where that still leads to it: messages are for the person who named it.
std::string pathOf(const PlannedRun& plan) {
  std::error_code error;
  return fs::absolute(plan.scene, error).lexically_normal() == plan.file ? plan.scene : plan.file;
}

}  // namespace

RunTask::RunTask(const PlannedRun& plan, const TaskSettings& settings, std::function<void()> changed)
    : plan_(plan),
      settings_(settings),
      changed_(std::move(changed)),
      folder_(settings.folder + "/" + plan.folder),
      thread_([this] { work(); }) {}

RunTask::~RunTask() { thread_.join(); }

double RunTask::progress() const { return end_ > 0.0 ? time_ / end_ : 0.0; }

void RunTask::update(double time, std::size_t particles) {
  time_.store(time, std::memory_order_relaxed);
  particles_.store(particles, std::memory_order_relaxed);
}

void RunTask::share(int cores) {
  const std::scoped_lock lock(mutex_);
  share_ = cores;
  wake_.notify_one();
}

void RunTask::cancel() {
  const std::scoped_lock lock(mutex_);
  cancelled_ = true;
  wake_.notify_one();
}

void RunTask::enter(Stage stage) {
  stage_ = stage;
  changed_();
}

void RunTask::refuse(const std::string& reason, const char* status) {
  result_.status = status;
  result_.reason = reason;
}

// Whatever goes wrong is this run's affair, and told in its row.
void RunTask::work() {
  try {
    load();
    if (waitForCores()) {
      run::inArena(taken_ = share_, [&] { begin(); });
      advance();
    }
    result_ = readResult(folder_);
  } catch (const scene::SceneError& e) {
    refuse(e.what(), "refused");
  } catch (const run::UsageError& e) {
    refuse(e.what(), "refused");
  } catch (const std::bad_alloc&) {
    refuse("there is not enough memory", "failed");
  } catch (const std::exception& e) {
    result_ = readResult(folder_);  // how far it came
    refuse(e.what(), "failed");
  }
  session_.reset();
  scene_.reset();
  enter(Stage::Ended);
}

void RunTask::load() {
  if (run::hasCheckpoint(folder_)) {
    particles_ = std::strtoull(readResult(folder_).value("particles").c_str(), nullptr, 10);
    return;
  }
  run::inArena(1, [&] { scene_ = scene::load(pathOf(plan_), plan_.changes); });
  particles_ = scene_->fluidParticles() + scene_->bulletCount();
  memory_ = scene::estimate(*scene_).bytes;
}

bool RunTask::waitForCores() {
  enter(Stage::Ready);
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [&] { return cancelled_ || share_ > 0; });
  return share_ > 0;
}

void RunTask::begin() {
  run::SessionOptions options = settings_.session;
  options.force = false;
  if (!scene_) {
    try {
      session_.emplace(run::RunFolder::open(folder_), options);
    } catch (const run::InputError& e) {
      session_.reset();
      notes_.push_back(fmt::format("{}; the run starts again", e.what()));
      scene_ = scene::load(pathOf(plan_), plan_.changes);
    }
  }
  if (scene_) {
    session_.emplace(std::move(*scene_), options);
    scene_.reset();
    session_->begin(run::RunFolder::create(folder_, session_->scene().name, true));
  }
  notes_.insert(notes_.end(), session_->notes().begin(), session_->notes().end());
  time_ = session_->time();
  end_ = session_->end();
}

void RunTask::advance() {
  enter(Stage::Running);
  if (session_->nothingLeft()) return;
  run::Status status = run::Status::Running;
  try {
    while (status == run::Status::Running) {
      taken_ = share_;
      run::inArena(taken_, [&] { status = session_->advance(*this).status; });
    }
  } catch (const std::bad_alloc&) {
    session_->markFailed("there is not enough memory");
    throw;
  } catch (const std::exception& e) {
    session_->markFailed(e.what());
    throw;
  }
}

}  // namespace froude::study
