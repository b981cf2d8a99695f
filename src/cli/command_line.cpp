// The one file that includes CLI11: all options of all commands, their help and their checks.
#include <fmt/format.h>
#include <froude/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "cli/description.h"
#include "cli/help_texts.h"
#include "cli/request.h"
#include "export/vdb_frames.h"
#include "run/exit_codes.h"
#include "scene/document.h"

namespace froude::cli {
namespace {

using run::UsageError;

constexpr std::array<std::string_view, 11> kCommands{"run",   "check", "explain", "field",      "batch", "resume",
                                                     "chart", "bench", "doctor",  "completion", "man"};
constexpr int kMostThreads = 1024;
constexpr int kMostTasks = 1000000;
constexpr double kMostMetres = 1e9;
constexpr int kNarrowest = 320, kWidest = 8192;  // picture [pixels]

CLI::Validator wholeNumber(int low, int high) {
  return {[=](std::string& text) -> std::string {
            int value = 0;
            if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
            return fmt::format("'{}' is not a whole number from {} to {}", text, low, high);
          },
          ""};
}

CLI::Validator seconds() {
  return {[](std::string& text) -> std::string {
            double value = 0.0;
            if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0.0) return {};
            return fmt::format("'{}' is not a time in seconds, 0 or more", text);
          },
          ""};
}

CLI::Validator metres(bool positive) {
  return {[=](std::string& text) -> std::string {
            double value = 0.0;
            const bool number = CLI::detail::lexical_cast(text, value) && std::abs(value) <= kMostMetres;
            if (number && (!positive || value > 0.0)) return {};
            return fmt::format("'{}' is not a {} in metres{}", text, positive ? "length" : "distance",
                               positive ? ", above 0" : "");
          },
          ""};
}

// Options as they are typed; what needs more than a look is judged after parsing.
struct Typed {
  run::RunOptions run;
  run::ResumeOptions resume;
  CheckRequest check;
  ExplainRequest explain;
  FieldRequest field;
  DoctorRequest doctor;
  study::BatchOptions batch;
  plan::ChartOptions chart;
  plan::ScalingOptions scaling;
  DescribeRequest describe;
  std::vector<std::string> sets, sweeps;
  std::string accuracy, frames, simd, layers, collect, cases, models, benchmark, subjects;
  double until = 0.0;
};

void addCommonOptions(CLI::App& command, run::SessionOptions& session, Typed& typed) {
  command.add_option("--threads", session.threads, "threads to compute with; default: all usable cores")
      ->check(wholeNumber(1, kMostThreads))
      ->type_name("N");
  command.add_option("--until", typed.until, "end at this simulated time instead of the scene's duration")
      ->check(seconds())
      ->type_name("SECONDS");
  command.add_option("--simd", typed.simd, "instruction set: scalar, sse4, avx2 or avx3")->type_name("TARGET");
  command.add_flag("--quiet", session.quiet, "errors only; the folder is still the last line on stdout");
}

void addSessionOptions(CLI::App& command, run::SessionOptions& session, Typed& typed) {
  addCommonOptions(command, session, typed);
  command.add_flag("--trace-leaks", session.traceLeaks,
                   "list every particle that leaked: when, where, into or through what; also in leaks.csv;"
                   " checks the path of every bullet, which is slower");
  command.add_flag("--verbose", session.verbose, "a line for every 100th sub-step: its length and what bound it");
}

void addSceneOptions(CLI::App& command, Typed& typed) {
  command.add_option("--set", typed.sets, "change a key of the scene, for example model.spacing=0.02; may be repeated")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
  command.add_option("--frames", typed.frames, "frames to write instead of the scene's: any of png,h5,vdb, or none")
      ->type_name("LIST");
}

void addRun(CLI::App& app, Typed& typed) {
  CLI::App& command = *app.add_subcommand("run", "run a scene to its end");
  command.add_option("SCENE", typed.run.scene, "the scene, a .toml file")->type_name("")->required();
  command.add_option("-o", typed.run.folder, "the run's folder, absent or empty; default: out/SCENE, out/SCENE-2, ...")
      ->type_name("DIR");
  command.add_flag("--force", typed.run.session.force, "replace the files of an earlier run in the folder");
  addSceneOptions(command, typed);
  command.add_option("--accuracy", typed.accuracy, "not in this version")->type_name("P%");
  addSessionOptions(command, typed.run.session, typed);
  command.footer(std::string(kRunFooter));
}

void addBatch(CLI::App& app, Typed& typed) {
  CLI::App& command = *app.add_subcommand("batch", "run many scenes, or one with many values of its keys");
  study::BatchOptions& batch = typed.batch;
  command.add_option("SCENE", batch.input.files, "scenes and batch files, .toml; with --resume those of before")
      ->type_name("");
  command.add_option("--sweep", typed.sweeps, "a key of the scenes and its values; repeated: all combinations")
      ->allow_extra_args(false)
      ->type_name("PATH=V1,V2,...");
  command.add_option("-o", batch.folder, "the batch's folder, absent or empty")->type_name("DIR");
  command.add_option("--jobs", batch.jobs, "runs side by side; default: as their sizes ask for")
      ->check(wholeNumber(1, kMostThreads))
      ->type_name("N");
  command.add_flag("--resume", batch.resume, "go on with the batch in the folder, run nothing twice");
  command.add_option("--baseline", batch.baseline, "compare with the results.csv of an earlier batch")
      ->type_name("CSV");
  command.add_flag("--slurm", batch.slurm, "hand the runs in to Slurm as a job array, one run a task, and end");
  command.add_option("--task", batch.task, "run this one of the batch in the folder, as a job of --slurm does")
      ->check(wholeNumber(0, kMostTasks))
      ->type_name("N");
  command.add_option("--collect", typed.collect, "gather the table of a batch's folder, run nothing")->type_name("DIR");
  addSceneOptions(command, typed);
  addCommonOptions(command, batch.session, typed);
  command.footer(std::string(kBatchFooter));
}

void addChart(CLI::App& app, Typed& typed) {
  CLI::App& command =
      *app.add_subcommand("chart", "measure speed against accuracy in every validation case, and draw it");
  plan::ChartOptions& chart = typed.chart;
  command.add_flag("--quick", chart.quick, "coarse spacings and quick points only, within three minutes");
  command.add_option("-o", chart.folder, "the folder of points and pictures; default: out/chart")->type_name("DIR");
  command.add_option("--cases", typed.cases, "these cases of docs/validation.md; default: all that stand on the chart")
      ->type_name("LIST");
  command.add_option("--models", typed.models, "these models; default: all")->type_name("LIST");
  command.add_option("--limit", chart.limit, "give a point up whose steps take longer; default: 120")
      ->check(seconds())
      ->type_name("SECONDS");
  command.add_option("--threads", chart.threads, "threads to compute with; default: all usable cores")
      ->check(wholeNumber(1, kMostThreads))
      ->type_name("N");
  command.footer(std::string(kChartFooter));
}

void addBench(CLI::App& app, Typed& typed) {
  CLI::App& command = *app.add_subcommand("bench", "measure how time and memory grow with particles and threads");
  command.add_option("WHAT", typed.benchmark, "scaling")->type_name("")->required();
  command.add_flag("--quick", typed.scaling.quick, "two sizes, one short run each");
  command.add_option("-o", typed.scaling.folder, "the folder of rows and pictures; default: out/scaling")
      ->type_name("DIR");
  command.add_option("--subjects", typed.subjects, "of apic,bullets,dfsph,pbf,soft,wcsph; default: all")
      ->type_name("LIST");
  command.add_option("--limit", typed.scaling.limit, "no larger size when one took longer; default: 30")
      ->check(seconds())
      ->type_name("SECONDS");
  command.footer(std::string(kBenchFooter));
}

void addDescriptions(CLI::App& app, Typed& typed) {
  CLI::App& completion = *app.add_subcommand("completion", "write the script by which a shell completes command lines");
  completion.add_option("SHELL", typed.describe.shell, "bash, zsh or fish")->type_name("")->required();
  completion.footer(std::string(kCompletionFooter));
  CLI::App& manual = *app.add_subcommand("man", "write the manual page");
  manual.footer(std::string(kManFooter));
}

void addResume(CLI::App& app, Typed& typed) {
  CLI::App& command = *app.add_subcommand("resume", "go on with a run that was stopped");
  command.add_option("DIR", typed.resume.folder, "the run's folder")->type_name("")->required();
  command.add_flag("--force", typed.resume.session.force, "go on although the SIMD target, and so the bits, differ");
  addSessionOptions(command, typed.resume.session, typed);
  command.footer(std::string(kResumeFooter));
}

void addReaders(CLI::App& app, Typed& typed) {
  CLI::App& check = *app.add_subcommand("check", "read and judge scenes, run nothing");
  check.add_option("SCENE", typed.check.scenes, "scenes, .toml files")->type_name("")->required();
  check.add_flag("--strict", typed.check.strict, "a warning is an error");
  check.add_flag("--json", typed.check.json, "findings as JSON on stdout");
  check.footer(std::string(kCheckFooter));

  CLI::App& explain = *app.add_subcommand("explain", "say what of a scene is modelled and why, and what it will cost");
  explain.add_option("SCENE", typed.explain.scene, "the scene, a .toml file")->type_name("")->required();
  explain.add_flag("--json", typed.explain.json, "as JSON");
  explain.footer(std::string(kExplainFooter));

  CLI::App& doctor = *app.add_subcommand("doctor", "say what this build and this machine are");
  doctor.add_flag("--json", typed.doctor.json, "as JSON");
  doctor.footer(std::string(kDoctorFooter));
}

void addField(CLI::App& app, Typed& typed) {
  CLI::App& command = *app.add_subcommand("field", "draw the distance field of a shape, or ask it at points");
  FieldRequest& field = typed.field;
  command.add_option("SHAPE", field.shape, "a shape: FILE.toml, SCENE.toml#BODY, FILE.csv or FILE.svg#ID")
      ->type_name("")
      ->required();
  command
      .add_option("-o", field.output,
                  "the picture to draw, .png or .svg, or a page to explore the field, .html; with --at a .csv instead "
                  "of stdout")
      ->type_name("FILE");
  command.add_option("--at", field.points, "answer at these points: a .csv with x,y in each row, or - for stdin")
      ->type_name("POINTS.csv");
  command.add_flag("--check", field.check, "compare with OpenVDB's level set of the shape, at several voxel sizes");
  command
      .add_option("--offset", field.picture.offsets,
                  "draw the curve at this distance, negative inside; may be repeated")
      ->allow_extra_args(false)
      ->check(metres(false))
      ->type_name("METRES");
  command.add_option("--show", typed.layers, "panels to draw: distance,cells,vectors,features; default: all")
      ->type_name("LIST");
  command.add_option("--width", field.picture.width, "of the picture; default: 1280")
      ->check(wholeNumber(kNarrowest, kWidest))
      ->type_name("PIXELS");
  command.add_option("--band", field.picture.band, "how far the cells reach; default: 15 % of the shape's size")
      ->check(metres(true))
      ->type_name("METRES");
  command.add_option("--cell", field.picture.cell, "size of a cell; default: by size and number of edges")
      ->check(metres(true))
      ->type_name("METRES");
  command.add_option("--scale", field.svg.scale, "metres for each user unit of a drawing; default: as it states")
      ->check(metres(true))
      ->type_name("METRES");
  command.add_option("--tolerance", field.svg.tolerance, "between a drawing's curves and their chords")
      ->check(metres(true))
      ->type_name("METRES");
  command.footer(std::string(kFieldFooter));
}

std::vector<std::string> commandNames() { return {kCommands.begin(), kCommands.end()}; }

std::string helpHint(std::string_view command) {
  return fmt::format("; `froude {}{}--help` shows what there is", command, command.empty() ? "" : " ");
}

void requireKnownCommand(const std::vector<std::string>& arguments) {
  const std::string commands = fmt::format("{}", fmt::join(kCommands, ", "));
  if (arguments.size() < 2) throw UsageError("a command is missing; there are " + commands + helpHint(""));
  const std::string& word = arguments[1];
  if (word.starts_with('-') || std::find(kCommands.begin(), kCommands.end(), word) != kCommands.end()) return;
  throw UsageError(
      fmt::format("there is no command '{}'{}; there are {}", word, scene::suggestion(word, commandNames()), commands));
}

std::vector<std::string> optionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

// What no option and no place took.
void refuseExtras(const CLI::App& command) {
  const std::vector<std::string> extras = command.remaining();
  if (extras.empty()) return;
  const std::string& word = extras.front();
  const std::string hint = helpHint(command.get_name());
  if (word.starts_with('-')) {
    const std::string bare = word.substr(0, word.find('='));
    throw UsageError(
        fmt::format("{}: there is no such option{}{}", word, scene::suggestion(bare, optionNames(command)), hint));
  }
  throw UsageError(fmt::format("'{}' is one argument too many{}", word, hint));
}

std::optional<SimdTarget> targetNamed(const std::string& word) {
  if (word.empty()) return std::nullopt;
  const std::optional<SimdTarget> target = simdTarget(word);
  const std::vector<SimdTarget> here = supportedSimdTargets();
  if (target && std::find(here.begin(), here.end(), *target) != here.end()) return target;
  std::vector<std::string> names;
  names.reserve(here.size());
  for (const SimdTarget t : here) names.emplace_back(name(t));
  throw UsageError(fmt::format("--simd {}: this {}; here there are {}", word,
                               target ? "processor does not have it" : "is no SIMD target", fmt::join(names, ", ")));
}

// The list of --frames as a value of the scene's key.
std::string framesValue(const std::string& text) {
  if (text == "none") return "[]";
  const std::vector<std::string> known{"png", "h5", "vdb", "none"};
  std::vector<std::string> kinds;
  for (const std::string& kind : CLI::detail::split(text, ',')) {
    if (kind == "vdb" && !exporting::kHasOpenVdb)
      throw UsageError("--frames vdb: this build has no OpenVDB; it has png and h5");
    if (kind != "png" && kind != "h5" && kind != "vdb") {
      throw UsageError(
          fmt::format("--frames {}: there is no kind of frames '{}'{}; name png, h5, vdb, several as png,h5, or none",
                      text, kind, scene::suggestion(kind, known)));
    }
    kinds.push_back('"' + kind + '"');
  }
  return fmt::format("[{}]", fmt::join(kinds, ", "));
}

scene::Override overrideOf(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && equals > 0) return {text.substr(0, equals), text.substr(equals + 1)};
  throw UsageError(fmt::format("--set {}: PATH=VALUE is wanted, for example --set model.spacing=0.02", text));
}

void finishSession(run::SessionOptions& session, const Typed& typed, const CLI::App& command,
                   const std::vector<std::string>& arguments) {
  if (command.count("--until") > 0) session.until = typed.until;
  session.simd = targetNamed(typed.simd);
  session.command = quoted(arguments);
}

std::vector<scene::Override> overridesOf(const Typed& typed, const CLI::App& command) {
  std::vector<scene::Override> overrides;
  for (const std::string& text : typed.sets) overrides.push_back(overrideOf(text));
  if (command.count("--frames") > 0) overrides.emplace_back("output.frames", framesValue(typed.frames));
  return overrides;
}

study::BatchOptions finishBatch(Typed& typed, const CLI::App& command, const std::vector<std::string>& arguments) {
  study::BatchOptions& batch = typed.batch;
  batch.collect = command.count("--collect") > 0;
  if (batch.collect) {
    if (!batch.input.files.empty() || command.count("-o") > 0 || batch.resume)
      throw UsageError("--collect DIR takes the batch in DIR as it is: no scenes, no -o, no --resume");
    batch.folder = typed.collect;
  }
  if (batch.folder.empty()) throw UsageError("-o DIR is missing: the folder of the batch" + helpHint("batch"));
  while (batch.folder.size() > 1 && batch.folder.back() == '/') batch.folder.pop_back();
  const bool whole = !batch.input.files.empty() || batch.resume;
  if (batch.task >= 0 && (whole || batch.slurm || batch.collect))
    throw UsageError("--task N takes the batch in -o DIR as it is: no scenes, no --resume, no --slurm");
  if (batch.slurm && command.count("--jobs") > 0)
    throw UsageError("--jobs is for this machine; Slurm decides how many tasks run at a time");
  if (!whole && !batch.collect && batch.task < 0)
    throw UsageError("SCENE is required: scenes or a batch file, or --resume" + helpHint("batch"));
  const bool changed = !typed.sweeps.empty() || !typed.sets.empty() || command.count("--frames") > 0;
  if (batch.input.files.empty() && changed)
    throw UsageError(
        "--sweep, --set and --frames belong to scenes, and none is named; --resume alone takes those of before");
  for (const std::string& text : typed.sweeps) batch.input.sweeps.push_back(study::parseSweep(text));
  batch.input.settings = overridesOf(typed, command);
  finishSession(batch.session, typed, command, arguments);
  return std::move(batch);
}

run::RunOptions finishRun(Typed& typed, const CLI::App& command, const std::vector<std::string>& arguments) {
  if (command.count("--accuracy") > 0) {
    throw UsageError(
        "--accuracy: not in this version: nothing chooses a model yet; name it in the scene as model.fluid");
  }
  typed.run.overrides = overridesOf(typed, command);
  if (command.count("-o") > 0 && typed.run.folder.empty()) throw UsageError("-o: the name of the folder is empty");
  finishSession(typed.run.session, typed, command, arguments);
  return std::move(typed.run);
}

std::vector<exporting::FieldLayer> layersOf(const std::string& text) {
  static const std::vector<std::string> kNames{"distance", "cells", "vectors", "features"};
  std::vector<exporting::FieldLayer> layers;
  for (const std::string& word : CLI::detail::split(text, ',')) {
    const auto found = std::find(kNames.begin(), kNames.end(), word);
    if (found == kNames.end())
      throw UsageError(fmt::format("--show {}: there is no panel '{}'{}; name some of {}", text, word,
                                   scene::suggestion(word, kNames), fmt::join(kNames, ",")));
    const auto layer = static_cast<exporting::FieldLayer>(found - kNames.begin());
    if (std::find(layers.begin(), layers.end(), layer) != layers.end())
      throw UsageError(fmt::format("--show {}: '{}' stands there twice", text, word));
    layers.push_back(layer);
  }
  return layers;
}

FieldRequest finishField(Typed& typed, const CLI::App& command) {
  FieldRequest& field = typed.field;
  const bool points = command.count("--at") > 0, picture = !points && !field.output.empty();
  if (points && field.points.empty()) throw UsageError("--at: the name of the table is empty");
  if (field.check && (points || command.count("-o") > 0)) throw UsageError("--check stands alone, without -o and --at");
  if (!field.check && !points && !picture)
    throw UsageError(
        "nothing is asked of the field; right is -o FILE.png, -o FILE.svg, -o FILE.html, --at POINTS.csv or --check");
  if (picture && !exporting::isPicture(field.output))
    throw UsageError(
        fmt::format("-o {}: a picture or a page is wanted, FILE.png, FILE.svg or FILE.html", field.output));
  if (points && !field.output.empty() && !field.output.ends_with(".csv"))
    throw UsageError(fmt::format("-o {}: with --at a table is written, FILE.csv", field.output));
  for (const char* option : {"--offset", "--show", "--width", "--band", "--cell"})
    if (!picture && command.count(option) > 0)
      throw UsageError(fmt::format("{} is for pictures, with -o FILE.png or FILE.svg", option));
  const bool page = picture && field.output.ends_with(".html");
  for (const char* option : {"--offset", "--show", "--width"})
    if (page && command.count(option) > 0)
      throw UsageError(fmt::format("{} is for pictures; a page has all layers, and curves at every distance", option));
  for (const char* option : {"--scale", "--tolerance"})
    if (command.count(option) > 0 && !scene::isDrawing(field.shape))
      throw UsageError(fmt::format("{} is for drawings, FILE.svg#ID; '{}' has its own metres", option, field.shape));
  if (command.count("--show") > 0) field.picture.layers = layersOf(typed.layers);
  return std::move(field);
}

plan::ChartOptions finishChart(Typed& typed, const CLI::App& command) {
  if (typed.chart.folder.empty()) throw UsageError("-o: the name of the folder is empty");
  for (const auto& [option, text, list] : {std::tuple{"--cases", &typed.cases, &typed.chart.cases},
                                           std::tuple{"--models", &typed.models, &typed.chart.models}}) {
    if (command.count(option) > 0) *list = CLI::detail::split(*text, ',');
  }
  return std::move(typed.chart);
}

plan::ScalingOptions finishBench(Typed& typed, const CLI::App& command) {
  if (typed.benchmark != "scaling")
    throw UsageError(fmt::format("bench {}: there is no such benchmark; there is scaling", typed.benchmark));
  if (typed.scaling.folder.empty()) throw UsageError("-o: the name of the folder is empty");
  if (command.count("--subjects") > 0) typed.scaling.subjects = CLI::detail::split(typed.subjects, ',');
  return std::move(typed.scaling);
}

Request finish(Typed& typed, const CLI::App& command, const std::vector<std::string>& arguments) {
  const std::string& name = command.get_name();
  if (name == "run") return finishRun(typed, command, arguments);
  if (name == "batch") return finishBatch(typed, command, arguments);
  if (name == "resume") {
    finishSession(typed.resume.session, typed, command, arguments);
    return typed.resume;
  }
  if (name == "check") return typed.check;
  if (name == "explain") return typed.explain;
  if (name == "field") return finishField(typed, command);
  if (name == "chart") return finishChart(typed, command);
  if (name == "bench") return finishBench(typed, command);
  if (name == "completion" || name == "man") {
    if (name == "completion") completionScript({}, typed.describe.shell);
    return typed.describe;
  }
  return typed.doctor;
}

constexpr std::string_view kWhat = "Froude: particles, fluids and soft bodies among rigid polygons, in two dimensions.";

std::string versionLine() {
  return fmt::format("froude {} (commit {}, SIMD {})\n", FROUDE_VERSION, FROUDE_COMMIT, name(bestSimdTarget()));
}

void build(CLI::App& app, Typed& typed) {
  app.set_version_flag("--version", versionLine(), "version, commit and SIMD target");
  app.allow_extras();
  addRun(app, typed);
  addReaders(app, typed);
  addField(app, typed);
  addBatch(app, typed);
  addResume(app, typed);
  addChart(app, typed);
  addBench(app, typed);
  addDescriptions(app, typed);
  app.footer(
      "`froude COMMAND --help` shows an example and the exit codes of a command.\nExample:\n"
      "  froude run scenes/dam_break.toml\nExit codes: 0 done; 2 the command line is wrong; others by command.");
  for (CLI::App* command : app.get_subcommands({})) command->allow_extras();
}

}  // namespace

std::string quoted(const std::vector<std::string>& arguments) {
  std::string text;
  for (const std::string& word : arguments) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 ||
             std::string_view("_-+=./,:@%").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (!text.empty()) text += ' ';
    if (plain) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

ProgramText describeProgram() {
  Typed typed;
  CLI::App app(std::string(kWhat), "froude");
  build(app, typed);
  ProgramText program{std::string(kWhat), FROUDE_VERSION, {}};
  for (const CLI::App* command : app.get_subcommands({})) {
    CommandText text{command->get_name(), command->get_description(), command->get_footer(), {}};
    for (const CLI::Option* option : command->get_options()) {
      const bool positional = option->get_positional();
      OptionText entry{{}, "", option->get_description(), positional};
      if (positional) entry.names.push_back(option->get_name(true, false));
      for (const std::string& word : option->get_snames()) entry.names.push_back("-" + word);
      for (const std::string& word : option->get_lnames()) entry.names.push_back("--" + word);
      if (!positional && option->get_items_expected_max() > 0) entry.argument = option->get_type_name();
      text.options.push_back(std::move(entry));
    }
    program.commands.push_back(std::move(text));
  }
  return program;
}

Request parseCommandLine(const std::vector<std::string>& arguments) {
  requireKnownCommand(arguments);
  Typed typed;
  CLI::App app(std::string(kWhat), "froude");
  build(app, typed);

  std::vector<const char*> words;
  words.reserve(arguments.size());
  for (const std::string& word : arguments) words.push_back(word.c_str());
  try {
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::CallForVersion&) {
    return PrintRequest{versionLine()};
  } catch (const CLI::CallForHelp&) {
    return PrintRequest{app.help()};
  } catch (const CLI::ParseError& e) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    for (const CLI::App* command : chosen) refuseExtras(*command);  // a misspelt option explains a missing argument
    throw UsageError(e.what() + helpHint(chosen.empty() ? "" : chosen.front()->get_name()));
  }
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  for (const CLI::App* command : chosen) refuseExtras(*command);
  refuseExtras(app);
  if (chosen.empty()) requireKnownCommand({arguments.front()});
  if (chosen.size() > 1) throw UsageError("two commands at once: " + chosen[1]->get_name() + "; give one");
  return finish(typed, *chosen.front(), arguments);
}

}  // namespace froude::cli
