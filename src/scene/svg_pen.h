// What an element of a drawing draws, segment by segment, as curves that are placed. Internal to this folder.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "scene/curve.h"
#include "scene/svg_values.h"

namespace froude::scene {

/// x' = a x + c y + e, y' = b x + d y + f.
struct Affine {
  double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0;

  Vec2 operator()(double x, double y) const { return {a * x + c * y + e, b * x + d * y + f}; }
  Vec2 turned(double x, double y) const { return {a * x + c * y, b * x + d * y}; }
  /// The transform that first does `inner`.
  Affine after(const Affine& inner) const {
    const Vec2 x = turned(inner.a, inner.b), y = turned(inner.c, inner.d), o = (*this)(inner.e, inner.f);
    return {x.x(), x.y(), y.x(), y.y(), o.x(), o.y()};
  }
};

/// Turns segments, of which the first is a move, into subpaths of curves, placed by a transform.
class Pen {
 public:
  explicit Pen(const Affine& place) : place_(place) {}

  void add(const PathSegment& s) {
    using Kind = PathSegment::Kind;
    if (s.kind == Kind::Move) {
      subpaths_.emplace_back();
    } else if (s.kind != Kind::Close) {
      if (closed_) subpaths_.emplace_back();  // goes on without a move
      subpaths_.back().push_back(curve(s));
    }
    closed_ = s.kind == Kind::Close;
    last_ = s.to;
  }
  void move(double x, double y) { add({.kind = PathSegment::Kind::Move, .to = {x, y}}); }
  void line(double x, double y) { add({.kind = PathSegment::Kind::Line, .to = {x, y}}); }
  /// A piece of an ellipse about `center`, onwards from the current point; its ends count quarters from the x axis.
  void arc(const Vec2& center, double rx, double ry, int first, int end) {
    static const double kCos[] = {1, 0, -1, 0}, kSin[] = {0, 1, 0, -1};
    add({.kind = PathSegment::Kind::Arc,
         .to = center + Vec2(rx * kCos[end % 4], ry * kSin[end % 4]),
         .center = center,
         .rx = rx,
         .ry = ry,
         .from = 0.5 * kPi * first,
         .until = 0.5 * kPi * end});
  }

  std::vector<std::vector<Curve>> take() { return std::move(subpaths_); }
  const Vec2& last() const { return last_; }

 private:
  Vec2 placed(const Vec2& p) const { return place_(p.x(), p.y()); }
  Curve curve(const PathSegment& s) const {
    const Vec2 from = placed(last_), to = placed(s.to);
    switch (s.kind) {
      case PathSegment::Kind::Quadratic:
        return Curve::quadratic(from, placed(s.a), to);
      case PathSegment::Kind::Cubic:
        return Curve::cubic(from, placed(s.a), placed(s.b), to);
      case PathSegment::Kind::Arc: {
        const double c = std::cos(s.turn), n = std::sin(s.turn);
        return Curve::ellipse(placed(s.center), place_.turned(s.rx * c, s.rx * n), place_.turned(-s.ry * n, s.ry * c),
                              s.from, s.until, from, to);
      }
      default:
        return Curve::line(from, to);
    }
  }

  Affine place_;
  std::vector<std::vector<Curve>> subpaths_;
  Vec2 last_{0, 0};
  bool closed_ = false;
};

}  // namespace froude::scene
