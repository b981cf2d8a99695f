#include "program_runs/program.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace froude::testing {
namespace fs = std::filesystem;

std::string Outcome::lastLine() const {
  std::istringstream lines(out);
  std::string last;
  for (std::string line; std::getline(lines, line);) last = line;
  return last;
}

Process::Process(const Words& arguments, const fs::path& folder, const Circumstances& circumstances) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0) std::abort();
  if ((circumstances.terminal ? openpty(&err[0], &err[1], nullptr, nullptr, nullptr) : pipe2(err, O_CLOEXEC)) != 0) {
    std::abort();
  }
  std::vector<std::string> words{FROUDE_PROGRAM_FILE};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    if (!circumstances.stdoutFile.empty()) dup2(open(circumstances.stdoutFile.c_str(), O_WRONLY), STDOUT_FILENO);
    for (const auto& [name, value] : circumstances.environment) setenv(name.c_str(), value.c_str(), 1);
    if (circumstances.fileSizeLimit >= 0) {
      const auto size = static_cast<rlim_t>(circumstances.fileSizeLimit);
      const rlimit limit{size, size};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    if (circumstances.addressSpace >= 0) {
      const auto size = static_cast<rlim_t>(circumstances.addressSpace);
      const rlimit limit{size, size};
      setrlimit(RLIMIT_AS, &limit);
    }
    if (chdir(folder.c_str()) == 0) execv(argv[0], argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
}

Process::~Process() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  wait();
}

void Process::signal(int number) const { kill(pid_, number); }

Outcome Process::wait() {
  Outcome outcome;
  pollfd ends[2] = {{out_, POLLIN, 0}, {err_, POLLIN, 0}};
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    poll(ends, 2, -1);
    for (int i = 0; i < 2; ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      char buffer[4096];
      const ssize_t got = ::read(ends[i].fd, buffer, sizeof buffer);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) {  // a terminal whose other side has gone says EIO
        close(ends[i].fd);
        ends[i].fd = -1;
        continue;
      }
      (i == 0 ? outcome.out : outcome.err).append(buffer, static_cast<std::size_t>(got));
    }
  }
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return outcome;
}

ProgramTest::ProgramTest() {
  std::string pattern = (fs::temp_directory_path() / "froude-program-XXXXXX").string();
  home_ = mkdtemp(pattern.data());
}

ProgramTest::~ProgramTest() {
  std::error_code ignored;
  fs::remove_all(home_, ignored);
}

Outcome ProgramTest::froude(const Words& arguments, const Circumstances& circumstances) const {
  return Process(arguments, home_, circumstances).wait();
}

void ProgramTest::write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

std::string ProgramTest::read(const std::string& name) const {
  std::ostringstream text;
  text << std::ifstream(path(name), std::ios::binary).rdbuf();
  return text.str();
}

nlohmann::json ProgramTest::summary(const std::string& folder) const {
  return nlohmann::json::parse(read(folder + "/summary.json"), nullptr, false);
}

std::string ProgramTest::stateHash(const std::string& folder) const {
  const nlohmann::json found = summary(folder);
  return found.is_object() ? found.value("state_hash", "") : "";
}

Words ProgramTest::files(const std::string& folder) const {
  Words names;
  for (const auto& entry : fs::recursive_directory_iterator(path(folder))) {
    names.push_back(fs::relative(entry.path(), path(folder)).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void ProgramTest::waitFor(const std::string& name) const {
  using namespace std::chrono;
  const auto end = steady_clock::now() + minutes(1);
  while (!fs::exists(path(name))) {
    ASSERT_LT(steady_clock::now(), end) << name << " does not come";
    std::this_thread::sleep_for(milliseconds(2));
  }
}

std::string ProgramTest::hashOfRun(const std::string& scene, const std::string& folder, const Words& words) const {
  Words arguments{"run", scene, "-o", folder, "--quiet"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  const Outcome outcome = froude(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return stateHash(folder);
}

std::string tinyScene() {
  return R"toml(format = 1
title = "A small dam"
duration = 0.1

[domain]
box = [0.0, 0.0, 1.0, 0.8]

[model]
fluid = "pbf"
spacing = 0.04

[[fluid.block]]
shape = { box = [0.0, 0.0, 0.4, 0.4] }

[[gauge]]
name = "front"
type = "front"
axis = "x"
every = 0.01

[[gauge]]
name = "energy"
type = "energy"
species = "fluid"
every = 0.025

[output]
every = 0.02
frames = []
)toml";
}

std::string mixedScene() {
  return R"toml(format = 1
seed = 7
duration = 0.2

[domain]
box = [0.0, 0.0, 1.2, 0.8]
walls = ["bottom", "top"]
periodic = ["x"]

[model]
fluid = "pbf"
spacing = 0.04

[[fluid.block]]
shape = { box = [0.1, 0.0, 0.5, 0.3] }
velocity = ["0.2*sin(6*y)", "0"]

[bullet]
radius = 0.004

[[bullet.block]]
shape = { box = [0.6, 0.3, 1.1, 0.6] }
count = 200
velocity = [0.5, -2.0]

[[emitter]]
kind = "fluid"
from = [0.8, 0.7]
to = [0.6, 0.7]
speed = 1.0
limit = 60
policy = "recycle-oldest"

[[emitter]]
kind = "bullet"
from = [0.2, 0.5]
to = [0.1, 0.5]
speed = 3.0
rate = 300.0
spread = 20.0
lifetime = 0.05
limit = 1000

[[sink]]
shape = { box = [0.0, 0.0, 0.05, 0.05] }

[[body]]
name = "stone"
shape = { regular = { sides = 5, radius = 0.06 } }
position = [0.75, 0.2]

[[body]]
name = "paddle"
shape = { box = [-0.02, -0.1, 0.02, 0.1] }
position = [1.0, 0.2]
motion = "scripted"
script = [ { until = 10.0, velocity = ["0.2*sin(20*t)", "0"], spin = 2.0 } ]

[[gauge]]
name = "energy"
type = "energy"
species = "fluid"
every = 0.007

[output]
every = 0.02
frames = []
)toml";
}

}  // namespace froude::testing
