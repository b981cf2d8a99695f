// Degenerate polygons under random rotation, offset and scale: each is refused for a reason that holds, or handled
// exactly. What holds is worked out here, in integers of any length over all pairs of edges, on the coordinates as they
// were rounded: what was drawn as collinear hardly ever is any more.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <functional>
#include <set>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>

#include "support/polygon_oracle.h"

namespace froude {
namespace {

using Reason = PolygonError::Reason;
using Ring = std::vector<Vec2>;
using Rings = std::vector<Ring>;  // the outer one first
using Integer = boost::multiprecision::cpp_int;

/// x · 2¹²⁰⁰.
Integer exact(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return Integer(static_cast<std::int64_t>(std::ldexp(mantissa, 53))) << (exponent - 53 + 1200);
}

int exactSide(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Integer ax = exact(a.x()), ay = exact(a.y()), bx = exact(b.x()), by = exact(b.y());
  const Integer cx = exact(c.x()), cy = exact(c.y());
  return Integer((ax - cx) * (by - cy) - (ay - cy) * (bx - cx)).sign();
}

bool within(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) && p.y() >= std::min(a.y(), b.y()) &&
         p.y() <= std::max(a.y(), b.y()) && exactSide(a, b, p) == 0;
}

enum class Meeting { None, Touch, Cross };

Meeting meeting(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  if (within(a, b, c) || within(a, b, d) || within(c, d, a) || within(c, d, b)) return Meeting::Touch;
  const bool apart = exactSide(a, b, c) * exactSide(a, b, d) >= 0 || exactSide(c, d, a) * exactSide(c, d, b) >= 0;
  return apart ? Meeting::None : Meeting::Cross;
}

/// +1 inside, 0 on the ring, −1 outside.
int exactWhere(const Ring& ring, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if (within(a, b, p)) return 0;
    if ((a.y() > p.y()) != (b.y() > p.y()) && (exactSide(a, b, p) > 0) == (b.y() > a.y())) inside = !inside;
  }
  return inside ? 1 : -1;
}

int exactWhere(const Rings& rings, const Vec2& p) {
  int where = exactWhere(rings[0], p);
  for (std::size_t r = 1; r < rings.size() && where > 0; ++r) where = std::min(where, -exactWhere(rings[r], p));
  return where;
}

/// The ring without repeats and vertices on straight runs, or every reason to refuse it.
std::set<Reason> repaired(Ring* ring) {
  for (const Vec2& p : *ring)
    if (!p.allFinite()) return {Reason::NonFinite};
  Ring& r = *ring;
  for (std::size_t i = 0; i < r.size() && r.size() > 1;)
    if (r[i] == r[(i + 1) % r.size()])
      r.erase(r.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  if (r.size() < 3) return {Reason::TooFewVertices};
  if (std::all_of(r.begin(), r.end(), [&](const Vec2& p) { return exactSide(r[0], r[1], p) == 0; }))
    return {Reason::ZeroArea};
  for (std::size_t i = 0; i < r.size();) {
    const Vec2 &before = r[(i + r.size() - 1) % r.size()], &after = r[(i + 1) % r.size()];
    if (exactSide(before, r[i], after) != 0) {
      ++i;
    } else if (within(before, after, r[i])) {
      r.erase(r.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    } else {
      return {Reason::SelfCrossing};  // it turns back
    }
  }
  return {};
}

/// Every reason for which the rings are no polygon; repairs them.
std::set<Reason> reasons(Rings* rings) {
  std::set<Reason> found;
  for (Ring& ring : *rings) found.merge(repaired(&ring));
  if (!found.empty()) return found;
  const Rings& all = *rings;
  std::vector<bool> meets(all.size() * all.size(), false);
  for (std::size_t p = 0; p < all.size(); ++p)
    for (std::size_t q = p; q < all.size(); ++q)
      for (std::size_t i = 0; i < all[p].size(); ++i)
        for (std::size_t j = p == q ? i + 2 : 0; j < all[q].size(); ++j) {
          if (p == q && i == 0 && j + 1 == all[q].size()) continue;  // neighbours
          const Meeting how =
              meeting(all[p][i], all[p][(i + 1) % all[p].size()], all[q][j], all[q][(j + 1) % all[q].size()]);
          if (how == Meeting::None) continue;
          meets[p * all.size() + q] = true;
          if (p == q) {
            found.insert(Reason::SelfCrossing);
          } else if (how == Meeting::Touch) {
            found.insert(Reason::HoleTouching);
          } else {
            found.insert(p == 0 ? Reason::HoleOutside : Reason::HolesOverlap);
          }
        }
  for (std::size_t q = 1; q < all.size(); ++q) {
    if (!meets[q] && exactWhere(all[0], all[q][0]) < 0) found.insert(Reason::HoleOutside);
    for (std::size_t p = 1; p < q; ++p)
      if (!meets[p * all.size() + q] && (exactWhere(all[p], all[q][0]) > 0 || exactWhere(all[q], all[p][0]) > 0))
        found.insert(Reason::HolesOverlap);
  }
  return found;
}

/// Distances of an accepted polygon at points that are hard for it, against all of its edges.
void expectExactDistances(const Polygon& polygon, const Rings& rings, RandomStream& random) {
  const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
  const Box all = polygon.bounds();
  const double size = all.size().maxCoeff();
  const double unit = std::max(all.min.cwiseAbs().maxCoeff(), all.max.cwiseAbs().maxCoeff()) + 0.2 * size;
  const double rounding = 1e-15 * unit;
  const DistanceField field(polygon, std::max(0.2 * size, 1e3 * rounding));
  for (int i = 0; i < 24; ++i) {
    const std::uint32_t e = random.below(polygon.edgeCount());
    const Vec2 a = polygon.edgeStart(e), b = polygon.edgeEnd(e);
    Vec2 p = a + random.uniform() * (b - a);
    if (i % 4 == 0) p = a;
    if (i % 4 == 1) p += 0.1 * size * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    if (i % 4 == 2)
      p = a + std::pow(10.0, random.uniform(-16, -1)) * size * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    const FieldSample s = field.sampleExact(p);
    const auto away = static_cast<double>(test::boundaryDistance(edges, p));
    const int where = exactWhere(rings, p);
    ASSERT_TRUE(s.exact);
    // Where two edges are as near as rounding can tell, the one that gives the exact sign answers: 2⁻⁴⁶ of the largest
    // coordinate decides on that.
    const double error = away <= 0x1p-45 * unit ? 0x1p-45 * unit : rounding;
    ASSERT_NEAR(std::abs(s.distance), away, error);
    if (s.distance != 0.0 && where != 0) {
      const bool inside = where > 0;
      ASSERT_EQ(s.distance < 0.0, inside) << s.distance << " " << away;
    }
    ASSERT_EQ(polygon.contains(p), where >= 0);
    ASSERT_NEAR(s.normal.norm(), 1.0, 1e-14);
    ASSERT_LE(static_cast<double>(test::boundaryDistance(edges, s.closest)), error);
    if (away <= field.band()) {
      ASSERT_EQ(field.sample(p).distance, s.distance);
    }
  }
}

struct BadInput {
  std::string name;
  Rings rings;
  /// What is done to the rings once they are placed.
  std::function<void(Rings*, RandomStream&)> spoil = [](Rings*, RandomStream&) {};
  /// Whatever the rounding: refused (1), accepted (0), or as the rounding wills (−1).
  int refused = -1;
};

/// The next number, down or up; beside 0 an ulp of 1: exact decisions are promised from 1e-140 on.
double ulpTowards(double x, double target) {
  return x == 0.0 ? std::copysign(0x1p-53, target) : std::nextafter(x, target);
}
double ulpBeside(double x, RandomStream& random) { return ulpTowards(x, random.below(2) == 0 ? -1e300 : 1e300); }

/// Puts a vertex that is one ulp from a random one, beside it in the ring.
void doubleByOneUlp(Rings* rings, RandomStream& random) {
  Ring& ring = (*rings)[random.below(static_cast<std::uint32_t>(rings->size()))];
  const auto at = static_cast<std::ptrdiff_t>(random.below(static_cast<std::uint32_t>(ring.size())));
  Vec2 p = ring[static_cast<std::size_t>(at)];
  if (random.below(3) != 0) p.x() = ulpBeside(p.x(), random);
  if (random.below(3) != 0) p.y() = ulpBeside(p.y(), random);
  ring.insert(ring.begin() + at, p);
}

void repeatSome(Rings* rings, RandomStream& random) {
  for (Ring& ring : *rings)
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::ptrdiff_t>(random.below(static_cast<std::uint32_t>(ring.size())));
      ring.insert(ring.begin() + at, ring[static_cast<std::size_t>(at)]);
    }
  (*rings)[0].push_back((*rings)[0].front());
}

void poison(Rings* rings, RandomStream& random) {
  static const double kPoison[] = {std::nan(""), kInfinity, -kInfinity};
  Ring& ring = (*rings)[random.below(static_cast<std::uint32_t>(rings->size()))];
  ring[random.below(static_cast<std::uint32_t>(ring.size()))][random.below(2)] = kPoison[random.below(3)];
}

const Ring kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
const Ring kHole{{0.2, 0.2}, {0.2, 0.6}, {0.6, 0.6}, {0.6, 0.2}};

std::vector<BadInput> corpus() {
  const auto none = [](Rings*, RandomStream&) {};
  return {
      {"collinear runs", {{{0, 0}, {0.1, 0}, {0.5, 0}, {0.7, 0}, {1, 0}, {1, 0.3}, {1, 1}, {0.5, 0.5}}}, none, -1},
      {"a collinear run that is doubled by an ulp", {{{0, 0}, {0.5, 0}, {1, 0}, {1, 1}, {0, 1}}}, doubleByOneUlp, -1},
      {"vertices one ulp apart", {kSquare, kHole}, doubleByOneUlp, -1},
      {"vertices one ulp apart on a needle", {{{0, 0}, {1, 0}, {1, 1e-6}}}, doubleByOneUlp, -1},
      {"repeated vertices", {kSquare, kHole}, repeatSome, 0},
      {"two points", {{{0, 0}, {1, 0.3}, {0, 0}, {1, 0.3}}}, none, 1},
      {"one point", {{{0.3, 0.1}, {0.3, 0.1}, {0.3, 0.1}}}, none, 1},
      {"all on one line", {{{0, 0}, {1, 0.3}, {2, 0.6}}}, none, -1},
      {"to and fro on one line", {{{0, 0}, {3, 1}, {1, 1. / 3}, {2, 2. / 3}}}, none, -1},
      {"a needle of aspect 1e6", {{{0, 0}, {1, 0}, {1, 1e-6}}}, none, 0},
      {"a needle of aspect 1e12", {{{0, 0}, {1, 0}, {1, 1e-12}}}, none, -1},
      {"a plate with a needle",
       {{{0, 0}, {1, 0}, {1, 0.2}, {0.5 + 1e-6, 0.2}, {0.5, 1.2}, {0.5 - 1e-6, 0.2}, {0, 0.2}}},
       none,
       -1},
      {"touches itself at a vertex", {{{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}}}, none, 1},
      {"touches itself at an edge", {{{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}}, none, -1},
      {"bow-tie", {{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, none, 1},
      {"bow-tie with a knot of an ulp", {{{0, 0}, {1, 1}, {1, 0}, {0.5, 0.5}, {0, 1}}}, none, -1},
      {"a spike of no width", {{{0, 0}, {1, 0}, {1.7, 0.4}, {1, 0}, {1, 1}}}, none, 1},
      {"a spike of no width into the inside", {{{0, 0}, {2, 0}, {1.2, 0.4}, {2, 0}, {2, 2}, {0, 2}}}, none, 1},
      {"a spike with a foot on its side", {{{0, 0}, {3, 0}, {1.1, 0}, {1.1, 2}, {0, 2}}}, none, -1},
      {"an edge twice", {{{0, 0}, {1, 0}, {1, 1}, {1, 0}, {0, 0}, {0, 1}}}, none, 1},
      {"two loops over each other", {{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 0}, {1, 1}}}, none, 1},
      {"hole equal to the outer ring", {kSquare, kSquare}, none, 1},
      {"hole equal to another", {kSquare, kHole, kHole}, none, 1},
      {"holes with a common vertex", {kSquare, kHole, {{0.6, 0.6}, {0.9, 0.6}, {0.9, 0.9}}}, none, 1},
      {"a hole on the outer ring's vertex", {kSquare, {{0, 0}, {0.5, 0.2}, {0.2, 0.5}}}, none, 1},
      {"a hole with a vertex on an edge", {kSquare, {{0.3, 0}, {0.5, 0.2}, {0.2, 0.5}}}, none, -1},
      {"a hole along an edge", {kSquare, {{0.3, 0}, {0.6, 0}, {0.5, 0.5}}}, none, -1},
      {"holes side by side", {kSquare, kHole, {{0.6, 0.3}, {0.6, 0.5}, {0.9, 0.4}}}, none, -1},
      {"holes an ulp from each other",
       {kSquare, kHole, {{0.6, 0.6}, {0.9, 0.6}, {0.9, 0.9}}},
       [](Rings* r, RandomStream& random) { (*r)[2][0].x() = ulpBeside((*r)[2][0].x(), random); },
       -1},
      {"a hole within a hole", {kSquare, kHole, {{0.3, 0.3}, {0.5, 0.3}, {0.4, 0.5}}}, none, 1},
      {"a hole beside the polygon", {kSquare, {{2, 2}, {3, 2}, {3, 3}}}, none, 1},
      {"a hole around the polygon", {kHole, kSquare}, none, 1},
      {"a hole across the outline", {kSquare, {{0.5, 0.5}, {1.5, 0.4}, {1.5, 0.7}}}, none, 1},
      {"a hole without area", {kSquare, {{0.2, 0.2}, {0.5, 0.5}, {0.7, 0.7}}}, none, -1},
      {"a wall of an ulp",
       {kSquare, kSquare},
       [](Rings* r, RandomStream&) {
         const Vec2 c = 0.5 * ((*r)[0][0] + (*r)[0][2]);
         for (Vec2& p : (*r)[1])
           for (int k = 0; k < 2; ++k) p[k] = ulpTowards(p[k], c[k]);
       },
       -1},
      {"not a number", {kSquare, kHole}, poison, 1},
      {"a sound polygon", {kSquare, kHole, {{0.7, 0.7}, {0.9, 0.7}, {0.9, 0.9}}}, none, 0},
  };
}

/// Accepts or refuses, compares with the oracle; true if refused.
bool expectRight(Rings rings, RandomStream& random) {
  const Rings given = rings;
  const std::set<Reason> why = reasons(&rings);
  try {
    const Polygon polygon = Polygon::make(given[0], Rings(given.begin() + 1, given.end()));
    EXPECT_TRUE(why.empty()) << "accepted, though there is a reason against it: " << static_cast<int>(*why.begin());
    std::size_t vertices = 0;
    for (const Ring& ring : rings) vertices += ring.size();
    EXPECT_EQ(polygon.edgeCount(), vertices) << "repaired otherwise";
    if (why.empty()) expectExactDistances(polygon, rings, random);
    return false;
  } catch (const PolygonError& error) {
    EXPECT_TRUE(why.count(error.reason()) == 1) << error.what();
    return true;
  }
}

void place(Rings* rings, double scale, const Transform& transform) {
  for (Ring& ring : *rings)
    for (Vec2& p : ring) p = transform.toWorld(scale * p);
}

TEST(BadInput, is_refused_for_a_reason_that_holds_or_handled_exactly_wherever_it_stands) {
  RandomStream random(23, 0);
  for (const BadInput& bad : corpus())
    for (int k = 0; k < 24; ++k) {
      SCOPED_TRACE(bad.name + " " + std::to_string(k));
      Rings rings = bad.rings;
      const double scale = k == 0 ? 1.0 : std::pow(10.0, random.uniform(-3.0, 3.0));
      const Vec2 offset = k % 3 == 1 ? Vec2(1e6, -1e6) : Vec2(0, 0);
      place(&rings, scale, Transform::of(offset, k == 0 ? 0.0 : random.uniform(0.0, 6.3)));
      bad.spoil(&rings, random);
      const bool refused = expectRight(std::move(rings), random);
      // Far off and small, rounding may make anything of anything; the exact answer above still counts.
      if (bad.refused >= 0 && offset.x() == 0.0) {
        EXPECT_EQ(refused, bad.refused == 1);
      }
      if (HasFatalFailure()) return;
    }
}

TEST(BadInput, the_corpus_has_both_sides_of_every_rounding) {
  // Were all of them refused, or all accepted, the exact comparison above would prove little.
  RandomStream random(29, 0);
  int refused = 0, accepted = 0;
  for (const BadInput& bad : corpus()) {
    if (bad.refused >= 0) continue;
    for (int k = 0; k < 10; ++k) {
      Rings rings = bad.rings;
      place(&rings, std::pow(10.0, random.uniform(-3.0, 3.0)), Transform::of({0, 0}, random.uniform(0.0, 6.3)));
      bad.spoil(&rings, random);
      (reasons(&rings).empty() ? accepted : refused) += 1;
    }
  }
  EXPECT_GT(refused, 20);
  EXPECT_GT(accepted, 20);
}

TEST(BadInput, random_rings_on_a_coarse_lattice_are_judged_as_the_exact_oracle_judges_them) {
  // On a lattice of 5 x 5 nearly everything touches, repeats or turns back.
  RandomStream random(31, 0);
  int refused = 0;
  for (int k = 0; k < 3000; ++k) {
    Rings rings(1 + random.below(3));
    for (Ring& ring : rings) {
      const std::uint32_t n = 3 + random.below(5);
      for (std::uint32_t i = 0; i < n; ++i) ring.emplace_back(random.below(5), random.below(5));
    }
    if (rings.size() > 1) rings[0] = {{-1, -1}, {5, -1}, {5, 5}, {-1, 5}};
    if (k % 2 == 1) place(&rings, 1.0, Transform::of({0, 0}, 0.6435));
    SCOPED_TRACE(k);
    refused += expectRight(std::move(rings), random);
    if (HasFailure()) return;
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 2500);
}

TEST(BadInput, sizes_at_which_a_moment_leaves_the_numbers_are_refused_and_none_before) {
  for (const double side : {1e-150, 1e-80, 1e80, 1e150})
    EXPECT_THROW(Polygon::box({{0, 0}, {side, side}}), PolygonError) << side;
  for (const double side : {1e-70, 1e-30, 1e-9, 1e9, 1e30, 1e70}) {
    const Polygon square = Polygon::box({{0, 0}, {side, side}});
    EXPECT_NEAR(square.area() / side / side, 1.0, 1e-15);
    EXPECT_NEAR(square.secondMoment() / side / side / side / side, 1.0 / 6.0, 1e-15);
    EXPECT_TRUE(square.contains({0.5 * side, side}));
  }
}

}  // namespace
}  // namespace froude
