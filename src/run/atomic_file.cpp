#include "run/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "export/frames.h"
#include "run/exit_codes.h"

namespace froude::run {
namespace {

// A rename is on disk only when its folder is.
void syncFolderOf(const std::string& file) {
  const std::size_t slash = file.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : file.substr(0, slash + 1);
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

void throwOutputError(const std::string& path) {
  throw exporting::OutputError(path + ": cannot be written: " + std::strerror(errno));
}

bool writeAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

PendingFile::PendingFile(std::string finalPath)
    : final_(std::move(finalPath)), part_(final_ + std::string(kPartSuffix)) {}

PendingFile::~PendingFile() {
  if (!committed_) unlink(part_.c_str());
}

void PendingFile::commit() {
  const int descriptor = open(part_.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) throwOutputError(final_);
  // Some file systems refuse to sync (EINVAL) yet are sound; a full or broken disk says so here at the latest.
  const bool synced = fsync(descriptor) == 0 || errno == EINVAL;
  const int reason = errno;
  close(descriptor);
  errno = reason;
  if (!synced || std::rename(part_.c_str(), final_.c_str()) != 0) throwOutputError(final_);
  committed_ = true;
  syncFolderOf(final_);
}

void writeWholeFile(const std::string& path, std::span<const std::string_view> contents) {
  PendingFile pending(path);
  const int descriptor = open(pending.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) throwOutputError(path);
  const bool written =
      std::all_of(contents.begin(), contents.end(), [&](std::string_view part) { return writeAll(descriptor, part); });
  const int reason = errno;
  const bool closed = close(descriptor) == 0;
  if (!written) errno = reason;
  if (!written || !closed) throwOutputError(path);
  pending.commit();
}

void keepAs(const std::string& path, const std::string& second) {
  const std::string beside = second + std::string(kPartSuffix);
  unlink(beside.c_str());
  if (link(path.c_str(), beside.c_str()) == 0) {
    if (std::rename(beside.c_str(), second.c_str()) != 0) unlink(beside.c_str());
    // Two names of one file: the rename does nothing, and leaves the name beside.
    unlink(beside.c_str());
  } else if (errno == EPERM || errno == ENOTSUP || errno == EMLINK) {
    std::rename(path.c_str(), second.c_str());
  }
}

std::string readWholeFile(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const auto fail = [&] { throw InputError(path + ": cannot be read: " + std::strerror(errno)); };
  if (descriptor < 0) fail();
  std::string contents;
  struct stat status = {};
  if (fstat(descriptor, &status) == 0 && status.st_size > 0) contents.reserve(static_cast<std::size_t>(status.st_size));
  char buffer[1 << 16];
  while (true) {
    const ssize_t got = read(descriptor, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      const int reason = errno;
      close(descriptor);
      errno = reason;
      fail();
    }
    if (got == 0) break;
    contents.append(buffer, static_cast<std::size_t>(got));
  }
  close(descriptor);
  return contents;
}

}  // namespace froude::run
