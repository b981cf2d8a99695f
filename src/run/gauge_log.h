// Growing files of whole lines: gauges.csv, leaks.csv.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "run/growing_file.h"

namespace froude::run {

/// Appends lines to a file, as GrowingFile says. Throws exporting::OutputError.
class GaugeLog {
 public:
  /// A new file with its header line.
  GaugeLog(std::string file, const std::string& header);
  /// An existing file, cut to its first `keepBytes` bytes: rows later than a checkpoint go.
  GaugeLog(std::string file, std::uint64_t keepBytes);

  void append(const std::vector<std::string>& rows);
  /// Waits until everything is on the disk.
  void sync() { file_.sync(); }
  std::uint64_t bytes() const { return file_.bytes(); }

 private:
  GrowingFile file_;
};

}  // namespace froude::run
