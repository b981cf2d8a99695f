// A file that grows at its end, by pieces that are there whole or not at all.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace froude::run {

/// Every `append` is on its way to the disk when it returns; what could not be written whole is taken back. Throws
/// exporting::OutputError.
class GrowingFile {
 public:
  /// A new file, in place of one that may be there.
  explicit GrowingFile(std::string file);
  /// An existing file, cut to its first `keepBytes` bytes; InputError where it has fewer.
  GrowingFile(std::string file, std::uint64_t keepBytes);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  void append(std::string_view bytes);
  /// Waits until everything is on the disk.
  void sync();
  std::uint64_t bytes() const { return bytes_; }
  const std::string& name() const { return file_; }

 private:
  std::string file_;
  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;
};

}  // namespace froude::run
