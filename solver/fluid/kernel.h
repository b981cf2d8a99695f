// The kernel in two dimensions, in units of the particle spacing dx: W = (5/4π)(1 − q²/4)⁴ for q = r/dx < 2.
// Why this one: it is a polynomial in q², so that a pair costs no square root and a wall no logarithm; the bell is within
// 2 % of the cubic spline's of the same support; and on a square lattice of spacing 1 it sums to 1.0010 (hexagonal: 1.010),
// so that a particle's mass density·dx² gives the rest density without a fitted factor. See docs/decisions/.
#pragma once

#include <froude/base/types.h>

namespace froude::kernel {

/// Support radius in spacings.
inline constexpr double kSupport = 2.0;
/// Normalisation in two dimensions: ∫ W dA = 1.
inline constexpr double kNorm = 5.0 / (4.0 * kPi);

/// W at the squared distance q2, in spacings squared [1/dx²].
inline double value(double q2) {
  const double m = 1.0 - 0.25 * q2;
  return m > 0.0 ? kNorm * (m * m) * (m * m) : 0.0;
}

/// (dW/dq)/q at the squared distance q2 [1/dx⁴]: the gradient is this times the vector of the pair in spacings.
inline double gradientFactor(double q2) {
  const double m = 1.0 - 0.25 * q2;
  return m > 0.0 ? -2.0 * kNorm * m * m * m : 0.0;
}

}  // namespace froude::kernel
