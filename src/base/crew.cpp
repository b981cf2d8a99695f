#include <froude/base/crew.h>

#include <tbb/task_group.h>

#include <algorithm>
#include <thread>

#include <froude/base/assert.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace froude {
namespace {

constexpr int kBits = 20;
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
constexpr int kPatience = 4000;  // pauses before a waiting thread gives its core away: some 50 µs

// Waits a little longer each time it is asked.
class Waiting {
 public:
  void pause() {
    if (++count_ > kPatience) {
      std::this_thread::yield();
      return;
    }
#if defined(__x86_64__)
    _mm_pause();
#endif
  }

 private:
  int count_ = 0;
};

std::uint64_t nextOf(std::uint64_t claim) { return claim & kMask; }
std::uint64_t blocksOf(std::uint64_t claim) { return (claim >> kBits) & kMask; }
bool anyLeft(std::uint64_t claim) { return nextOf(claim) < blocksOf(claim); }

}  // namespace

void Crew::runBlock(std::uint64_t block) {
  const std::size_t begin = static_cast<std::size_t>(block) * blockSize_;
  (*body_)(begin, std::min(count_, begin + blockSize_));
}

// Who has claimed a block pins its stage: the fields that describe it stay until the block is done.
void Crew::help() {
  const ScopedFloatMode mode;
  Waiting waiting;
  while (!over_.load(std::memory_order_acquire)) {
    if (!anyLeft(claim_.load(std::memory_order_relaxed))) {
      waiting.pause();
      continue;
    }
    const std::uint64_t mine = claim_.fetch_add(1, std::memory_order_acq_rel);
    if (!anyLeft(mine)) continue;
    runBlock(nextOf(mine));
    done_.fetch_add(1, std::memory_order_acq_rel);
    waiting = Waiting();
  }
}

void Crew::stage(std::size_t count, std::size_t blockSize, Body body) {
  if (count == 0) return;
  const std::size_t blocks = blockCount(count, blockSize);
  FROUDE_ASSERT(blocks < kMask);
  if (alone_ || blocks == 1) {
    for (std::size_t b = 0; b < blocks; ++b) body(b * blockSize, std::min(count, (b + 1) * blockSize));
    return;
  }
  // Helpers that came late may still count beyond the last block of the stage before; they touch nothing else.
  body_ = &body;
  count_ = count;
  blockSize_ = blockSize;
  done_.store(0, std::memory_order_relaxed);
  const std::uint64_t number = (claim_.load(std::memory_order_relaxed) >> (2 * kBits)) + 1;
  claim_.store((number << (2 * kBits)) | (static_cast<std::uint64_t>(blocks) << kBits), std::memory_order_release);
  while (true) {
    const std::uint64_t mine = claim_.fetch_add(1, std::memory_order_acq_rel);
    if (!anyLeft(mine)) break;
    runBlock(nextOf(mine));
    done_.fetch_add(1, std::memory_order_acq_rel);
  }
  Waiting waiting;
  while (done_.load(std::memory_order_acquire) != blocks) waiting.pause();
}

void Crew::run(bool useful, FunctionRef<void(Crew&)> work) {
  const ScopedFloatMode mode;
  Crew crew;
  const int helpers = useful ? concurrency() - 1 : 0;
  if (helpers <= 0) {
    work(crew);
    return;
  }
  crew.alone_ = false;
  tbb::task_group group;
  for (int k = 0; k < helpers; ++k) group.run([&crew] { crew.help(); });
  work(crew);
  crew.over_.store(true, std::memory_order_release);
  group.wait();
}

}  // namespace froude
