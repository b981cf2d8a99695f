#include <froude/base/random.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace {

using namespace froude;
using Words = std::array<std::uint32_t, 4>;

// The known-answer vectors that the authors publish with Random123, for philox4x32 with 10 rounds.
TEST(Philox, gives_the_published_answers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  const std::uint32_t f = 0xffffffff;
  EXPECT_EQ(philox({f, f, f, f}, {f, f}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(RandomStream, a_value_depends_on_its_counter_and_not_on_the_way_there) {
  RandomStream a(5, 9);
  std::vector<std::uint64_t> values;
  for (int i = 0; i < 100; ++i) values.push_back(a.bits());
  RandomStream b(5, 9);
  for (const std::uint64_t i : {99u, 0u, 50u}) {
    b.setCounter(i);
    EXPECT_EQ(b.bits(), values[i]);
    EXPECT_EQ(b.counter(), i + 1);
  }
}

TEST(RandomStream, seeds_and_streams_differ_in_all_their_bits) {
  std::set<std::uint64_t> firsts;
  for (int bit = 0; bit < 64; ++bit) {
    firsts.insert(RandomStream(std::uint64_t{1} << bit, 0).bits());
    firsts.insert(RandomStream(0, std::uint64_t{1} << bit).bits());
  }
  firsts.insert(RandomStream(0, 0).bits());
  RandomStream late(0, 0);
  late.setCounter(std::uint64_t{1} << 40);
  firsts.insert(late.bits());
  EXPECT_EQ(firsts.size(), 130u);
}

TEST(RandomStream, uniform_numbers_have_the_mean_and_variance_of_their_range) {
  RandomStream random(1, 1);
  constexpr int kCount = 200000;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += u * u;
  }
  const double mean = sum / kCount;
  EXPECT_NEAR(mean, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kCount));
  EXPECT_NEAR(squares / kCount - mean * mean, 1.0 / 12.0, 0.001);
}

TEST(RandomStream, below_reaches_every_value_equally_often) {
  RandomStream random(2, 1);
  std::array<int, 7> hits{};
  for (int i = 0; i < 70000; ++i) ++hits.at(random.below(7));
  double chiSquare = 0.0;
  for (const int h : hits) chiSquare += (h - 10000.0) * (h - 10000.0) / 10000.0;
  EXPECT_LT(chiSquare, 22.5);  // 6 degrees of freedom, one in a thousand
  EXPECT_EQ(random.below(1), 0u);
}

}  // namespace
