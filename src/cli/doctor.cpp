#include "cli/doctor.h"

#include <cairo/cairo.h>
#include <fmt/format.h>
#include <froude/base/assert.h>
#include <froude/base/simd.h>
#include <froude/version.h>
#include <muParserDef.h>
#include <toml++/impl/version.h>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "export/vdb_frames.h"
#include "run/exit_codes.h"
#include "run/hdf5_archive.h"
#include "run/machine.h"
#include "run/summary.h"
#include "run/threads.h"

namespace froude::cli {
namespace {

using Json = nlohmann::ordered_json;

/// How much the same work takes at different times, in microseconds.
struct ClockNoise {
  double median = 0.0, percentile99 = 0.0, worst = 0.0;
};

ClockNoise clockNoise() {
  using Clock = std::chrono::steady_clock;
  constexpr int kRepeats = 2000;
  constexpr int kWork = 20000;  // multiplications: about 50 µs, long against the clock, short against a time slice
  std::vector<double> times;
  volatile double sink = 1.0;
  for (int i = 0; i < kRepeats; ++i) {
    const Clock::time_point start = Clock::now();
    double x = sink;
    for (int k = 0; k < kWork; ++k) x = x * 0.999999 + 1e-6;
    sink = x;
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  return {times[kRepeats / 2], times[kRepeats * 99 / 100], times.back()};
}

std::string numbers(int a, int b, int c) { return fmt::format("{}.{}.{}", a, b, c); }

std::vector<std::pair<std::string, std::string>> dependencies() {
  const std::string openVdb = exporting::openVdbVersion();
  return {
      {"oneTBB", run::tbbVersion()},
      {"Eigen", numbers(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"HDF5", run::hdf5Version()},
      {"OpenVDB", openVdb.empty() ? "not in this build: no .vdb frames, no `froude field --check`" : openVdb},
      {"Cairo", cairo_version_string()},
      {"fmt", numbers(FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
      {"toml++", numbers(TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH)},
      {"muParser", mu::ParserVersion},
      {"CLI11", CLI11_VERSION},
      {"nlohmann-json", numbers(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
  };
}

std::vector<std::string> targetNames() {
  std::vector<std::string> names;
  for (const SimdTarget target : supportedSimdTargets()) names.emplace_back(name(target));
  return names;
}

Json findings() {
  Json json;
  json["froude_version"] = FROUDE_VERSION;
  json["git_commit"] = FROUDE_COMMIT;
  json["build_type"] = run::buildType();
  json["assertions"] = kAssertionsOn;
  json["optimized"] = kOptimized;
  json["compiler"] = run::compilerName();
  json["simd"] = name(bestSimdTarget());
  json["simd_targets"] = targetNames();
  json["cpu"] = run::cpuName();
  json["threads"] = run::usableCores();
  json["available_memory_bytes"] = run::availableMemoryBytes();
  for (const auto& [library, version] : dependencies()) json["dependencies"][library] = version;
  const ClockNoise noise = clockNoise();
  json["clock_noise"] = {
      {"median_us", noise.median}, {"percentile_99_us", noise.percentile99}, {"worst_us", noise.worst}};
  json["ffmpeg"] = run::findProgram("ffmpeg");
  return json;
}

void printText(const Json& json) {
  const auto line = [](const std::string& key, const std::string& value) { fmt::print("{:<14} {}\n", key, value); };
  line("froude", json["froude_version"].get<std::string>() + " (commit " + json["git_commit"].get<std::string>() + ")");
  line("build", json["build_type"].get<std::string>() + ", " + json["compiler"].get<std::string>());
  line("assertions", json["assertions"].get<bool>() ? "on: times of this build mean nothing" : "off");
  line("optimisation", json["optimized"].get<bool>() ? "on" : "off: times of this build mean nothing");
  line("SIMD", fmt::format("{} (here: {})", json["simd"].get<std::string>(), fmt::join(targetNames(), ", ")));
  line("processor", json["cpu"].get<std::string>());
  line("threads", std::to_string(json["threads"].get<int>()));
  line("free memory", run::bytesInWords(json["available_memory_bytes"].get<double>()));
  const Json& noise = json["clock_noise"];
  const double median = noise["median_us"].get<double>();
  line("clock noise", fmt::format("median {:.1f} µs, 99 % within {:+.0f} %, worst {:+.0f} %", median,
                                  100.0 * (noise["percentile_99_us"].get<double>() / median - 1.0),
                                  100.0 * (noise["worst_us"].get<double>() / median - 1.0)));
  const std::string ffmpeg = json["ffmpeg"].get<std::string>();
  line("ffmpeg", ffmpeg.empty() ? "not installed: runs make pictures but no film" : ffmpeg);
  for (const auto& [library, version] : json["dependencies"].items()) line(library, version.get<std::string>());
}

}  // namespace

int doctorCommand(bool json) {
  const Json found = findings();
  if (json) {
    fmt::print("{}\n", found.dump(2));
  } else {
    printText(found);
  }
  return run::kDone;
}

}  // namespace froude::cli
