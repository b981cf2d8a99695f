#include "run/run_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "export/frames.h"
#include "run/atomic_file.h"
#include "run/exit_codes.h"

namespace froude::run {
namespace {

namespace fs = std::filesystem;
using exporting::OutputError;

bool allDigits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// `frame_00012.png` for ("frame_", ".png").
bool isNumbered(std::string_view name, std::string_view before, std::string_view after) {
  return name.size() > before.size() + after.size() && name.starts_with(before) && name.ends_with(after) &&
         allDigits(name.substr(before.size(), name.size() - before.size() - after.size()));
}

// What a run writes at the top of its folder; anything else is somebody's own.
bool isRunFile(std::string_view name) {
  if (name.ends_with(kPartSuffix)) name.remove_suffix(kPartSuffix.size());
  constexpr std::array<std::string_view, 11> kNames{
      "scene.toml", "summary.json", "checkpoint.h5", "checkpoint_before.h5", "gauges.csv", "leaks.csv",
      "frames.h5",  "frames.xdmf",  "film.mp4",      "player.frames",        "index.html"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end() || isNumbered(name, "frame_", ".png") ||
         isNumbered(name, "frame_", ".vdb");
}

bool isSegment(std::string_view name) {
  if (name.ends_with(kPartSuffix)) name.remove_suffix(kPartSuffix.size());
  return isNumbered(name, "", ".h5");
}

bool holdsRun(const std::string& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder + "/summary.json", ignored) && fs::is_regular_file(folder + "/scene.toml", ignored);
}

template <typename Predicate>
void removeFiles(const std::string& folder, Predicate belongs) {
  std::error_code error;
  std::vector<fs::path> doomed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_directory() && belongs(entry.path().filename().string())) doomed.push_back(entry.path());
  }
  for (const fs::path& file : doomed) {
    if (unlink(file.c_str()) != 0) throw OutputError(file.string() + ": cannot be replaced: " + std::strerror(errno));
  }
}

void removeRunFiles(const std::string& folder) {
  std::error_code ignored;
  if (fs::is_directory(folder + "/frames", ignored)) {
    removeFiles(folder + "/frames", isSegment);
    rmdir((folder + "/frames").c_str());  // stays if something foreign is in it
  }
  // What tells that this is a run goes last: a process that is killed in between leaves a folder that may be replaced.
  removeFiles(folder,
              [](std::string_view name) { return isRunFile(name) && name != "scene.toml" && name != "summary.json"; });
  removeFiles(folder, [](std::string_view name) { return name == "summary.json"; });
  removeFiles(folder, isRunFile);
}

bool isEmptyButForLock(const std::string& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string() != FolderLock::kName) return false;
  }
  return true;
}

// A run that was killed before its first summary: what is written until then, and nothing else.
bool holdsBeginning(const std::string& folder) {
  constexpr std::array<std::string_view, 4> kFirst{"scene.toml", "scene.toml.part", "summary.json.part",
                                                   FolderLock::kName};
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (std::find(kFirst.begin(), kFirst.end(), name) == kFirst.end()) return false;
  }
  return true;
}

std::string withoutSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

// False when something of that name was there already.
bool makeFolder(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  std::error_code error;
  if (!parent.empty()) fs::create_directories(parent, error);
  if (!error && mkdir(path.c_str(), 0777) == 0) return true;
  if (!error && errno == EEXIST) return false;
  throw OutputError(path + ": cannot be made: " + (error ? error.message() : std::strerror(errno)));
}

// mkdir decides, so that two runs that start together get two folders.
std::string firstFreeFolder(const std::string& sceneName) {
  std::string path = "out/" + sceneName;
  for (int number = 2; !makeFolder(path); ++number) path = fmt::format("out/{}-{}", sceneName, number);
  return path;
}

}  // namespace

RunFolder::RunFolder(std::string path, bool made) : path_(std::move(path)), made_(made), lock_(path_, "run") {}

RunFolder RunFolder::create(const std::string& wanted, const std::string& sceneName, bool force) {
  if (wanted.empty() && !force) return {firstFreeFolder(sceneName), true};
  const std::string path = wanted.empty() ? "out/" + sceneName : withoutSlash(wanted);
  if (makeFolder(path)) return {path, true};

  std::error_code error;
  if (!fs::is_directory(path, error))
    throw UsageError("-o " + path + ": this is a file; name a folder that is absent or empty");
  if (access(path.c_str(), R_OK | X_OK) != 0) throwOutputError(path);
  RunFolder folder(path, false);
  if (isEmptyButForLock(path)) return folder;
  if (!holdsRun(path) && !(force && holdsBeginning(path))) {
    throw UsageError("-o " + path +
                     ": the folder holds files that are not a run's; name a folder that is absent or empty");
  }
  if (!force) {
    throw UsageError("-o " + path + ": the folder holds a run; `froude resume " + path +
                     "` goes on with it, --force replaces it, another -o keeps it");
  }
  removeRunFiles(path);
  return folder;
}

RunFolder RunFolder::open(const std::string& folder) {
  const std::string path = withoutSlash(folder);
  std::error_code error;
  if (!fs::is_directory(path, error)) throw UsageError(path + ": there is no such folder; name the folder of a run");
  if (!holdsRun(path))
    throw UsageError(path + ": this is not the folder of a run (it has no scene.toml and summary.json)");
  return {path, false};
}

void RunFolder::abandon() {
  removeRunFiles(path_);
  if (!made_) return;
  unlink(file(FolderLock::kName).c_str());
  rmdir(path_.c_str());
}

}  // namespace froude::run
