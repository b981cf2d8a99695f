// Lattice coordinates: positions as whole multiples of dx·2⁻²³ in 32-bit integers that wrap around.
// A difference of two of them is exact for any pair nearer than 256 spacings, however large the domain and however far
// it is from the origin; as a float it then has the full 24 bits. So pair loops run on 4 bytes a coordinate at the
// precision that float has near the origin, everywhere. (Lost against it: float from a cell's corner, which needs an
// offset for each run of candidates; plain float, which is off by 1e-3 dx at 10,000 dx from the origin; double, twice
// the bytes.)
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace froude::lattice {

/// Lattice units in a spacing.
inline constexpr double kUnitsPerSpacing = 8388608.0;  // 2²³

/// Position [spacings] to lattice units, rounded to nearest even, modulo 2³². Precondition: |position| < 2³⁹ spacings.
/// Adding 1.5·2⁵² leaves the integer in the low bits of the mantissa, up to 2⁵¹ of them, without a call.
inline std::int32_t coordinate(double spacings) {
  if (!(std::abs(spacings) < 134217728.0)) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(std::llrint(spacings * kUnitsPerSpacing)));
  }
  return static_cast<std::int32_t>(
      static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(spacings * kUnitsPerSpacing + 6755399441055744.0)));
}

/// a − b, wrapped: the true difference for neighbours.
inline std::int32_t difference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

inline std::int32_t sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

}  // namespace froude::lattice
