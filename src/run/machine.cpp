#include "run/machine.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <thread>

namespace froude::run {
namespace {

constexpr int kNoLimit = 1 << 20;  // more cores than any machine has

int affinityCores() {
  // Sets of growing size: the kernel refuses one that is smaller than its own mask.
  for (int cpus = 1024; cpus <= 1024 * 64; cpus *= 4) {
    cpu_set_t* set = CPU_ALLOC(static_cast<std::size_t>(cpus));
    const std::size_t size = CPU_ALLOC_SIZE(static_cast<std::size_t>(cpus));
    CPU_ZERO_S(size, set);
    const bool known = sched_getaffinity(0, size, set) == 0;
    const int count = known ? CPU_COUNT_S(size, set) : 0;
    CPU_FREE(set);
    if (known) return count;
  }
  return static_cast<int>(std::thread::hardware_concurrency());
}

std::string firstLine(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

// Path of this process in the version 2 hierarchy ("0::/user.slice"); empty when there is none.
std::optional<std::string> controlGroup() {
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("0::")) return line.substr(3);
  }
  return std::nullopt;
}

// Calls visit(folder) for the process's control group and every group above it: the tightest limit counts.
void forEachControlGroup(const std::function<void(const std::string&)>& visit) {
  const std::optional<std::string> group = controlGroup();
  if (!group) return;
  std::string path = *group;
  while (true) {
    visit("/sys/fs/cgroup" + path);
    if (path.empty() || path == "/") return;
    path.erase(path.find_last_of('/'));
  }
}

int quotaCores() {
  double cores = kNoLimit;
  forEachControlGroup([&](const std::string& folder) {
    std::istringstream line(firstLine(folder + "/cpu.max"));
    double quota = 0.0, period = 0.0;
    if (line >> quota >> period && quota > 0.0 && period > 0.0) cores = std::min(cores, quota / period);
  });
  return static_cast<int>(std::ceil(cores));
}

int slurmCores() {
  const char* text = std::getenv("SLURM_CPUS_PER_TASK");
  const int cores = text != nullptr ? std::atoi(text) : 0;
  return cores > 0 ? cores : kNoLimit;
}

// What a limit on the address space (`ulimit -v`) leaves.
std::uint64_t addressSpaceLeft() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<std::uint64_t>::max();
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const std::uint64_t used = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 1;  // 0 would mean unknown
}

}  // namespace

int usableCores() { return std::max(1, std::min({affinityCores(), quotaCores(), slurmCores()})); }

std::uint64_t availableMemoryBytes() {
  std::uint64_t available = 0;
  std::ifstream in("/proc/meminfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("MemAvailable:")) available = std::strtoull(line.c_str() + 13, nullptr, 10) * 1024;
  }
  forEachControlGroup([&](const std::string& folder) {
    const std::string limit = firstLine(folder + "/memory.max");
    if (limit.empty() || limit == "max") return;
    const std::uint64_t most = std::strtoull(limit.c_str(), nullptr, 10);
    const std::uint64_t used = std::strtoull(firstLine(folder + "/memory.current").c_str(), nullptr, 10);
    available = std::min(available, most > used ? most - used : 0);
  });
  return available > 0 ? std::min(available, addressSpaceLeft()) : 0;
}

std::string cpuName() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string findProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string file = (folder.empty() ? "." : folder) + "/" + name;
    if (access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

std::string programPath() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).string();
}

std::string bytesInWords(double bytes) {
  constexpr std::array<std::string_view, 6> kUnits{"bytes", "kB", "MB", "GB", "TB", "PB"};
  std::size_t unit = 0;
  while (bytes >= 1000.0 && unit + 1 < kUnits.size()) {
    bytes /= 1000.0;
    ++unit;
  }
  return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

}  // namespace froude::run
