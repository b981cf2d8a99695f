// A crew that walks through many short parallel stages together, without a visit to the scheduler between them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include <froude/base/api.h>
#include <froude/base/parallel.h>

namespace froude {

/// Within `work`, each call of `stage` is a loop over fixed blocks that ends before the next begins, as parallelFor;
/// but its cost beside the bodies is that of a few atomic operations. Helpers are tasks of the caller's arena and come
/// when they can: the caller alone is enough, and never waits for one that has not come. While they wait for the next
/// stage they spin, so what stands between the stages should be short. No allocation of ours.
class FROUDE_API Crew {
 public:
  /// Runs work(crew) in the calling thread, with up to concurrency() − 1 helpers; alone where `useful` is false.
  static void run(bool useful, FunctionRef<void(Crew&)> work);

  /// Calls body(begin, end) once for each block of [0, count); blocks depend on `blockSize` only. Precondition: called
  /// by the thread that runs `work`, and fewer than 2²⁰ blocks.
  void stage(std::size_t count, std::size_t blockSize, FunctionRef<void(std::size_t, std::size_t)> body);

 private:
  using Body = FunctionRef<void(std::size_t, std::size_t)>;
  void help();
  void runBlock(std::uint64_t block);

  // Number of the stage (24 bits), of its blocks (20), of the next block (20).
  std::atomic<std::uint64_t> claim_{0};
  std::atomic<std::uint64_t> done_{0};  // blocks of the stage
  std::atomic<bool> over_{false};
  const Body* body_ = nullptr;
  std::size_t count_ = 0, blockSize_ = 1;
  bool alone_ = true;
};

}  // namespace froude
