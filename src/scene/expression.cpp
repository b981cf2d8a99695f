#include "scene/expression.h"

#include <muParser.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace froude::scene {

struct Expression::Source {
  std::string text, variables;
  std::uint64_t id = 0;
};

namespace {

/// A parser and the variables it is bound to; it does not move.
struct Compiled {
  double x = 0.0, y = 0.0, t = 0.0;
  mu::Parser parser;

  Compiled(const std::string& text, const std::string& variables) {
    if (variables.find('x') != std::string::npos) parser.DefineVar("x", &x);
    if (variables.find('y') != std::string::npos) parser.DefineVar("y", &y);
    if (variables.find('t') != std::string::npos) parser.DefineVar("t", &t);
    parser.DefineConst("pi", 3.14159265358979323846);
    parser.DefineFun("erf", static_cast<double (*)(double)>(std::erf));  // smooth starts; muParser has none
    parser.SetExpr(text);
  }
  Compiled(const Compiled&) = delete;
  Compiled& operator=(const Compiled&) = delete;
};

/// muParser objects are not for several threads: each thread has its own of each expression.
Compiled& compiledHere(std::uint64_t id, const std::string& text, const std::string& variables) {
  constexpr std::size_t kMost = 4096;  // a batch of scenes leaves old expressions behind
  thread_local std::unordered_map<std::uint64_t, std::unique_ptr<Compiled>> cache;
  std::unique_ptr<Compiled>* slot = &cache[id];
  if (*slot == nullptr) {
    if (cache.size() > kMost) {
      cache.clear();
      slot = &cache[id];
    }
    *slot = std::make_unique<Compiled>(text, variables);
  }
  return **slot;
}

}  // namespace

Expression::Expression(const std::string& text, const std::string& variables) {
  static std::atomic<std::uint64_t> next{1};
  try {
    Compiled trial(text, variables);
    const double value = trial.parser.Eval();
    if (trial.parser.GetNumResults() != 1) throw ExpressionError("one expression is wanted, not a list");
    if (trial.parser.GetUsedVar().empty()) {
      constant_ = value;
      return;
    }
  } catch (const mu::Parser::exception_type& error) {
    throw ExpressionError(error.GetMsg());
  }
  source_ = std::make_shared<const Source>(Source{text, variables, next.fetch_add(1)});
}

double Expression::evaluate(double x, double y, double t) const {
  if (source_ == nullptr) return constant_;
  Compiled& compiled = compiledHere(source_->id, source_->text, source_->variables);
  compiled.x = x;
  compiled.y = y;
  compiled.t = t;
  return compiled.parser.Eval();
}

}  // namespace froude::scene
