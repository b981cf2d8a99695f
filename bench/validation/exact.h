// Exact flows: what the cases are compared with. SI units; each with its source.
#pragma once

#include <vector>

#include <froude/base/types.h>

namespace froude::validation {

/// Start-up of plane Poiseuille flow between walls at y = 0 and L, from rest, by an acceleration F along x:
/// Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214-226, eq. 28. [m/s]
double poiseuilleStart(double y, double t, double L, double viscosity, double F);

/// Start-up of plane Couette flow, the wall at y = L moving with V along x: same paper, eq. 29. [m/s]
double couetteStart(double y, double t, double L, double viscosity, double V);

/// Steady flow between coaxial cylinders, inner radius r1 turning at ω, outer radius r2 at rest: v = a r + b/r [m/s].
double couetteRing(double r, double r1, double r2, double omega);

/// Taylor & Green (1937) on the periodic unit square with U = 1 m/s:
/// u = −f cos 2πx sin 2πy, v = f sin 2πx cos 2πy, f = exp(−8π²νt).
Vec2 taylorGreen(const Vec2& x, double t, double viscosity);
/// The same vortices moved by a quarter period, so that [0, ½]² holds one, and its sides are streamlines without shear:
/// u = f sin 2πx cos 2πy, v = −f cos 2πx sin 2πy.
Vec2 taylorGreenBox(const Vec2& x, double t, double viscosity);

/// Period of the small standing wave with one wave length L over the depth D [m], g [m/s²]: 2π/ω with ω² = g k tanh kD,
/// k = 2π/L (H. Lamb, "Hydrodynamics", 6th ed., 1932, § 228). Its amplitude fades as exp(−2νk² t) (§ 348). [s]
double standingWavePeriod(double L, double D, double g);

/// An elliptic drop of ideal fluid, free all round, under the acceleration −B² x: its motion is affine, x = F ξ with F
/// = diag(a, 1/a) for a circle of radius 1 and the initial velocity A0 (x, −y).
struct Drop {
  double a = 1.0;   // semi-axis along x [m]; 1/a along y
  double da = 0.0;  // [m/s]
};
/// Both drops of the cases: Monaghan, J. Comput. Phys. 110 (1994) 399-406 (B = 0), and Antuono et al., Comput. Methods
/// Appl. Mech. Eng. 289 (2015) 209-226 (B > 0). Of F'' = λ F⁻ᵀ − B² F with det F = 1, by fourth-order Runge-Kutta steps
/// of at most dt [s].
Drop dropAt(double t, double A0, double B, double dt);
/// Kinetic energy over density [m⁴/s²]: π (a'² + (1/a)'²)/8.
double kinetic(const Drop& drop);
/// First time t > 0 when the semi-axis along x comes back to 1 from below, B > 0 [s].
double dropPeriod(double A0, double B, double dt);

}  // namespace froude::validation
