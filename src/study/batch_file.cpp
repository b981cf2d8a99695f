#include "study/batch_file.h"

#include <fmt/format.h>

#include <filesystem>

#include "scene/document.h"
#include "scene/reader.h"

namespace froude::study {
namespace {

namespace fs = std::filesystem;
using scene::Node;
using scene::SceneError;

Node parse(const std::string& file) {
  return scene::parseDocument(file, scene::readText(file, "a scene or a batch file (.toml)"));
}

std::string joined(const std::string& path, const std::string& key) { return path.empty() ? key : path + "." + key; }

/// The leaves of a tree of keys, "model.spacing" whether it was written with dots, quotes or tables.
template <typename Leaf, typename Visit>
void forEachLeaf(const Node& table, const std::string& path, Leaf isLeaf, Visit visit) {
  for (const auto& [key, value] : table.entries) {
    const std::string name = joined(path, key);
    if (value.kind == Node::Kind::Table && !isLeaf(value)) {
      forEachLeaf(value, name, isLeaf, visit);
    } else {
      visit(name, value);
    }
  }
}

bool isRange(const Node& node) {
  const Node* from = node.find("from");
  return from != nullptr && from->isNumeric();
}

std::vector<std::string> readScenes(scene::TableReader& batch, const std::string& file) {
  const Node& list = batch.need("scenes", "a list of scenes, [\"dam.toml\"]");
  if (list.kind != Node::Kind::Array || list.items.empty()) batch.fail("scenes", "right is a list, [\"dam.toml\"]");
  std::vector<std::string> scenes;
  for (const Node& item : list.items) {
    if (item.kind != Node::Kind::Text) batch.fail(item, "scenes", "is no file name, right is \"dam.toml\"");
    const fs::path path = fs::path(file).parent_path() / item.text;
    std::error_code error;
    if (!fs::is_regular_file(path, error))
      batch.fail(item, "scenes",
                 fmt::format("there is no scene {}, right is a path from the batch file", path.string()));
    if (isBatchFile(path.string())) batch.fail(item, "scenes", item.text + " is a batch file, right is a scene");
    scenes.push_back(path.lexically_normal().string());
  }
  return scenes;
}

void checkZip(const scene::TableReader& batch, const std::vector<Sweep>& sweeps) {
  for (const Sweep& sweep : sweeps)
    if (sweep.values.size() != sweeps.front().values.size())
      batch.fail("combine",
                 fmt::format("\"zip\" takes lists of one length; {} has {} values, {} has {}", sweeps.front().path,
                             sweeps.front().values.size(), sweep.path, sweep.values.size()));
}

}  // namespace

bool isBatchFile(const std::string& file) {
  const Node document = parse(file);
  return document.find("batch") != nullptr;
}

BatchFile readBatchFile(const std::string& file) {
  const Node document = parse(file);
  scene::TableReader root(file, document, "", {"batch"});
  std::optional<scene::TableReader> batch = root.table("batch", {"scenes", "set", "sweep", "combine"});
  BatchFile result;
  result.scenes = readScenes(*batch, file);
  for (const char* key : {"set", "sweep"})
    if (const Node* node = batch->find(key); node != nullptr && node->kind != Node::Kind::Table)
      batch->fail(key, "is no table, right are keys of a scene and their values, under [batch.sweep]");
  if (const Node* settings = batch->find("set"))
    forEachLeaf(
        *settings, "", [](const Node&) { return false; },
        [&](const std::string& path, const Node& value) {
          result.settings.emplace_back(path, scene::toInline(value));
        });
  if (const Node* sweeps = batch->find("sweep"))
    forEachLeaf(*sweeps, "", isRange, [&](const std::string& path, const Node& value) {
      result.sweeps.push_back({path, sweepValues(file, "batch.sweep." + path, value)});
    });
  if (batch->word("combine", {"product", "zip"}, "product") == "zip") {
    result.how = Combination::Zip;
    checkZip(*batch, result.sweeps);
  }
  return result;
}

}  // namespace froude::study
