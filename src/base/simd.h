// Which instruction set the wide loops use: chosen once, handed down as a value, never a global.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <froude/base/api.h>

namespace froude {

/// Targets that every x86-64 build contains; `Scalar` is plain C++ and runs anywhere.
enum class SimdTarget : int { Scalar = 0, Sse4 = 1, Avx2 = 2, Avx3 = 3 };

/// "scalar", "sse4", "avx2", "avx3".
FROUDE_API std::string_view name(SimdTarget target);
/// Inverse of `name`; empty for an unknown word.
FROUDE_API std::optional<SimdTarget> simdTarget(std::string_view name);
/// Targets that this build holds and this processor runs, slowest first.
FROUDE_API std::vector<SimdTarget> supportedSimdTargets();
/// The last of `supportedSimdTargets`. Allocates nothing.
FROUDE_API SimdTarget bestSimdTarget();

}  // namespace froude
