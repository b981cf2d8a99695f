// A scene file as a tree of values that know where they stand. No library shows through.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace froude::scene {

/// One value of a file: its kind says which of the members below counts. Tables keep the order of the file.
struct Node {
  enum class Kind { Boolean, Integer, Number, Text, Array, Table, Date };

  Kind kind = Kind::Table;
  int line = 0, column = 0;  // of the value; 0: given by --set or made by Froude
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;
  std::string text;
  std::vector<Node> items;                            // Array
  std::vector<std::pair<std::string, Node>> entries;  // Table
  std::vector<std::pair<int, int>> keyPlaces;         // Table: line and column of each key

  static Node of(bool value);
  static Node of(double value);
  static Node of(std::int64_t value);
  static Node of(std::string value);
  static Node of(const char* value) { return of(std::string(value)); }
  static Node of(const Vec2& value);
  static Node array(std::vector<Node> items = {});

  bool isNumeric() const { return kind == Kind::Integer || kind == Kind::Number; }
  /// The value of a key of a table, or null.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  /// Sets a key of a table, replacing what was there; returns the new value.
  Node& set(std::string_view key, Node value);
  void remove(std::string_view key);
};

/// "a table", "a string", "an integer" …, for messages.
std::string_view kindName(Node::Kind kind);

/// Writes a table as a TOML document: numbers in the shortest form that reads back as the same bits; arrays of tables
/// under [[…]], other tables under […], tables inside arrays inline.
std::string toToml(const Node& table);

/// A value on one line, as it stands behind `key =`.
std::string toInline(const Node& value);

}  // namespace froude::scene
