// What a model is for, what binds its time step and where it fails: shown by `explain`, printed in the docs.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <froude/base/api.h>

namespace froude {

struct ModelCard {
  std::string name;  // as in a scene
  std::string title;
  std::string models;  // what it models
  std::string doesNotModel;
  std::vector<std::string> stepBounds;  // each with its formula
  std::vector<std::string> knownFailures;
  std::vector<std::string> references;
};

/// All models of this build, in the order in which a scene may name them.
FROUDE_API std::span<const ModelCard> modelCards();
/// Null for an unknown name.
FROUDE_API const ModelCard* findModelCard(std::string_view name);

}  // namespace froude
