// Curves of drawings and the straight pieces that stand for them: nowhere farther from the curve than a tolerance.
#pragma once

#include <vector>

#include <froude/base/error.h>
#include <froude/base/types.h>

namespace froude::scene {

/// A cubic polynomial or a piece of an ellipse, P(t) for t from `begin()` to `end()` [m].
class Curve {
 public:
  static Curve line(const Vec2& a, const Vec2& b);
  static Curve quadratic(const Vec2& a, const Vec2& control, const Vec2& b);
  static Curve cubic(const Vec2& a, const Vec2& controlA, const Vec2& controlB, const Vec2& b);
  /// center + u cos t + v sin t; u and v are conjugate half-diameters: any affine image of a circle. `start` and `end`
  /// are what the piece begins and ends with, to the bit.
  static Curve ellipse(const Vec2& center, const Vec2& u, const Vec2& v, double from, double to, const Vec2& start,
                       const Vec2& end);

  double begin() const { return from_; }
  double end() const { return to_; }
  const Vec2& start() const { return start_; }
  const Vec2& stop() const { return stop_; }
  bool isLine() const { return kind_ == Kind::Line; }
  /// A piece of a circle has the same curvature everywhere.
  bool isCircular() const;
  double radius() const { return u_.norm(); }

  Vec2 at(double t) const;
  /// The box of the whole curve, by its extremes.
  Box bounds() const;
  /// Never less than the largest distance from the curve between t = a and t = b to the chord of these two points, and
  /// equal to it where the curve does not run beyond the chord's ends. Closed form.
  double deviation(double a, double b) const;

 private:
  enum class Kind { Line, Cubic, Ellipse };
  /// Least and largest of n·(P(t) − P(a)) for t from a to b.
  std::pair<double, double> extremes(const Vec2& n, double a, double b) const;

  Kind kind_ = Kind::Line;
  Vec2 center_{0, 0}, u_{0, 0}, v_{0, 0};  // ellipse
  Vec2 c_[4];                              // cubic: c0 + c1 t + c2 t² + c3 t³
  double from_ = 0.0, to_ = 1.0;
  Vec2 start_{0, 0}, stop_{0, 0};
};

/// More pieces than allowed.
class TooManyPieces : public Error {
 public:
  using Error::Error;
};

/// Appends the ends of straight pieces that stay within `tolerance` [m] > 0 of the curve; its start is not among them.
/// As few pieces as there can be, and of like deviation: each goes as far as the tolerance lets it, then the tolerance
/// is lowered as far as that takes no further piece. A circle is divided evenly. Throws TooManyPieces beyond `limit`.
/// Cost: about 200 evaluations a piece.
void flatten(const Curve& curve, double tolerance, std::size_t limit, std::vector<Vec2>* out);

}  // namespace froude::scene
