// Reading a scene from beginning to end: parse, override, check each section, place particles, write down what was
// meant.
#include <fmt/format.h>
#include <froude/version.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "scene/draft.h"
#include "scene/sha256.h"

namespace froude::scene {

namespace {

/// The sections in the order of the documentation, whatever the order of reading was.
std::string writeResolved(const Node& resolved, const std::string& file) {
  Node ordered;
  for (const char* key : {"format", "title", "seed", "duration", "gravity", "domain", "model", "fluid", "bullet",
                          "emitter", "sink", "body", "soft", "gauge", "output"})
    if (const Node* value = resolved.find(key)) ordered.set(key, *value);
  const std::string name = std::filesystem::path(file).filename().string();
  std::string comment;
  for (const char c : name) comment += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  return "# Everything that " + comment +
         " meant, resolved by Froude " FROUDE_VERSION "; this file alone gives the same run.\n" + toToml(ordered);
}

void readAll(TableReader& root, Draft& draft) {
  readHeader(root, draft);
  readDomain(root, draft);
  readEmitters(root, draft);
  readSinks(root, draft);
  readBodies(root, draft);
  readSoft(root, draft);
  readBullets(root, draft);
  readFluid(root, draft);
  readOutput(root, draft);
  readGauges(root, draft);
}

/// What needs two sections to be judged.
void checkEmitters(const TableReader& root, const Draft& draft) {
  const WorldDef& world = draft.scene.world;
  const Node* tables = root.find("emitter");
  for (std::size_t i = 0; i < world.emitters.size(); ++i) {
    const EmitterDef& emitter = world.emitters[i];
    const double length = (emitter.to - emitter.from).norm();
    const bool tooShort = emitter.kind == EmitterDef::Kind::Fluid && length < world.fluid->spacing;
    if (tooShort)
      root.fail(*tables->items[i].find("from"), emitter.name + ".from",
                fmt::format("the nozzle is {} m long, right is at least the spacing of {} m", show(length),
                            show(world.fluid->spacing)));
  }
}

}  // namespace

std::size_t Scene::fluidParticles() const {
  std::size_t count = 0;
  for (const SeededBlock& block : fluidBlocks) count += block.positions.size();
  return count;
}

std::size_t Scene::bulletCount() const {
  std::size_t count = 0;
  for (const SeededBlock& block : bulletBlocks) count += block.positions.size();
  return count;
}

std::size_t Scene::softPoints() const {
  std::size_t count = 0;
  for (const SoftDef& soft : world.soft) count += soft.mesh->points.size();
  return count;
}

std::string readText(const std::string& file, const std::string& right) {
  const std::filesystem::path path(file);
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw SceneError({file, 0, 0}, "file", "is a folder, right is " + right);
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw SceneError({file, 0, 0}, "file",
                     std::filesystem::exists(path, error) ? "cannot be read, right is a file with read permission"
                                                          : "there is no such file, right is the path of " + right);
  std::ostringstream text;
  text << stream.rdbuf();
  if (stream.bad()) throw SceneError({file, 0, 0}, "file", "reading stopped half-way");
  return text.str();
}

const std::vector<std::string>& sceneKeys() {
  static const std::vector<std::string> kKeys{"format", "title", "seed",  "duration", "gravity", "accuracy",
                                              "domain", "model", "fluid", "bullet",   "emitter", "sink",
                                              "body",   "soft",  "gauge", "output"};
  return kKeys;
}

Scene load(const std::string& file, const std::vector<Override>& overrides) {
  const std::string text = readText(file, "a scene (.toml)");
  Node document = parseDocument(file, text);
  for (const Override& change : overrides) applyOverride(document, file, change);
  Draft draft;
  draft.scene.file = file;
  draft.scene.name = std::filesystem::path(file).stem().string();
  draft.scene.sha256 = sha256(text);
  TableReader root(file, document, "", sceneKeys());
  readAll(root, draft);
  checkEmitters(root, draft);
  checkMemory(draft);
  seed(draft);
  judge(draft);
  draft.scene.resolved = writeResolved(root.resolved(), file);
  return std::move(draft.scene);
}

World makeWorld(const Scene& scene) {
  World world(scene.world);
  for (const SeededBlock& block : scene.fluidBlocks) world.addFluid(block.positions, block.velocities);
  for (const SeededBlock& block : scene.bulletBlocks) world.addBullets(block.positions, block.velocities);
  return world;
}

}  // namespace froude::scene
