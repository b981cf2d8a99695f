// Errors of construction. Steps never throw; what was built wrongly says so here.
#pragma once

#include <stdexcept>
#include <string>

#include <froude/base/api.h>

namespace froude {

/// Base of every exception that Froude throws; `what()` says what is wrong and what would be right.
class FROUDE_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace froude
