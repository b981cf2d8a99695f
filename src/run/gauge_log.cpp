#include "run/gauge_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "run/atomic_file.h"
#include "run/exit_codes.h"

namespace froude::run {

GaugeLog::GaugeLog(std::string file, const std::string& header) : file_(std::move(file)) {
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throwOutputError(file_);
  write(header + "\n");
}

GaugeLog::GaugeLog(std::string file, std::uint64_t keepBytes) : file_(std::move(file)), bytes_(keepBytes) {
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0) throwOutputError(file_);
  struct stat status = {};
  if (fstat(descriptor_, &status) == 0 && static_cast<std::uint64_t>(status.st_size) < keepBytes) {
    throw InputError(file_ + ": rows from before the checkpoint are missing; the run cannot go on with it");
  }
  const auto end = static_cast<off_t>(keepBytes);
  if (ftruncate(descriptor_, end) != 0 || lseek(descriptor_, end, SEEK_SET) != end) throwOutputError(file_);
}

GaugeLog::~GaugeLog() {
  if (descriptor_ >= 0) close(descriptor_);
}

void GaugeLog::write(const std::string& text) {
  if (!writeAll(descriptor_, text)) {
    const int reason = errno;
    const auto end = static_cast<off_t>(bytes_);
    if (ftruncate(descriptor_, end) == 0) lseek(descriptor_, end, SEEK_SET);
    errno = reason;
    throwOutputError(file_);
  }
  bytes_ += text.size();
}

void GaugeLog::append(const std::vector<std::string>& rows) {
  if (rows.empty()) return;
  std::string text;
  for (const std::string& row : rows) (text += row) += '\n';
  write(text);
}

void GaugeLog::sync() {
  if (fsync(descriptor_) != 0 && errno != EINVAL) throwOutputError(file_);
}

}  // namespace froude::run
