#include "validation/exact.h"

#include <algorithm>
#include <cmath>

namespace froude::validation {
namespace {

// Terms of the series that are left out are below exp(−(100 π)² νt/L²) / 100³, or nothing for any t worth reading.
constexpr int kTerms = 100;

/// a'' of the affine drop. From F = diag(a, 1/a), F'' = λ F⁻ᵀ − B² F: a'' = λ/a − B² a, and det F = 1 gives
/// λ = (tr((F⁻¹F')²) + 2B²)/tr(F⁻¹F⁻ᵀ) = (2 (a'/a)² + 2B²)/(a⁻² + a²).
double acceleration(double a, double da, double B) {
  const double lambda = (2.0 * (da / a) * (da / a) + 2.0 * B * B) / (1.0 / (a * a) + a * a);
  return lambda / a - B * B * a;
}

Drop rungeKutta(const Drop& d, double B, double h) {
  const double v1 = d.da, k1 = acceleration(d.a, d.da, B);
  const double v2 = d.da + 0.5 * h * k1, k2 = acceleration(d.a + 0.5 * h * v1, v2, B);
  const double v3 = d.da + 0.5 * h * k2, k3 = acceleration(d.a + 0.5 * h * v2, v3, B);
  const double v4 = d.da + h * k3, k4 = acceleration(d.a + h * v3, v4, B);
  return {d.a + h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4), d.da + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)};
}

}  // namespace

double poiseuilleStart(double y, double t, double L, double viscosity, double F) {
  double u = F / (2.0 * viscosity) * y * (L - y);
  for (int n = 0; n < kTerms; ++n) {
    const double k = kPi * (2 * n + 1) / L;
    u -= 4.0 * F / (viscosity * L * k * k * k) * std::sin(k * y) * std::exp(-viscosity * k * k * t);
  }
  return u;
}

double couetteStart(double y, double t, double L, double viscosity, double V) {
  double u = V * y / L;
  for (int n = 1; n < kTerms; ++n) {
    const double k = kPi * n / L;
    u += (n % 2 == 0 ? 2.0 : -2.0) * V / (n * kPi) * std::sin(k * y) * std::exp(-viscosity * k * k * t);
  }
  return u;
}

double couetteRing(double r, double r1, double r2, double omega) {
  const double a = -omega * r1 * r1 / (r2 * r2 - r1 * r1);
  return a * r - a * r2 * r2 / r;
}

Vec2 taylorGreen(const Vec2& x, double t, double viscosity) {
  const double f = std::exp(-8.0 * kPi * kPi * viscosity * t), kx = 2.0 * kPi * x.x(), ky = 2.0 * kPi * x.y();
  return {-f * std::cos(kx) * std::sin(ky), f * std::sin(kx) * std::cos(ky)};
}

Vec2 taylorGreenBox(const Vec2& x, double t, double viscosity) {
  return taylorGreen(x - Vec2(0.25, 0.25), t, viscosity);
}

double standingWavePeriod(double L, double D, double g) {
  const double k = 2.0 * kPi / L;
  return 2.0 * kPi / std::sqrt(g * k * std::tanh(k * D));
}

Drop dropAt(double t, double A0, double B, double dt) {
  Drop drop{1.0, A0};
  const double steps = std::max(1.0, std::ceil(t / dt));
  for (int i = 0; i < static_cast<int>(steps); ++i) drop = rungeKutta(drop, B, t / steps);
  return drop;
}

double kinetic(const Drop& drop) {
  const double db = -drop.da / (drop.a * drop.a);
  return kPi / 8.0 * (drop.da * drop.da + db * db);
}

double dropPeriod(double A0, double B, double dt) {
  Drop drop{1.0, A0};
  for (double t = 0.0;; t += dt) {
    const Drop next = rungeKutta(drop, B, dt);
    if (drop.a < 1.0 && next.a >= 1.0) return t + dt * (1.0 - drop.a) / (next.a - drop.a);
    drop = next;
  }
}

}  // namespace froude::validation
