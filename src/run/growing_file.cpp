#include "run/growing_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "run/atomic_file.h"
#include "run/exit_codes.h"

namespace froude::run {

GrowingFile::GrowingFile(std::string file) : file_(std::move(file)) {
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throwOutputError(file_);
}

GrowingFile::GrowingFile(std::string file, std::uint64_t keepBytes) : file_(std::move(file)), bytes_(keepBytes) {
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0) throwOutputError(file_);
  struct stat status = {};
  if (fstat(descriptor_, &status) == 0 && static_cast<std::uint64_t>(status.st_size) < keepBytes) {
    throw InputError(file_ + ": what was written before the checkpoint is missing; the run cannot go on with it");
  }
  const auto end = static_cast<off_t>(keepBytes);
  if (ftruncate(descriptor_, end) != 0 || lseek(descriptor_, end, SEEK_SET) != end) throwOutputError(file_);
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void GrowingFile::append(std::string_view bytes) {
  if (!writeAll(descriptor_, bytes)) {
    const int reason = errno;
    const auto end = static_cast<off_t>(bytes_);
    if (ftruncate(descriptor_, end) == 0) lseek(descriptor_, end, SEEK_SET);
    errno = reason;
    throwOutputError(file_);
  }
  bytes_ += bytes.size();
}

void GrowingFile::sync() {
  if (fsync(descriptor_) != 0 && errno != EINVAL) throwOutputError(file_);
}

}  // namespace froude::run
