#include "scene/node.h"

#include <fmt/format.h>

#include <cctype>

namespace froude::scene {

Node Node::of(bool value) {
  Node n;
  n.kind = Kind::Boolean;
  n.boolean = value;
  return n;
}

Node Node::of(double value) {
  Node n;
  n.kind = Kind::Number;
  n.number = value;
  return n;
}

Node Node::of(std::int64_t value) {
  Node n;
  n.kind = Kind::Integer;
  n.integer = value;
  return n;
}

Node Node::of(std::string value) {
  Node n;
  n.kind = Kind::Text;
  n.text = std::move(value);
  return n;
}

Node Node::of(const Vec2& value) { return array({of(value.x()), of(value.y())}); }

Node Node::array(std::vector<Node> items) {
  Node n;
  n.kind = Kind::Array;
  n.items = std::move(items);
  return n;
}

const Node* Node::find(std::string_view key) const {
  for (const auto& [name, value] : entries)
    if (name == key) return &value;
  return nullptr;
}

Node* Node::find(std::string_view key) { return const_cast<Node*>(std::as_const(*this).find(key)); }

Node& Node::set(std::string_view key, Node value) {
  if (Node* present = find(key)) {
    *present = std::move(value);
    return *present;
  }
  keyPlaces.emplace_back(value.line, value.column);
  entries.emplace_back(std::string(key), std::move(value));
  return entries.back().second;
}

void Node::remove(std::string_view key) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].first != key) continue;
    entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(i));
    keyPlaces.erase(keyPlaces.begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
}

std::string_view kindName(Node::Kind kind) {
  switch (kind) {
    case Node::Kind::Boolean:
      return "a boolean";
    case Node::Kind::Integer:
      return "an integer";
    case Node::Kind::Number:
      return "a number";
    case Node::Kind::Text:
      return "a string";
    case Node::Kind::Array:
      return "an array";
    case Node::Kind::Table:
      return "a table";
    case Node::Kind::Date:
      return "a date or time";
  }
  return "a value";
}

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7F) {
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(byte));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string key(const std::string& name) {
  bool bare = !name.empty();
  for (const char c : name) bare = bare && (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-');
  return bare ? name : quoted(name);
}

std::string number(double value) {
  std::string text = fmt::format("{}", value);  // the shortest digits that read back as the same double
  // TOML tells 1 and 1.0 apart, and wants digits on both sides of a point.
  if (text.find_first_of(".einf") == std::string::npos) text += ".0";
  return text;
}

}  // namespace

std::string toInline(const Node& node) {
  std::string out;
  switch (node.kind) {
    case Node::Kind::Boolean:
      return node.boolean ? "true" : "false";
    case Node::Kind::Integer:
      return fmt::format("{}", node.integer);
    case Node::Kind::Number:
      return number(node.number);
    case Node::Kind::Date:
    case Node::Kind::Text:
      return quoted(node.text);
    case Node::Kind::Array:
      for (const Node& item : node.items) out += (out.empty() ? "" : ", ") + toInline(item);
      return "[" + out + "]";
    case Node::Kind::Table:
      for (const auto& [name, value] : node.entries)
        out += (out.empty() ? " " : ", ") + key(name) + " = " + toInline(value);
      return out.empty() ? "{}" : "{" + out + " }";
  }
  return out;
}

namespace {

bool isArrayOfTables(const Node& node) {
  if (node.kind != Node::Kind::Array || node.items.empty()) return false;
  for (const Node& item : node.items)
    if (item.kind != Node::Kind::Table) return false;
  return true;
}

/// Top-level tables and their arrays of tables get headers; deeper tables (shape, png, repeat) are written inline.
void writeTable(const Node& table, const std::string& path, std::string& out) {
  for (const auto& [name, value] : table.entries) {
    const bool header = isArrayOfTables(value) ? name != "script" : value.kind == Node::Kind::Table && path.empty();
    if (!header) out += key(name) + " = " + toInline(value) + "\n";
  }
  for (const auto& [name, value] : table.entries) {
    const std::string child = path.empty() ? key(name) : path + "." + key(name);
    if (value.kind == Node::Kind::Table && path.empty()) {
      out += "\n[" + child + "]\n";
      writeTable(value, child, out);
    } else if (isArrayOfTables(value) && name != "script") {
      for (const Node& item : value.items) {
        out += "\n[[" + child + "]]\n";
        writeTable(item, child, out);
      }
    }
  }
}

}  // namespace

std::string toToml(const Node& table) {
  std::string out;
  writeTable(table, "", out);
  return out;
}

}  // namespace froude::scene
