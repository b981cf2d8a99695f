// Sine and cosine of many angles at once, over SIMD lanes: for batches of rotations.
#pragma once

#include <span>

#include <froude/base/api.h>
#include <froude/base/simd.h>

namespace froude {

/// sine[i], cosine[i] of angle[i] [rad]. Preconditions: three spans of one length; results may not overlap the angles
/// unless they are the same span. Largest error 1.5e-16 (half a unit in the last place of 1 is 1.1e-16) for |angle| ≤
/// 1e5; beyond it, and for what is not finite, std::sin and std::cos. An angle has the same results wherever in the
/// span it stands; targets differ in the last bit, and Scalar is std::sin and std::cos. Cost: docs/decisions.
FROUDE_API void sinCos(std::span<const double> angle, std::span<double> sine, std::span<double> cosine,
                       SimdTarget target = bestSimdTarget());

}  // namespace froude
