// Runs the built program as a user does, in a folder of its own, and looks at what it leaves behind.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace froude::testing {

using Words = std::vector<std::string>;

/// How a process ended. `code` is the exit code, or −signal when a signal killed it.
struct Outcome {
  int code = 0;
  std::string out, err;
  std::string lastLine() const;  // of stdout
};

/// What a test may want of the process beside its arguments.
struct Circumstances {
  std::vector<std::pair<std::string, std::string>> environment;  // added
  long fileSizeLimit = -1;                                       // RLIMIT_FSIZE [bytes]
  long addressSpace = -1;                                        // RLIMIT_AS [bytes]
  std::string stdoutFile;                                        // instead of being caught
  bool terminal = false;                                         // stderr is a terminal
};

/// A program that is running. Killed if it still runs in the destructor.
class Process {
 public:
  Process(const Words& arguments, const std::filesystem::path& folder, const Circumstances& circumstances = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void signal(int number) const;
  Outcome wait();

 private:
  pid_t pid_ = -1;
  int out_ = -1, err_ = -1;
};

/// Each test has a folder, which is the program's working folder, and is removed afterwards.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// froude ARGUMENTS…, to its end.
  Outcome froude(const Words& arguments, const Circumstances& circumstances = {}) const;
  std::filesystem::path path(const std::string& name) const { return home_ / name; }
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  nlohmann::json summary(const std::string& folder) const;
  std::string stateHash(const std::string& folder) const;
  /// Everything below a folder, sorted; "" is the test's own.
  Words files(const std::string& folder) const;
  /// Waits until a file is there; fails the test after a minute.
  void waitFor(const std::string& name) const;
  /// Runs SCENE into FOLDER with further words; expects success and returns the state hash.
  std::string hashOfRun(const std::string& scene, const std::string& folder, const Words& words = {}) const;

  std::filesystem::path home_;
};

/// A block of fluid of 100 particles that collapses in a box; gauges, no frames.
std::string tinyScene();
/// Of everything a little: fluid, bullets, a fixed and a scripted body, an emitter, a sink, a periodic pair of sides.
std::string mixedScene();

}  // namespace froude::testing
