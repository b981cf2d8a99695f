// A file with a table [batch]: scenes, what is set in all of them, and what is swept.
#pragma once

#include <string>
#include <vector>

#include "study/sweep.h"

namespace froude::study {

struct BatchFile {
  std::vector<std::string> scenes;  // paths, from here
  std::vector<scene::Override> settings;
  std::vector<Sweep> sweeps;
  Combination how = Combination::Product;
};

/// Has the file a table [batch]? Throws SceneError for a file that cannot be read or is not TOML.
bool isBatchFile(const std::string& file);

/// Throws SceneError with the place of what is wrong. Scenes are named relative to the batch file.
BatchFile readBatchFile(const std::string& file);

}  // namespace froude::study
