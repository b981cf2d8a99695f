// player.frames: the coded frames of a run, appended one by one while it goes on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "export/frame_coder.h"
#include "run/growing_file.h"

namespace froude::exporting {

/// A growing file of records. One that stands in a page must stay within what a browser takes, so a file that reaches
/// `kLargest` takes no more frames.
class PageFrames {
 public:
  static constexpr const char* kName = "player.frames";
  static constexpr std::uint64_t kLargest = 256 << 20;  // [bytes]

  struct Entry {
    FrameRecord record;
    std::uint64_t begin = 0;  // of its payload in the file
  };

  /// A new file, or for `nextFrame` > 0 that of an earlier run without its frames from that number on, and without what
  /// a crash left half-written. Throws OutputError.
  PageFrames(std::string folder, int nextFrame);

  /// Appends a frame; false when the file is full. What cannot be written whole is taken back, and OutputError thrown.
  bool append(CoarseFrame frame);
  /// Waits until everything is on the disk.
  void sync() { file_->sync(); }

  const std::string& file() const { return file_->name(); }
  const std::vector<Entry>& entries() const { return entries_; }
  std::uint64_t bytes() const { return file_->bytes(); }

 private:
  std::optional<run::GrowingFile> file_;
  std::vector<Entry> entries_;
  FrameCoder coder_;
};

}  // namespace froude::exporting
