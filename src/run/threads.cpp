#include "run/threads.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/version.h>

namespace froude::run {

void withThreads(int threads, FunctionRef<void()> body) {
  // An arena alone would be held to the number of cores.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] { body(); });
}

std::string tbbVersion() { return fmt::format("{} (headers {})", TBB_runtime_version(), TBB_VERSION_STRING); }

}  // namespace froude::run
