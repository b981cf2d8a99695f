// Conservative advancement with a bound of second order: along the line between the closest points every vertex is
// followed with its velocity, and what turning can add is bounded by its acceleration. The step to where that bound
// meets the target never goes too far, and near the impact it halves the error's exponent, as Newton's does.
#include <froude/solver/contact/time_of_impact.h>

#include <froude/solver/contact/pair_frame.h>

namespace froude {

namespace {

// A tip that passes at a hair's breadth takes some ten steps, and there may be one with every turn.
constexpr double kSteps = 100.0, kStepsPerRadian = 20.0, kMostSteps = 10000.0;
constexpr double kSlack = 0.1;  // of the target
constexpr int kSupportSteps = 16;

// Sine and cosine by their series, to the last bit for turns up to 0.8 rad: most steps turn by less, and the general
// functions reduce their argument first.
Rotation rotationOf(double angle) {
  if (!(std::abs(angle) <= 0.8)) return Rotation::of(angle);
  const double q = angle * angle;
  const double s = ((1.0 / 6227020800.0 - q / 1307674368000.0) * q - 1.0 / 39916800.0) * q + 1.0 / 362880.0;
  const double c = ((1.0 / 479001600.0 - q / 87178291200.0) * q - 1.0 / 3628800.0) * q + 1.0 / 40320.0;
  return {(((c * q - 1.0 / 720.0) * q + 1.0 / 24.0) * q - 0.5) * q + 1.0,
          angle * (((s * q - 1.0 / 5040.0) * q + 1.0 / 120.0) * q - 1.0 / 6.0) * q + angle};
}

Transform poseAt(const RigidMotion& motion, double time) {
  const Rotation turn = rotationOf(motion.spin * time);
  const Rotation& r = motion.start.rotation;
  return {motion.start.position + time * motion.velocity, {r.c * turn.c - r.s * turn.s, r.s * turn.c + r.c * turn.s}};
}

// How far a shape reaches along a direction, bounded by a function of time: the extreme over its vertices of a linear
// one, and a square for what their paths bend.
struct Reach {
  const ConvexShape& shape;
  Flat normal, turned;  // the direction, and what the spin adds to it in a second, in the shape's frame
  double speed;         // of the origin along it [m/s]
  double fastest;       // of any vertex along it, without sign [m/s]
  double bend;          // [m/s²]
  std::uint32_t vertex;

  Reach(const ConvexShape& s, const RigidMotion& m, const Transform& p, const Flat& n, double span, std::uint32_t hint)
      : shape(s),
        normal(p.rotation.c * n.x + p.rotation.s * n.y, p.rotation.c * n.y - p.rotation.s * n.x),
        turned(m.spin * normal.y, -m.spin * normal.x),
        speed(dot(n, m.velocity)),
        fastest(std::abs(speed) + std::abs(m.spin) * s.reach()),
        bend(bendOf(s, std::abs(m.spin), span)),
        vertex(hint) {}

  // A vertex at (u, w), along and across the direction, is at u cos θ + w sin θ after a turn by θ. That is at most
  // u + wθ + rθ²/2 for all that are not farther from the origin than r. Where u ≥ 0 it is at most u + wθ + |w|θ³/6: its
  // path bends back. While the turn is so small that no vertex with u < 0 can come to reach farther than the disc that
  // the shape holds about its origin, only those with u ≥ 0 count.
  static double bendOf(const ConvexShape& shape, double spin, double span) {
    const double bend = spin * spin * shape.reach();
    const double turn = spin * span;
    return shape.reach() * turn <= shape.hold() ? bend * std::min(1.0, turn / 3.0) : bend;
  }

  /// Position and velocity of the vertex, about the origin.
  double offset() const { return dot(normal, shape.vertex(vertex)); }
  double rate() const { return speed + dot(turned, shape.vertex(vertex)); }
  /// True if another vertex reaches farther after `time`.
  bool follow(double time) {
    const std::uint32_t old = vertex;
    vertex = climb(shape, normal + time * turned, old);
    return vertex != old;
  }
};

// First time at which gap + rate t − bend t²/2 is 0, or infinity; gap ≥ 0, bend ≥ 0.
double fallTime(double gap, double rate, double bend) {
  // Without the difference of nearly equal numbers that the textbook's root has for a falling gap.
  const double root = std::sqrt(rate * rate + 2.0 * bend * gap);
  if (rate < 0.0) return 2.0 * gap / (root - rate);
  return bend > 0.0 ? (root + rate) / bend : kInfinity;
}

// A time within which the pair surely stays farther apart along n than `aim`, at most `span`.
double safeTime(Reach& a, Reach& b, double between, double aim, double span) {
  const double distance = between - a.offset() - b.offset();
  // Every pair of vertices has a bound above the true one: the extreme pair at its time is followed down from that of
  // the closest features to where it stays the same, which is where the true bound meets the target.
  double time = span;
  for (int k = 0; k < kSupportSteps; ++k) {
    const double gap = std::max(between - a.offset() - b.offset() - aim, 0.0);
    time = std::min(time, fallTime(gap, -a.rate() - b.rate(), a.bend + b.bend));
    const bool movedA = a.follow(time), movedB = b.follow(time);
    if (!movedA && !movedB) return time;
  }
  return std::min(span, std::max(distance - aim, 0.0) / (a.fastest + b.fastest));
}

// Does the pair come nearer within `span` than it is by more than is worth telling? By the features' own velocities.
bool isClosing(const ConvexShape& shapeA, const ConvexShape& shapeB, const ClosestFeatures& closest, const Reach& a,
               const Reach& b, double span, double worth) {
  const auto fastest = [](const ConvexShape& shape, Feature feature, Reach reach) {
    reach.vertex = featureIndex(feature);
    double rate = reach.rate();
    if (isEdge(feature)) {
      reach.vertex = shape.next(reach.vertex);
      rate = std::max(rate, reach.rate());
    }
    return rate;
  };
  return (fastest(shapeA, closest.a, a) + fastest(shapeB, closest.b, b)) * span > worth;
}

}  // namespace

TimeOfImpact timeOfImpact(const ConvexShape& a, const RigidMotion& motionA, const ConvexShape& b,
                          const RigidMotion& motionB, double duration, double target) {
  TimeOfImpact impact;
  PairCache cache;
  double time = 0.0;
  const double turn = (std::abs(motionA.spin) + std::abs(motionB.spin)) * duration;
  const int limit = static_cast<int>(std::fmin(kSteps + kStepsPerRadian * turn, kMostSteps));
  for (int step = 1; step <= limit; ++step) {
    const Transform poseA = poseAt(motionA, time), poseB = poseAt(motionB, time);
    const ClosestFeatures closest = closestFeatures(a, b, poseIn(poseA, poseB), cache);
    impact.steps = step;
    if (closest.status == PairStatus::Overlapping) {
      impact.status = time == 0.0 ? ImpactStatus::Overlapping : ImpactStatus::Failed;
      return impact;
    }
    if (closest.status == PairStatus::Failed) return impact;
    impact.time = time;
    const double span = duration - time;
    const Vec2 normal = poseA.rotation.apply(closest.normal);
    Reach reachA(a, motionA, poseA, normal, span, featureIndex(closest.a));
    Reach reachB(b, motionB, poseB, -Flat(normal), span, featureIndex(closest.b));
    double aim = target;
    if (closest.distance <= (1.0 + kSlack) * target) {
      if (isClosing(a, b, closest, reachA, reachB, span, kSlack * target))
        return impact.status = ImpactStatus::Hit, impact;
      aim = std::max(closest.distance - kSlack * target, 0.0);
    }
    const double safe = safeTime(reachA, reachB, normal.dot(poseB.position - poseA.position), aim, span);
    if (safe >= span) {
      impact.status = ImpactStatus::Separate;
      impact.time = duration;
      return impact;
    }
    // Turning against each other at rest, at the target: nothing shows that they part.
    if (!(time + safe > time)) return impact.status = ImpactStatus::Hit, impact;
    time += safe;
  }
  return impact;
}

}  // namespace froude
