// Loops over fixed blocks in the caller's TBB arena, and sums whose bits do not depend on the number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <froude/base/api.h>

namespace froude {

/// A non-owning reference to a callable: no allocation, no template in the source file behind it.
template <typename Signature>
class FunctionRef;

template <typename R, typename... Args>
class FunctionRef<R(Args...)> {
 public:
  template <typename F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef>)
      FunctionRef(F&& f)  // NOLINT(google-explicit-constructor): call sites pass lambdas
      : object_(const_cast<void*>(static_cast<const void*>(&f))), call_([](void* object, Args... args) -> R {
          return (*static_cast<std::remove_reference_t<F>*>(object))(std::forward<Args>(args)...);
        }) {}
  R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

 private:
  void* object_;
  R (*call_)(void*, Args...);
};

/// Elements a block holds unless a caller has a reason: large enough to hide scheduling, small enough to share.
inline constexpr std::size_t kBlockSize = 1024;

/// Number of blocks of `blockSize` that cover `count` elements.
constexpr std::size_t blockCount(std::size_t count, std::size_t blockSize = kBlockSize) {
  return (count + blockSize - 1) / blockSize;
}

/// Calls body(begin, end) once for each block of [0, count). Blocks depend on blockSize only, never on the number of
/// threads; their order is not defined. Runs in the caller's arena; with one thread, or one block, in the calling
/// thread. Every worker computes with denormals flushed and rounding to nearest. No allocation of ours.
FROUDE_API void parallelFor(std::size_t count, std::size_t blockSize, FunctionRef<void(std::size_t, std::size_t)> body);

inline void parallelFor(std::size_t count, FunctionRef<void(std::size_t, std::size_t)> body) {
  parallelFor(count, kBlockSize, body);
}

/// Sum of body(begin, end) over the blocks, added in block order: the same bits on any number of threads.
FROUDE_API double parallelSum(std::size_t count, FunctionRef<double(std::size_t, std::size_t)> body);

/// Largest body(begin, end) over the blocks; `lowest` for count = 0. A NaN from any block is returned as NaN.
FROUDE_API double parallelMax(std::size_t count, double lowest, FunctionRef<double(std::size_t, std::size_t)> body);

/// The parts body(begin, end) of fixed blocks, joined in block order by join(Part, Part) → Part, from `start` on: the
/// same bits on any number of threads. For several sums and extremes in one pass. No allocation.
template <typename Part, typename Body, typename Join>
Part reduceBlocks(std::size_t count, const Part& start, Body&& body, Join&& join) {
  constexpr std::size_t kMaxBlocks = 256;
  std::size_t blockSize = kBlockSize;
  while (blockCount(count, blockSize) > kMaxBlocks) blockSize *= 2;
  std::array<Part, kMaxBlocks> parts;
  parallelFor(count, blockSize,
              [&](std::size_t begin, std::size_t end) { parts[begin / blockSize] = body(begin, end); });
  Part all = start;
  for (std::size_t b = 0; b < blockCount(count, blockSize); ++b) all = join(all, parts[b]);
  return all;
}

/// Threads that a loop may use here: the concurrency of the arena of the caller.
FROUDE_API int concurrency();

/// Flushes denormals and rounds to nearest in the current thread until it goes out of scope.
class FROUDE_API ScopedFloatMode {
 public:
  ScopedFloatMode();
  ~ScopedFloatMode();
  ScopedFloatMode(const ScopedFloatMode&) = delete;
  ScopedFloatMode& operator=(const ScopedFloatMode&) = delete;

 private:
  unsigned long long saved_;
};

}  // namespace froude
