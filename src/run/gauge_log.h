// Growing files of whole lines: gauges.csv, leaks.csv.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace froude::run {

/// Appends lines to a file. Every `append` is on its way to the disk when it returns; what could not be written
/// whole is taken back. Throws exporting::OutputError.
class GaugeLog {
 public:
  /// A new file with its header line.
  GaugeLog(std::string file, const std::string& header);
  /// An existing file, cut to its first `keepBytes` bytes: rows later than a checkpoint go.
  GaugeLog(std::string file, std::uint64_t keepBytes);
  ~GaugeLog();
  GaugeLog(const GaugeLog&) = delete;
  GaugeLog& operator=(const GaugeLog&) = delete;

  void append(const std::vector<std::string>& rows);
  /// Waits until everything is on the disk.
  void sync();
  std::uint64_t bytes() const { return bytes_; }

 private:
  void write(const std::string& text);

  std::string file_;
  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;
};

}  // namespace froude::run
