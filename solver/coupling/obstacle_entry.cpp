// The certificate of a path: does a piece of it enter an obstacle? Decided by exact orientation (fields/crossing.h),
// not by the sweep that found the path.
#include <froude/fields/crossing.h>
#include <froude/solver/coupling/obstacles.h>

namespace froude {
namespace {

constexpr double kChordTurn = 0.01;  // [rad] of a body between the ends of a chord in its frame
constexpr int kHalvings = 40;        // of a chord: its departure from the curve falls by four each time

// A straight piece in the world, seen from a polygon that moves.
struct SeenPiece {
  const DistanceField& field;
  const RigidMotion& motion;
  const Transform& last;  // pose at the end of the sub-step
  double dt;              // of the sub-step [s]
  double t0, t1;          // of the piece, shares of the sub-step
  Vec2 from, to;          // in the world [m]

  Vec2 start() const { return (t0 > 0.0 ? motion.at(t0 * dt) : motion.start).toLocal(from); }
  Vec2 end() const { return t1 < 1.0 ? motion.at(t1 * dt).toLocal(to) : last.toLocal(to); }
  Vec2 at(double share) const { return motion.at(share * dt).toLocal(from + (share - t0) / (t1 - t0) * (to - from)); }

  // A chord that enters counts if it goes on doing so however finely it is divided: the curve itself may not.
  bool entersBetween(double s, double e, const Vec2& p, const Vec2& q, int halvings) const {
    if (enteredEdge(field, p, q) < 0) return false;
    if (halvings == 0 || inside(q)) return true;
    const double middle = 0.5 * (s + e);
    const Vec2 m = at(middle);
    return inside(m) || entersBetween(s, middle, p, m, halvings - 1) || entersBetween(middle, e, m, q, halvings - 1);
  }

  bool inside(const Vec2& local) const { return field.lowerBound(local) <= 0.0 && field.sample(local).distance < 0.0; }

  bool enters() const {
    const Vec2 p0 = start(), p1 = end();
    const double seconds = (t1 - t0) * dt;
    // The path in the body's frame is no longer than this; about the body's origin both ends are the farthest points.
    const double way = (to - from - seconds * motion.velocity).norm() +
                       std::abs(motion.spin) * seconds * std::sqrt(std::max(p0.squaredNorm(), p1.squaredNorm()));
    if (field.lowerBound(p0) > way) return false;
    const double chords = std::max(1.0, std::ceil(std::abs(motion.spin) * seconds / kChordTurn));
    Vec2 p = p0;
    double s = t0;
    for (double k = 1.0; k <= chords; ++k) {
      const double e = k == chords ? t1 : t0 + k / chords * (t1 - t0);
      const Vec2 q = k == chords ? p1 : at(e);
      if (entersBetween(s, e, p, q, kHalvings)) return true;
      p = q;
      s = e;
    }
    return false;
  }
};

}  // namespace

Obstacles::Entry Obstacles::entry(const PathPiece& piece, const CollisionFilter& filter) const {
  Entry found;
  const double length = (piece.to - piece.from).norm();
  forEachImage(piece.from, length, [&](const Vec2& shift) {
    if (found.entered) return;
    const Vec2 from = piece.from + shift, to = piece.to + shift;
    if (const std::int32_t edge = fixed_->enteredEdge(from, to, filter); edge >= 0) {
      found = {true, fixed_->edges()[static_cast<std::size_t>(edge)].body};
      return;
    }
    if (moving_.empty()) return;
    Box box;
    box.include(from);
    box.include(to);
    const auto check = [&](const Moving& m) {
      if (found.entered || !filter.accepts(m.group, m.collidesWith) || !m.swept.overlaps(box)) return;
      // As the map of free space: the body at half of the sub-step, and how far it strays from there.
      if (m.field->lowerBound(m.middle.toLocal(from)) - m.stray > length) return;
      const SeenPiece seen{*m.field, m.motion, m.end, dt_, piece.begin, piece.end, from, to};
      const bool enters =
          piece.carrier == m.body ? enteredEdge(*m.field, seen.start(), seen.end()) >= 0 : seen.enters();
      if (enters) found = {true, m.body};
    };
    // As the sweep: what is listed near the start is all that a short piece can meet.
    if (length <= reach_) {
      for (const std::uint32_t k : movingNear(from)) check(moving_[k]);
    } else {
      for (const Moving& m : moving_) check(m);
    }
  });
  return found;
}

bool Obstacles::inside(const Vec2& x, const CollisionFilter& filter) const {
  bool found = false;
  forEachImage(x, fixed_->band(), [&](const Vec2& shift) {
    const Vec2 p = x + shift;
    // Past an open side the walls go on, but nothing meets them outside the grid.
    found =
        found || (fixed_->grid().inGrid(p) && fixed_->lowerBound(p) <= 0.0 && fixed_->sample(p, filter).distance < 0.0);
    if (found || moving_.empty()) return;
    for (const std::uint32_t k : movingNear(p)) {
      const Moving& m = moving_[k];
      if (!filter.accepts(m.group, m.collidesWith) || !m.swept.contains(p)) continue;
      found = found || m.field->sample(m.end.toLocal(p)).distance < 0.0;
    }
  });
  return found;
}

}  // namespace froude
