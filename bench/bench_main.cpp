// The main of every benchmark: refuses to print a rate that would not be a user's, and writes rows (--rows FILE).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <froude/base/assert.h>
#include <froude/base/simd.h>
#include <froude/version.h>

namespace {

constexpr const char* kHeader = "question,case,cpu,cores,commit,build,simd,threads,dt,ns_median,ns_best,error,runs\n";

std::string cpuName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string number(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Prints as Google Benchmark does, and keeps what becomes rows.
class RowReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const auto counter = [&run](const char* name) {
        const auto at = run.counters.find(name);
        return at == run.counters.end() ? -1.0 : static_cast<double>(at->second);
      };
      const std::string name = run.run_name.str();
      if (cases_.count(name) == 0) order_.push_back(name);
      Case& c = cases_[name];
      const double perItem = counter("per_item");
      c.nanoseconds.push_back(
          1e9 * (perItem > 0.0 ? perItem : run.real_accumulated_time / static_cast<double>(run.iterations)));
      c.threads = counter("on_threads");
      c.dt = counter("dt");
      c.error = counter("error");
    }
  }

  bool write(const std::string& file, const std::string& question) const {
    const bool fresh = !std::ifstream(file).good();
    std::ofstream out(file, std::ios::app);
    if (fresh) out << kHeader;
    for (const std::string& name : order_) {
      Case c = cases_.at(name);
      std::sort(c.nanoseconds.begin(), c.nanoseconds.end());
      const std::string shown = name.substr(0, name.find("/real_time"));
      out << question << ",\"" << shown << "\",\"" << cpuName() << "\"," << std::thread::hardware_concurrency() << ','
          << FROUDE_COMMIT << ",release," << froude::name(froude::bestSimdTarget()) << ','
          << (c.threads > 0.0 ? number(c.threads, "%.0f") : "1") << ',' << (c.dt > 0.0 ? number(c.dt, "%g") : "n/a")
          << ',' << number(c.nanoseconds[c.nanoseconds.size() / 2], "%.4g") << ','
          << number(c.nanoseconds.front(), "%.4g") << ',' << (c.error >= 0.0 ? number(c.error, "%.3g") : "n/a") << ','
          << c.nanoseconds.size() << '\n';
    }
    return out.good();
  }

 private:
  struct Case {
    std::vector<double> nanoseconds;
    double threads = -1.0, dt = -1.0, error = -1.0;
  };
  std::map<std::string, Case> cases_;
  std::vector<std::string> order_;
};

}  // namespace

int main(int argc, char** argv) {
  if (froude::kAssertionsOn || !froude::kOptimized) {
    std::fprintf(stderr, "%s: this build has %s; configure with the preset 'bench' for rates that mean something\n",
                 argv[0], froude::kAssertionsOn ? "assertions on" : "no optimisation");
    return 2;
  }
  std::string rows;
  std::vector<char*> words;
  for (int i = 0; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--rows" && i + 1 < argc) {
      rows = argv[++i];
    } else {
      words.push_back(argv[i]);
    }
  }
  // A median needs runs; what the caller says comes later and wins.
  std::string repetitions = "--benchmark_repetitions=9";
  if (!rows.empty()) words.insert(words.begin() + 1, repetitions.data());
  int count = static_cast<int>(words.size());
  words.push_back(nullptr);
  benchmark::Initialize(&count, words.data());
  if (benchmark::ReportUnrecognizedArguments(count, words.data())) return 2;
  RowReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  if (rows.empty()) return 0;
  std::string question = argv[0];
  question = question.substr(question.find_last_of('/') + 1);
  question = question.substr(0, question.rfind("_bench"));
  if (reporter.write(rows, question)) return 0;
  std::fprintf(stderr, "%s: cannot write %s\n", argv[0], rows.c_str());
  return 4;
}
