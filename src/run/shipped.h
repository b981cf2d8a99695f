// Files that come with Froude: scenes, published curves, measured points.
#pragma once

#include <string>

namespace froude::run {

/// The file's path, as "scenes/dam_break.toml": beside an installed program, else in the source tree that this was
/// built from.
std::string shippedFile(const std::string& relative);

}  // namespace froude::run
