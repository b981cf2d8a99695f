#include <froude/particles/key_sort.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>

namespace froude {
namespace {

// Below this a second thread costs more than it saves.
constexpr std::size_t kSerialKeys = 16384;
constexpr std::size_t kMaxChunks = 16;
constexpr std::size_t kKeyBlock = 8192;

}  // namespace

void KeySort::sort(std::span<const std::uint32_t> keys, std::size_t keyCount) {
  FROUDE_ASSERT(keys.size() < 0xFFFFFFFFu);
  order_.resize(keys.size());
  // Every chunk costs a histogram of all keys, so sparse ones take fewer. The number of chunks follows the machine, and
  // may: a stable sort has one result.
  const std::size_t affordable = 4 * keys.size() / std::max<std::size_t>(1, keyCount);
  const std::size_t chunks = std::min({static_cast<std::size_t>(concurrency()), kMaxChunks, affordable});
  if (chunks < 2 || keys.size() < kSerialKeys) {
    sortSerial(keys, keyCount);
  } else {
    sortParallel(keys, keyCount, chunks);
  }
}

// start_[c + 2] counts the keys c; summed up, start_[c + 1] is where c starts; and when the last
// key c has been placed there, it has become where c + 1 starts.
void KeySort::sortSerial(std::span<const std::uint32_t> keys, std::size_t keyCount) {
  const std::size_t n = keys.size();
  start_.resize(keyCount + 2);
  std::uint32_t* start = start_.data();
  std::memset(start, 0, (keyCount + 2) * sizeof(std::uint32_t));
  const std::uint32_t* key = keys.data();
  std::uint32_t* order = order_.data();
  std::uint32_t descents = 0, previous = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t c = key[i];
    descents += c < previous ? 1u : 0u;
    previous = c;
    ++start[c + 2];
  }
  sorted_ = descents == 0;
  std::uint32_t sum = 0;
  for (std::size_t c = 2; c < keyCount + 2; ++c) start[c] = sum += start[c];
  if (sorted_) {
    for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<std::uint32_t>(i);
    std::memmove(start, start + 1, (keyCount + 1) * sizeof(std::uint32_t));
  } else {
    for (std::size_t i = 0; i < n; ++i) order[start[key[i] + 1]++] = static_cast<std::uint32_t>(i);
  }
  start_.resize(keyCount + 1);
}

void KeySort::sortParallel(std::span<const std::uint32_t> keys, std::size_t keyCount, std::size_t chunks) {
  const std::size_t n = keys.size();
  const std::size_t chunkSize = (n + chunks - 1) / chunks;
  start_.resize(keyCount + 1);
  histograms_.resize(chunks * keyCount);
  std::array<std::uint32_t, kMaxChunks> descents{};
  parallelFor(n, chunkSize, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* histogram = histograms_.data() + begin / chunkSize * keyCount;
    std::memset(histogram, 0, keyCount * sizeof(std::uint32_t));
    const std::uint32_t* key = keys.data();
    std::uint32_t down = 0, previous = begin > 0 ? key[begin - 1] : 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t c = key[i];
      down += c < previous ? 1u : 0u;
      previous = c;
      ++histogram[c];
    }
    descents[begin / chunkSize] = down;
  });
  sorted_ = std::all_of(descents.begin(), descents.end(), [](std::uint32_t d) { return d == 0; });
  blockSums_.resize(blockCount(keyCount, kKeyBlock));
  parallelFor(keyCount, kKeyBlock, [&](std::size_t begin, std::size_t end) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < chunks; ++k) {
      const std::uint32_t* histogram = histograms_.data() + k * keyCount;
      for (std::size_t c = begin; c < end; ++c) sum += histogram[c];
    }
    blockSums_[begin / kKeyBlock] = sum;
  });
  std::uint32_t before = 0;
  for (std::uint32_t& sum : blockSums_) before += std::exchange(sum, before);
  parallelFor(keyCount, kKeyBlock, [&](std::size_t begin, std::size_t end) {
    std::uint32_t next = blockSums_[begin / kKeyBlock];
    for (std::size_t c = begin; c < end; ++c) {
      start_[c] = next;
      for (std::size_t k = 0; k < chunks; ++k) next += std::exchange(histograms_[k * keyCount + c], next);
    }
  });
  start_[keyCount] = static_cast<std::uint32_t>(n);
  parallelFor(n, chunkSize, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* next = histograms_.data() + begin / chunkSize * keyCount;
    for (std::size_t i = begin; i < end; ++i) order_[next[keys[i]]++] = static_cast<std::uint32_t>(i);
  });
}

std::size_t KeySort::memoryBytes() const {
  return sizeof(std::uint32_t) *
         (order_.capacity() + start_.capacity() + histograms_.capacity() + blockSums_.capacity());
}

}  // namespace froude
