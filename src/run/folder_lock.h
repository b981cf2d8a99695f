// The lock of a folder that one process alone writes into.
#pragma once

#include <string>

namespace froude::run {

/// An flock on the file `.lock` of a folder, held for as long as the object lives: it never outlives the process, and
/// the file goes with it.
class FolderLock {
 public:
  static constexpr const char* kName = ".lock";

  /// Throws UsageError "FOLDER: another WHO is writing here; …" when another process holds it, exporting::OutputError
  /// when the file cannot be made.
  FolderLock(std::string folder, const std::string& who);
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;
  ~FolderLock();

 private:
  std::string file_;
  int lock_ = -1;
};

}  // namespace froude::run
