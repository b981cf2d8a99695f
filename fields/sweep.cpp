#include <froude/fields/sweep.h>

#include <froude/base/assert.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/sweep_static.h>

namespace froude {
namespace detail {

double skinFor(const EdgeGrid& grid, std::initializer_list<Vec2> points) {
  double scale = grid.scale();
  for (const Vec2& p : points) scale = std::max(scale, p.cwiseAbs().maxCoeff());
  return kSweepSkin * scale;
}

FieldSample startOf(const EdgeGrid& grid, const Vec2& center, double enough) {
  FieldSample start;
  start.distance = grid.lowerBound(center);
  if (!(start.distance > enough)) start.distance = grid.distance(center, &start.exact);
  return start;
}

bool startsInside(const EdgeGrid& grid, const FieldSample& atStart, const Vec2& center, const Chord& chord,
                  SweepHit* hit) {
  if (!(atStart.distance < chord.radius - chord.skin) || (!atStart.exact && atStart.distance > 0.0)) return false;
  const FieldSample sample = atStart.edge >= 0 ? atStart : grid.sampleExact(center);
  *hit = {true, 0.0, center, sample.closest, sample.normal, sample.edge, -1, true};
  return true;
}

Vec2 pushOut(const EdgeGrid& grid, const Vec2& center, double radius, double clearance) {
  const double before = grid.sample(center).distance;
  Vec2 shifted = center;
  double distance = before;
  // Off the nearest feature first; in a corner its neighbour then is the nearest.
  for (int round = 0; round < 4 && distance < radius + 0.75 * clearance; ++round) {
    const FieldSample here = grid.sample(shifted);
    shifted += (radius + clearance - here.distance) * here.normal;
    distance = grid.sample(shifted).distance;
  }
  return distance > before ? Vec2(shifted - center) : Vec2(0.0, 0.0);
}

SweepHit sweepStill(const EdgeGrid& grid, const Vec2& from, const Vec2& to, double radius, const FieldSample& atStart,
                    const SourceFilter* accepts) {
  const double skin = skinFor(grid, {from, to});
  return sweepChord(grid, {from, to, radius, skin, floorFor(radius, skin, atStart.distance)}, atStart, accepts);
}

SweepHit sweepChord(const EdgeGrid& grid, const Chord& chord, const FieldSample& atStart, const SourceFilter* accepts) {
  SweepHit hit;
  hit.center = chord.to;
  if (startsInside(grid, atStart, chord.from, chord, &hit)) return hit;
  const Vec2 path = chord.to - chord.from;
  if (atStart.distance > chord.radius + chord.skin + path.norm()) return hit;
  const ChordHit contact = firstContact(grid, chord, accepts);
  if (!contact.hit) return hit;
  const Vec2 center = chord.from + contact.time * path;
  const Vec2 normal = contactNormal(grid, contact, center);
  hit.hit = true;
  hit.time = contact.time;
  hit.center = center + pushOut(grid, center, chord.radius, chord.skin);
  hit.point = contactPoint(grid, contact, center);
  hit.normal = normal;
  hit.edge = static_cast<std::int32_t>(contact.edge);
  return hit;
}

}  // namespace detail

namespace {

using detail::Chord;
using detail::ChordHit;
using detail::EdgeGrid;

/// A curved path is accepted as touching after this many chords though it may only graze.
constexpr int kPatience = 200;
/// Turn of one chord [rad].
constexpr double kLargestTurn = 0.5;
/// Grazing discs are held off by at most this part of their radius, or of the polygon's size.
constexpr double kGrazeOfRadius = 1e-3;
constexpr double kGrazeOfSize = 1e-6;

/// The disc's path in the frame of the moving polygon, over fractions 0 … 1 of the step.
struct RelativePath {
  Transform start;
  Vec2 offset;  // of the disc from the polygon's origin, in world axes [m]
  Vec2 travel;  // its change over the step [m]
  double turn;  // of the polygon over the step [rad]

  Vec2 offsetAt(double time) const { return offset + time * travel; }
  Vec2 at(double time) const {
    const Vec2 still = start.rotation.applyInverse(offsetAt(time));
    return turn * time == 0.0 ? still : Rotation::of(turn * time).applyInverse(still);
  }
  /// Largest distance from the polygon's origin between two times: the offset is linear, so at an end.
  double arm(double begin, double end) const { return std::max(offsetAt(begin).norm(), offsetAt(end).norm()); }
  /// Bounds of the first and second derivative by the fraction.
  double speed(double largestArm) const { return travel.norm() + std::abs(turn) * largestArm; }
  double curvature(double largestArm) const { return turn * turn * largestArm + 2.0 * std::abs(turn) * travel.norm(); }
};

/// Fractions during which the path is within `radius` of the polygon's origin; first > second if never.
std::pair<double, double> windowWithin(const RelativePath& path, double radius) {
  const double a = path.travel.squaredNorm();
  const double b = path.offset.dot(path.travel);
  const double c = path.offset.squaredNorm() - radius * radius;
  if (a == 0.0) return c <= 0.0 ? std::pair(0.0, 1.0) : std::pair(1.0, 0.0);
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return {1.0, 0.0};
  const double root = std::sqrt(discriminant);
  return {std::max(0.0, (-b - root) / a), std::min(1.0, (-b + root) / a)};
}

struct CurveHit {
  ChordHit contact;
  double time;       // fraction of the step
  double clearance;  // [m] to keep beyond the radius
};

/// Follows the curved path in chords; each grows while nothing is near and shrinks where its deviation might hide a
/// contact.
class CurveSearch {
 public:
  CurveSearch(const EdgeGrid& grid, const RelativePath& path, const Chord& whole)
      : grid_(grid), path_(path), radius_(whole.radius), skin_(whole.skin), floor_(whole.floor) {
    const double size = grid.outlines().size().maxCoeff();
    graze_ = std::min(radius_ > 0.0 ? kGrazeOfRadius * radius_ : kInfinity, kGrazeOfSize * size);
  }

  CurveHit first() {
    const Vec2 farthest = grid_.outlines().min.cwiseAbs().cwiseMax(grid_.outlines().max.cwiseAbs());
    const auto [enter, leave] = windowWithin(path_, farthest.norm() + 1.01 * radius_ + 2.0 * skin_);
    double time = enter;
    double step = 1.0;
    for (int chords = 0; time < leave;) {
      if (const double skip = freeTime(time, leave); skip > 0.0) {
        time += skip;
        continue;
      }
      step = std::min({step, leave - time, kLargestTurn / std::abs(path_.turn)});
      const double curvature = path_.curvature(path_.arm(time, time + step));
      const double slack = std::min(0.125 * curvature * step * step, 0.1 * grid_.band());
      step = std::min(step, std::sqrt(8.0 * slack / curvature));
      const ChordHit contact =
          detail::firstContact(grid_, {path_.at(time), path_.at(time + step), radius_, skin_, floor_, slack});
      ++chords;
      if (!contact.hit) {
        if (slack > graze_) chords = 0;  // off by more than a graze
        time += step;
        step *= 2.0;
        continue;
      }
      const bool fine = slack <= 0.0625 * skin_ || (chords > kPatience && slack <= graze_) || step < 1e-15;
      time += contact.time * step;
      if (fine) return {contact, time, std::max(skin_, 2.0 * slack)};
      // The true contact is within about 2 · slack of where the chord stopped; finer than rounding is never needed.
      const double finest = std::sqrt(0.5 * skin_ / curvature) * 0.999;
      step = std::max(finest, std::min(0.125 * step, 8.0 * slack / path_.speed(path_.arm(time, time + step))));
    }
    return {ChordHit(), 1.0, 0.0};
  }

 private:
  /// Empty space ahead, by the clearance of the cell and the greatest speed in the polygon's frame; 0 if it is not
  /// worth it.
  double freeTime(double time, double leave) const {
    const double clearance = grid_.lowerBound(path_.at(time)) - radius_ - 2.0 * skin_;
    if (clearance < 0.25 * grid_.band()) return 0.0;
    return std::min(clearance / path_.speed(path_.arm(time, leave)), leave - time) + 1e-16;
  }

  const EdgeGrid& grid_;
  const RelativePath& path_;
  const double radius_, skin_, floor_;
  double graze_;
};

}  // namespace

Transform RigidMotion::at(double t) const {
  if (spin * t == 0.0) return {start.position + t * velocity, start.rotation};
  const Rotation turn = Rotation::of(spin * t);
  const Rotation& r = start.rotation;
  return {start.position + t * velocity, {r.c * turn.c - r.s * turn.s, r.s * turn.c + r.c * turn.s}};
}

SweepHit sweepDisc(const DistanceField& field, const Vec2& from, const Vec2& to, double radius) {
  FROUDE_ASSERT(radius >= 0.0 && radius <= field.band());
  if (!detail::finitePath(from, to)) return {};
  const EdgeGrid& grid = field.grid();
  return detail::sweepStill(grid, from, to, radius,
                            detail::startOf(grid, from, detail::freeDistance(grid, from, to, radius)), nullptr);
}

SweepHit sweepDisc(const DistanceField& field, const RigidMotion& motion, double dt, const Vec2& from, const Vec2& to,
                   double radius) {
  FROUDE_ASSERT(radius >= 0.0 && radius <= field.band());
  if (!detail::finitePath(from, to) || !motion.velocity.allFinite() || !std::isfinite(motion.spin)) return {};
  const EdgeGrid& grid = field.grid();
  const RelativePath path{motion.start, from - motion.start.position, (to - from) - dt * motion.velocity,
                          dt * motion.spin};
  const Vec2 end = motion.start.position + dt * motion.velocity;
  const double skin = detail::skinFor(grid, {from, to, motion.start.position, end});
  const Vec2 start = path.at(0.0);
  const FieldSample atStart = detail::startOf(grid, start, radius + 2.0 * skin);
  // The end matters to a polygon that does not turn; the other path is followed in chords of its own.
  const Vec2 stop = path.turn == 0.0 ? path.at(1.0) : start;
  const Chord whole{start, stop, radius, skin, detail::floorFor(radius, skin, atStart.distance)};

  SweepHit hit;
  if (path.turn == 0.0) {
    hit = detail::sweepChord(grid, whole, atStart, nullptr);
  } else if (!detail::startsInside(grid, atStart, whole.from, whole, &hit)) {
    const CurveHit curve = CurveSearch(grid, path, whole).first();
    hit.hit = curve.contact.hit;
    if (hit.hit) {
      const Vec2 center = path.at(curve.time);
      hit.time = curve.time;
      hit.normal = detail::contactNormal(grid, curve.contact, center);
      hit.point = detail::contactPoint(grid, curve.contact, center);
      hit.center = center + detail::pushOut(grid, center, radius, curve.clearance);
      hit.edge = static_cast<std::int32_t>(curve.contact.edge);
    }
  }
  if (!hit.hit) {
    hit.center = to;
    return hit;
  }
  const Transform pose = motion.at(hit.time * dt);
  // The path itself is not sent through the frames and back; only a push is, which is tiny.
  const Vec2 center = from + hit.time * (to - from);
  hit.center = center + pose.rotation.apply(hit.center - path.at(hit.time));
  hit.point = pose.toWorld(hit.point);
  hit.normal = pose.rotation.apply(hit.normal);
  return hit;
}

}  // namespace froude
