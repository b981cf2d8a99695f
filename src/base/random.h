// Counter-based random numbers: a value depends on seed, stream and counter only, never on the order of calls.
#pragma once

#include <array>
#include <cstdint>

#include <froude/base/api.h>

namespace froude {

/// Philox-4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011): four 32-bit words of the
/// counter's block under the key. Passes the known-answer test of its authors.
FROUDE_API std::array<std::uint32_t, 4> philox(const std::array<std::uint32_t, 4>& counter,
                                               const std::array<std::uint32_t, 2>& key);

/// Random numbers of one stream (an emitter, a block of bullets, a test). Value n is the same however it is reached.
/// State to be saved: the counter alone.
class FROUDE_API RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform integer in [0, bound), bound > 0; bias below 2^-32 · bound.
  std::uint32_t below(std::uint32_t bound);
  /// 64 random bits.
  std::uint64_t bits();

  std::uint64_t counter() const { return counter_; }
  void setCounter(std::uint64_t counter) { counter_ = counter; }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
  std::uint64_t counter_ = 0;
};

}  // namespace froude
