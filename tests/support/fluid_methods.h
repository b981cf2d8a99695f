// The fluid methods: what holds for every one of them is one suite, run for each.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/worlds.h"

namespace froude::testing {

/// Of a suite: `class X : public FluidMethod {}`, `INSTANTIATE_TEST_SUITE_P(Each, X, kFluidMethods, methodName)`.
class FluidMethod : public ::testing::TestWithParam<const char*> {
 protected:
  static WorldDef fluidWorld(const Box& domain, double dx) {
    WorldDef def = testing::fluidWorld(domain, dx);
    def.fluid->model = GetParam();
    return def;
  }
  /// For what one method does better than the others.
  static bool pbf() { return GetParam() == std::string("pbf"); }
  /// What cannot hold where sound is a thousandth as fast as in water, or does not hold yet, says so where it stands.
  static bool apic() { return GetParam() == std::string("apic"); }
  static bool wcsph() { return GetParam() == std::string("wcsph"); }
};

inline const auto kFluidMethods = ::testing::Values("pbf", "dfsph", "wcsph", "apic");
/// Those that have viscosity, and walls to which a fluid sticks.
inline const auto kViscousMethods = ::testing::Values("pbf", "dfsph", "wcsph", "apic");
/// Those that surface tension serves.
inline const auto kTensionMethods = ::testing::Values("pbf", "dfsph", "wcsph");

inline std::string methodName(const ::testing::TestParamInfo<const char*>& info) { return info.param; }

/// Steps freely until the world's time is at least `end`.
inline void runTo(World& world, double end) {
  while (world.time() < end) {
    const StepReport report = world.substep();
    ASSERT_TRUE(report.ok()) << name(report.trouble) << " " << report.troubleValue << " at " << world.time() << " s";
  }
}

inline double meanSpeed(const World& world) {
  double sum = 0.0;
  const ParticlePool& pool = *world.fluid();
  for (std::size_t i = 0; i < pool.size(); ++i) sum += std::hypot(pool.vx()[i], pool.vy()[i]);
  return sum / static_cast<double>(pool.size());
}

/// Momentum that is not in the books, of that of all particles at the largest speed so far.
inline double momentumError(const World& world) {
  const Totals totals = world.totals();
  const Ledger& ledger = world.ledger();
  return (totals.momentum - ledger.momentum0 - ledger.impulse).norm() / (totals.mass * ledger.maxSpeed);
}

}  // namespace froude::testing
