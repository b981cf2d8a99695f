// Convex pieces against what a partition is: exact signs in 113 bits, areas, points that lie in one piece only.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include <froude/base/random.h>
#include <froude/fields/convex_pieces.h>

#include "support/polygon_generator.h"
#include "support/polygon_oracle.h"

namespace froude {
namespace {

long double areaOf(const std::vector<Vec2>& ring) {
  long double twice = 0.0L;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = ring[i] - ring[0], b = ring[(i + 1) % ring.size()] - ring[0];
    twice += static_cast<long double>(a.x()) * b.y() - static_cast<long double>(a.y()) * b.x();
  }
  return 0.5L * twice;
}

std::size_t reflexCount(const Polygon& polygon) {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < polygon.edgeCount(); ++i)
    if (test::side(polygon.vertices()[polygon.previous(i)], polygon.vertices()[i],
                   polygon.vertices()[polygon.next(i)]) < 0)
      ++count;
  return count;
}

/// Left of every edge: strictly inside; on the line of some and left of the others: on the boundary.
int whereInConvex(const std::vector<Vec2>& ring, const Vec2& p) {
  int least = 1;
  for (std::size_t i = 0; i < ring.size(); ++i)
    least = std::min(least, test::side(ring[i], ring[(i + 1) % ring.size()], p));
  return least;
}

/// Everything that `convexPieces` promises.
void expectPartition(const Polygon& polygon, const std::vector<ConvexPiece>& pieces, RandomStream& random) {
  std::vector<int> outline(polygon.edgeCount(), 0);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> cuts;
  long double area = 0.0L;
  std::vector<std::vector<Vec2>> rings;
  for (const ConvexPiece& piece : pieces) {
    ASSERT_GE(piece.size(), 3u);
    ASSERT_EQ(piece.outlineEdge.size(), piece.size());
    rings.push_back(piece.points(polygon));
    const std::vector<Vec2>& ring = rings.back();
    ASSERT_GT(areaOf(ring), 0.0L);
    area += areaOf(ring);
    int turns = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()], &c = ring[(k + 2) % ring.size()];
      ASSERT_GE(test::side(a, b, c), 0);
      // A convex ring goes round once: it turns from rightwards to leftwards, or up to down, once.
      if (a.y() < b.y() && !(b.y() < c.y())) ++turns;
      const std::uint32_t from = piece.vertex[k], to = piece.vertex[(k + 1) % ring.size()];
      if (piece.outlineEdge[k] >= 0) {
        ASSERT_EQ(static_cast<std::uint32_t>(piece.outlineEdge[k]), from);
        ASSERT_EQ(polygon.next(from), to);
        ++outline[from];
      } else {
        ASSERT_NE(polygon.next(from), to);
        ++cuts[{from, to}];
      }
    }
    ASSERT_EQ(turns, 1);
  }
  for (const int times : outline) ASSERT_EQ(times, 1);
  for (const auto& [ends, times] : cuts) {
    ASSERT_EQ(times, 1);
    ASSERT_EQ(cuts.count({ends.second, ends.first}), 1u);
  }
  std::vector<Vec2> all(polygon.vertices().begin(), polygon.vertices().end());
  long double whole = 0.0L;
  for (std::size_t r = 0; r + 1 < polygon.ringStarts().size(); ++r)
    whole += areaOf({all.begin() + polygon.ringStarts()[r], all.begin() + polygon.ringStarts()[r + 1]});
  const Vec2 size = polygon.bounds().size();
  ASSERT_NEAR(static_cast<double>(area), static_cast<double>(whole), 1e-15 * size.x() * size.y());

  const std::size_t reflex = reflexCount(polygon), holes = polygon.ringStarts().size() - 2;
  ASSERT_LE(pieces.size(), 2 * reflex + 1 - holes);
  ASSERT_EQ(pieces.size(), cuts.size() / 2 + 1 - holes);  // Euler: each cut parts, but for those that join holes
  if (holes == 0) {
    ASSERT_GE(pieces.size(), (reflex + 1) / 2 + (reflex > 0 ? 1 : 0));
  }

  const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
  for (int k = 0; k < 30; ++k) {
    const Vec2 p = polygon.bounds().min + Vec2(random.uniform() * size.x(), random.uniform() * size.y());
    int inside = 0, touching = 0;
    for (const std::vector<Vec2>& ring : rings) {
      const int where = whereInConvex(ring, p);
      inside += where > 0 ? 1 : 0;
      touching += where == 0 ? 1 : 0;
    }
    if (touching > 0) continue;
    ASSERT_EQ(inside, test::whereIs(edges, p) > 0 ? 1 : 0);
  }
}

std::map<std::string, Polygon> goldenPolygons() {
  std::ifstream stream(std::string(FROUDE_TEST_DATA) + "/geometry_polygons.json");
  std::map<std::string, Polygon> polygons;
  const nlohmann::json table = nlohmann::json::parse(stream)["polygons"];
  for (const auto& [name, entry] : table.items()) {
    std::vector<std::vector<Vec2>> rings;
    for (const auto& loop : entry["loops"]) {
      rings.emplace_back();
      for (const auto& p : loop) rings.back().emplace_back(p[0].get<double>(), p[1].get<double>());
    }
    polygons.emplace(name, Polygon::make(rings[0], {rings.begin() + 1, rings.end()}));
  }
  return polygons;
}

TEST(ConvexPieces, part_every_shape_of_the_exact_table) {
  RandomStream random(5, 1);
  const std::map<std::string, Polygon> polygons = goldenPolygons();
  EXPECT_EQ(polygons.size(), 17u);
  for (const auto& [name, polygon] : polygons) {
    SCOPED_TRACE(name);
    const std::vector<ConvexPiece> pieces = convexPieces(polygon);
    expectPartition(polygon, pieces, random);
    if (reflexCount(polygon) == 0) {
      EXPECT_EQ(pieces.size(), 1u);
    }
  }
}

// Where the least number is known: a reflex vertex each for an L, both at once for a channel's floor, four arms.
TEST(ConvexPieces, are_as_few_as_can_be_for_simple_letters) {
  const auto count = [](std::vector<Vec2> ring) { return convexPieces(Polygon::make(std::move(ring))).size(); };
  EXPECT_EQ(count({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}), 2u);
  EXPECT_EQ(count({{0, 0}, {3, 0}, {3, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}), 2u);
  EXPECT_EQ(count({{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}), 3u);
  EXPECT_EQ(count({{0, 0}, {4, 1}, {0, 2}, {1, 1}}), 2u);
}

class ConvexPiecesOfAnyShape : public ::testing::TestWithParam<int> {};

TEST_P(ConvexPiecesOfAnyShape, are_a_partition) {
  RandomStream random(321, static_cast<std::uint64_t>(GetParam()));
  for (int round = 0; round < 400; ++round) {
    const test::Outline outline = test::makeOutline(static_cast<test::Shape>(GetParam()), random);
    const double scale = std::pow(10.0, random.uniform(-6.0, 6.0));
    const Transform place = Transform::of({random.uniform(-3.0, 3.0) * scale, random.uniform(-3.0, 3.0) * scale},
                                          round % 3 == 0 ? 0.0 : random.uniform(0.0, 2.0 * kPi));
    const Polygon polygon = test::placed(outline, scale, place);
    SCOPED_TRACE(outline.name + " " + std::to_string(round));
    expectPartition(polygon, convexPieces(polygon), random);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, ConvexPiecesOfAnyShape, ::testing::Range(0, test::kShapeCount));

// Staircases and grids of holes on integers: hosts of vertices on one line and on one circle.
TEST(ConvexPieces, stand_degenerate_positions) {
  RandomStream random(9, 9);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec2> ring{{0, 0}};
    const int columns = 2 + static_cast<int>(random.below(8));
    for (int i = columns - 1; i >= 0; --i) {
      const double height = 1 + random.below(4);
      ring.emplace_back(i + 1, i == columns - 1 ? 0.0 : ring.back().y());
      ring.emplace_back(i + 1, height);
      ring.emplace_back(i, height);
    }
    const Polygon polygon = Polygon::make(ring);
    expectPartition(polygon, convexPieces(polygon), random);
  }
  std::vector<std::vector<Vec2>> holes;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      holes.push_back({{2.0 * i + 1, 2.0 * j + 1},
                       {2.0 * i + 2, 2.0 * j + 1},
                       {2.0 * i + 2, 2.0 * j + 2},
                       {2.0 * i + 1, 2.0 * j + 2}});
  const Polygon sieve = Polygon::make({{0, 0}, {13, 0}, {13, 13}, {0, 13}}, holes);
  expectPartition(sieve, convexPieces(sieve), random);
}

TEST(ConvexPieces, are_the_same_again) {
  RandomStream random(4, 2);
  for (int shape = 0; shape < test::kShapeCount; ++shape) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(shape), random);
    const std::vector<ConvexPiece> one = convexPieces(polygon), two = convexPieces(polygon);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
      EXPECT_EQ(one[k].vertex, two[k].vertex);
      EXPECT_EQ(one[k].outlineEdge, two[k].outlineEdge);
    }
  }
}

double sharpestAngle(const Polygon& polygon, const std::vector<ConvexPiece>& pieces) {
  double least = kPi;
  for (const ConvexPiece& piece : pieces) {
    const std::vector<Vec2> ring = piece.points(polygon);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 in = ring[(k + ring.size() - 1) % ring.size()] - ring[k], out = ring[(k + 1) % ring.size()] - ring[k];
      least = std::min(least, std::atan2(std::abs(cross(out, in)), out.dot(in)));
    }
  }
  return least * 180.0 / kPi;
}

// The figures of docs/decisions/fields-convex-pieces.md.
TEST(ConvexPieces, are_as_few_and_as_blunt_as_was_noted) {
  struct Noted {
    const char* name;
    std::size_t pieces;
    double degrees;
  };
  const std::map<std::string, Polygon> polygons = goldenPolygons();
  for (const Noted& noted :
       {Noted{"star5", 4, 38.3}, Noted{"lshape", 2, 45.0}, Noted{"comb4", 5, 45.0}, Noted{"gear12", 13, 88.0},
        Noted{"spiral2", 48, 75.4}, Noted{"needle", 2, 0.11}, Noted{"holed_square", 4, 33.6}, Noted{"koch1", 5, 60.0},
        Noted{"koch2", 23, 30.0}, Noted{"koch3", 81, 30.0}, Noted{"koch4", 303, 30.0}}) {
    const Polygon& polygon = polygons.at(noted.name);
    const std::vector<ConvexPiece> pieces = convexPieces(polygon);
    EXPECT_LE(pieces.size(), noted.pieces) << noted.name;
    EXPECT_GT(sharpestAngle(polygon, pieces), noted.degrees - 1e-6) << noted.name;
  }
}

TEST(ConvexPieces, part_an_outline_of_ten_thousand_edges) {
  RandomStream random(31, 7);
  std::vector<Vec2> ring;
  for (int i = 0; i < 10000; ++i)
    ring.push_back(
        test::generator::polar(random.uniform(0.3, 1.0), 2.0 * kPi * (i + random.uniform(0.0, 0.5)) / 10000));
  const Polygon polygon = Polygon::make(ring);
  expectPartition(polygon, convexPieces(polygon), random);
}

}  // namespace
}  // namespace froude
