// The kernel in two dimensions, in units of the particle spacing dx: with m = 1 − q²/4, q = r/dx < 2,
//     w = (4/5)·(5/4π)·m⁴ + (1/5)·(11/4π)·m¹⁰ = m⁴ (1 + 0.55 m⁶)/π,     ∫ w dA = 1.
// Why this one: it is a polynomial in q², so that a pair costs no square root and a wall no logarithm. m⁴ alone has a
// negative lobe in its Fourier transform, and particles pair up under pressure (seen: bottom corners of a tank at
// rest); a fifth of m¹⁰ makes it positive, as Wendland's kernels are. On the square lattice of spacing 1 it sums
// to 1.0160, on the hexagonal one of the same density to 1.0178: the sum over particles is divided by their mean, so
// that a particle's mass density·dx² gives the rest density in both. See docs/decisions/.
#pragma once

#include <froude/base/types.h>

namespace froude::kernel {

/// Blend: the kernel above. WendlandC2: (7/4π)(1 − q/2)⁴(1 + 2q) (Wendland, Adv. Comput. Math. 4 (1995)), whose Fourier
/// transform is positive everywhere: supports of more than 2 spacings need that, or particles pair up. Both reach to
/// q = 2.
enum class Kind { Blend, WendlandC2 };

/// Support radius in spacings.
inline constexpr double kSupport = 2.0;
/// Sum over the lattices named above, for particles; walls are integrals and have none.
inline constexpr double kLatticeSum = 1.0169;
/// Σ of the gradient's linear moment, −½ Σ r·∇W, over the hexagonal lattice that a fluid under pressure takes: the
/// share of a pressure gradient that the particles feel, and so what a multiplier counts as pressure (square lattice:
/// 0.977).
inline constexpr double kGradientMoment = 0.935;
/// The same, mean of both lattices: the share of a velocity's Laplacian that Morris' term over particles feels. A
/// wall's term is an integral and feels all of it.
inline constexpr double kLaplacianMoment = 0.956;
/// Factor of the shape m⁴ (1 + kTail m⁶) for particles.
inline constexpr double kNorm = 1.0 / (kPi * kLatticeSum);
inline constexpr double kTail = 0.55;

/// W at the squared distance q2, in spacings squared [1/dx²].
inline double value(double q2) {
  const double m = 1.0 - 0.25 * q2;
  const double m2 = m * m;
  return m > 0.0 ? kNorm * m2 * m2 * (1.0 + kTail * m2 * m2 * m2) : 0.0;
}

/// (dW/dq)/q at the squared distance q2 [1/dx⁴]: the gradient is this times the vector of the pair in spacings.
inline double gradientFactor(double q2) {
  const double m = 1.0 - 0.25 * q2;
  const double m3 = m * m * m;
  return m > 0.0 ? -2.0 * kNorm * m3 * (1.0 + 2.5 * kTail * m3 * m3) : 0.0;
}

/// Factor of Wendland's kernel, and of its gradient −5·kWendland·(1 − q/2)³ over q.
inline constexpr double kWendland = 7.0 / (4.0 * kPi);

/// Wendland's kernel at the distance q.
inline double wendland(double q) {
  const double k = 1.0 - 0.5 * q;
  return k > 0.0 ? kWendland * k * k * k * k * (1.0 + 2.0 * q) : 0.0;
}

}  // namespace froude::kernel
