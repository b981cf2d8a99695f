#include <froude/base/crew.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <vector>

namespace {

using namespace froude;

TEST(Crew, every_block_of_every_stage_runs_once_and_stages_do_not_overlap) {
  for (const int threads : {1, 2, 3, 7}) {
    tbb::task_arena(threads).execute([&] {
      constexpr std::size_t kCount = 1000;
      std::vector<std::uint64_t> value(kCount, 0), next(kCount, 0);
      // Each stage reads what its neighbours wrote in the one before: any overlap of stages would show.
      Crew::run(true, [&](Crew& crew) {
        for (int stage = 0; stage < 400; ++stage) {
          crew.stage(kCount, 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) next[i] = value[i] + value[(i + 1) % kCount] + i;
          });
          value.swap(next);
        }
      });
      std::vector<std::uint64_t> wanted(kCount, 0), work(kCount, 0);
      for (int stage = 0; stage < 400; ++stage) {
        for (std::size_t i = 0; i < kCount; ++i) work[i] = wanted[i] + wanted[(i + 1) % kCount] + i;
        wanted.swap(work);
      }
      EXPECT_EQ(value, wanted) << threads << " threads";
    });
  }
}

TEST(Crew, an_empty_stage_and_one_that_is_one_block_need_no_helper) {
  Crew::run(true, [](Crew& crew) {
    int calls = 0;
    crew.stage(0, 8, [&](std::size_t, std::size_t) { ++calls; });
    EXPECT_EQ(calls, 0);
    crew.stage(5, 8, [&](std::size_t begin, std::size_t end) {
      ++calls;
      EXPECT_EQ(begin, 0u);
      EXPECT_EQ(end, 5u);
    });
    EXPECT_EQ(calls, 1);
  });
}

TEST(Crew, alone_it_does_the_same) {
  std::atomic<int> sum{0};
  Crew::run(false, [&](Crew& crew) {
    for (int k = 0; k < 10; ++k) {
      crew.stage(100, 7, [&](std::size_t begin, std::size_t end) { sum += static_cast<int>(end - begin); });
    }
  });
  EXPECT_EQ(sum.load(), 1000);
}

}  // namespace
