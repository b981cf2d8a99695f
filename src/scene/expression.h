// Expressions in scenes: "-4*x", "sin(2*pi*t)". Parsed by muParser, evaluated from any thread.
#pragma once

#include <memory>
#include <string>

#include <froude/base/error.h>

namespace froude::scene {

/// The text is no expression, or has a variable that means nothing at this key; `what()` is the parser's message.
class ExpressionError : public Error {
 public:
  using Error::Error;
};

/// A number that may depend on x, y [m] and t [s]. Copies are cheap and share the text; evaluation is pure and may run
/// in several threads at once (each keeps its own parser object). Functions of muParser (`^`, sin … in radians), `erf`
/// and `pi`.
class Expression {
 public:
  /// A constant.
  explicit Expression(double value = 0.0) : constant_(value) {}
  /// `variables`: those that have a meaning here, out of "xyt". ExpressionError if the text does not compile.
  Expression(const std::string& text, const std::string& variables);

  /// True if no variable occurs in it, also for texts like "-9.81".
  bool isConstant() const { return source_ == nullptr; }
  /// Cost: some 50 ns for a short formula after the first call in a thread.
  double evaluate(double x, double y, double t) const;

 private:
  struct Source;
  std::shared_ptr<const Source> source_;
  double constant_ = 0.0;
};

}  // namespace froude::scene
