#include "run/threads.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/version.h>

namespace froude::run {

struct ThreadLimit::Impl {
  tbb::global_control limit;
};

ThreadLimit::ThreadLimit(int threads)
    : impl_(new Impl{
          tbb::global_control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads))}) {}

ThreadLimit::~ThreadLimit() = default;

void inArena(int threads, FunctionRef<void()> body) {
  tbb::task_arena arena(threads);
  arena.execute([&] { body(); });
}

void withThreads(int threads, FunctionRef<void()> body) {
  const ThreadLimit limit(threads);  // an arena alone would be held to the number of cores
  inArena(threads, body);
}

std::string tbbVersion() { return fmt::format("{} (headers {})", TBB_runtime_version(), TBB_VERSION_STRING); }

}  // namespace froude::run
