#include "study/plan.h"

#include <fmt/format.h>
#include <froude/version.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "run/exit_codes.h"
#include "scene/document.h"
#include "scene/sha256.h"
#include "study/batch_file.h"

namespace froude::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using run::UsageError;

constexpr std::size_t kLongestName = 160;  // of a folder [bytes]; file systems take 255, and a run adds to it

// Scenes with their sweeps, before they are multiplied out.
struct Group {
  std::vector<std::string> scenes;
  std::vector<scene::Override> settings;
  std::vector<Sweep> sweeps;
  Combination how = Combination::Product;
};

// Own sweeps and settings come with each batch file.
std::vector<Group> groupsOf(const BatchInput& input) {
  std::vector<Group> groups;
  for (const std::string& file : input.files) {
    if (isBatchFile(file)) {
      BatchFile batch = readBatchFile(file);
      groups.push_back({std::move(batch.scenes), std::move(batch.settings), std::move(batch.sweeps), batch.how});
    } else {
      groups.push_back({{file}, {}, {}, Combination::Product});
    }
  }
  return groups;
}

void refuseTwice(const std::vector<Sweep>& own, const std::vector<Sweep>& more) {
  std::set<std::string> seen;
  for (const auto* sweeps : {&own, &more})
    for (const Sweep& sweep : *sweeps)
      if (!seen.insert(sweep.path).second)
        throw UsageError(fmt::format("{} is swept twice; one list with all its values is right", sweep.path));
}

// model.spacing → spacing, where no other parameter ends like that.
std::string shortName(const std::string& path, const std::vector<std::string>& all) {
  const auto last = [](const std::string& p) { return p.substr(p.find_last_of('.') + 1); };
  const auto same = std::count_if(all.begin(), all.end(), [&](const std::string& p) { return last(p) == last(path); });
  return plainWord(same > 1 ? path : last(path));
}

std::string folderName(const PlannedRun& run, bool withScene, const std::vector<std::string>& paths) {
  std::string name = withScene || run.parameters.empty() ? plainWord(fs::path(run.scene).stem().string()) : "";
  for (const auto& [path, value] : run.parameters)
    name += fmt::format("{}{}={}", name.empty() ? "" : "_", shortName(path, paths), plainWord(value));
  if (name.size() > kLongestName) name = name.substr(0, kLongestName) + "-" + scene::sha256(name).substr(0, 8);
  if (name.front() == '.' || name.front() == '-') name.insert(0, "_");  // no hidden folder, no option
  return name;
}

// Names that differ in nothing but what a file name leaves out get a number.
void nameFolders(BatchPlan& plan) {
  std::set<std::string> files, taken;
  for (const PlannedRun& run : plan.runs) files.insert(run.file);
  for (PlannedRun& run : plan.runs) {
    const std::string name = folderName(run, files.size() > 1, plan.parameters);
    run.folder = name;
    for (int number = 2; !taken.insert(run.folder).second; ++number) run.folder = fmt::format("{}-{}", name, number);
  }
}

Json pairs(const std::vector<scene::Override>& changes) {
  Json list = Json::array();
  for (const auto& [path, value] : changes) list.push_back({path, value});
  return list;
}

std::vector<scene::Override> overrides(const Json& list) {
  std::vector<scene::Override> changes;
  for (const Json& pair : list) changes.emplace_back(pair.at(0).get<std::string>(), pair.at(1).get<std::string>());
  return changes;
}

}  // namespace

std::string checksumOf(const std::string& file) {
  return scene::sha256(scene::readText(file, "a scene or a batch file (.toml)"));
}

BatchPlan makePlan(const BatchInput& input) {
  BatchPlan plan;
  for (Group& group : groupsOf(input)) {
    refuseTwice(group.sweeps, input.sweeps);
    std::vector<std::vector<std::string>> own = combinations(group.sweeps, group.how);
    const std::vector<std::vector<std::string>> more = combinations(input.sweeps, Combination::Product);
    std::vector<Sweep> sweeps = group.sweeps;
    sweeps.insert(sweeps.end(), input.sweeps.begin(), input.sweeps.end());
    for (const Sweep& sweep : sweeps)
      if (std::find(plan.parameters.begin(), plan.parameters.end(), sweep.path) == plan.parameters.end())
        plan.parameters.push_back(sweep.path);
    for (const std::string& file : group.scenes) {
      const std::string full = fs::absolute(file).lexically_normal().string();
      plan.scenes[full] = checksumOf(file);
      for (const auto& first : own) {
        for (const auto& second : more) {
          PlannedRun run{{}, file, full, group.settings, {}};
          run.changes.insert(run.changes.end(), input.settings.begin(), input.settings.end());
          std::vector<std::string> values = first;
          values.insert(values.end(), second.begin(), second.end());
          for (std::size_t i = 0; i < sweeps.size(); ++i) run.parameters.emplace_back(sweeps[i].path, values[i]);
          run.changes.insert(run.changes.end(), run.parameters.begin(), run.parameters.end());
          plan.runs.push_back(std::move(run));
        }
      }
    }
  }
  nameFolders(plan);
  return plan;
}

std::string toJson(const BatchPlan& plan) {
  Json json;
  json["schema"] = 1;
  json["froude_version"] = FROUDE_VERSION;
  json["git_commit"] = FROUDE_COMMIT;
  json["command"] = plan.command;
  json["simd"] = plan.simd;
  json["until"] = plan.until ? Json(*plan.until) : Json(nullptr);
  json["scenes"] = plan.scenes;
  json["parameters"] = plan.parameters;
  json["runs"] = Json::array();
  for (const PlannedRun& run : plan.runs)
    json["runs"].push_back({{"folder", run.folder},
                            {"scene", run.scene},
                            {"file", run.file},
                            {"set", pairs(run.changes)},
                            {"parameters", pairs(run.parameters)}});
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

BatchPlan planFromJson(const std::string& text, const std::string& file) {
  try {
    const Json json = Json::parse(text);
    BatchPlan plan;
    json.at("command").get_to(plan.command);
    json.at("simd").get_to(plan.simd);
    if (!json.at("until").is_null()) plan.until = json.at("until").get<double>();
    json.at("scenes").get_to(plan.scenes);
    json.at("parameters").get_to(plan.parameters);
    for (const Json& run : json.at("runs"))
      plan.runs.push_back({run.at("folder").get<std::string>(), run.at("scene").get<std::string>(),
                           run.at("file").get<std::string>(), overrides(run.at("set")),
                           overrides(run.at("parameters"))});
    return plan;
  } catch (const Json::exception& e) {
    throw run::InputError(file + ": this is not the plan of a batch: " + e.what());
  }
}

std::string difference(const BatchPlan& begun, const BatchPlan& asked) {
  for (const auto& [file, checksum] : begun.scenes) {
    const auto found = asked.scenes.find(file);
    if (found != asked.scenes.end() && found->second != checksum) return file + " has been changed since";
  }
  if (begun.runs.size() != asked.runs.size())
    return fmt::format("it has {} runs, and {} are asked for", begun.runs.size(), asked.runs.size());
  for (std::size_t i = 0; i < begun.runs.size(); ++i) {
    const PlannedRun &a = begun.runs[i], &b = asked.runs[i];
    if (a.file != b.file || a.changes != b.changes)
      return fmt::format("its run {} is {}, not {}", i, a.folder, b.folder);
  }
  if (begun.until != asked.until) return "--until differs";
  if (begun.simd != asked.simd) return fmt::format("it computes with {}, not with {}", begun.simd, asked.simd);
  return {};
}

}  // namespace froude::study
