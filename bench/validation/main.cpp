// How right is each fluid method and each model of soft bodies, how does that improve with resolution, and what does it
// cost?
//
//   validation [--methods A,B] [--cases A,B] [--quick] [--threads N] [--limit SECONDS] [--rows FILE] [--list]
//
// Runs shipped scenes whose answer is known, at three spacings each (--quick: coarser and shorter), and prints the
// errors, the order of convergence and the wall time of the steps. Exit codes: 0 all runs were made, whatever their
// errors; 2 the command line is wrong; 4 the rows could not be written.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>

#include "validation/rows.h"

namespace {

using namespace froude;
using namespace froude::validation;

constexpr const char* kUsage =
    "usage: validation [--methods A,B] [--cases A,B] [--quick] [--threads N] [--limit SECONDS] [--rows FILE] "
    "[--list]\n"
    "  --methods A,B   fluid methods and models of soft bodies (default: all of this build)\n"
    "  --cases A,B     cases (default: all; --list names them)\n"
    "  --quick         coarser spacings and shorter runs: does everything still work?\n"
    "  --threads N     threads of the steps (default 1)\n"
    "  --limit SECONDS give a run up whose steps take longer\n"
    "  --rows FILE     append the rows to FILE, CSV\n"
    "  --list          say what there is, and run nothing\n"
    "  --help          say this\n"
    "exit codes: 0 all runs were made, whatever their errors; 2 the command line is wrong; 4 the rows cannot be "
    "written\n";

struct Options {
  std::vector<std::string> methods, cases;
  bool quick = false, list = false, help = false;
  int threads = 1;
  double limit = kInfinity;  // [s]
  std::string rows;
};

std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> out;
  std::stringstream stream(list);
  for (std::string word; std::getline(stream, word, ',');)
    if (!word.empty()) out.push_back(word);
  if (out.empty()) throw Error("'" + list + "' names nothing; leave the option out for all");
  return out;
}

/// Throws Error in words.
Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      options.help = true;
      continue;
    }
    if (word == "--quick" || word == "--list") {
      (word == "--quick" ? options.quick : options.list) = true;
      continue;
    }
    if (word != "--methods" && word != "--cases" && word != "--threads" && word != "--limit" && word != "--rows")
      throw Error("unknown word '" + word + "'");
    if (i + 1 == argc) throw Error(word + " needs a value");
    const std::string value = argv[++i];
    if (word == "--methods") options.methods = words(value);
    if (word == "--cases") options.cases = words(value);
    if (word == "--rows") options.rows = value;
    if (word == "--limit") {
      const auto result = std::from_chars(value.data(), value.data() + value.size(), options.limit);
      if (result.ec != std::errc() || *result.ptr != '\0' || !(options.limit > 0.0))
        throw Error("--limit " + value + ": seconds above 0 are right");
    }
    if (word == "--threads") {
      const auto result = std::from_chars(value.data(), value.data() + value.size(), options.threads);
      if (result.ec != std::errc() || *result.ptr != '\0' || options.threads < 1 || options.threads > 1024)
        throw Error("--threads " + value + ": a number from 1 to 1024 is right");
    }
  }
  return options;
}

void expectKnown(const std::vector<std::string>& asked, const std::vector<std::string>& known,
                 const std::string& what) {
  for (const std::string& name : asked)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(fmt::format("unknown {} '{}'; there are: {}", what, name, fmt::join(known, ", ")));
}

void list(const std::vector<std::string>& methods) {
  fmt::print("methods: {}\n\n", fmt::join(methods, ", "));
  for (const Case& c : allCases()) {
    fmt::print("{} (scenes/{}.toml{})\n  {}\n  spacings {}; quick {}\n", c.name, c.scene,
               c.softModels.empty() ? "" : fmt::format("; {}", fmt::join(c.softModels, ", ")), c.measures,
               fmt::join(c.full.spacings, ", "), fmt::join(c.quick.spacings, ", "));
  }
}

/// Appends; the heads stand in the first line of a new file.
void write(const std::string& file, const std::vector<std::string>& lines) {
  std::string first;
  const bool fresh = !std::getline(std::ifstream(file), first);
  if (!fresh && first != csvHead()) throw Error("--rows " + file + ": holds something else than rows of this program");
  std::ofstream out(file, std::ios::app);
  if (fresh) out << csvHead() << '\n';
  for (const std::string& line : lines) out << line << '\n';
  if (!out.flush()) throw std::system_error(errno, std::generic_category(), "cannot write " + file);
}

Series run(const Case& entry, const std::string& method, const Options& options) {
  Series series{&entry, method, {}};
  const Form& form = options.quick ? entry.quick : entry.full;
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
  tbb::task_arena arena(options.threads);
  for (const double spacing : form.spacings)
    series.outcomes.push_back(arena.execute([&] {
      return runOnce(entry, method, spacing, form.overrides, {options.limit, {}});
    }));
  return series;
}

int validate(Options options) {
  std::vector<std::string> methods = fluidMethods();
  for (const auto& [name, model] : scene::softModelNames()) methods.push_back(name);
  std::vector<std::string> names;
  for (const Case& c : allCases()) names.push_back(c.name);
  expectKnown(options.methods, methods, "method");
  expectKnown(options.cases, names, "case");
  if (options.methods.empty()) options.methods = methods;
  if (options.cases.empty()) options.cases = names;
  if (options.help) {
    fmt::print("{}", kUsage);
    return 0;
  }
  if (options.list) {
    list(methods);
    return 0;
  }
  if (!options.rows.empty()) write(options.rows, {});  // not after the first hour that it cannot be
  const Context here = context(options.threads);
  if (!here.timed) fmt::print(stderr, "validation: this build is not the one of the preset 'bench': no times\n");
  fmt::print("{}\n", tableHead());
  for (const Case& entry : allCases()) {
    if (std::find(options.cases.begin(), options.cases.end(), entry.name) == options.cases.end()) continue;
    for (const std::string& method : methodsOf(entry)) {
      if (std::find(options.methods.begin(), options.methods.end(), method) == options.methods.end()) continue;
      const Series series = run(entry, method, options);
      for (const std::string& line : tableLines(series, here)) fmt::print("{}\n", line);
      std::fflush(stdout);
      if (!options.rows.empty()) write(options.rows, csvLines(series, here));
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return validate(parse(argc, argv));
  } catch (const std::system_error& e) {
    fmt::print(stderr, "validation: {}\n", e.what());
    return 4;
  } catch (const Error& e) {
    fmt::print(stderr, "validation: {}\n{}", e.what(), kUsage);
    return 2;
  }
}
