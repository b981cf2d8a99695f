#include "study/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "run/exit_codes.h"
#include "scene/document.h"
#include "scene/reader.h"

namespace froude::study {
namespace {

using run::UsageError;
using scene::Node;
using scene::Range;

constexpr std::int64_t kMostValues = 100000;  // of one sweep

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Splits at commas that stand in no brackets, braces or quotes.
std::vector<std::string> splitValues(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
  }
  for (std::string& part : parts) part = trimmed(part);
  return parts;
}

// A node as the text that --set would take; a word stays bare where it is read back as a word.
std::string asText(const Node& node) {
  if (node.kind == Node::Kind::Text) {
    const std::optional<Node> bare = scene::parseValue(node.text);
    if (bare && bare->kind == Node::Kind::Text && bare->text == node.text) return node.text;
  }
  return scene::toInline(node);
}

// 0.1 + 2·0.1 is no number that a person wrote: twelve digits name the same one. Whole numbers come without a point, so
// that they may stand where integers are wanted.
std::string numberText(double value) { return fmt::format("{:.12g}", value); }

std::vector<std::string> stepped(scene::TableReader& range, double from, double to) {
  const double step = range.number("step", Range::positive());
  const double count = std::floor(std::abs(to - from) / step + 1e-9) + 1.0;  // the end counts in spite of rounding
  if (count > static_cast<double>(kMostValues))
    range.fail("step", fmt::format("asks for {:.3g} values, right are at most {}", count, kMostValues));
  std::vector<std::string> values;
  for (int i = 0; i < static_cast<int>(count); ++i)
    values.push_back(numberText(from + i * (to >= from ? step : -step)));
  return values;
}

std::vector<std::string> rangeValues(scene::TableReader& range) {
  const double from = range.number("from", Range::any()), to = range.number("to", Range::any());
  const bool log = range.word("scale", {"linear", "log"}, "linear") == "log";
  if (range.has("count") == range.has("step")) range.fail("count", "right is one of count and step");
  if (log && !(from * to > 0.0)) range.fail("scale", "on a log scale from and to are right with one sign, and not 0");
  if (log && range.has("step")) range.fail("step", "a log scale has equal ratios, right is count");
  if (range.has("step")) return stepped(range, from, to);
  const auto count = static_cast<int>(range.integer("count", 1, kMostValues));
  std::vector<std::string> values;
  for (int i = 0; i < count; ++i) {
    const double s = count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
    values.push_back(numberText(s == 1.0 ? to : log ? from * std::pow(to / from, s) : from + s * (to - from)));
  }
  return values;
}

bool isRange(const Node& node) {
  const Node* from = node.kind == Node::Kind::Table ? node.find("from") : nullptr;
  return from != nullptr && from->isNumeric();
}

}  // namespace

Sweep parseSweep(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw UsageError(
        fmt::format("--sweep {}: PATH=VALUE,VALUE,... is wanted, for example --sweep model.spacing=0.02,0.01", text));
  }
  Sweep sweep{text.substr(0, equals), splitValues(text.substr(equals + 1))};
  for (const std::string& value : sweep.values) {
    if (!scene::parseValue(value)) {
      throw UsageError(
          fmt::format("--sweep {}: '{}' is no TOML value; right is a number, \"text\", [1, 2] or {{ a = "
                      "1 }}, with commas between",
                      text, value));
    }
    if (std::count(sweep.values.begin(), sweep.values.end(), value) > 1)
      throw UsageError(fmt::format("--sweep {}: {} stands there twice", text, value));
  }
  return sweep;
}

std::vector<std::string> sweepValues(const std::string& file, const std::string& path, const Node& node) {
  std::vector<std::string> values;
  if (isRange(node)) {
    scene::TableReader range(file, node, path, {"from", "to", "count", "step", "scale"});
    values = rangeValues(range);
  } else if (node.kind == Node::Kind::Array) {
    for (const Node& item : node.items) values.push_back(asText(item));
  }
  if (values.empty()) {
    throw scene::SceneError({file, node.line, node.column}, path,
                            "is no list of values, right is [0.02, 0.01] or { from = 1, to = 8, step = 1 }");
  }
  for (const std::string& value : values)
    if (std::count(values.begin(), values.end(), value) > 1)
      throw scene::SceneError({file, node.line, node.column}, path, value + " stands there twice, once is right");
  return values;
}

std::vector<std::vector<std::string>> combinations(const std::vector<Sweep>& sweeps, Combination how) {
  std::vector<std::vector<std::string>> all(1);
  if (how == Combination::Zip && !sweeps.empty()) {
    all.assign(sweeps.front().values.size(), {});
    for (std::size_t i = 0; i < all.size(); ++i)
      for (const Sweep& sweep : sweeps) all[i].push_back(sweep.values[i]);
    return all;
  }
  for (const Sweep& sweep : sweeps) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& start : all) {
      for (const std::string& value : sweep.values) {
        longer.push_back(start);
        longer.back().push_back(value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

std::string plainWord(const std::string& value) {
  std::string word;
  for (const char c : value) {
    if (c == '"' || c == '\'' || c == ' ' || c == '[' || c == ']') continue;
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-';
    word += plain ? c : '_';
  }
  return word;
}

}  // namespace froude::study
