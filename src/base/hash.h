// The state hash: 64 bits over everything that decides how a simulation goes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <froude/base/api.h>

namespace froude {

/// Streaming 64-bit hash of blocks of bytes. Not cryptographic. The result depends on the blocks and their order; each
/// call of `add` is one block and mixes in its length.
class FROUDE_API StateHash {
 public:
  void add(const void* data, std::size_t bytes);
  template <typename T>
  void addValue(const T& value) {
    add(&value, sizeof value);
  }
  std::uint64_t value() const;
  /// 16 lower-case hexadecimal digits.
  std::string hex() const;

 private:
  std::uint64_t state_ = 0x9E3779B97F4A7C15ull;
};

}  // namespace froude
