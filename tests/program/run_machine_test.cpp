// What the machine allows, and words for numbers.
#include <gtest/gtest.h>
#include <sched.h>

#include <cstdlib>
#include <limits>
#include <set>
#include <string>

#include "run/machine.h"
#include "run/progress.h"
#include "run/threads.h"

namespace froude::run {
namespace {

TEST(Machine, cores_follow_the_affinity_mask) {
  cpu_set_t all;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  cpu_set_t one;
  CPU_ZERO(&one);
  for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i) {
    if (CPU_ISSET(i, &all)) CPU_SET(i, &one);
  }
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const int cores = usableCores();
  sched_setaffinity(0, sizeof all, &all);
  EXPECT_EQ(cores, 1);
  EXPECT_LE(usableCores(), CPU_COUNT(&all));
}

TEST(Machine, slurm_lowers_the_cores_and_nonsense_does_not) {
  setenv("SLURM_CPUS_PER_TASK", "1", 1);
  EXPECT_EQ(usableCores(), 1);
  unsetenv("SLURM_CPUS_PER_TASK");
  const int cores = usableCores();
  for (const char* text : {"0", "-3", "many", "100000", ""}) {
    setenv("SLURM_CPUS_PER_TASK", text, 1);
    EXPECT_EQ(usableCores(), cores) << text;
  }
  unsetenv("SLURM_CPUS_PER_TASK");
}

TEST(Machine, memory_and_processor_are_known) {
  EXPECT_GT(availableMemoryBytes(), 16u << 20);
  EXPECT_FALSE(cpuName().empty());
}

TEST(Machine, programs_are_found_on_the_path_only) {
  EXPECT_TRUE(findProgram("sh").ends_with("/sh"));
  EXPECT_EQ(findProgram("no-such-program-at-all"), "");
}

TEST(Machine, sizes_and_times_read_well) {
  EXPECT_EQ(bytesInWords(512.0), "512 bytes");
  EXPECT_EQ(bytesInWords(3.2e11), "320 GB");
  EXPECT_EQ(durationInWords(4.26), "4.3 s");
  EXPECT_EQ(durationInWords(200.0), "3 min 20 s");
  EXPECT_EQ(durationInWords(3720.0), "1 h 02 min");
  EXPECT_EQ(durationInWords(std::numeric_limits<double>::infinity()), "unknown");
}

TEST(Threads, an_arena_has_exactly_the_threads_asked_for) {
  for (const int threads : {1, 2, 3, 7}) {
    int inside = 0;
    withThreads(threads, [&] { inside = concurrency(); });
    EXPECT_EQ(inside, threads);
  }
}

TEST(Threads, what_is_thrown_inside_comes_out) {
  EXPECT_THROW(withThreads(2, [] { throw std::string("out"); }), std::string);
}

TEST(Colour, no_color_is_honoured) {
  setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(colourWelcome());
  EXPECT_EQ(label("error"), "error: ");
  unsetenv("NO_COLOR");
}

}  // namespace
}  // namespace froude::run
