// Geometric decisions that are exact for doubles: on which side of a line does a point lie?
#pragma once

#include <froude/base/api.h>
#include <froude/base/types.h>

namespace froude {

namespace detail {
/// The slow, exact branch of `orientation`.
FROUDE_API int orientationExact(const Vec2& a, const Vec2& b, const Vec2& c);
}  // namespace detail

/// +1 if c lies to the left of the directed line a → b, −1 if to the right, 0 if exactly on it. Exact for all doubles
/// whose products neither overflow nor underflow (magnitudes 1e-140 … 1e140, or zero). Cost: a few flops; the exact
/// branch is taken only within rounding of zero. Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic
/// and fast robust geometric predicates", Discrete & Computational Geometry 18, 1997 (filter A; the rest is one full
/// expansion).
inline int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  constexpr double kFilter = 3.3306690738754716e-16;  // (3 + 16ε)ε with ε = 2⁻⁵³
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double determinant = left - right;
  if (std::abs(determinant) > kFilter * (std::abs(left) + std::abs(right))) return determinant > 0.0 ? 1 : -1;
  return detail::orientationExact(a, b, c);
}

/// True if p lies exactly on the closed segment a b.
FROUDE_API bool onSegment(const Vec2& a, const Vec2& b, const Vec2& p);

/// How two closed segments meet: not at all, in a single point that is inside both, or otherwise (an end point on the
/// other segment, or a shared piece). Exact.
enum class SegmentContact { None, Crossing, Touching };
FROUDE_API SegmentContact segmentContact(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

}  // namespace froude
