#include "study/csv.h"

#include <fmt/format.h>

#include "run/exit_codes.h"

namespace froude::study {
namespace {

/// Reads the cells of one row; `at` moves behind its end.
std::vector<std::string> readRow(const std::string& text, std::size_t& at) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c != '"') {
        cells.back() += c;
      } else if (at + 1 < text.size() && text[at + 1] == '"') {
        cells.back() += text[++at];
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      cells.emplace_back();
    } else if (c == '\n') {
      ++at;
      break;
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

CsvTable parseCsv(const std::string& text, const std::string& file) {
  if (text.empty()) throw run::InputError(file + ": the table is empty");
  CsvTable table;
  std::size_t at = 0;
  table.columns = readRow(text, at);
  while (at < text.size()) {
    table.rows.push_back(readRow(text, at));
    if (table.rows.back().size() != table.columns.size()) {
      throw run::InputError(fmt::format("{}: row {} has {} cells, its header {}", file, table.rows.size(),
                                        table.rows.back().size(), table.columns.size()));
    }
  }
  return table;
}

std::string csvLine(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    if (cells[i].find_first_of(",\"\r\n") == std::string::npos) {
      line += cells[i];
      continue;
    }
    line += '"';
    for (const char c : cells[i]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

}  // namespace froude::study
