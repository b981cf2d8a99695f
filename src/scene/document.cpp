#include "scene/document.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <numeric>
#include <sstream>

namespace froude::scene {

namespace {

std::pair<int, int> placeOf(const toml::source_region& region) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

Node convert(const toml::node& source);

Node convertTable(const toml::table& source) {
  Node table;
  table.kind = Node::Kind::Table;
  for (const auto& [key, value] : source) {
    table.entries.emplace_back(std::string(key.str()), convert(value));
    table.keyPlaces.push_back(placeOf(key.source()));
  }
  // The library sorts keys by name; messages and the resolved scene want the order of the file.
  std::vector<std::size_t> order(table.entries.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return table.keyPlaces[a] < table.keyPlaces[b]; });
  Node sorted;
  for (const std::size_t i : order) {
    sorted.entries.push_back(std::move(table.entries[i]));
    sorted.keyPlaces.push_back(table.keyPlaces[i]);
  }
  return sorted;
}

Node convert(const toml::node& source) {
  Node node;
  switch (source.type()) {
    case toml::node_type::boolean:
      node = Node::of(source.as_boolean()->get());
      break;
    case toml::node_type::integer:
      node = Node::of(source.as_integer()->get());
      break;
    case toml::node_type::floating_point:
      node = Node::of(source.as_floating_point()->get());
      break;
    case toml::node_type::string:
      node = Node::of(source.as_string()->get());
      break;
    case toml::node_type::array:
      node = Node::array();
      for (const toml::node& item : *source.as_array()) node.items.push_back(convert(item));
      break;
    case toml::node_type::table:
      node = convertTable(*source.as_table());
      break;
    default:
      node.kind = Node::Kind::Date;
  }
  std::tie(node.line, node.column) = placeOf(source.source());
  return node;
}

void forgetPlaces(Node& node) {
  node.line = node.column = 0;
  for (Node& item : node.items) forgetPlaces(item);
  for (auto& entry : node.entries) forgetPlaces(entry.second);
  for (auto& place : node.keyPlaces) place = {0, 0};
}

std::optional<Node> parseOneLine(const std::string& text) {
  try {
    const toml::table parsed = toml::parse("value = " + text + "\n");
    if (parsed.size() != 1) return std::nullopt;
    Node node = convert(*parsed.get("value"));
    forgetPlaces(node);
    return node;
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
}

}  // namespace

Node parseDocument(const std::string& file, const std::string& text) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw SceneError({file, 1, 1}, "format", "the file is empty, a scene starts with format = 1");
  try {
    const toml::table parsed = toml::parse(text, file);
    Node node = convertTable(parsed);
    node.line = node.column = 1;
    return node;
  } catch (const toml::parse_error& error) {
    const auto [line, column] = placeOf(error.source());
    std::string what(error.description());
    if (what.find("table 'fluid'") != std::string::npos)
      throw SceneError({file, line, column}, "fluid",
                       "a second [fluid], one fluid per scene is right (its blocks are [[fluid.block]])");
    throw SceneError({file, line, column}, "TOML", "not a TOML document: " + what);
  }
}

std::optional<Node> parseValue(const std::string& text) {
  if (text.empty() || text.find_first_of("\r\n") != std::string::npos) return std::nullopt;
  if (std::optional<Node> value = parseOneLine(text)) return value;
  if (text.find_first_of("[]{}\"'") != std::string::npos) return std::nullopt;
  std::string escaped;
  for (const char c : text) escaped += (c == '\\') ? "\\\\" : std::string(1, c);
  return parseOneLine('"' + escaped + '"');
}

namespace {

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  std::stringstream stream(path);
  for (std::string part; std::getline(stream, part, '.');) parts.push_back(part);
  return parts;
}

std::optional<std::size_t> asIndex(const std::string& word) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return index;
}

/// Follows an array by index or by name. A name may hold dots ("peg.3"), so the longest match wins; `at` moves on.
Node* elementOf(Node& array, const std::vector<std::string>& parts, std::size_t& at) {
  if (const auto index = asIndex(parts[at])) {
    ++at;
    return *index < array.items.size() ? &array.items[*index] : nullptr;
  }
  for (std::size_t end = parts.size(); end > at; --end) {
    std::string name = parts[at];
    for (std::size_t i = at + 1; i < end; ++i) name += "." + parts[i];
    for (Node& item : array.items) {
      const Node* own = item.kind == Node::Kind::Table ? item.find("name") : nullptr;
      if (own == nullptr || own->text != name) continue;
      at = end;
      return &item;
    }
  }
  return nullptr;
}

[[noreturn]] void refuseElement(const std::string& file, const std::string& path, const std::string& word,
                                const Node& array) {
  std::vector<std::string> names;
  for (const Node& item : array.items)
    if (const Node* own = item.find("name")) names.push_back(own->text);
  std::string right = array.items.empty() ? ", the array is empty"
                                          : fmt::format(", right is an index from 0 to {}", array.items.size() - 1);
  if (!names.empty()) right += " or a name" + suggestion(word, names);
  throw SceneError({file, 0, 0}, path, fmt::format("--set: \"{}\" names no element{}", word, right));
}

}  // namespace

void applyOverride(Node& document, const std::string& file, const Override& change) {
  const auto& [path, text] = change;
  const std::vector<std::string> parts = split(path);
  if (parts.empty() || path.back() == '.' || std::find(parts.begin(), parts.end(), "") != parts.end())
    throw SceneError({file, 0, 0}, path.empty() ? "--set" : path,
                     "--set: not a path, right is for example model.spacing");
  const std::optional<Node> value = parseValue(text);
  if (!value)
    throw SceneError(
        {file, 0, 0}, path,
        fmt::format("--set: {} is no TOML value, right is a number, \"text\", [1, 2] or {{ a = 1 }}", text));
  Node* node = &document;
  for (std::size_t at = 0; at < parts.size();) {
    if (node->kind == Node::Kind::Array) {
      const std::string word = parts[at];
      Node* next = elementOf(*node, parts, at);
      if (next == nullptr) refuseElement(file, path, word, *node);
      node = next;
    } else if (node->kind == Node::Kind::Table) {
      Node* next = node->find(parts[at]);
      // An absent table is made here; a word that means nothing is refused when the document is checked.
      node = next != nullptr ? next : &node->set(parts[at], Node());
      ++at;
    } else {
      throw SceneError(
          {file, 0, 0}, path,
          fmt::format("--set: \"{}\" is looked for in {}, which has no keys", parts[at], kindName(node->kind)));
    }
  }
  *node = *value;
}

namespace {

/// Damerau-Levenshtein distance (optimal string alignment): a swap of neighbours counts once.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t same = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + same});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  const std::string start = word.substr(0, 64);  // a longer word is no slip of the hand, and the table is quadratic
  std::string best;
  std::size_t least = static_cast<std::size_t>(-1);
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(start, candidate);
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::string best = nearest(word, known);
  return best.empty() ? "" : ", the nearest is \"" + best + "\"";
}

}  // namespace froude::scene
