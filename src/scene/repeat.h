// `repeat`: copies of a body in rows. Internal to this folder.
#pragma once

#include <array>
#include <optional>

#include "scene/reader.h"

namespace froude::scene {

/// How copies are laid out: count[i] steps along step[i], first index fastest.
struct Repeat {
  std::array<std::int64_t, 2> count{1, 1};
  std::array<Vec2, 2> step{Vec2(0, 0), Vec2(0, 0)};
  double turn = 0.0;  // [degrees] each

  std::int64_t copies() const { return count[0] * count[1]; }
  /// Of copy k against the first [m].
  Vec2 offset(std::int64_t k) const {
    return static_cast<double>(k % count[0]) * step[0] + static_cast<double>(k / count[0]) * step[1];
  }
};

/// The table `repeat` of a body; empty where it has none. Throws SceneError.
std::optional<Repeat> readRepeat(TableReader& body);

/// The angle of copy k [degrees]. SceneError beyond 1e9.
double turnedBy(const TableReader& body, const Repeat& repeat, double degrees, std::int64_t k);

/// [A-Za-z_][A-Za-z0-9_-]*, and dots, which copies have. SceneError for any other name.
void checkBodyName(const TableReader& body, const std::string& name);

}  // namespace froude::scene
