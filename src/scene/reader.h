// Typed reading of a table of a scene: every refusal with its place and key, every default written down.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/document.h"
#include "scene/expression.h"

namespace froude::scene {

/// Allowed numbers: low … high, the ends themselves only where not open.
struct Range {
  double low = -1e9, high = 1e9;
  bool openLow = false, openHigh = false;

  static Range any() { return {}; }
  /// Above zero, and not absurdly large.
  static Range positive(double high = 1e9) { return {0.0, high, true, false}; }
  static Range notNegative(double high = 1e9) { return {0.0, high, false, false}; }
  static Range between(double low, double high) { return {low, high, false, false}; }
};

/// Reads one table. Keys that are not in `known` are refused at construction. Each accessor takes the key's default
/// (none: the key must be there), checks type and range, and writes the value, given or default, into `resolved()`:
/// what has been read is the resolved scene. All members throw SceneError.
class TableReader {
 public:
  TableReader(const std::string& file, const Node& table, std::string path, std::vector<std::string> known);

  bool has(const std::string& key) const { return find(key) != nullptr; }
  const Node* find(const std::string& key) const;
  /// The node of a key that must be there.
  const Node& need(const std::string& key, const std::string& right) const;

  double number(const std::string& key, Range range, std::optional<double> byDefault = std::nullopt);
  /// Written down only if given.
  std::optional<double> optionalNumber(const std::string& key, Range range);
  std::int64_t integer(const std::string& key, std::int64_t low, std::int64_t high,
                       std::optional<std::int64_t> byDefault = std::nullopt);
  bool boolean(const std::string& key, bool byDefault);
  std::string text(const std::string& key, std::optional<std::string> byDefault = std::nullopt);
  /// A text out of a list; `absent` are words of the format that this version does not serve.
  std::string word(const std::string& key, const std::vector<std::string>& words, std::optional<std::string> byDefault,
                   const std::vector<std::string>& absent = {});
  Vec2 vector(const std::string& key, std::optional<Vec2> byDefault = std::nullopt);
  /// [xmin, ymin, xmax, ymax] with min < max.
  Box box(const std::string& key, std::optional<Box> byDefault = std::nullopt);
  /// Two components, each a number or an expression in `variables`.
  std::array<Expression, 2> expressions(const std::string& key, const std::string& variables, const Vec2& byDefault);
  Expression expression(const std::string& key, const std::string& variables, double byDefault);
  /// Words of a list, each at most once.
  std::vector<std::string> words(const std::string& key, const std::vector<std::string>& allowed,
                                 const std::vector<std::string>& byDefault);
  /// A table within; empty where absent.
  std::optional<TableReader> table(const std::string& key, std::vector<std::string> known);
  /// Tables of an array [[key]], named by their `name` in paths, else by their index; empty where absent.
  std::vector<TableReader> tables(const std::string& key, const std::vector<std::string>& known);

  Place place() const { return {file_, table_->line, table_->column}; }
  Place place(const std::string& key) const;     // of its value, or of the table where absent
  Place keyPlace(const std::string& key) const;  // of the key itself
  std::string pathOf(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  const std::string& path() const { return path_; }
  const std::string& file() const { return file_; }
  [[noreturn]] void fail(const std::string& key, const std::string& problem) const;
  [[noreturn]] void fail(const Node& at, const std::string& key, const std::string& problem) const;

  Node& resolved() { return resolved_; }

 private:
  double checked(const Node& node, const std::string& key, const Range& range) const;
  Expression compile(const Node& node, const std::string& key, const std::string& variables) const;

  std::string file_;
  const Node* table_;
  std::string path_;
  std::vector<std::string> known_;
  Node resolved_;
};

/// "0.5" as a person would write it, for messages.
std::string show(double value);
/// `"a", "b" or "c"`.
std::string choice(const std::vector<std::string>& words);

}  // namespace froude::scene
