#include <froude/base/archive.h>

#include <string>

namespace froude {

void MemorySnapshot::Writer::bytes(std::string_view, void* data, std::size_t elementSize, std::size_t n) {
  const std::size_t size = elementSize * n;
  AlignedArray<std::byte>& buffer = snapshot_.buffer_;
  const std::size_t needed = snapshot_.used_ + size;
  if (buffer.size() < needed) {
    // A little more than now, not twice as much: a state grows by few particles, and is most of what a world holds.
    if (buffer.capacity() < needed) buffer.reserve(needed + needed / 8);
    buffer.resize(needed);
  }
  if (size > 0) std::memcpy(buffer.data() + snapshot_.used_, data, size);
  snapshot_.used_ += size;
}

std::size_t MemorySnapshot::Writer::count(std::string_view name, std::size_t current) {
  bytes(name, &current, sizeof current, 1);
  return current;
}

void MemorySnapshot::Reader::bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t n) {
  const std::size_t size = elementSize * n;
  if (at_ + size > snapshot_.used_) throw Error("snapshot: '" + std::string(name) + "' is not in the saved state");
  if (size > 0) std::memcpy(data, snapshot_.buffer_.data() + at_, size);
  at_ += size;
}

std::size_t MemorySnapshot::Reader::count(std::string_view name, std::size_t) {
  std::size_t n = 0;
  bytes(name, &n, sizeof n, 1);
  return n;
}

}  // namespace froude
