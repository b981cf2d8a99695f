// A viscous fluid between two plates that it sticks to, 20 spacings apart, and how it starts from rest.
#pragma once

#include "support/worlds.h"

namespace froude::testing {

inline constexpr double kChannelSpacing = 0.05, kChannelViscosity = 0.1;  // m, m²/s; the plates are 1 m apart

/// Plates at y = 0 and `top` [m], periodic along x with 1 m, without gravity.
inline WorldDef channel(const std::string& method, double top = 1.0) {
  WorldDef def = fluidWorld({{0.0, 0.0}, {1.0, top}}, kChannelSpacing);
  def.fluid->model = method;
  def.fluid->viscosity = kChannelViscosity;
  def.domain.periodicX = true;
  def.domain.closed = {false, false, true, true};
  def.domain.slip = Slip::NoSlip;
  def.gravity = {0.0, 0.0};
  return def;
}

/// Largest difference of the particles' velocity along the channel to `exact`(y).
template <typename Exact>
double largestError(const World& world, Exact&& exact) {
  const ParticlePool& pool = *world.fluid();
  double most = 0.0;
  for (std::size_t i = 0; i < pool.size(); ++i) most = std::max(most, std::abs(pool.vx()[i] - exact(pool.y()[i])));
  return most;
}

/// Start-up from rest between plates 1 m apart, by a force [m/s²] or a plate's speed [m/s]: series of Morris, Fox and
/// Zhu, J. Comput. Phys. 136 (1997), eq. 28 and 29.
inline double poiseuille(double y, double t, double force) {
  double u = force / (2.0 * kChannelViscosity) * y * (1.0 - y);
  for (int n = 1; n < 400; n += 2) {
    const double k = kPi * n;
    u -= 4.0 * force / (kChannelViscosity * k * k * k) * std::sin(k * y) * std::exp(-kChannelViscosity * k * k * t);
  }
  return u;
}

inline double couette(double y, double t, double speed) {
  double u = speed * y;
  for (int n = 1; n < 200; ++n) {
    const double k = kPi * n;
    u += 2.0 * speed / k * (n % 2 == 0 ? 1.0 : -1.0) * std::sin(k * y) * std::exp(-kChannelViscosity * k * k * t);
  }
  return u;
}

}  // namespace froude::testing
