// Conservative advancement with a bound of second order: along the line between the closest points every vertex is
// followed with its velocity, and what turning can add is bounded by its acceleration. The step to where that bound
// meets the target never goes too far, and near the impact it halves the error's exponent, as Newton's does.
#include <froude/solver/contact/time_of_impact.h>

namespace froude {

namespace {

// A tip that passes at a hair's breadth takes some ten steps, and there may be one with every turn.
constexpr double kSteps = 100.0, kStepsPerRadian = 20.0, kMostSteps = 10000.0;
constexpr double kSlack = 0.1;  // of the target
constexpr int kSupportSteps = 16;

// How far a shape reaches against `sign` · n, as a linear function of time: the extreme over its vertices.
struct Reach {
  const ConvexShape& shape;
  const RigidMotion& motion;
  Transform pose;
  Vec2 normal, turned;  // n, and what the spin adds to it in a second, in the shape's frame; pointing to the other one
  double speed;         // of the origin along n [m/s]
  double bend;          // largest acceleration of a vertex [m/s²]
  std::uint32_t vertex = 0;

  Reach(const ConvexShape& s, const RigidMotion& m, const Transform& p, const Vec2& n, std::uint32_t hint)
      : shape(s),
        motion(m),
        pose(p),
        normal(p.rotation.applyInverse(n)),
        turned(m.spin * rightNormal(normal)),
        speed(m.velocity.dot(n)),
        bend(m.spin * m.spin * radius()),
        vertex(hint) {}

  double radius() const { return shape.centroid().norm() + shape.outerRadius(); }
  /// Position and velocity of the vertex along n, about the origin.
  double offset() const { return normal.dot(shape.vertex(vertex)); }
  double rate() const { return speed + turned.dot(shape.vertex(vertex)); }
  /// No vertex is faster along n [m/s].
  double fastest() const { return std::abs(speed) + std::abs(motion.spin) * radius(); }
  /// True if another vertex reaches farther after `time`.
  bool follow(double time) {
    const std::uint32_t old = vertex;
    vertex = shape.support(normal + time * turned, old);
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
  // Every vertex pair's bound is above the true one, so the extreme pair is followed down to where it stays the same.
  double time = span;
  for (int k = 0; k < kSupportSteps; ++k) {
    const bool movedA = a.follow(time), movedB = b.follow(time);
    if (k > 0 && !movedA && !movedB) return time;
    const double gap = std::max(between - a.offset() - b.offset() - aim, 0.0);
    time = std::min(time, fallTime(gap, -a.rate() - b.rate(), a.bend + b.bend));
  }
  return std::min(span, std::max(distance - aim, 0.0) / (a.fastest() + b.fastest()));
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
    const Transform poseA = motionA.at(time), poseB = motionB.at(time);
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
    Reach reachA(a, motionA, poseA, normal, featureIndex(closest.a));
    Reach reachB(b, motionB, poseB, -normal, featureIndex(closest.b));
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
