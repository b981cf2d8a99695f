// FROUDE_ASSERT: a programmer's mistake, checked in debug builds and in all tests (NDEBUG absent).
#pragma once

#include <cassert>

#define FROUDE_ASSERT(condition) assert(condition)

namespace froude {
/// True in builds whose assertions are on; such builds refuse to print rates.
#ifdef NDEBUG
inline constexpr bool kAssertionsOn = false;
#else
inline constexpr bool kAssertionsOn = true;
#endif
/// True in optimised builds.
#ifdef __OPTIMIZE__
inline constexpr bool kOptimized = true;
#else
inline constexpr bool kOptimized = false;
#endif
}  // namespace froude
