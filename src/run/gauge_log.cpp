#include "run/gauge_log.h"

#include <utility>

namespace froude::run {

GaugeLog::GaugeLog(std::string file, const std::string& header) : file_(std::move(file)) {
  file_.append(header + "\n");
}

GaugeLog::GaugeLog(std::string file, std::uint64_t keepBytes) : file_(std::move(file), keepBytes) {}

void GaugeLog::append(const std::vector<std::string>& rows) {
  if (rows.empty()) return;
  std::string text;
  for (const std::string& row : rows) (text += row) += '\n';
  file_.append(text);
}

}  // namespace froude::run
