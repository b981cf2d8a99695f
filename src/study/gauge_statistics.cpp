#include "study/gauge_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "study/csv.h"

namespace froude::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The course of one column, value by value.
class Course {
 public:
  void add(double t, double value) {
    last_ = value;
    if (!std::isfinite(value)) return;
    min_ = count_ == 0 ? value : std::min(min_, value);
    max_ = count_ == 0 ? value : std::max(max_, value);
    if (count_ > 0) area_ += 0.5 * (value + before_) * (t - t_), span_ += t - t_;
    t_ = t;
    before_ = value;
    ++count_;
  }
  void write(const std::string& name, std::vector<std::pair<std::string, std::string>>& out) const {
    const double mean = span_ > 0.0 ? area_ / span_ : before_;
    const auto put = [&](const char* what, double value) {
      out.emplace_back("gauge." + name + what, fmt::format("{}", value));
    };
    put(".last", last_);
    put(".min", min_);
    put(".max", max_);
    put(".mean", mean);
  }

 private:
  double last_ = kNan, min_ = kNan, max_ = kNan, before_ = kNan;
  double t_ = 0.0, area_ = 0.0, span_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<std::pair<std::string, std::string>> gaugeStatistics(const std::string& text, const std::string& file) {
  std::vector<std::pair<std::string, std::string>> out;
  if (text.empty()) return out;
  const CsvTable table = parseCsv(text, file);
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    Course course;
    for (const auto& row : table.rows)
      if (!row[c].empty()) course.add(std::strtod(row[0].c_str(), nullptr), std::strtod(row[c].c_str(), nullptr));
    course.write(table.columns[c], out);
  }
  return out;
}

}  // namespace froude::study
