// The scaling benchmark: the same work on every number of threads, memory per particle, and its picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "plan/scaling.h"
#include "run/exit_codes.h"

namespace froude::plan {
namespace {

const Subject& subject(const std::string& name) {
  const auto& all = scalingSubjects();
  return *std::find_if(all.begin(), all.end(), [&](const Subject& s) { return s.name == name; });
}

TEST(Scaling, does_the_same_sub_steps_on_every_number_of_threads) {
  const std::array threads{1, 2};
  const std::vector<Sample> samples = measureScaling(subject("pbf"), 0.05, threads, 0.01, 2);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].particles, samples[1].particles);
  EXPECT_EQ(samples[0].substeps, samples[1].substeps);
  EXPECT_EQ(samples[0].sweeps, samples[1].sweeps);
  EXPECT_GE(samples[0].substeps, 3u);
  for (const Sample& s : samples) {
    EXPECT_GT(s.best, 0.0);
    EXPECT_GE(s.median, s.best);
    EXPECT_EQ(s.runs, 2);
  }
}

TEST(Scaling, makes_every_subject_k_times_as_large) {
  const std::array one{1};
  for (const Subject& s : scalingSubjects()) {
    const auto small = measureScaling(s, 0.25, one, 0.0, 1).front(),
               large = measureScaling(s, 1.0, one, 0.0, 1).front();
    const double ratio = static_cast<double>(large.particles) / static_cast<double>(small.particles);
    EXPECT_GT(ratio, 2.5) << s.name << ": of small soft bodies many particles lie on the edge, and grow with a length";
    EXPECT_LT(ratio, 4.5) << s.name;
    EXPECT_GE(small.bytes, 0.0) << s.name;
  }
}

TEST(Scaling, of_memory_is_a_positive_number) { EXPECT_GT(triadScaling(2), 0.1); }

TEST(Scaling, is_drawn_of_one_sample_and_of_none) {
  const Sample one{"pbf", 10000, 1, 10, 5.0, 300.0, 290.0, 3, 500.0};
  Sample two = one;
  two.threads = 2;
  two.median = 160.0;
  const std::vector<Sample> samples{one, two};
  EXPECT_EQ(drawScaling("a.png", samples, 1.5, "where").substr(1, 3), "PNG");
  EXPECT_NE(drawScaling("a.svg", {}, 1.0, "where").find("<svg"), std::string::npos);
}

TEST(Scaling, refuses_a_subject_that_there_is_not_or_a_build_that_cannot_be_timed) {
  EXPECT_THROW(scalingCommand({.subjects = {"bpf"}}), run::UsageError);
}

}  // namespace
}  // namespace froude::plan
