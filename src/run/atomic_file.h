// Whole files, written beside and renamed: a reader sees the old file or the new one, never half of one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace froude::run {

/// Suffix of a file that is being written; such a file is always rubbish after a crash.
inline constexpr std::string_view kPartSuffix = ".part";

/// A file under construction beside its final place. Another library may write to `path()`; `commit` syncs the file and
/// renames it. Without `commit` the destructor removes it. One writer per final name at a time.
class PendingFile {
 public:
  explicit PendingFile(std::string finalPath);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& path() const { return part_; }
  /// Throws exporting::OutputError, naming the file and the reason.
  void commit();

 private:
  std::string final_;
  std::string part_;
  bool committed_ = false;
};

/// Writes all of `contents`, in one part or several, to `path`. Throws exporting::OutputError and leaves the old file
/// as it was.
void writeWholeFile(const std::string& path, std::span<const std::string_view> contents);
inline void writeWholeFile(const std::string& path, std::string_view contents) {
  writeWholeFile(path, std::span(&contents, 1));
}

/// Gives the file a second name, in place of what had that name; a file that is not there is none. On a file system
/// without links it moves. What fails changes nothing.
void keepAs(const std::string& path, const std::string& second);

/// Writes all bytes to a file descriptor, going on after interruptions. False with errno set when it cannot.
bool writeAll(int descriptor, std::string_view bytes);

/// All bytes of a file. Throws InputError.
std::string readWholeFile(const std::string& path);

/// Throws exporting::OutputError "FILE: cannot be written: No space left on device" for the present errno.
[[noreturn]] void throwOutputError(const std::string& path);

}  // namespace froude::run
