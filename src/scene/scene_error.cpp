// What is wrong and what is doubtful, with its place: FILE:LINE:COLUMN: key: text.
#include <fmt/format.h>

#include "scene/scene.h"

namespace froude::scene {

namespace {

std::string located(const Place& place, const std::string& key, const std::string& text) {
  return fmt::format("{}:{}:{}: {}: {}", place.file, place.line, place.column, key, text);
}

}  // namespace

SceneError::SceneError(const Place& place, const std::string& key, const std::string& problem)
    : Error(located(place, key, problem)), place_(place), key_(key) {}

std::string Warning::line() const { return located(place, key, "warning: " + text); }

}  // namespace froude::scene
