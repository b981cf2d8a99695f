#include <froude/base/simd.h>

#include <array>

#include <hwy/targets.h>

namespace froude {
namespace {

struct Entry {
  SimdTarget target;
  std::string_view name;
  long long highwayBit;
};

constexpr std::array<Entry, 4> kEntries{{{SimdTarget::Scalar, "scalar", 0},
                                         {SimdTarget::Sse4, "sse4", HWY_SSE4},
                                         {SimdTarget::Avx2, "avx2", HWY_AVX2},
                                         {SimdTarget::Avx3, "avx3", HWY_AVX3}}};

}  // namespace

std::string_view name(SimdTarget target) { return kEntries[static_cast<std::size_t>(target)].name; }

std::optional<SimdTarget> simdTarget(std::string_view word) {
  for (const Entry& e : kEntries) {
    if (e.name == word) return e.target;
  }
  return std::nullopt;
}

std::vector<SimdTarget> supportedSimdTargets() {
  const long long running = hwy::SupportedTargets();
  std::vector<SimdTarget> targets;
  for (const Entry& e : kEntries) {
    if (e.highwayBit == 0 || (running & e.highwayBit) != 0) targets.push_back(e.target);
  }
  return targets;
}

SimdTarget bestSimdTarget() {
  const long long running = hwy::SupportedTargets();
  SimdTarget best = SimdTarget::Scalar;
  for (const Entry& e : kEntries) {
    if ((running & e.highwayBit) != 0) best = e.target;
  }
  return best;
}

}  // namespace froude
