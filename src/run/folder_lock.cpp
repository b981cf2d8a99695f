#include "run/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "run/atomic_file.h"
#include "run/exit_codes.h"

namespace froude::run {

FolderLock::FolderLock(std::string folder, const std::string& who) : file_(folder + "/" + kName) {
  while (true) {
    lock_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) throwOutputError(file_);
    const bool locked = flock(lock_, LOCK_EX | LOCK_NB) == 0;
    if (!locked && errno == EWOULDBLOCK) {
      ::close(lock_);
      throw UsageError(folder + ": another " + who + " is writing here; wait for it, or name another folder with -o");
    }
    if (!locked) return;  // some file systems of clusters have no locks; a run without one is better than none
    struct stat held = {};
    struct stat present = {};
    if (fstat(lock_, &held) == 0 && stat(file_.c_str(), &present) == 0 && held.st_ino == present.st_ino) return;
    ::close(lock_);
  }
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : file_(std::move(other.file_)), lock_(std::exchange(other.lock_, -1)) {}

FolderLock::~FolderLock() {
  if (lock_ < 0) return;
  // Removed while it is still held: whoever opened the old file sees that it has gone and opens anew.
  unlink(file_.c_str());
  ::close(lock_);
}

}  // namespace froude::run
