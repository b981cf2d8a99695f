#include <froude/solver/queries.h>

#include <array>

namespace froude {
namespace {

double squaredDistance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (a + share * along - p).squaredNorm();
}

// Do two closed segments share a point?
bool cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  auto side = [](const Vec2& p, const Vec2& q, const Vec2& r) { return froude::cross(Vec2(q - p), Vec2(r - p)); };
  auto within = [](const Vec2& p, const Vec2& q, const Vec2& r) {
    Box box;
    box.include(p);
    box.include(q);
    return box.contains(r);
  };
  const double c1 = side(a, b, c), d1 = side(a, b, d), a1 = side(c, d, a), b1 = side(c, d, b);
  if (((c1 > 0.0) != (d1 > 0.0)) && ((a1 > 0.0) != (b1 > 0.0)) && c1 != 0.0 && d1 != 0.0 && a1 != 0.0 && b1 != 0.0) {
    return true;
  }
  return (c1 == 0.0 && within(a, b, c)) || (d1 == 0.0 && within(a, b, d)) || (a1 == 0.0 && within(c, d, a)) ||
         (b1 == 0.0 && within(c, d, b));
}

bool meetsDisc(const Polygon& polygon, const Vec2& center, double radius) {
  if (polygon.contains(center)) return true;
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    if (squaredDistance(center, polygon.edgeStart(e), polygon.edgeEnd(e)) <= radius * radius) return true;
  }
  return false;
}

bool edgesCross(const Polygon& polygon, const Vec2& a, const Vec2& b) {
  for (std::uint32_t e = 0; e < polygon.edgeCount(); ++e) {
    if (cross(polygon.edgeStart(e), polygon.edgeEnd(e), a, b)) return true;
  }
  return false;
}

}  // namespace

Box Area::bounds() const {
  if (const Box* box = std::get_if<Box>(&shape_)) return *box;
  if (const Disc* disc = std::get_if<Disc>(&shape_)) return Box{disc->center, disc->center}.grown(disc->radius);
  return std::get<const Polygon*>(shape_)->bounds();
}

bool Area::contains(const Vec2& point) const {
  if (const Box* box = std::get_if<Box>(&shape_)) return box->contains(point);
  if (const Disc* disc = std::get_if<Disc>(&shape_)) {
    return (point - disc->center).squaredNorm() <= disc->radius * disc->radius;
  }
  return std::get<const Polygon*>(shape_)->contains(point);
}

bool Area::meets(const Polygon& polygon, const Transform& transform) const {
  const Polygon placed = polygon.transformed(transform);
  const Box box = bounds();
  if (!placed.bounds().overlaps(box)) return false;
  if (const Disc* disc = std::get_if<Disc>(&shape_)) return meetsDisc(placed, disc->center, disc->radius);
  // One lies in the other, or their boundaries cross.
  if (contains(placed.vertices()[0])) return true;
  if (const Polygon* const* other = std::get_if<const Polygon*>(&shape_)) {
    const Polygon& area = **other;
    if (placed.contains(area.vertices()[0])) return true;
    for (std::uint32_t e = 0; e < area.edgeCount(); ++e) {
      if (edgesCross(placed, area.edgeStart(e), area.edgeEnd(e))) return true;
    }
    return false;
  }
  const std::array<Vec2, 4> corners{box.min, Vec2(box.max.x(), box.min.y()), box.max, Vec2(box.min.x(), box.max.y())};
  if (placed.contains(corners[0])) return true;
  for (std::size_t k = 0; k < 4; ++k) {
    if (edgesCross(placed, corners[k], corners[(k + 1) % 4])) return true;
  }
  return false;
}

}  // namespace froude
