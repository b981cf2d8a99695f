#include "export/page_frames.h"

#include <filesystem>
#include <fstream>
#include <utility>

namespace froude::exporting {
namespace {

/// The whole records of a file with numbers below `next`, up to the first that is not one.
std::vector<PageFrames::Entry> readRecords(const std::string& file, std::uint64_t size, int next) {
  std::vector<PageFrames::Entry> entries;
  std::ifstream stream(file, std::ios::binary);
  char header[FrameCoder::kHeaderBytes];
  FrameRecord record;
  std::uint64_t at = 0;
  while (stream.read(header, sizeof header) && readRecord(header, record) && record.index < next) {
    const std::uint64_t begin = at + sizeof header;
    at = begin + record.packed;
    if (at > size) break;
    entries.push_back({record, begin});
    stream.seekg(static_cast<std::streamoff>(at));
  }
  return entries;
}

}  // namespace

PageFrames::PageFrames(std::string folder, int nextFrame) {
  std::string file = std::move(folder) + "/" + kName;
  std::error_code error;
  const std::uint64_t size = nextFrame > 0 ? std::filesystem::file_size(file, error) : 0;
  if (nextFrame == 0 || error) {
    file_.emplace(std::move(file));
    return;
  }
  entries_ = readRecords(file, size, nextFrame);
  file_.emplace(std::move(file), entries_.empty() ? 0 : entries_.back().begin + entries_.back().record.packed);
}

bool PageFrames::append(CoarseFrame frame) {
  if (bytes() >= kLargest) return false;
  const std::string record = coder_.encode(std::move(frame));
  Entry entry{{}, bytes() + FrameCoder::kHeaderBytes};
  file_->append(record);
  readRecord(record.data(), entry.record);
  entries_.push_back(entry);
  return true;
}

}  // namespace froude::exporting
