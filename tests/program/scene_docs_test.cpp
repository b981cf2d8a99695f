// Every TOML block of the docs is a scene that loads. A block marked "toml fragment" is completed first, by what a
// scene cannot do without.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "program/scene_support.h"
#include "study/plan.h"

namespace froude {
namespace {

struct Block {
  std::string file, kind, text;
  int line = 0;
};

std::vector<Block> blocksOf(const std::filesystem::path& file) {
  std::vector<Block> blocks;
  std::ifstream stream(file);
  bool inside = false;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.rfind("```", 0) == 0) {
      inside = !inside;
      if (inside) blocks.push_back({file.string(), line.substr(3), "", number});
    } else if (inside) {
      blocks.back().text += line + "\n";
    }
  }
  return blocks;
}

std::vector<Block> allBlocks() {
  const std::filesystem::path source(FROUDE_SOURCE_DIR);
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(source / "README.md")) files.push_back(source / "README.md");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source / "docs"))
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  std::vector<Block> blocks;
  for (const auto& file : files)
    for (Block& block : blocksOf(file)) blocks.push_back(std::move(block));
  return blocks;
}

/// A scene around a fragment: the first lines before it, a domain and some fluid behind it, where it has none itself.
std::string completed(const std::string& fragment) {
  const auto has = [&](const std::string& line) { return ("\n" + fragment).find("\n" + line) != std::string::npos; };
  std::string text;
  if (!has("format")) text += "format = 1\n";
  if (!has("duration")) text += "duration = 1.0\n";
  text += fragment;
  if (!has("[domain]")) text += "\n[domain]\nbox = [0.0, 0.0, 4.0, 3.0]\n";
  if (!has("[[fluid.block]]")) text += "\n[[fluid.block]]\nshape = { box = [0.0, 0.0, 1.0, 1.0] }\n";
  return text;
}

/// What is said against a scene that stands where the drawings of the shipped scenes are.
std::string judged(const std::string& text) {
  const froude::testing::SceneFile file(text);
  std::filesystem::copy(std::string(FROUDE_SOURCE_DIR) + "/scenes/drawings",
                        std::filesystem::path(file.path()).parent_path() / "drawings");
  try {
    scene::load(file.path());
  } catch (const scene::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Docs, every_scene_in_them_loads) {
  int scenes = 0;
  for (const Block& block : allBlocks()) {
    if (block.kind != "toml") continue;
    SCOPED_TRACE(block.file + ":" + std::to_string(block.line));
    ++scenes;
    EXPECT_EQ(judged(block.text), "accepted");
  }
  EXPECT_GE(scenes, 2);
}

TEST(Docs, every_fragment_of_a_scene_in_them_loads) {
  int fragments = 0;
  for (const Block& block : allBlocks()) {
    if (block.kind != "toml fragment") continue;
    SCOPED_TRACE(block.file + ":" + std::to_string(block.line));
    ++fragments;
    EXPECT_EQ(judged(completed(block.text)), "accepted");
  }
  EXPECT_GE(fragments, 10);
}

TEST(Docs, every_batch_file_in_them_is_read) {
  int batches = 0;
  for (const Block& block : allBlocks()) {
    if (block.kind != "toml batch") continue;
    SCOPED_TRACE(block.file + ":" + std::to_string(block.line));
    ++batches;
    const std::string home = std::filesystem::temp_directory_path() / ("froude-docs-" + std::to_string(getpid()));
    std::filesystem::copy(std::string(FROUDE_SOURCE_DIR) + "/scenes", home, std::filesystem::copy_options::recursive);
    std::ofstream(home + "/b.toml") << block.text;
    const study::BatchPlan plan = study::makePlan({{home + "/b.toml"}, {}, {}});
    EXPECT_EQ(plan.runs.size(), 24u);
    for (const std::size_t i : {std::size_t{0}, plan.runs.size() - 1})
      EXPECT_NO_THROW(scene::load(plan.runs[i].scene, plan.runs[i].changes));
    std::filesystem::remove_all(home);
  }
  EXPECT_GE(batches, 1);
}

TEST(Docs, the_complete_scene_of_the_format_has_no_warning) {
  const std::vector<Block> blocks = blocksOf(std::filesystem::path(FROUDE_SOURCE_DIR) / "docs/scene-format.md");
  ASSERT_FALSE(blocks.empty());
  const scene::Scene s = froude::testing::loadText(blocks.back().text);
  for (const scene::Warning& warning : s.warnings) ADD_FAILURE() << warning.line();
  EXPECT_GT(s.fluidParticles(), 1000u);
}

}  // namespace
}  // namespace froude
