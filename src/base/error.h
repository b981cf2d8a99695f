// Errors of construction. Steps never throw; what was built wrongly says so here.
#pragma once

#include <stdexcept>
#include <string>

namespace froude {

/// Base of every exception that Froude throws; `what()` says what is wrong and what would be right.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace froude
