#include <froude/base/aligned.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <utility>

namespace {

using froude::AlignedArray;

template <typename T>
bool onBoundary(const AlignedArray<T>& a) {
  return reinterpret_cast<std::uintptr_t>(a.data()) % 64 == 0;
}

TEST(AlignedArray, data_is_on_a_64_byte_boundary_at_every_size) {
  AlignedArray<double> doubles;
  AlignedArray<char> bytes;
  for (std::size_t size = 1; size < 3000; size = size * 3 / 2 + 1) {
    doubles.resize(size);
    bytes.resize(size);
    EXPECT_TRUE(onBoundary(doubles)) << size;
    EXPECT_TRUE(onBoundary(bytes)) << size;
  }
}

TEST(AlignedArray, a_full_vector_may_be_read_before_the_first_and_behind_the_last_element) {
  AlignedArray<unsigned char> a(1);
  int sum = 0;
  for (std::ptrdiff_t i = -static_cast<std::ptrdiff_t>(froude::kSimdPadding);
       i <= static_cast<std::ptrdiff_t>(froude::kSimdPadding); ++i) {
    sum += a.data()[i];  // the address sanitizer would object
  }
  EXPECT_EQ(sum, 0);
}

TEST(AlignedArray, growing_keeps_the_contents_and_new_elements_are_zero) {
  AlignedArray<int> a(10);
  std::iota(a.begin(), a.end(), 1);
  a.resize(5);
  a.resize(1000);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(a[i], static_cast<int>(i) + 1);
  for (std::size_t i = 5; i < 1000; ++i) ASSERT_EQ(a[i], 0) << i;
}

TEST(AlignedArray, shrinking_keeps_the_memory_until_it_is_asked_to_give_it_back) {
  AlignedArray<int> a(1000);
  a[3] = 7;
  const int* place = a.data();
  a.resize(4);
  EXPECT_EQ(a.data(), place);
  EXPECT_EQ(a.capacity(), 1000u);
  a.shrink();
  EXPECT_EQ(a.capacity(), 4u);
  EXPECT_EQ(a[3], 7);
  a.clear();
  a.shrink();
  EXPECT_EQ(a.capacity(), 0u);
  EXPECT_TRUE(a.empty());
}

TEST(AlignedArray, an_element_of_its_own_can_be_pushed_back_while_it_grows) {
  AlignedArray<int> a;
  a.push_back(42);
  for (int i = 0; i < 1000; ++i) a.push_back(a[0]);
  EXPECT_EQ(std::accumulate(a.begin(), a.end(), 0), 42 * 1001);
}

TEST(AlignedArray, copies_are_independent_and_moves_take_everything) {
  AlignedArray<int> a(3);
  a[1] = 5;
  AlignedArray<int> copy = a;
  copy[1] = 6;
  EXPECT_EQ(a[1], 5);
  copy = a;
  EXPECT_EQ(copy[1], 5);
  const int* place = a.data();
  AlignedArray<int> moved = std::move(a);
  EXPECT_EQ(moved.data(), place);
  EXPECT_EQ(moved.size(), 3u);
}

}  // namespace
