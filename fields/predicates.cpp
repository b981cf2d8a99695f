#include <froude/fields/predicates.h>

#include <array>

namespace froude {
namespace {

/// A sum of doubles that do not overlap, smallest first: the exact value of an expression. Twelve terms are enough for
/// the six products of an orientation.
class Expansion {
 public:
  void addProduct(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }

  int sign() const {
    const double top = size_ == 0 ? 0.0 : terms_[size_ - 1];
    return (top > 0.0) - (top < 0.0);
  }

 private:
  /// Grow-expansion with elimination of zeros (Shewchuk 1997, figure 6).
  void add(double value) {
    std::size_t kept = 0;
    double sum = value;
    for (std::size_t i = 0; i < size_; ++i) {
      const double total = sum + terms_[i];
      const double part = total - sum;
      const double error = (sum - (total - part)) + (terms_[i] - part);
      if (error != 0.0) terms_[kept++] = error;
      sum = total;
    }
    if (sum != 0.0) terms_[kept++] = sum;
    size_ = kept;
  }

  std::array<double, 12> terms_{};
  std::size_t size_ = 0;
};

}  // namespace

int detail::orientationExact(const Vec2& a, const Vec2& b, const Vec2& c) {
  Expansion determinant;  // of rows (a, 1), (b, 1), (c, 1), from the input coordinates, since differences would round
  determinant.addProduct(a.x(), b.y());
  determinant.addProduct(-a.y(), b.x());
  determinant.addProduct(b.x(), c.y());
  determinant.addProduct(-b.y(), c.x());
  determinant.addProduct(c.x(), a.y());
  determinant.addProduct(-c.y(), a.x());
  return determinant.sign();
}

bool onSegment(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) && p.y() >= std::min(a.y(), b.y()) &&
         p.y() <= std::max(a.y(), b.y()) && orientation(a, b, p) == 0;
}

SegmentContact segmentContact(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) < std::min(a.y(), b.y())) {
    return SegmentContact::None;
  }
  const int c1 = orientation(a, b, c);
  const int d1 = orientation(a, b, d);
  const int a2 = orientation(c, d, a);
  const int b2 = orientation(c, d, b);
  if (c1 * d1 > 0 || a2 * b2 > 0) return SegmentContact::None;
  if (c1 * d1 < 0 && a2 * b2 < 0) return SegmentContact::Crossing;
  const bool touching = onSegment(a, b, c) || onSegment(a, b, d) || onSegment(c, d, a) || onSegment(c, d, b);
  return touching ? SegmentContact::Touching : SegmentContact::None;
}

}  // namespace froude
