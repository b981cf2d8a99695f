#include "run/shipped.h"

#include <filesystem>

#include "run/machine.h"

namespace froude::run {

std::string shippedFile(const std::string& relative) {
  namespace fs = std::filesystem;
  static const fs::path kRoot = [] {
    const fs::path beside = fs::path(programPath()).parent_path().parent_path() / FROUDE_SHARED_FOLDER;
    return fs::exists(beside / "scenes") ? beside : fs::path(FROUDE_SOURCE_ROOT);
  }();
  return kRoot / relative;
}

}  // namespace froude::run
