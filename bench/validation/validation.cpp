#include "validation/validation.h"

#include <algorithm>

#include "run/shipped.h"

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

const char* flowName(FlowKind flow) {
  switch (flow) {
    case FlowKind::None:
      break;
    case FlowKind::Splash:
      return "splash";
    case FlowKind::Surface:
      return "free surface";
    case FlowKind::Confined:
      return "confined";
    case FlowKind::AtRest:
      return "at rest";
    case FlowKind::Soft:
      return "soft";
    case FlowKind::Bullets:
      return "bullets";
  }
  return "none";
}

std::span<const Case> allCases() { return registered(); }

std::string scenePath(const std::string& name) { return run::shippedFile("scenes/" + name + ".toml"); }

std::string dataPath(const std::string& file) { return run::shippedFile("tests/data/" + file); }

}  // namespace froude::validation
