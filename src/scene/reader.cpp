#include "scene/reader.h"

#include <fmt/format.h>
#include <froude/base/assert.h>

#include <algorithm>

namespace froude::scene {

std::string show(double value) { return fmt::format("{:.10g}", value); }

std::string choice(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += '"' + words[i] + '"';
  }
  return out;
}

TableReader::TableReader(const std::string& file, const Node& table, std::string path, std::vector<std::string> known)
    : file_(file), table_(&table), path_(std::move(path)), known_(std::move(known)) {
  if (table.kind != Node::Kind::Table) {
    const std::string what = fmt::format("is {}, right is a table", kindName(table.kind));
    throw SceneError({file_, table.line, table.column}, path_, what);
  }
  for (const auto& entry : table.entries) {
    const std::string& key = entry.first;
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    throw SceneError(keyPlace(key), pathOf(key), "unknown key" + suggestion(key, known_));
  }
}

const Node* TableReader::find(const std::string& key) const {
  FROUDE_ASSERT(std::find(known_.begin(), known_.end(), key) != known_.end());
  return table_->find(key);
}

const Node& TableReader::need(const std::string& key, const std::string& right) const {
  const Node* node = find(key);
  if (node == nullptr) throw SceneError(place(), pathOf(key), "is missing, right is " + right);
  return *node;
}

Place TableReader::place(const std::string& key) const {
  const Node* node = table_->find(key);
  return node == nullptr ? place() : Place{file_, node->line, node->column};
}

Place TableReader::keyPlace(const std::string& key) const {
  for (std::size_t i = 0; i < table_->entries.size(); ++i)
    if (table_->entries[i].first == key) return {file_, table_->keyPlaces[i].first, table_->keyPlaces[i].second};
  return place();
}

void TableReader::fail(const std::string& key, const std::string& problem) const {
  throw SceneError(place(key), pathOf(key), problem);
}

void TableReader::fail(const Node& at, const std::string& key, const std::string& problem) const {
  throw SceneError({file_, at.line, at.column}, pathOf(key), problem);
}

namespace {

std::string describe(const Range& range) {
  if (range.low == 0.0 && range.openLow) return "a number above 0, at most " + show(range.high);
  return fmt::format("a number {} {} and {} {}", range.openLow ? "above" : "from", show(range.low),
                     range.openHigh ? "below" : "at most", show(range.high));
}

}  // namespace

double TableReader::checked(const Node& node, const std::string& key, const Range& range) const {
  if (!node.isNumeric()) fail(node, key, fmt::format("is {}, right is {}", kindName(node.kind), describe(range)));
  const double value = node.kind == Node::Kind::Integer ? static_cast<double>(node.integer) : node.number;
  if (!std::isfinite(value)) fail(node, key, fmt::format("is {}, right is {}", show(value), describe(range)));
  const bool low = range.openLow ? value > range.low : value >= range.low;
  const bool high = range.openHigh ? value < range.high : value <= range.high;
  if (!low || !high) fail(node, key, fmt::format("is {}, right is {}", show(value), describe(range)));
  return value;
}

double TableReader::number(const std::string& key, Range range, std::optional<double> byDefault) {
  if (!has(key) && byDefault) return resolved_.set(key, Node::of(*byDefault)).number;
  return resolved_.set(key, Node::of(checked(need(key, describe(range)), key, range))).number;
}

std::optional<double> TableReader::optionalNumber(const std::string& key, Range range) {
  if (!has(key)) return std::nullopt;
  return number(key, range);
}

std::int64_t TableReader::integer(const std::string& key, std::int64_t low, std::int64_t high,
                                  std::optional<std::int64_t> byDefault) {
  if (!has(key) && byDefault) return resolved_.set(key, Node::of(*byDefault)).integer;
  const std::string right = fmt::format("an integer from {} to {}", low, high);
  const Node& node = need(key, right);
  if (node.kind == Node::Kind::Number) fail(key, fmt::format("is {}, right is {}", show(node.number), right));
  if (node.kind != Node::Kind::Integer) fail(key, fmt::format("is {}, right is {}", kindName(node.kind), right));
  if (node.integer < low || node.integer > high) fail(key, fmt::format("is {}, right is {}", node.integer, right));
  return resolved_.set(key, Node::of(node.integer)).integer;
}

bool TableReader::boolean(const std::string& key, bool byDefault) {
  const Node* node = find(key);
  if (node != nullptr && node->kind != Node::Kind::Boolean)
    fail(key, fmt::format("is {}, right is true or false", kindName(node->kind)));
  return resolved_.set(key, Node::of(node != nullptr ? node->boolean : byDefault)).boolean;
}

std::string TableReader::text(const std::string& key, std::optional<std::string> byDefault) {
  if (!has(key) && byDefault) return resolved_.set(key, Node::of(*byDefault)).text;
  const Node& node = need(key, "a string");
  if (node.kind != Node::Kind::Text) fail(key, fmt::format("is {}, right is a string", kindName(node.kind)));
  return resolved_.set(key, Node::of(node.text)).text;
}

std::string TableReader::word(const std::string& key, const std::vector<std::string>& words,
                              std::optional<std::string> byDefault, const std::vector<std::string>& absent) {
  if (!has(key) && !byDefault) need(key, choice(words));
  const Node* node = find(key);
  if (node != nullptr && node->kind != Node::Kind::Text)
    fail(key, fmt::format("is {}, right is {}", kindName(node->kind), choice(words)));
  std::string value = text(key, byDefault);
  if (std::find(absent.begin(), absent.end(), value) != absent.end())
    fail(key, fmt::format("\"{}\" is not in this version; this build has: {}", value, fmt::join(words, ", ")));
  if (std::find(words.begin(), words.end(), value) == words.end())
    fail(key, fmt::format("is \"{}\", right is {}", value, choice(words)));
  return value;
}

Vec2 TableReader::vector(const std::string& key, std::optional<Vec2> byDefault) {
  if (!has(key) && byDefault) {
    resolved_.set(key, Node::of(*byDefault));
    return *byDefault;
  }
  const Node& node = need(key, "two numbers, [x, y]");
  if (node.kind != Node::Kind::Array || node.items.size() != 2)
    fail(key, fmt::format("is {}, right are two numbers, [x, y]", node.kind == Node::Kind::Array
                                                                      ? fmt::format("an array of {}", node.items.size())
                                                                      : std::string(kindName(node.kind))));
  const Vec2 value(checked(node.items[0], key, Range::any()), checked(node.items[1], key, Range::any()));
  resolved_.set(key, Node::of(value));
  return value;
}

Box TableReader::box(const std::string& key, std::optional<Box> byDefault) {
  static const std::string kRight = "[xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax";
  std::array<double, 4> v{};
  if (!has(key) && byDefault) {
    v = {byDefault->min.x(), byDefault->min.y(), byDefault->max.x(), byDefault->max.y()};
  } else {
    const Node& node = need(key, kRight);
    if (node.kind != Node::Kind::Array || node.items.size() != 4)
      fail(key, fmt::format("is {}, right is {}",
                            node.kind == Node::Kind::Array ? fmt::format("an array of {}", node.items.size())
                                                           : std::string(kindName(node.kind)),
                            kRight));
    for (std::size_t i = 0; i < 4; ++i) v[i] = checked(node.items[i], key, Range::any());
    if (!(v[0] < v[2] && v[1] < v[3]))
      fail(key,
           fmt::format("is [{}, {}, {}, {}], right is {}", show(v[0]), show(v[1]), show(v[2]), show(v[3]), kRight));
  }
  resolved_.set(key, Node::array({Node::of(v[0]), Node::of(v[1]), Node::of(v[2]), Node::of(v[3])}));
  return {Vec2(v[0], v[1]), Vec2(v[2], v[3])};
}

Expression TableReader::compile(const Node& node, const std::string& key, const std::string& variables) const {
  if (node.kind != Node::Kind::Text) {
    if (node.isNumeric()) return Expression(checked(node, key, Range::any()));
    fail(node, key, fmt::format("is {}, right is a number or an expression in a string", kindName(node.kind)));
  }
  try {
    return Expression(node.text, variables);
  } catch (const ExpressionError& error) {
    std::vector<std::string> names;
    for (const char c : variables) names.emplace_back(1, c);
    fail(node, key,
         fmt::format("\"{}\": {} (an expression may use {}, pi, ^ and functions such as sin)", node.text, error.what(),
                     fmt::join(names, ", ")));
  }
}

namespace {

/// Expressions stay text in the resolved scene, constants become numbers.
Node resolvedExpression(const Node& node) {
  if (node.kind == Node::Kind::Text) return Node::of(node.text);
  return Node::of(node.kind == Node::Kind::Integer ? static_cast<double>(node.integer) : node.number);
}

}  // namespace

std::array<Expression, 2> TableReader::expressions(const std::string& key, const std::string& variables,
                                                   const Vec2& byDefault) {
  const Node* node = find(key);
  if (node == nullptr) {
    resolved_.set(key, Node::of(byDefault));
    return {Expression(byDefault.x()), Expression(byDefault.y())};
  }
  if (node->kind != Node::Kind::Array || node->items.size() != 2)
    fail(key, fmt::format("is {}, right are two numbers or expressions, [x, y]",
                          node->kind == Node::Kind::Array ? fmt::format("an array of {}", node->items.size())
                                                          : std::string(kindName(node->kind))));
  std::array<Expression, 2> both{compile(node->items[0], key, variables), compile(node->items[1], key, variables)};
  resolved_.set(key, Node::array({resolvedExpression(node->items[0]), resolvedExpression(node->items[1])}));
  return both;
}

Expression TableReader::expression(const std::string& key, const std::string& variables, double byDefault) {
  const Node* node = find(key);
  if (node == nullptr) return Expression(resolved_.set(key, Node::of(byDefault)).number);
  Expression result = compile(*node, key, variables);
  resolved_.set(key, resolvedExpression(*node));
  return result;
}

std::vector<std::string> TableReader::words(const std::string& key, const std::vector<std::string>& allowed,
                                            const std::vector<std::string>& byDefault) {
  std::vector<std::string> values = byDefault;
  if (const Node* node = find(key)) {
    if (node->kind != Node::Kind::Array)
      fail(key, fmt::format("is {}, right is a list of {}", kindName(node->kind), choice(allowed)));
    values.clear();
    for (const Node& item : node->items) {
      if (item.kind != Node::Kind::Text)
        fail(item, key, fmt::format("holds {}, right is a list of {}", kindName(item.kind), choice(allowed)));
      if (std::find(allowed.begin(), allowed.end(), item.text) == allowed.end())
        fail(item, key, fmt::format("holds \"{}\", right is a list of {}", item.text, choice(allowed)));
      if (std::find(values.begin(), values.end(), item.text) != values.end())
        fail(item, key, fmt::format("holds \"{}\" twice, once is right", item.text));
      values.push_back(item.text);
    }
  }
  Node list = Node::array();
  for (const std::string& value : values) list.items.push_back(Node::of(value));
  resolved_.set(key, std::move(list));
  return values;
}

std::optional<TableReader> TableReader::table(const std::string& key, std::vector<std::string> known) {
  const Node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return TableReader(file_, *node, pathOf(key), std::move(known));
}

std::vector<TableReader> TableReader::tables(const std::string& key, const std::vector<std::string>& known) {
  const Node* node = find(key);
  std::vector<TableReader> all;
  if (node == nullptr) return all;
  if (node->kind != Node::Kind::Array)
    fail(key, fmt::format("is {}, right are tables, [[{}]]", kindName(node->kind), pathOf(key)));
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    const Node& item = node->items[i];
    const Node* name = item.kind == Node::Kind::Table ? item.find("name") : nullptr;
    const bool named = name != nullptr && name->kind == Node::Kind::Text && !name->text.empty();
    all.emplace_back(file_, item, pathOf(key) + "." + (named ? name->text : std::to_string(i)), known);
  }
  return all;
}

}  // namespace froude::scene
