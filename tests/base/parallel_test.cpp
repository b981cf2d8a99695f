#include <froude/base/parallel.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <froude/base/random.h>

namespace {

using namespace froude;

constexpr int kThreads[] = {1, 2, 3, 7};

template <typename F>
void onThreads(int threads, F&& f) {
  tbb::task_arena arena(threads);
  arena.execute(f);
}

// Magnitudes over 60 orders: any other order of adding gives other bits.
std::vector<double> wildNumbers(std::size_t n) {
  RandomStream random(7, 3);
  std::vector<double> v(n);
  for (double& x : v) x = random.uniform(-1.0, 1.0) * std::pow(10.0, random.uniform(-30.0, 30.0));
  return v;
}

TEST(ParallelFor, every_index_is_visited_exactly_once) {
  for (const std::size_t count : {0u, 1u, 1023u, 1024u, 1025u, 100000u}) {
    for (const int threads : kThreads) {
      std::vector<std::atomic<int>> visits(count);
      onThreads(threads, [&] {
        parallelFor(count, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
      });
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1) << i << " of " << count;
    }
  }
}

TEST(ParallelFor, blocks_depend_on_the_block_size_only) {
  for (const int threads : kThreads) {
    std::vector<std::size_t> ends(blockCount(10000, 333), 0);
    onThreads(threads, [&] {
      parallelFor(10000, 333, [&](std::size_t begin, std::size_t end) {
        ASSERT_EQ(begin % 333, 0u);
        ends[begin / 333] = end;
      });
    });
    for (std::size_t b = 0; b < ends.size(); ++b) EXPECT_EQ(ends[b], std::min<std::size_t>(10000, (b + 1) * 333));
  }
}

TEST(ParallelFor, workers_flush_denormals_and_the_caller_keeps_its_mode) {
  volatile double tiny = std::numeric_limits<double>::min();
  std::atomic<int> notFlushed{0};
  onThreads(3, [&] {
    parallelFor(100 * kBlockSize, [&](std::size_t, std::size_t) {
      if (tiny * 0.5 != 0.0) ++notFlushed;
    });
  });
  EXPECT_EQ(notFlushed, 0);
  EXPECT_NE(tiny * 0.5, 0.0);
}

TEST(ParallelSum, has_the_same_bits_on_any_number_of_threads) {
  for (const std::size_t count : {1u, 1500u, 70000u, 3000000u}) {
    const std::vector<double> v = wildNumbers(count);
    std::vector<std::uint64_t> sums;
    for (const int threads : kThreads) {
      onThreads(threads, [&] {
        const double sum = parallelSum(count, [&](std::size_t begin, std::size_t end) {
          return std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(begin),
                                 v.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
        });
        sums.push_back(std::bit_cast<std::uint64_t>(sum));
      });
    }
    for (const std::uint64_t sum : sums) EXPECT_EQ(sum, sums.front()) << count;
  }
}

TEST(ParallelSum, of_whole_numbers_is_exact) {
  const double sum = parallelSum(3000000, [](std::size_t begin, std::size_t end) {
    double s = 0.0;
    for (std::size_t i = begin; i < end; ++i) s += static_cast<double>(i);
    return s;
  });
  EXPECT_EQ(sum, 3000000.0 * 2999999.0 / 2.0);
  EXPECT_EQ(parallelSum(0, [](std::size_t, std::size_t) { return 1.0; }), 0.0);
}

TEST(ParallelMax, finds_the_largest_and_passes_on_nan) {
  std::vector<double> v = wildNumbers(50000);
  const auto largest = [&v](std::size_t begin, std::size_t end) {
    double m = v[begin];
    for (std::size_t i = begin; i < end; ++i) m = std::isnan(v[i]) || v[i] > m ? v[i] : m;
    return m;
  };
  v[41234] = 1e31;
  EXPECT_EQ(parallelMax(v.size(), 0.0, largest), 1e31);
  EXPECT_EQ(parallelMax(v.size(), 1e32, largest), 1e32);
  EXPECT_EQ(parallelMax(0, -3.0, largest), -3.0);
  v[777] = std::nan("");
  for (std::size_t i = 778; i < 1024; ++i) v[i] = std::nan("");
  EXPECT_TRUE(std::isnan(parallelMax(v.size(), 0.0, largest)));
}

TEST(FunctionRef, calls_the_object_itself_and_not_a_copy) {
  int calls = 0;
  auto counter = [&calls, own = 0]() mutable {
    ++calls;
    return ++own;
  };
  const FunctionRef<int()> ref(counter);
  ref();
  EXPECT_EQ(ref(), 2);
  EXPECT_EQ(counter(), 3);
  EXPECT_EQ(calls, 3);
}

}  // namespace
