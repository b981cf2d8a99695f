// Tables of comma-separated values (RFC 4180): quotes around what needs them, in and out.
#pragma once

#include <string>
#include <vector>

namespace froude::study {

struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // each as long as `columns`
};

/// Throws run::InputError for a text without a header, or with a row of another length; `file` is for messages.
CsvTable parseCsv(const std::string& text, const std::string& file);
/// A line with its end.
std::string csvLine(const std::vector<std::string>& cells);

}  // namespace froude::study
