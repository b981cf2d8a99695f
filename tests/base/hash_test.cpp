#include <froude/base/hash.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace {

using froude::StateHash;

std::uint64_t hashOf(const std::vector<unsigned char>& bytes) {
  StateHash h;
  h.add(bytes.data(), bytes.size());
  return h.value();
}

TEST(StateHash, every_single_bit_matters_at_every_length) {
  for (std::size_t size = 0; size <= 100; ++size) {
    std::vector<unsigned char> bytes(size, 0x5a);
    std::set<std::uint64_t> seen{hashOf(bytes)};
    for (std::size_t bit = 0; bit < 8 * size; ++bit) {
      bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8);
      seen.insert(hashOf(bytes));
      bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8);
    }
    EXPECT_EQ(seen.size(), 8 * size + 1) << size;
  }
}

TEST(StateHash, no_two_flipped_bits_cancel) {
  std::vector<unsigned char> bytes(72, 0x3c);
  std::set<std::uint64_t> seen{hashOf(bytes)};
  const auto flip = [&bytes](std::size_t bit) { bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8); };
  std::size_t pairs = 0;
  for (std::size_t a = 0; a < 8 * bytes.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b, ++pairs) {
      flip(a);
      flip(b);
      seen.insert(hashOf(bytes));
      flip(b);
      flip(a);
    }
  }
  EXPECT_EQ(seen.size(), pairs + 1);
}

TEST(StateHash, lengths_of_zeros_and_splits_into_blocks_matter) {
  std::set<std::uint64_t> seen;
  for (std::size_t size = 0; size < 300; ++size) seen.insert(hashOf(std::vector<unsigned char>(size, 0)));
  EXPECT_EQ(seen.size(), 300u);
  const std::vector<unsigned char> bytes(64, 1);
  StateHash split;
  split.add(bytes.data(), 32);
  split.add(bytes.data() + 32, 32);
  EXPECT_NE(split.value(), hashOf(bytes));
}

TEST(StateHash, order_matters_and_repetition_is_exact) {
  StateHash ab, ba, again;
  ab.addValue(1.0);
  ab.addValue(2.0);
  ba.addValue(2.0);
  ba.addValue(1.0);
  again.addValue(1.0);
  again.addValue(2.0);
  EXPECT_NE(ab.value(), ba.value());
  EXPECT_EQ(ab.value(), again.value());
  EXPECT_EQ(ab.hex(), again.hex());
}

TEST(StateHash, hex_is_the_value_in_sixteen_digits) {
  StateHash h;
  h.addValue(42);
  EXPECT_EQ(h.hex().size(), 16u);
  EXPECT_EQ(std::stoull(h.hex(), nullptr, 16), h.value());
}

TEST(StateHash, zero_and_minus_zero_are_different_states) {
  StateHash plus, minus;
  plus.addValue(0.0);
  minus.addValue(-0.0);
  EXPECT_NE(plus.value(), minus.value());
}

}  // namespace
