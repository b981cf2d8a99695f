// The parameters of a batch: which keys of a scene take which values, and in what combinations.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scene/node.h"

namespace froude::study {

/// A key of the scene and the values that it takes, as the TOML text that `--set` would take.
struct Sweep {
  std::string path;
  std::vector<std::string> values;
};

enum class Combination { Product, Zip };

/// "PATH=v1,v2,…", split at commas outside brackets, braces and quotes. Throws run::UsageError for anything else, and
/// for a value that stands there twice.
Sweep parseSweep(const std::string& text);

/// The value of a key in [batch.sweep]: a list of values, or a range { from, to, count | step, scale }. `path` is for
/// messages. Throws scene::SceneError.
std::vector<std::string> sweepValues(const std::string& file, const std::string& path, const scene::Node& node);

/// One value of each sweep, for each run: all combinations with the last sweep fastest, or the first values, the second
/// values, … of all. Precondition of Zip: equal lengths.
std::vector<std::vector<std::string>> combinations(const std::vector<Sweep>& sweeps, Combination how);

/// A value as part of a folder's name: letters, digits and `.+-` stay, quotes and blanks go, anything else becomes `_`.
std::string plainWord(const std::string& value);

}  // namespace froude::study
