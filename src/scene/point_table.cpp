#include "scene/point_table.h"

#include <fmt/format.h>

#include <charconv>
#include <iostream>
#include <sstream>
#include <string_view>

#include "scene/draft.h"

namespace froude::scene {

namespace {

constexpr std::string_view kRow = "right are two numbers with a comma between them: x,y";

struct Cell {
  std::string_view text;
  int column = 1;  // in its line
};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return text.substr(0, 0);
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<Cell> cellsOf(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    const std::string_view text = trimmed(line.substr(from, comma - from));
    cells.push_back(
        {text, static_cast<int>((text.empty() ? from : static_cast<std::size_t>(text.data() - line.data()))) + 1});
    from = comma + 1;
  }
  return cells;
}

/// Letters of a header, or of no number at all.
bool isWord(std::string_view text) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  return !text.empty() && (letter(text[0]) || text[0] == '"') && text != "nan" && text != "inf";
}

bool isHeader(const std::vector<Cell>& cells) {
  const auto is = [](std::string_view text, char name) {
    if (text.size() == 3 && text.front() == '"' && text.back() == '"') text = text.substr(1, 1);
    return text.size() == 1 && std::tolower(static_cast<unsigned char>(text[0])) == name;
  };
  return cells.size() == 2 && is(cells[0].text, 'x') && is(cells[1].text, 'y');
}

double number(const std::string& file, int line, const Cell& cell, char name, double largest) {
  std::string_view text = cell.text;
  const Place place{file, line, cell.column};
  const std::string key(1, name);
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string shown(cell.text.substr(0, 40));
  if (error == std::errc::result_out_of_range) throw SceneError(place, key, "\"" + shown + "\" is beyond all doubles");
  if (error != std::errc() || end != text.data() + text.size())
    throw SceneError(place, key, fmt::format("\"{}\" is not a number, {}", shown, kRow));
  if (!(std::abs(value) <= largest))
    throw SceneError(place, key,
                     fmt::format("is {}, right is a number from -{:g} at most {:g}", shown, largest, largest));
  return value;
}

std::string textOf(const std::string& file) {
  if (file != "-") return readText(file, "a table of points (.csv)");
  std::ostringstream text;
  text << std::cin.rdbuf();
  return text.str();
}

}  // namespace

std::vector<Vec2> readPoints(const std::string& file, double largest) {
  const std::string text = textOf(file);
  const std::string name = file == "-" ? "standard input" : file;
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // spreadsheets put a byte-order mark in front
  std::vector<Vec2> points;
  bool first = true;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (row.ends_with('\r')) row.remove_suffix(1);
    if (trimmed(row).empty() || trimmed(row)[0] == '#') continue;
    const std::vector<Cell> cells = cellsOf(row);
    const bool mayBeHeader = std::exchange(first, false);
    if (mayBeHeader && isHeader(cells)) continue;
    if (mayBeHeader && isWord(cells[0].text))
      throw SceneError({name, line, 1}, "header",
                       fmt::format("is \"{}\", right is x,y or no header", trimmed(row).substr(0, 40)));
    if (cells.size() != 2)
      throw SceneError({name, line, cells.size() > 2 ? cells[2].column : 1}, "row",
                       fmt::format("has {} cell{}, {}", cells.size(), cells.size() == 1 ? "" : "s", kRow));
    const double x = number(name, line, cells[0], 'x', largest);
    points.emplace_back(x, number(name, line, cells[1], 'y', largest));
  }
  return points;
}

}  // namespace froude::scene
