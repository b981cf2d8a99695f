#include <froude/particles/fill.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <froude/fields/polygon.h>

namespace froude {
namespace {

constexpr int kMostDraws = 10000;

// Places nearer to the boundary than this, in spacings, are on it, and so outside: rounding must not decide about rows.
constexpr double kOnBoundary = 1e-9;
// Places nearer than this to a crossing of their row are asked exactly.
constexpr double kNear = 1e-6;

bool isWellInside(const Polygon& shape, const Vec2& p, double margin) {
  for (const double sx : {-margin, margin}) {
    for (const double sy : {-margin, margin}) {
      if (!shape.contains(p + Vec2(sx, sy))) return false;
    }
  }
  return true;
}

// One row of the lattice: where the boundary crosses it, sorted, so that most places need a count instead of all edges.
class Row {
 public:
  Row(const Polygon& shape, double spacing) : shape_(shape), spacing_(spacing) {
    const Box& box = shape.bounds();
    const double largest = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).maxCoeff();
    near_ = kNear * spacing + 1e-13 * largest;
  }

  void moveTo(double y) {
    y_ = y;
    crossings_.clear();
    allExact_ = false;
    for (std::uint32_t e = 0; e < shape_.edgeCount(); ++e) {
      const Vec2& a = shape_.edgeStart(e);
      const Vec2& b = shape_.edgeEnd(e);
      if (std::abs(a.y() - y) <= near_) allExact_ = true;  // a vertex on the row, or an edge along it
      if ((a.y() > y) == (b.y() > y)) continue;
      crossings_.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
    std::sort(crossings_.begin(), crossings_.end());
  }

  bool contains(double x) const {
    const auto next = std::lower_bound(crossings_.begin(), crossings_.end(), x);
    const bool near =
        (next != crossings_.end() && *next - x <= near_) || (next != crossings_.begin() && x - *(next - 1) <= near_);
    if (near || allExact_) return isWellInside(shape_, {x, y_}, kOnBoundary * spacing_);
    return (next - crossings_.begin()) % 2 != 0;
  }

 private:
  const Polygon& shape_;
  double spacing_, near_, y_ = 0.0;
  std::vector<double> crossings_;
  bool allExact_ = false;
};

constexpr auto kNeverBlocked = [](const Vec2&) { return false; };

}  // namespace

FillResult fillLattice(const Polygon& shape, double spacing, FunctionRef<bool(const Vec2&)> isBlocked,
                       std::size_t limit) {
  if (!(spacing > 0.0) || !std::isfinite(spacing)) {
    throw FillError("filling: a spacing of " + std::to_string(spacing) + " m is not a positive number");
  }
  const Box& box = shape.bounds();
  const Vec2 places = (box.size() / spacing).array() + 0.5;
  if (std::floor(places.x()) * std::floor(places.y()) > static_cast<double>(limit)) {
    throw FillError("filling: a box of " + std::to_string(box.size().x()) + " × " + std::to_string(box.size().y()) +
                    " m at a spacing of " + std::to_string(spacing) + " m has more than " + std::to_string(limit) +
                    " places; make the shape smaller or the spacing larger");
  }
  const auto columns = static_cast<std::size_t>(places.x());
  const auto rows = static_cast<std::size_t>(places.y());
  FillResult result;
  Row row(shape, spacing);
  for (std::size_t j = 0; j < rows; ++j) {
    const double y = box.min.y() + (static_cast<double>(j) + 0.5) * spacing;
    row.moveTo(y);
    for (std::size_t i = 0; i < columns; ++i) {
      const Vec2 p{box.min.x() + (static_cast<double>(i) + 0.5) * spacing, y};
      if (!row.contains(p.x())) continue;
      if (isBlocked(p)) {
        ++result.cut;
      } else {
        result.points.push_back(p);
      }
    }
  }
  return result;
}

FillResult fillLattice(const Polygon& shape, double spacing) { return fillLattice(shape, spacing, kNeverBlocked); }

std::vector<Vec2> fillRandom(const Polygon& shape, std::size_t count, RandomStream& random,
                             FunctionRef<bool(const Vec2&)> isBlocked) {
  const Box& box = shape.bounds();
  std::vector<Vec2> points;
  points.reserve(count);
  int draws = 0;
  while (points.size() < count) {
    const double x = random.uniform(box.min.x(), box.max.x());
    const Vec2 p{x, random.uniform(box.min.y(), box.max.y())};
    if (shape.contains(p) && !isBlocked(p)) {
      points.push_back(p);
      draws = 0;
    } else if (++draws == kMostDraws) {
      throw FillError("filling: " + std::to_string(kMostDraws) + " random places in a row were outside the shape or " +
                      "taken, after " + std::to_string(points.size()) + " of " + std::to_string(count) +
                      " points; free some of the shape or ask for fewer");
    }
  }
  return points;
}

std::vector<Vec2> fillRandom(const Polygon& shape, std::size_t count, RandomStream& random) {
  return fillRandom(shape, count, random, kNeverBlocked);
}

PlacedPoints::PlacedPoints(double clearance) : clearance_(clearance) {
  if (!(clearance > 0.0) || !std::isfinite(clearance)) {
    throw FillError("filling: a clearance of " + std::to_string(clearance) + " m is not a positive number");
  }
}

// Neighbouring cells have neighbouring numbers, wrapped to 32 bits; cells that wrap to the same key only cost a look.
std::uint64_t PlacedPoints::key(double cx, double cy) {
  constexpr double kWrap = 4294967296.0;
  const auto wrapped = [](double c) { return static_cast<std::uint64_t>(c - kWrap * std::floor(c / kWrap)); };
  return (wrapped(cx) << 32) | wrapped(cy);
}

void PlacedPoints::add(const Vec2& point) {
  if (points_.size() >= kEnd) throw FillError("filling: more than 2^32 − 1 placed points");
  const auto number = static_cast<std::uint32_t>(points_.size());
  const auto [place, fresh] =
      last_.try_emplace(key(std::floor(point.x() / clearance_), std::floor(point.y() / clearance_)), number);
  next_.push_back(fresh ? kEnd : place->second);
  place->second = number;
  points_.push_back(point);
}

void PlacedPoints::add(std::span<const Vec2> points) {
  for (const Vec2& p : points) add(p);
}

bool PlacedPoints::isTaken(const Vec2& point) const {
  const double cx = std::floor(point.x() / clearance_), cy = std::floor(point.y() / clearance_);
  const double limit = clearance_ * clearance_;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto cell = last_.find(key(cx + dx, cy + dy));
      if (cell == last_.end()) continue;
      for (std::uint32_t k = cell->second; k != kEnd; k = next_[k]) {
        if ((points_[k] - point).squaredNorm() < limit) return true;
      }
    }
  }
  return false;
}

}  // namespace froude
