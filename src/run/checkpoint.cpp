#include "run/checkpoint.h"

#include <froude/base/simd.h>
#include <froude/version.h>

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "run/atomic_file.h"
#include "run/exit_codes.h"

namespace froude::run {
namespace {

constexpr const char* kFormat = "2";

using Json = nlohmann::json;

Json toJson(const RunRecord& r) {
  return {{"command", r.command},         {"sceneFile", r.sceneFile}, {"sceneName", r.sceneName},
          {"sceneSha256", r.sceneSha256}, {"warnings", r.warnings},   {"wallSeconds", r.wallSeconds},
          {"fluidArea0", r.fluidArea0},   {"nextFrame", r.nextFrame}, {"gaugeBytes", r.gaugeBytes}};
}

RunRecord recordOf(const Json& json) {
  RunRecord r;
  json.at("command").get_to(r.command);
  json.at("sceneFile").get_to(r.sceneFile);
  json.at("sceneName").get_to(r.sceneName);
  json.at("sceneSha256").get_to(r.sceneSha256);
  json.at("warnings").get_to(r.warnings);
  json.at("wallSeconds").get_to(r.wallSeconds);
  json.at("fluidArea0").get_to(r.fluidArea0);
  json.at("nextFrame").get_to(r.nextFrame);
  json.at("gaugeBytes").get_to(r.gaugeBytes);
  return r;
}

// Both directions in one place, so that they cannot differ.
void archiveState(Archive& a, World& world, GaugeSet& gauges) {
  a.beginSection("world");
  world.archive(a);
  a.endSection();
  a.beginSection("gauges");
  gauges.archive(a);
  a.endSection();
}

}  // namespace

std::string buildVersion() { return FROUDE_VERSION " (" FROUDE_COMMIT ")"; }

bool hasCheckpoint(const std::string& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder + "/" + kCheckpointName, ignored) ||
         std::filesystem::exists(folder + "/" + kOlderCheckpointName, ignored);
}

std::uint64_t saveCheckpoint(const std::string& folder, World& world, GaugeSet& gauges, const RunRecord& record) {
  Hdf5Writer writer;
  writer.attribute("format_version", kFormat);
  writer.attribute("froude_version", buildVersion());
  writer.attribute("simd", std::string(name(world.definition().simd)));
  writer.attribute("state_hash", world.stateHash());
  Json run;
  run["time"] = world.time();
  run["record"] = toJson(record);
  writer.text("run", run.dump(-1, ' ', false, Json::error_handler_t::replace));
  archiveState(writer, world, gauges);
  const auto image = writer.finish();
  const std::string file = folder + "/" + kCheckpointName;
  keepAs(file, folder + "/" + kOlderCheckpointName);
  writeWholeFile(file, image);
  return image[0].size() + image[1].size();
}

std::unique_ptr<Checkpoint> openCheckpoint(const std::string& folder, std::vector<std::string>& notes) {
  if (!hasCheckpoint(folder)) {
    throw UsageError(folder +
                     ": it has no checkpoint.h5, so there is nothing to go on from; start again with "
                     "`froude run " +
                     folder + "/scene.toml`");
  }
  const auto older = [&]() -> std::unique_ptr<Checkpoint> {
    try {
      return std::make_unique<Checkpoint>(folder + "/" + kOlderCheckpointName);
    } catch (const Error&) {  // what is wrong with the newest is the thing to tell
      return nullptr;
    }
  };
  const auto tell = [&](const std::string& why, const Checkpoint& found) {
    notes.push_back(
        fmt::format("warning: {}; the checkpoint before it, of t = {:.6g} s, is taken instead", why, found.time()));
  };
  try {
    return std::make_unique<Checkpoint>(folder + "/" + kCheckpointName);
  } catch (const InputError& e) {
    std::unique_ptr<Checkpoint> found = older();
    if (!found) throw;
    tell(e.what(), *found);
    return found;
  } catch (const UsageError& e) {
    std::unique_ptr<Checkpoint> found = older();
    if (!found) throw;
    tell(e.what(), *found);
    return found;
  }
}

Checkpoint::Checkpoint(const std::string& file) : file_(file), reader_(file) {
  const std::string format = reader_.attribute("format_version");
  version_ = reader_.attribute("froude_version");
  if (format != kFormat) {
    throw UsageError(file + ": checkpoint of format " + format + " from Froude " + version_ +
                     "; this build reads format " + kFormat + ": resume it with the build that wrote it");
  }
  simd_ = reader_.attribute("simd");
  stateHash_ = reader_.attribute("state_hash");
  try {
    const Json run = Json::parse(reader_.text("run"));
    time_ = run.at("time").get<double>();
    record_ = recordOf(run.at("record"));
  } catch (const Json::exception& e) {
    throw InputError(file + ": its record of the run cannot be read: " + e.what());
  }
}

void Checkpoint::load(World& world, GaugeSet& gauges) {
  archiveState(reader_, world, gauges);
  if (world.stateHash() != stateHash_) {
    throw InputError(file_ + ": the state that was loaded (" + world.stateHash() + ") is not the one that was saved (" +
                     stateHash_ + "); another build may have written it: " + version_);
  }
}

}  // namespace froude::run
