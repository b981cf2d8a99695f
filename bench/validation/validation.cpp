#include "validation/validation.h"

#include <algorithm>

namespace froude::validation {
namespace {

std::vector<Case>& registered() {
  static std::vector<Case> cases;
  return cases;
}

}  // namespace

Registered::Registered(Case entry) {
  std::vector<Case>& cases = registered();
  // Files are initialised in no particular order.
  const auto place = std::find_if(cases.begin(), cases.end(), [&](const Case& c) { return entry.name < c.name; });
  cases.insert(place, std::move(entry));
}

std::span<const Case> allCases() { return registered(); }

std::string scenePath(const std::string& name) {
  return std::string(FROUDE_VALIDATION_ROOT) + "/scenes/" + name + ".toml";
}

std::string dataPath(const std::string& file) { return std::string(FROUDE_VALIDATION_ROOT) + "/tests/data/" + file; }

}  // namespace froude::validation
