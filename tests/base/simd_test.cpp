#include <froude/base/simd.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace froude;

TEST(Simd, every_target_has_a_name_that_leads_back_to_it) {
  for (const SimdTarget t : {SimdTarget::Scalar, SimdTarget::Sse4, SimdTarget::Avx2, SimdTarget::Avx3}) {
    EXPECT_EQ(simdTarget(name(t)), t);
  }
  EXPECT_EQ(name(SimdTarget::Scalar), "scalar");
  EXPECT_EQ(name(SimdTarget::Sse4), "sse4");
  EXPECT_EQ(name(SimdTarget::Avx2), "avx2");
  EXPECT_EQ(name(SimdTarget::Avx3), "avx3");
}

TEST(Simd, an_unknown_name_leads_nowhere) {
  for (const char* word : {"", "AVX2", "avx", "neon", "avx22"}) EXPECT_FALSE(simdTarget(word)) << word;
}

TEST(Simd, supported_targets_rise_from_scalar_to_the_best) {
  const std::vector<SimdTarget> targets = supportedSimdTargets();
  ASSERT_FALSE(targets.empty());
  EXPECT_EQ(targets.front(), SimdTarget::Scalar);
  EXPECT_EQ(targets.back(), bestSimdTarget());
  EXPECT_TRUE(std::is_sorted(targets.begin(), targets.end()));
}

#if defined(__x86_64__) && defined(__GNUC__)
TEST(Simd, supported_targets_agree_with_the_processor) {
  const std::vector<SimdTarget> targets = supportedSimdTargets();
  const auto supports = [&](SimdTarget t) { return std::find(targets.begin(), targets.end(), t) != targets.end(); };
  EXPECT_TRUE(!supports(SimdTarget::Sse4) || __builtin_cpu_supports("sse4.2"));
  EXPECT_TRUE(!supports(SimdTarget::Avx2) || __builtin_cpu_supports("avx2"));
  EXPECT_TRUE(!supports(SimdTarget::Avx3) || __builtin_cpu_supports("avx512f"));
}
#endif

}  // namespace
