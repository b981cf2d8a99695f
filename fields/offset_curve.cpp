#include <froude/fields/offset_curve.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace froude {
namespace {

constexpr double kTurn = 2.0 * kPi;

struct Interval {
  double low, high;
};

/// Numbers between which a candidate is wholly nearer or wholly farther than the offset from one edge.
struct Cuts {
  std::array<double, 12> at{};
  std::size_t count = 0;
  void add(double t) { at[count++] = t; }
};

Vec2 atAngle(const Vec2& center, double radius, double angle) {
  return center + radius * Vec2(std::cos(angle), std::sin(angle));
}

/// The part of an offset curve that one feature would give alone: parameters 0 … length along it, in metres for
/// straight pieces and radians for arcs.
struct Candidate {
  FeatureKind feature;
  std::uint32_t edge;
  Vec2 start;            // straight: where it starts; arc: the vertex
  Vec2 direction{0, 0};  // straight
  double radius = 0.0;   // arc
  double startAngle = 0.0, sign = 1.0, length = 0.0;

  Vec2 point(double t) const {
    return feature == FeatureKind::Edge ? Vec2(start + t * direction) : atAngle(start, radius, startAngle + sign * t);
  }
};

class Builder {
 public:
  Builder(const Polygon& polygon, double offset) : polygon_(polygon), offset_(offset), reach_(std::abs(offset)) {
    double largest = reach_;
    for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i) {
      Box box;
      box.include(polygon.edgeStart(i));
      box.include(polygon.edgeEnd(i));
      boxes_.push_back(box);
      normals_.push_back(rightNormal((polygon.edgeEnd(i) - polygon.edgeStart(i)).normalized()));
      largest = std::max(largest, polygon.edgeStart(i).cwiseAbs().maxCoeff());
    }
    rounding_ = 4e-15 * largest;
  }

  std::vector<OffsetPiece> build() {
    for (std::uint32_t i = 0; i < polygon_.edgeCount(); ++i) {
      if (offset_ != 0.0 && polygon_.convexAt(i) == (offset_ > 0.0)) addCandidate(arcAt(i));
      addCandidate(parallelTo(i));
    }
    return std::move(pieces_);
  }

 private:
  Candidate parallelTo(std::uint32_t i) const {
    const Vec2 along = polygon_.edgeEnd(i) - polygon_.edgeStart(i);
    Candidate c{FeatureKind::Edge, i, polygon_.edgeStart(i) + offset_ * normals_[i]};
    c.length = along.norm();
    c.direction = along / c.length;
    return c;
  }

  /// From the normal of the edge before the vertex to that of the edge behind it.
  Candidate arcAt(std::uint32_t i) const {
    const Vec2 before = normals_[polygon_.previous(i)], behind = normals_[i];
    Candidate c{FeatureKind::StartVertex, i, polygon_.edgeStart(i)};
    c.radius = reach_;
    const Vec2 first = offset_ > 0.0 ? before : Vec2(-before);
    c.startAngle = std::atan2(first.y(), first.x());
    c.sign = offset_ > 0.0 ? 1.0 : -1.0;
    c.length = std::abs(std::atan2(cross(before, behind), before.dot(behind)));
    return c;
  }

  void addCandidate(const Candidate& c) {
    Box box;
    if (c.feature == FeatureKind::Edge) {
      box.include(c.start);
      box.include(c.point(c.length));
    } else {
      box.include(c.start);
      box = box.grown(c.radius);
    }
    box = box.grown(reach_);
    nearer_.clear();
    for (std::uint32_t e = 0; e < polygon_.edgeCount(); ++e) {
      const bool own = e == c.edge || (c.feature == FeatureKind::StartVertex && e == polygon_.previous(c.edge));
      if (!own && reach_ > 0.0 && boxes_[e].overlaps(box)) cut(c, e);
    }
    std::sort(nearer_.begin(), nearer_.end(), [](const Interval& a, const Interval& b) { return a.low < b.low; });
    double from = 0.0;
    for (const Interval& gone : nearer_) {
      keep(c, from, gone.low);
      from = std::max(from, gone.high);
    }
    keep(c, from, c.length);
  }

  void keep(const Candidate& c, double low, double high) {
    const double least = c.feature == FeatureKind::Edge ? rounding_ : rounding_ / c.radius;
    if (!(high - low > least)) return;
    // Across the tip of a spike the far side is as near as the own one to rounding: look on which side this is.
    if (offset_ != 0.0 && polygon_.contains(c.point(0.5 * (low + high))) != (offset_ < 0.0)) return;
    OffsetPiece piece;
    piece.feature = c.feature;
    piece.edge = c.edge;
    piece.from = c.point(low);
    piece.to = c.point(high);
    if (c.feature == FeatureKind::StartVertex) {
      piece.startAngle = c.startAngle + c.sign * low;
      piece.sweep = c.sign * (high - low);
    }
    pieces_.push_back(piece);
  }

  /// Where the candidate is nearer to edge e than the offset. What is nearer to an edge is a convex set, so along a
  /// straight piece this is one interval; along an arc it can be two.
  void cut(const Candidate& c, std::uint32_t e) {
    Cuts cuts;
    cuts.add(0.0);
    cuts.add(c.length);
    const Vec2 &a = polygon_.edgeStart(e), &b = polygon_.edgeEnd(e);
    if (c.feature == FeatureKind::Edge) {
      cutLine(c, a, normals_[e], &cuts);
      cutLineByDisc(c, a, &cuts);
      cutLineByDisc(c, b, &cuts);
    } else {
      cutArc(c, a, normals_[e], &cuts);
      cutArcByDisc(c, a, &cuts);
      cutArcByDisc(c, b, &cuts);
    }
    const auto end = std::remove_if(cuts.at.begin(), cuts.at.begin() + static_cast<std::ptrdiff_t>(cuts.count),
                                    [&](double t) { return !(t >= 0.0 && t <= c.length); });
    std::sort(cuts.at.begin(), end);
    for (auto t = cuts.at.begin(); t + 1 < end; ++t) {
      if (!(*t < *(t + 1))) continue;
      if (distance(e, c.point(0.5 * (*t + *(t + 1)))) < reach_ - rounding_) nearer_.push_back({*t, *(t + 1)});
    }
  }

  void cutLine(const Candidate& c, const Vec2& a, const Vec2& normal, Cuts* cuts) const {
    const double slope = c.direction.dot(normal), height = (c.start - a).dot(normal);
    if (slope == 0.0) return;
    cuts->add((reach_ - height) / slope);
    cuts->add((-reach_ - height) / slope);
  }

  void cutLineByDisc(const Candidate& c, const Vec2& center, Cuts* cuts) const {
    const Vec2 arm = center - c.start;
    const double along = arm.dot(c.direction), aside = cross(c.direction, arm);
    const double square = (reach_ - aside) * (reach_ + aside);
    if (square < 0.0) return;
    cuts->add(along - std::sqrt(square));
    cuts->add(along + std::sqrt(square));
  }

  void addAngle(const Candidate& c, double angle, Cuts* cuts) const {
    double t = std::fmod(c.sign * (angle - c.startAngle), kTurn);
    if (t < 0.0) t += kTurn;
    cuts->add(t);
  }

  void cutArc(const Candidate& c, const Vec2& a, const Vec2& normal, Cuts* cuts) const {
    const double toNormal = std::atan2(normal.y(), normal.x()), height = (c.start - a).dot(normal);
    for (const double level : {reach_, -reach_}) {
      const double cosine = (level - height) / c.radius;
      if (std::abs(cosine) > 1.0) continue;
      addAngle(c, toNormal + std::acos(cosine), cuts);
      addAngle(c, toNormal - std::acos(cosine), cuts);
    }
  }

  void cutArcByDisc(const Candidate& c, const Vec2& center, Cuts* cuts) const {
    const Vec2 arm = center - c.start;
    const double cosine = 0.5 * arm.norm() / c.radius;
    if (cosine > 1.0 || cosine == 0.0) return;
    const double toCenter = std::atan2(arm.y(), arm.x());
    addAngle(c, toCenter + std::acos(cosine), cuts);
    addAngle(c, toCenter - std::acos(cosine), cuts);
  }

  double distance(std::uint32_t e, const Vec2& p) const {
    const Vec2 &a = polygon_.edgeStart(e), &b = polygon_.edgeEnd(e);
    const Vec2 along = leftNormal(normals_[e]);
    const Vec2 arm = p - a;
    if (along.dot(arm) <= 0.0) return arm.norm();
    if (along.dot(p - b) >= 0.0) return (p - b).norm();
    return std::abs(normals_[e].dot(arm));
  }

  const Polygon& polygon_;
  double offset_, reach_;
  double rounding_ = 0.0;  // distances that differ by less are equal [m]
  std::vector<Box> boxes_;
  std::vector<Vec2> normals_;
  std::vector<Interval> nearer_;
  std::vector<OffsetPiece> pieces_;
};

}  // namespace

Vec2 OffsetPiece::at(double u, const Polygon& polygon, double offset) const {
  if (feature == FeatureKind::Edge) return from + u * (to - from);
  return atAngle(polygon.edgeStart(edge), std::abs(offset), startAngle + u * sweep);
}

std::vector<OffsetPiece> offsetCurve(const Polygon& polygon, double offset) {
  if (!std::isfinite(offset)) throw Error("an offset must be finite [m]");
  return Builder(polygon, offset).build();
}

}  // namespace froude
