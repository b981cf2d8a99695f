#include "scene/curve.h"

#include <algorithm>
#include <cmath>

namespace froude::scene {

Curve Curve::line(const Vec2& a, const Vec2& b) {
  Curve curve;
  curve.start_ = a;
  curve.stop_ = b;
  curve.c_[0] = a;
  curve.c_[1] = b - a;
  curve.c_[2] = curve.c_[3] = Vec2::Zero();
  return curve;
}

Curve Curve::quadratic(const Vec2& a, const Vec2& control, const Vec2& b) {
  Curve curve = line(a, b);
  curve.kind_ = Kind::Cubic;
  curve.c_[1] = 2.0 * (control - a);
  curve.c_[2] = (a - control) + (b - control);
  return curve;
}

Curve Curve::cubic(const Vec2& a, const Vec2& controlA, const Vec2& controlB, const Vec2& b) {
  Curve curve = line(a, b);
  curve.kind_ = Kind::Cubic;
  curve.c_[1] = 3.0 * (controlA - a);
  curve.c_[2] = 3.0 * ((a - controlA) + (controlB - controlA));
  curve.c_[3] = (b - a) + 3.0 * (controlA - controlB);
  return curve;
}

Curve Curve::ellipse(const Vec2& center, const Vec2& u, const Vec2& v, double from, double to, const Vec2& start,
                     const Vec2& end) {
  Curve curve = line(start, end);
  curve.kind_ = Kind::Ellipse;
  curve.center_ = center;
  curve.u_ = u;
  curve.v_ = v;
  curve.from_ = from;
  curve.to_ = to;
  return curve;
}

bool Curve::isCircular() const {
  const double size = u_.squaredNorm();
  return kind_ == Kind::Ellipse && std::abs(u_.dot(v_)) <= 1e-12 * size &&
         std::abs(v_.squaredNorm() - size) <= 1e-12 * size;
}

Vec2 Curve::at(double t) const {
  if (t == from_) return start_;
  if (t == to_) return stop_;
  if (kind_ == Kind::Ellipse) return center_ + std::cos(t) * u_ + std::sin(t) * v_;
  return c_[0] + t * (c_[1] + t * (c_[2] + t * c_[3]));
}

std::pair<double, double> Curve::extremes(const Vec2& n, double a, double b) const {
  const double base = n.dot(at(a));
  const double end = n.dot(at(b)) - base;
  double low = std::min(0.0, end), high = std::max(0.0, end);
  const auto look = [&](double t) {
    if (!(t > std::min(a, b) && t < std::max(a, b))) return;
    const double value = n.dot(at(t)) - base;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  if (kind_ == Kind::Ellipse) {
    const double first = std::atan2(n.dot(v_), n.dot(u_));
    const double before = first + kPi * std::floor((std::min(a, b) - first) / kPi);
    for (double t = before; t < std::max(a, b); t += kPi) look(t);
  } else if (kind_ == Kind::Cubic) {
    // n·P'(t) = p + q t + r t², by the form of the roots that does not cancel.
    const double p = n.dot(c_[1]), q = 2.0 * n.dot(c_[2]), r = 3.0 * n.dot(c_[3]);
    const double discriminant = q * q - 4.0 * p * r;
    if (discriminant >= 0.0) {
      const double s = -0.5 * (q + std::copysign(std::sqrt(discriminant), q));
      if (r != 0.0) look(s / r);
      if (s != 0.0) look(p / s);
    }
  }
  return {low, high};
}

Box Curve::bounds() const {
  const auto [left, right] = extremes({1.0, 0.0}, from_, to_);
  const auto [bottom, top] = extremes({0.0, 1.0}, from_, to_);
  return {start_ + Vec2(left, bottom), start_ + Vec2(right, top)};
}

double Curve::deviation(double a, double b) const {
  const Vec2 chord = at(b) - at(a);
  const double length = chord.norm();
  const Vec2 along = length > 0.0 ? Vec2(chord / length) : Vec2(1.0, 0.0);
  const auto [right, left] = extremes(leftNormal(along), a, b);
  const auto [back, front] = extremes(along, a, b);
  const double beside = std::max(-right, left);
  const double beyond = std::max({0.0, -back, front - length});
  return std::hypot(beside, beyond);
}

namespace {

/// The end of the longest piece from `t` that keeps the tolerance, found by halving; 0 pieces shorter than `least`.
double reach(const Curve& curve, double t, double tolerance, double least, double* step) {
  const double end = curve.end(), sign = end > t ? 1.0 : -1.0;
  const double rest = std::abs(end - t);
  if (curve.deviation(t, end) <= tolerance) return end;
  double good = 0.0, bad = std::min(rest, 2.0 * *step);
  while (bad < rest && curve.deviation(t, t + sign * bad) <= tolerance) {
    good = bad;
    bad = std::min(rest, 2.0 * bad);
  }
  for (int i = 0; i < 60 && (good == 0.0 || bad - good > 1e-3 * bad) && bad > least; ++i) {
    const double middle = 0.5 * (good + bad);
    (curve.deviation(t, t + sign * middle) <= tolerance ? good : bad) = middle;
  }
  if (good < least) throw TooManyPieces("a curve needs too many pieces");
  *step = good;
  return t + sign * good;
}

/// The parameters at which the pieces end; empty where it takes more than `limit`.
std::vector<double> pieces(const Curve& curve, double tolerance, std::size_t limit) {
  std::vector<double> ends;
  const double all = std::abs(curve.end() - curve.begin());
  double t = curve.begin(), step = all / 16.0;
  while (t != curve.end()) {
    if (ends.size() == limit) return {};
    t = reach(curve, t, tolerance, 1e-9 * all, &step);
    ends.push_back(t);
  }
  return ends;
}

}  // namespace

void flatten(const Curve& curve, double tolerance, std::size_t limit, std::vector<Vec2>* out) {
  if (curve.isLine()) {
    out->push_back(curve.stop());
    return;
  }
  std::vector<double> ends;
  if (curve.isCircular()) {
    // A chord over the angle θ is r (1 − cos θ/2) from its arc.
    const double half = std::asin(std::sqrt(std::min(1.0, 0.5 * tolerance / curve.radius())));
    const double angle = std::abs(curve.end() - curve.begin());
    const double count = std::max(std::ceil(angle / (4.0 * half)), angle > kPi ? 3.0 : 1.0);
    if (!(count <= static_cast<double>(limit))) throw TooManyPieces("a circle needs too many pieces");
    for (double i = 1.0; i < count; i += 1.0)
      ends.push_back(curve.begin() + (curve.end() - curve.begin()) * (i / count));
    ends.push_back(curve.end());
  } else {
    ends = pieces(curve, tolerance, limit);
    if (ends.empty()) throw TooManyPieces("a curve needs too many pieces");
    double even = 1.0, uneven = 0.0;
    for (int i = 0; i < 10; ++i) {
      const double middle = 0.5 * (even + uneven);
      std::vector<double> other = pieces(curve, middle * tolerance, ends.size());
      (other.empty() ? uneven : even) = middle;
      if (!other.empty()) ends = std::move(other);
    }
  }
  for (const double t : ends) out->push_back(curve.at(t));
}

}  // namespace froude::scene
