// Scenes from texts, for tests.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace froude::testing {

/// A file with that text under the test's own folder; removed at the end.
class SceneFile {
 public:
  explicit SceneFile(const std::string& text, const std::string& name = "scene.toml") {
    static int number = 0;
    folder_ =
        std::filesystem::temp_directory_path() /
        ("froude-scene-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "-" + std::to_string(number++));
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / name).string();
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~SceneFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  SceneFile(const SceneFile&) = delete;
  SceneFile& operator=(const SceneFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::filesystem::path folder_;
  std::string path_;
};

inline scene::Scene loadText(const std::string& text, const std::vector<scene::Override>& overrides = {}) {
  const SceneFile file(text);
  return scene::load(file.path(), overrides);
}

/// "LINE:COLUMN: key: what is wrong" of the refusal; "accepted" if there is none.
inline std::string refusal(const std::string& text, const std::vector<scene::Override>& overrides = {}) {
  const SceneFile file(text);
  try {
    scene::load(file.path(), overrides);
  } catch (const scene::SceneError& error) {
    const std::string what = error.what();
    if (what.rfind(file.path() + ":", 0) != 0) return "the message does not begin with the file: " + what;
    return what.substr(file.path().size() + 1);
  }
  return "accepted";
}

/// Four lines that a scene cannot do without; line 5 is the first of what follows.
inline const std::string kHead = "format = 1\nduration = 1.0\n[domain]\nbox = [0.0, 0.0, 2.0, 1.0]\n";
/// A small block of fluid, 8 lines.
inline const std::string kFluid =
    "[model]\nspacing = 0.1\n[fluid]\ndensity = 1000.0\n[[fluid.block]]\nshape = { box = [0.0, 0.0, 1.0, 0.5] }\n"
    "velocity = [0.0, 0.0]\n\n";

}  // namespace froude::testing
