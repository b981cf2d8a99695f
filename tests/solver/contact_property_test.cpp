// The whole narrow phase against brute force: a corpus of hard pairs and a million random ones, under random rotation,
// far offsets and scales from a millimetre to a kilometre, in both orders, from cold, warm and stale starts.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include <froude/solver/contact/contact_manifold.h>
#include <froude/solver/contact/sat.h>

#include "support/convex_pairs.h"
#include "support/pair_oracle.h"

namespace froude {
namespace {

using namespace test;

/// Collects what is wrong with one pair.
struct Complaints {
  std::ostringstream text;
  bool any = false;

  void unless(bool good, const char* what, double got = 0.0, double expected = 0.0) {
    if (good) return;
    any = true;
    text << what << ": " << got << " instead of " << expected << '\n';
  }
};

RealVec real(const Vec2& v) { return {v.x(), v.y()}; }

Real boundaryDistance(const RealVec& p, const RealRing& ring) {
  Real least = kInfinity;
  for (std::size_t k = 0; k < ring.size(); ++k)
    least = std::min(least, segmentDistance(p, ring[k], ring[(k + 1) % ring.size()]));
  return least;
}

Real featureDistance(const RealVec& p, const RealRing& ring, Feature feature) {
  const std::size_t k = featureIndex(feature);
  return isEdge(feature) ? segmentDistance(p, ring[k], ring[(k + 1) % ring.size()]) : length(p - ring[k]);
}

struct Truth {
  RealRing a, b;  // in A's frame
  OracleAxis axis;
  Real distance = 0;   // where they are apart
  Real tolerance = 0;  // of lengths: ten thousand roundings of the size, a few of the coordinates
};

Truth truthOf(const ConvexShape& a, const ConvexShape& b, const Transform& pose) {
  Truth truth{placed(a.vertices(), {}), placed(b.vertices(), pose), {}};
  truth.axis = oracleAxis(truth.a, truth.b);
  if (truth.axis.separation > 0) truth.distance = oracleDistance(truth.a, truth.b);
  Real reach = pose.position.norm();
  for (const RealVec& v : truth.a) reach = std::max(reach, length(v));
  for (const RealVec& v : truth.b) reach = std::max(reach, length(v));
  truth.tolerance = 1e-12L * (a.outerRadius() + b.outerRadius()) + 2e-15L * reach;
  return truth;
}

void checkClosest(const ConvexShape& a, const ConvexShape& b, const ClosestFeatures& c, const Truth& truth,
                  Complaints& complaints) {
  const Real tolerance = truth.tolerance;
  complaints.unless(c.steps <= 2 * static_cast<int>(a.size() + b.size() + 8), "steps", c.steps);
  complaints.unless(c.status != PairStatus::Failed, "failed");
  if (std::abs(truth.axis.separation) > tolerance) {
    complaints.unless((c.status == PairStatus::Overlapping) == (truth.axis.separation < 0), "status",
                      static_cast<double>(c.status), static_cast<double>(truth.axis.separation));
  }
  complaints.unless(std::abs(c.distance - truth.distance) <= tolerance, "distance", c.distance,
                    static_cast<double>(truth.distance));
  complaints.unless(std::abs(c.normal.norm() - 1.0) < 1e-14, "length of the normal", c.normal.norm(), 1.0);
  if (c.status == PairStatus::Overlapping || c.status == PairStatus::Failed) return;
  complaints.unless((c.onB - c.onA - c.distance * c.normal).norm() <= tolerance, "points against the normal");
  const Real offA = featureDistance(real(c.onA), truth.a, c.a), offB = featureDistance(real(c.onB), truth.b, c.b);
  complaints.unless(offA <= tolerance, "point off A's feature", static_cast<double>(offA), c.distance);
  complaints.unless(offB <= tolerance, "point off B's feature", static_cast<double>(offB), c.distance);
  // Each point in the Voronoi region of the other's feature: nothing of the other is nearer.
  complaints.unless(boundaryDistance(real(c.onA), truth.b) >= c.distance - tolerance, "A's point outside the region");
  complaints.unless(boundaryDistance(real(c.onB), truth.a) >= c.distance - tolerance, "B's point outside the region");
}

void checkAxis(const SeparatingAxis& axis, const Truth& truth, Complaints& complaints) {
  const Real tolerance = truth.tolerance;
  complaints.unless(axis.status != PairStatus::Failed, "axis failed");
  if (axis.separation > 0.0) {
    complaints.unless(truth.axis.separation >= axis.separation - tolerance, "a separation that is not", axis.separation,
                      static_cast<double>(truth.axis.separation));
    return;
  }
  complaints.unless(std::abs(axis.separation - truth.axis.separation) <= tolerance, "depth", axis.separation,
                    static_cast<double>(truth.axis.separation));
  // The translation vector, whichever of two equal ones it is, parts them.
  Real low = kInfinity, high = -kInfinity;
  for (const RealVec& v : truth.b) low = std::min(low, dot(v, real(axis.normal)));
  for (const RealVec& v : truth.a) high = std::max(high, dot(v, real(axis.normal)));
  complaints.unless(std::abs(low - high - axis.separation) <= tolerance, "translation vector");
}

void checkManifold(const ContactManifold& m, double margin, const Truth& truth, Complaints& complaints) {
  const Real tolerance = truth.tolerance;
  const Real separation = truth.axis.separation > 0 ? truth.distance : truth.axis.separation;
  if (separation > margin + tolerance) {
    complaints.unless(m.count == 0 && m.status == PairStatus::Apart, "points beyond the margin", m.count);
    return;
  }
  if (separation > margin - tolerance) return;
  complaints.unless(m.count == 1 || m.count == 2, "count", m.count, 1);
  Real least = kInfinity;
  for (std::uint32_t k = 0; k < m.count; ++k) {
    const ManifoldPoint& p = m.points[k];
    least = std::min<Real>(least, p.separation);
    complaints.unless(p.separation <= margin, "a point beyond the margin", p.separation, margin);
    if (m.status != PairStatus::Near) continue;
    const Vec2 half = 0.5 * p.separation * m.normal;
    complaints.unless(boundaryDistance(real(p.at - half), truth.a) <= 2 * tolerance, "not midway from A");
    complaints.unless(boundaryDistance(real(p.at + half), truth.b) <= 2 * tolerance, "not midway from B");
  }
  complaints.unless(least >= separation - tolerance, "deeper than deep", static_cast<double>(least),
                    static_cast<double>(separation));
  if (m.status == PairStatus::Near)
    complaints.unless(least <= separation + tolerance, "nearest point left out", static_cast<double>(least),
                      static_cast<double>(separation));
  if (m.count == 2) complaints.unless(m.points[0].id != m.points[1].id, "one name for two points");
}

/// Everything that is promised of a pair, from the start that `cache` is; leaves the warm cache there.
std::string checkPair(const ConvexShape& a, const ConvexShape& b, const Transform& pose, const Truth& truth,
                      PairCache cache) {
  Complaints complaints;
  const double margin = 0.1 * (a.outerRadius() + b.outerRadius());
  PairCache walk = cache, axes = cache, contact = cache;
  for (int pass = 0; pass < 2; ++pass) {  // the second one is warm
    checkClosest(a, b, closestFeatures(a, b, pose, walk), truth, complaints);
    checkAxis(sat(a, b, pose, axes), truth, complaints);
    checkManifold(contactManifold(a, b, pose, margin, contact), margin, truth, complaints);
  }
  return complaints.any ? complaints.text.str() : "";
}

std::string checkBothWays(const ConvexShape& a, const ConvexShape& b, const Transform& poseA, const Transform& poseB,
                          const PairCache& stale) {
  const Transform bInA = poseIn(poseA, poseB), aInB = poseIn(poseB, poseA);
  const Truth truth = truthOf(a, b, bInA), mirrored = truthOf(b, a, aInB);
  std::string found = checkPair(a, b, bInA, truth, {}) + checkPair(a, b, bInA, truth, stale) +
                      checkPair(b, a, aInB, mirrored, {}) + checkPair(b, a, aInB, mirrored, {stale.b, stale.a});
  // Where the normal is unique and well conditioned, the other order tells its opposite.
  PairCache one, two;
  const ClosestFeatures c = closestFeatures(a, b, bInA, one), d = closestFeatures(b, a, aInB, two);
  const double bound = 1e-6 * (a.outerRadius() + b.outerRadius());
  if (truth.distance > bound && (c.normal + bInA.rotation.apply(d.normal)).norm() > 1e-5)
    found += "the other order has another normal\n";
  return found;
}

struct Case {
  std::string name;
  std::vector<Vec2> a, b;
  Transform bInA;
};

std::vector<Vec2> diamond() { return {{1, 0}, {0, 1}, {-1, 0}, {0, -1}}; }

std::vector<Case> corpus() {
  std::vector<Case> cases;
  const std::vector<Vec2> square = rectangle(1, 1), plank = rectangle(3, 0.2);
  const std::vector<Vec2> needle{{0, 0}, {1, 0}, {0.5, 1e-6}};
  const double below = std::nextafter(1.0, 0.0);
  const std::vector<Vec2> nicked{{-1, -1}, {1, -1}, {1, below}, {below, 1}, {-1, 1}};
  const Rotation turned = Rotation::of(kPi);
  for (const double gap : {0.1, 1e-3, 1e-9, 1e-15, 0.0, -1e-15, -1e-9, -1e-3, -0.1}) {
    const auto add = [&](const std::string& name, std::vector<Vec2> a, std::vector<Vec2> b, const Transform& pose) {
      cases.push_back(
          {name + " with a gap of 1e-15 times " + std::to_string(1e15 * gap), std::move(a), std::move(b), pose});
    };
    add("parallel edges", square, square, {{2.0 + gap, 0.3}, {}});
    add("edges of one length", square, square, {{2.0 + gap, 0.0}, {}});
    add("a plank on a box", square, plank, {{0.4, 1.2 + gap}, {}});
    add("nearly parallel edges", square, plank, Transform::of({0.4, 1.2 + gap}, 1e-13));
    add("vertex on vertex", square, square, {{2.0 + gap, 2.0 + gap}, {}});
    add("vertex beside vertex", square, square, {{2.0 + gap, 2.0}, {}});
    add("vertex on an edge", square, diamond(), {{2.0 + gap, 0.25}, {}});
    add("diamonds tip to tip", diamond(), diamond(), {{2.0 + gap, 0.0}, {}});
    add("a nick of one rounding step", nicked, square, {{2.0 + gap, 0.5}, {}});
    add("a nick and a corner", nicked, square, {{2.0 + gap, 2.0 + gap}, {}});
    add("straight runs", straightRun(9), straightRun(7), {{0.1, -1.0 - gap}, turned});
    add("needles side by side", needle, needle, {{0.2, 1e-6 + gap}, {}});
    add("needles base to base", needle, needle, {{1.0, -gap}, turned});
    add("needles tip to tip", needle, needle, {{1.0 + gap, 0.0}, {}});
    add("a needle on a box", square, needle, Transform::of({1.0 + gap, 0.1}, 0.3));
  }
  cases.push_back({"identical", square, square, {}});
  cases.push_back({"identical needles", needle, needle, {}});
  cases.push_back({"identical runs", straightRun(9), straightRun(9), {}});
  cases.push_back({"centres coincident", square, diamond(), {}});
  cases.push_back({"square in square", square, rectangle(0.5, 0.5), {}});
  cases.push_back({"contained off the middle", square, scaled(diamond(), 0.1), {{0.7, 0.4}, {}}});
  cases.push_back({"the other way round", scaled(diamond(), 0.1), square, {{0.7, 0.4}, {}}});
  cases.push_back({"needle across a needle", needle, needle, Transform::of({0.5, -0.5}, 0.5 * kPi)});
  return cases;
}

TEST(ContactProperty, hard_pairs_in_every_place_size_and_order) {
  RandomStream random(8, 1);
  for (const Case& hard : corpus())
    for (int k = 0; k < 40; ++k) {
      // The first of each as it stands: what touches exactly, touches exactly.
      const double scale = k == 0 ? 1.0 : std::pow(10.0, random.uniform(-3.0, 3.0));
      const double far = k % 2 == 0 ? 0.0 : 1e6;
      const Transform poseA =
          k == 0 ? Transform{}
                 : Transform::of({random.uniform(-far, far), random.uniform(-far, far)}, turnAtRandom(random));
      const Rotation& r = poseA.rotation;
      const Rotation& q = hard.bInA.rotation;
      const Transform poseB{poseA.position + r.apply(scale * hard.bInA.position),
                            {r.c * q.c - r.s * q.s, r.s * q.c + r.c * q.s}};
      const PairCache stale{random.below(50), random.below(50)};
      const std::string found =
          checkBothWays(ConvexShape(scaled(hard.a, scale)), ConvexShape(scaled(hard.b, scale)), poseA, poseB, stale);
      ASSERT_EQ(found, "") << hard.name << ", place " << k << ", scale " << scale;
    }
}

TEST(ContactProperty, shapes_far_from_their_own_origin) {
  RandomStream random(8, 2);
  for (int k = 0; k < 2000; ++k) {
    const Vec2 offsetA(random.uniform(-1e6, 1e6), random.uniform(-1e6, 1e6));
    const Vec2 offsetB(random.uniform(-1e6, 1e6), random.uniform(-1e6, 1e6));
    const ConvexShape a(scaled(roundRing(random, 3 + random.below(9)), 1.0, offsetA));
    const ConvexShape b(scaled(roundRing(random, 3 + random.below(9)), 1.0, offsetB));
    const Rotation turn = Rotation::of(turnAtRandom(random));
    const Vec2 apart = random.uniform(0.0, 3.0) * unit(turnAtRandom(random));
    ASSERT_EQ(checkBothWays(a, b, {}, {offsetA + apart - turn.apply(offsetB), turn}, {}), "") << k;
  }
}

TEST(ContactProperty, a_thousand_vertices_and_two_hundred) {
  RandomStream random(8, 3);
  for (int k = 0; k < 20; ++k) {
    const ConvexShape a(roundRing(random, 1000, random.uniform(0.01, 1.0)));
    const ConvexShape b(roundRing(random, 200, random.uniform(0.01, 1.0)));
    const Transform pose = Transform::of(random.uniform(0.0, 3.0) * unit(turnAtRandom(random)), turnAtRandom(random));
    ASSERT_EQ(checkBothWays(a, b, {}, pose, {random.below(2000), random.below(400)}), "") << k;
  }
}

TEST(LongContactProperty, a_million_random_pairs_agree_with_brute_force) {
  const int pairs = std::getenv("FROUDE_LONG") != nullptr ? 10'000'000 : 1'000'000;
  RandomStream random(8, 4);
  for (int k = 0; k < pairs;) {
    const double scale = std::pow(10.0, random.uniform(-3.0, 3.0));
    const ConvexShape a(scaled(roundRing(random, 3 + random.below(6), random.uniform(0.05, 1.0)), scale));
    const ConvexShape b(scaled(roundRing(random, 3 + random.below(6), random.uniform(0.05, 1.0)), scale));
    const Transform poseA = Transform::of({random.uniform(-1e6, 1e6), random.uniform(-1e6, 1e6)}, turnAtRandom(random));
    PairCache stale{random.below(16), random.below(16)};
    for (int place = 0; place < 50; ++place, ++k) {
      const Vec2 apart = scale * random.uniform(0.0, 2.5) * unit(turnAtRandom(random));
      const Transform bInA = poseIn(poseA, Transform::of(poseA.position + apart, turnAtRandom(random)));
      const std::string found = checkPair(a, b, bInA, truthOf(a, b, bInA), stale);
      ASSERT_EQ(found, "") << k;
      stale = {random.below(16), random.below(16)};
    }
  }
}

}  // namespace
}  // namespace froude
