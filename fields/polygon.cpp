#include <froude/fields/polygon.h>

#include <froude/fields/polygon_check.h>
#include <froude/fields/predicates.h>

namespace froude {

Polygon Polygon::make(std::vector<Vec2> outer, std::vector<std::vector<Vec2>> holes, std::vector<std::string>* notes) {
  std::vector<detail::Ring> rings;
  rings.reserve(holes.size() + 1);
  rings.push_back(std::move(outer));
  for (std::vector<Vec2>& hole : holes) rings.push_back(std::move(hole));
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const std::string name = r == 0 ? std::string("the outer ring") : "hole " + std::to_string(r - 1);
    detail::repairRing(&rings[r], r == 0, name, notes);
  }
  detail::refuseCrossings(rings);

  Polygon polygon;
  polygon.ringStarts_.push_back(0);
  for (const detail::Ring& ring : rings) {
    polygon.vertices_.insert(polygon.vertices_.end(), ring.begin(), ring.end());
    polygon.ringStarts_.push_back(static_cast<std::uint32_t>(polygon.vertices_.size()));
  }
  polygon.link();
  polygon.measure();
  constexpr double kLeast = std::numeric_limits<double>::min();
  if (!(polygon.area_ >= kLeast && polygon.secondMoment_ >= kLeast && std::isfinite(polygon.secondMoment_))) {
    throw PolygonError(PolygonError::Reason::ZeroArea,
                       "the area or its second moment is not a normal number; give coordinates in metres");
  }
  return polygon;
}

Polygon Polygon::box(const Box& box) {
  return make({box.min, {box.max.x(), box.min.y()}, box.max, {box.min.x(), box.max.y()}});
}

Polygon Polygon::regular(int sides, double radius) {
  std::vector<Vec2> ring;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * i / sides;
    ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return make(std::move(ring));
}

bool Polygon::convexAt(std::uint32_t i) const {
  return orientation(vertices_[previous_[i]], vertices_[i], vertices_[next_[i]]) > 0;
}

bool Polygon::contains(const Vec2& p) const {
  if (!bounds_.contains(p)) return false;
  bool inside = false;
  for (std::size_t r = 0; r + 1 < ringStarts_.size(); ++r) {
    const int where = detail::locate(&vertices_[ringStarts_[r]], ringStarts_[r + 1] - ringStarts_[r], p);
    if (where == 0) return true;
    if (where > 0) inside = !inside;
  }
  return inside;
}

Polygon Polygon::restored(std::vector<Vec2> vertices, std::vector<std::uint32_t> ringStarts) {
  Polygon polygon;
  polygon.vertices_ = std::move(vertices);
  polygon.ringStarts_ = std::move(ringStarts);
  polygon.link();
  polygon.measure();
  return polygon;
}

Polygon Polygon::transformed(const Transform& transform) const {
  Polygon moved = *this;
  for (Vec2& v : moved.vertices_) v = transform.toWorld(v);
  moved.measure();
  return moved;
}

void Polygon::link() {
  next_.resize(vertices_.size());
  previous_.resize(vertices_.size());
  for (std::size_t r = 0; r + 1 < ringStarts_.size(); ++r) {
    const std::uint32_t first = ringStarts_[r];
    const std::uint32_t end = ringStarts_[r + 1];
    for (std::uint32_t i = first; i < end; ++i) {
      next_[i] = i + 1 < end ? i + 1 : first;
      previous_[next_[i]] = i;
    }
  }
}

/// Green's theorem edge by edge, about the middle of the box so that nothing cancels far from the origin; in long
/// double so that many edges do not add up rounding.
void Polygon::measure() {
  bounds_ = Box();
  for (const Vec2& v : vertices_) bounds_.include(v);
  const Vec2 middle = bounds_.center();
  long double doubleArea = 0;
  long double sx = 0;
  long double sy = 0;
  long double polar = 0;
  for (std::uint32_t i = 0; i < edgeCount(); ++i) {
    const long double ax = static_cast<long double>(edgeStart(i).x()) - middle.x();
    const long double ay = static_cast<long double>(edgeStart(i).y()) - middle.y();
    const long double bx = static_cast<long double>(edgeEnd(i).x()) - middle.x();
    const long double by = static_cast<long double>(edgeEnd(i).y()) - middle.y();
    const long double c = ax * by - ay * bx;
    doubleArea += c;
    sx += c * (ax + bx);
    sy += c * (ay + by);
    polar += c * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by);
  }
  const long double area = doubleArea / 2;
  const long double cx = sx / (3 * doubleArea);
  const long double cy = sy / (3 * doubleArea);
  area_ = static_cast<double>(area);
  centroid_ = Vec2(static_cast<double>(middle.x() + cx), static_cast<double>(middle.y() + cy));
  secondMoment_ = static_cast<double>(polar / 12 - area * (cx * cx + cy * cy));
}

}  // namespace froude
