#include <froude/solver/report.h>

namespace froude {

std::string_view name(StepLimit limit) {
  static constexpr std::array<std::string_view, static_cast<std::size_t>(StepLimit::kCount)> kNames{
      "literal", "courant", "acceleration", "pressure", "viscosity", "acoustic",  "surface tension",
      "spin",    "wall",    "body",         "bullet",   "soft",      "requested", "undone"};
  return kNames[static_cast<std::size_t>(limit)];
}

std::string_view name(Trouble trouble) {
  static constexpr std::array<std::string_view, 6> kNames{"none",        "non-finite value", "displacement",
                                                          "compression", "energy gain",      "turn of a body"};
  return kNames[static_cast<std::size_t>(trouble)];
}

}  // namespace froude
