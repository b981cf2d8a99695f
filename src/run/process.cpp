#include "run/process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <froude/base/error.h>

extern char** environ;

namespace froude::run {
namespace {

constexpr std::size_t kKeptErrors = 4096;  // bytes

/// What the child starts with: its three standard files, its folder, and signals as a shell would hand them down.
class SpawnSettings {
 public:
  SpawnSettings(int errorPipe, const std::string& folder, Listen listen) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, errorPipe, STDERR_FILENO);
    if (listen == Listen::ToAll) posix_spawn_file_actions_adddup2(&actions_, errorPipe, STDOUT_FILENO);
    if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    posix_spawnattr_init(&attributes_);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnSettings() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&actions_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

std::string readTail(int descriptor) {
  std::string kept;
  char buffer[4096];
  while (true) {
    const ssize_t got = read(descriptor, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    kept.append(buffer, static_cast<std::size_t>(got));
    if (kept.size() > kKeptErrors) kept.erase(0, kept.size() - kKeptErrors);
  }
  return kept;
}

}  // namespace

ProcessResult runProcess(const std::vector<std::string>& arguments, const std::string& folder, Listen listen) {
  if (arguments.empty()) throw Error("a process needs the name of a program");
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error(arguments[0] + ": cannot be started: " + std::strerror(errno));

  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const SpawnSettings settings(ends[1], folder, listen);
  const int failure = posix_spawnp(&child, argv[0], settings.actions(), settings.attributes(), argv.data(), environ);
  close(ends[1]);
  if (failure != 0) {
    close(ends[0]);
    throw Error(arguments[0] + ": cannot be started: " + std::strerror(failure));
  }

  ProcessResult result;
  result.errors = readTail(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace froude::run
