#include <froude/base/parallel.h>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>

#include <froude/base/aligned.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace froude {

#if defined(__x86_64__)
namespace {
// MXCSR: flush-to-zero (bit 15), denormals-are-zero (bit 6), all exceptions masked, rounding to nearest.
constexpr unsigned kSteppingMode = 0x8000u | 0x0040u | 0x1f80u;
}  // namespace

ScopedFloatMode::ScopedFloatMode() : saved_(_mm_getcsr()) { _mm_setcsr(kSteppingMode); }
ScopedFloatMode::~ScopedFloatMode() { _mm_setcsr(static_cast<unsigned>(saved_)); }
#elif defined(__aarch64__)
ScopedFloatMode::ScopedFloatMode() {
  unsigned long long fpcr = 0;
  asm volatile("mrs %0, fpcr" : "=r"(fpcr));
  saved_ = fpcr;
  asm volatile("msr fpcr, %0" : : "r"(1ull << 24));  // FZ, rounding to nearest
}
ScopedFloatMode::~ScopedFloatMode() { asm volatile("msr fpcr, %0" : : "r"(saved_)); }
#else
ScopedFloatMode::ScopedFloatMode() : saved_(static_cast<unsigned long long>(std::fegetround())) {
  std::fesetround(FE_TONEAREST);
}
ScopedFloatMode::~ScopedFloatMode() { std::fesetround(static_cast<int>(saved_)); }
#endif

namespace {

// oneTBB is not built with the thread sanitizer, which therefore cannot see that a loop's bodies come after what stood
// before the loop and before what stands behind it. These calls say so, and no more: bodies of one loop still race with
// each other. The marks are global because a body may read nothing, not even its captures, before it has entered.
#if defined(__SANITIZE_THREAD__)
char openMark;
char closeMark;
void openLoop() { __tsan_release(&openMark); }
void enterBody() { __tsan_acquire(&openMark); }
void leaveBody() { __tsan_release(&closeMark); }
void closeLoop() { __tsan_acquire(&closeMark); }
#else
void openLoop() {}
void enterBody() {}
void leaveBody() {}
void closeLoop() {}
#endif

}  // namespace

int concurrency() { return tbb::this_task_arena::max_concurrency(); }

void parallelFor(std::size_t count, std::size_t blockSize, FunctionRef<void(std::size_t, std::size_t)> body) {
  if (count == 0) return;
  const std::size_t blocks = blockCount(count, blockSize);
  auto runBlocks = [&](std::size_t first, std::size_t last) {
    const ScopedFloatMode mode;
    for (std::size_t b = first; b < last; ++b) body(b * blockSize, std::min(count, (b + 1) * blockSize));
  };
  if (blocks == 1 || concurrency() == 1) {
    runBlocks(0, blocks);
    return;
  }
  openLoop();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const tbb::blocked_range<std::size_t>& r) {
    enterBody();
    runBlocks(r.begin(), r.end());
    leaveBody();
  });
  closeLoop();
}

namespace {

// Partial results live on the stack for as many blocks as fit; a longer loop takes larger blocks, by a rule that knows
// the count only, so that the grouping of the sum is the same on every machine.
constexpr std::size_t kMaxPartials = 1024;

template <typename Combine>
double reduceBlocks(std::size_t count, double initial, FunctionRef<double(std::size_t, std::size_t)> body,
                    Combine combine) {
  std::size_t blockSize = kBlockSize;
  while (blockCount(count, blockSize) > kMaxPartials) blockSize *= 2;
  std::array<double, kMaxPartials> partial;
  parallelFor(count, blockSize,
              [&](std::size_t begin, std::size_t end) { partial[begin / blockSize] = body(begin, end); });
  double result = initial;
  const std::size_t blocks = blockCount(count, blockSize);
  for (std::size_t b = 0; b < blocks; ++b) result = combine(result, partial[b]);
  return result;
}

}  // namespace

double parallelSum(std::size_t count, FunctionRef<double(std::size_t, std::size_t)> body) {
  return reduceBlocks(count, 0.0, body, [](double a, double b) { return a + b; });
}

double parallelMax(std::size_t count, double lowest, FunctionRef<double(std::size_t, std::size_t)> body) {
  return reduceBlocks(count, lowest, body, [](double a, double b) {
    if (std::isnan(a) || std::isnan(b)) return std::nan("");
    return std::max(a, b);
  });
}

}  // namespace froude
