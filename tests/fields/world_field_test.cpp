#include <gtest/gtest.h>

#include <memory>
#include <set>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/world_field.h>

#include "support/polygon_generator.h"
#include "support/sweep_oracle.h"

namespace froude {
namespace {

/// A world and, for each of its solids, what the oracle needs.
struct Setting {
  std::vector<Polygon> polygons;
  std::vector<PlacedPolygon> placed;
  DomainWalls walls;
  std::unique_ptr<WorldField> world;
  std::vector<std::vector<test::OracleEdge>> edges;  // one list a polygon, in world coordinates as the field has them

  void build(double band, double cellSize = 0.0) {
    world = std::make_unique<WorldField>(placed, walls, band, cellSize);
    edges.assign(placed.size(), {});
    for (const FieldEdge& e : world->edges()) {
      if (e.body >= 0) edges[static_cast<std::size_t>(e.body)].push_back({e.a, e.b});
    }
  }

  /// Signed distance to what lies beyond closed walls.
  double wallDistance(const Vec2& p) const {
    const Box& box = walls.box;
    const std::array<double, 4> inwards{p.x() - box.min.x(), box.max.x() - p.x(), p.y() - box.min.y(),
                                        box.max.y() - p.y()};
    double outside = 0.0;
    double least = kInfinity;
    Vec2 beyond(0.0, 0.0);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!walls.closed[k]) continue;
      least = std::min(least, inwards[k]);
      if (inwards[k] < 0.0) beyond[static_cast<Eigen::Index>(k / 2)] = inwards[k];
      outside = beyond.norm();
    }
    return least >= 0.0 ? least : -outside;
  }

  double distance(const Vec2& p) const {
    double best = wallDistance(p);
    for (const auto& list : edges) best = std::min(best, static_cast<double>(test::signedDistance(list, p)));
    return best;
  }
};

Setting randomSetting(RandomStream& random, int count, const std::array<bool, 4>& closed) {
  Setting s;
  s.walls = {{{-2.0, -1.0}, {2.0, 2.0}}, closed};
  for (int k = 0; k < count; ++k) {
    s.polygons.push_back(test::randomPolygon(static_cast<test::Shape>(random.below(test::kShapeCount)), random));
  }
  for (int k = 0; k < count; ++k) {
    const Transform at =
        Transform::of({random.uniform(-2.2, 2.2), random.uniform(-1.2, 2.2)}, random.uniform(0.0, 6.3));
    s.placed.push_back({&s.polygons[static_cast<std::size_t>(k)], at, k});
  }
  return s;
}

Vec2 anywhere(RandomStream& random) { return {random.uniform(-2.0, 2.0), random.uniform(-1.0, 2.0)}; }

constexpr std::array<bool, 4> kClosed{true, true, true, true};
constexpr std::array<bool, 4> kOpen{false, false, false, false};

TEST(WorldField, equals_the_least_of_all_distances_within_the_band) {
  RandomStream random(41, 0);
  int exact = 0;
  for (int k = 0; k < 12; ++k) {
    // Polygons overlap each other and the walls.
    Setting s = randomSetting(random, 1 + k, {k % 2 == 0, k % 3 == 0, true, k % 4 == 0});
    s.build(0.04, k % 3 == 0 ? 0.07 : 0.0);
    for (int i = 0; i < 1500; ++i) {
      Vec2 p = anywhere(random);
      if (i % 2 == 0) {
        const FieldEdge& e = s.world->edges()[random.below(static_cast<std::uint32_t>(s.world->edges().size()))];
        const Vec2 near =
            e.a + random.uniform() * (e.b - e.a) + 0.05 * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        if (e.body >= 0 && s.walls.box.contains(near)) p = near;
      }
      SCOPED_TRACE(std::to_string(k) + " point " + std::to_string(i));
      const double wanted = s.distance(p);
      const WorldSample sample = s.world->sample(p);
      const WorldSample all = s.world->sampleExact(p);
      ASSERT_TRUE(all.exact);
      ASSERT_NEAR(all.distance, wanted, 1e-14);
      if (sample.exact) {
        ++exact;
        ASSERT_NEAR(sample.distance, wanted, 1e-14);
        ASSERT_NEAR(sample.normal.norm(), 1.0, 1e-14);
        ASSERT_NEAR((p - sample.distance * sample.normal - sample.closest).norm(), 0.0, 1e-14);
        ASSERT_EQ(sample.body, s.world->edges()[static_cast<std::size_t>(sample.edge)].body);
      } else {
        ASSERT_GT(std::abs(wanted), 0.04);
        ASSERT_EQ(sample.distance > 0.0, wanted > 0.0);
        // Inside overlapping solids the bound is one of the union, which is deeper than any of them.
        if (wanted > 0.0) {
          ASSERT_LE(sample.distance, wanted * (1.0 + 1e-12));
        }
      }
      const double bound = s.world->lowerBound(p);
      ASSERT_LE(bound, std::max(wanted, 0.0) + 1e-14);
    }
  }
  EXPECT_GT(exact, 5000);
}

TEST(WorldField, a_domain_without_walls_and_polygons_is_empty) {
  const WorldField world({}, {{{0, 0}, {1, 1}}, kOpen}, 0.1);
  EXPECT_TRUE(world.edges().empty());
  EXPECT_FALSE(world.sample({0.5, 0.5}).exact);
  EXPECT_GT(world.sample({0.5, 0.5}).distance, 0.0);
  EXPECT_FALSE(world.sampleExact({3.0, 0.5}).exact);
  EXPECT_FALSE(world.sweepDisc({0.1, 0.1}, {5.0, 5.0}, 0.05).hit);
  EXPECT_FALSE(WorldField({}, DomainWalls(), 0.1).sweepDisc({0.1, 0.1}, {5.0, 5.0}, 0.05).hit);
}

TEST(WorldField, closed_walls_meet_in_corners_and_open_sides_let_through) {
  const WorldField world({}, {{{0, 0}, {4, 3}}, {true, false, true, false}}, 0.2);
  EXPECT_EQ(world.edges().size(), 2u);
  const WorldSample floor = world.sample({2.0, 0.1});
  EXPECT_NEAR(floor.distance, 0.1, 1e-15);
  EXPECT_EQ(floor.normal, Vec2(0.0, 1.0));
  EXPECT_EQ(floor.body, -1);
  EXPECT_NEAR(world.sample({0.05, 0.1}).distance, 0.05, 1e-15);
  const WorldSample corner = world.sample({-0.03, -0.04});
  EXPECT_NEAR(corner.distance, -0.05, 1e-15);
  EXPECT_NEAR((corner.closest - Vec2(0, 0)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(world.sweepDisc({3.9, 1.0}, {9.0, 1.0}, 0.05).hit) << "out through the open right side";
  EXPECT_FALSE(world.sweepDisc({1.0, 2.9}, {1.0, 9.0}, 0.05).hit) << "out through the open top";
  // At an open side the floor does not end: a disc that leaves low does not catch on its end.
  EXPECT_NEAR(world.sample({4.05, 0.05}).distance, 0.05, 1e-15);
  const SweepHit hit = world.sweepDisc({1.0, 1.0}, {1.0, -1.0}, 0.25 * 0.5);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 0.4375, 1e-11);
  EXPECT_EQ(hit.body, -1);
  EXPECT_EQ(hit.normal, Vec2(0.0, 1.0));
}

TEST(WorldField, a_point_on_a_wall_may_slide_into_a_corner_and_stops_there) {
  const WorldField world({}, {{{0, 0}, {4, 3}}, kClosed}, 0.2);
  const SweepHit hit = world.sweepDisc({1.0, 0.0}, {-1.0, 0.0}, 0.0);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 0.5, 1e-11);
  EXPECT_EQ(hit.normal, Vec2(1.0, 0.0));
  EXPECT_GE(hit.center.x(), 0.0);
  EXPECT_GE(hit.center.y(), 0.0);
}

TEST(WorldField, finds_the_edges_near_a_point_in_order) {
  RandomStream random(42, 0);
  Setting s = randomSetting(random, 10, {true, true, true, false});
  s.build(0.1);
  for (int i = 0; i < 3000; ++i) {
    const Vec2 p = anywhere(random);
    const double radius = random.uniform(0.0, 0.1);
    std::vector<std::uint32_t> seen;
    s.world->forEachEdgeNear(p, radius, [&](const FieldEdge& e) {
      EXPECT_NEAR(e.normal.dot(e.b - e.a), 0.0, 1e-9);
      seen.push_back(e.index);
    });
    ASSERT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    ASSERT_EQ(std::set<std::uint32_t>(seen.begin(), seen.end()).size(), seen.size());
    for (const FieldEdge& e : s.world->edges()) {
      const auto d = static_cast<double>(test::segmentDistance({e.a, e.b}, p));
      if (std::abs(d - radius) < 1e-13) continue;
      ASSERT_EQ(std::binary_search(seen.begin(), seen.end(), e.index), d < radius);
    }
  }
}

TEST(WorldField, a_sweep_hits_the_earliest_of_all_bodies) {
  RandomStream random(43, 0);
  Setting s = randomSetting(random, 8, kClosed);
  s.build(0.05);
  std::vector<test::OracleEdge> edges;
  for (const FieldEdge& e : s.world->edges()) edges.push_back({e.a, e.b});
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec2 p = anywhere(random);
    const Vec2 q = i % 2 == 0 ? anywhere(random) : Vec2(p + 0.1 * (anywhere(random) - p));
    const double radius = i % 3 == 0 ? 0.0 : random.uniform(0.0, 0.05);
    if (s.distance(p) <= radius + 1e-9) continue;
    const SweepHit hit = s.world->sweepDisc(p, q, radius);
    const std::optional<long double> wanted = test::firstTouch(edges, p, q, radius);
    ASSERT_EQ(hit.hit, wanted.has_value()) << i;
    if (!hit.hit) continue;
    ++hits;
    ASSERT_LE(hit.time, static_cast<double>(*wanted) + 1e-14);
    ASSERT_EQ(hit.body, s.world->edges()[static_cast<std::size_t>(hit.edge)].body);
    ASSERT_NEAR(s.distance(p + hit.time * (q - p)), radius, 1e-11);
    ASSERT_GE(s.distance(hit.center), radius);
  }
  EXPECT_GT(hits, 500);
}

TEST(WorldField, a_filter_lets_through_what_it_does_not_accept_and_nothing_else) {
  RandomStream random(44, 0);
  Setting s = randomSetting(random, 9, kClosed);
  for (std::size_t k = 0; k < s.placed.size(); ++k) {
    s.placed[k].group = 1u << (k % 3);
    s.placed[k].collidesWith = k % 4 == 3 ? 2u : ~0u;
  }
  s.build(0.05);
  for (const CollisionFilter filter : {CollisionFilter{1, 2u}, CollisionFilter{2, 5u}, CollisionFilter{1, 0u}}) {
    std::vector<PlacedPolygon> accepted;
    for (const PlacedPolygon& p : s.placed) {
      if ((p.group & filter.collidesWith) != 0 && (filter.group & p.collidesWith) != 0)
        accepted.push_back({p.polygon, p.transform, p.body});
    }
    const WorldField only(accepted, s.walls, 0.05);
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec2 p = anywhere(random);
      const Vec2 q = anywhere(random);
      const double radius = i % 2 == 0 ? 0.0 : random.uniform(0.0, 0.05);
      const WorldSample a = s.world->sample(p, filter);
      const WorldSample b = only.sampleExact(p);
      if (std::abs(b.distance) <= 0.05) {
        ASSERT_TRUE(a.exact);
        ASSERT_NEAR(a.distance, b.distance, 1e-15);
        ASSERT_EQ(a.body, b.body);
      } else {
        ASSERT_LE(std::abs(a.distance), std::abs(b.distance) * (1 + 1e-12));
        ASSERT_EQ(a.distance > 0.0, b.distance > 0.0);
      }
      const SweepHit h = s.world->sweepDisc(p, q, radius, filter);
      const SweepHit o = only.sweepDisc(p, q, radius);
      ASSERT_EQ(h.hit, o.hit) << i;
      ASSERT_EQ(h.startedInside, o.startedInside) << i;
      ASSERT_NEAR(h.time, o.time, 1e-9) << i;
      ASSERT_EQ(h.body, o.body) << i;
      hits += h.hit;
    }
    EXPECT_GT(hits, 50);
  }
}

TEST(WorldField, clearance_of_a_cell_holds_for_all_of_its_points) {
  RandomStream random(45, 0);
  for (const auto& closed : {kClosed, kOpen, std::array<bool, 4>{true, false, true, true}}) {
    Setting s = randomSetting(random, 5, closed);
    s.build(0.03);
    const WorldField& w = *s.world;
    ASSERT_EQ(w.clearance().size(), static_cast<std::size_t>(w.nx()) * static_cast<std::size_t>(w.ny()));
    double useful = 0.0;
    for (int k = 0; k < 3000; ++k) {
      const auto i = static_cast<int>(random.below(static_cast<std::uint32_t>(w.nx())));
      const auto j = static_cast<int>(random.below(static_cast<std::uint32_t>(w.ny())));
      const Vec2 p = w.gridOrigin() + w.cellSize() * Vec2(i + random.uniform(), j + random.uniform());
      const double clearance = static_cast<double>(w.clearance()[static_cast<std::size_t>(i + j * w.nx())]);
      ASSERT_LE(clearance, std::max(0.0, s.distance(p)) + 1e-14);
      useful = std::max(useful, clearance);
    }
    EXPECT_GT(useful, 0.1);
  }
}

TEST(WorldField, two_boxes_that_share_a_side_are_one_solid) {
  const Polygon box = Polygon::box({{0, 0}, {1, 1}});
  const std::array<PlacedPolygon, 2> pair{PlacedPolygon{&box, Transform(), 0},
                                          PlacedPolygon{&box, Transform::of({1, 0}, 0), 1}};
  const WorldField world(pair, DomainWalls(), 0.2);
  EXPECT_NEAR(world.sample({1.0, 1.1}).distance, 0.1, 1e-15);
  EXPECT_LT(world.sample({0.95, 0.5}).distance, 0.0);
  EXPECT_LT(world.sample({1.05, 0.5}).distance, 0.0);
  for (int k = 0; k < 100; ++k) {
    const double x = 0.999 + 0.00002 * k;
    const SweepHit hit = world.sweepDisc({x, 1.5}, {x, 0.5}, 0.0);
    ASSERT_TRUE(hit.hit);
    ASSERT_NEAR(hit.time, 0.5, 1e-11);
    ASSERT_EQ(hit.normal, Vec2(0.0, 1.0));
  }
  // Sliding over the seam meets nothing.
  EXPECT_FALSE(world.sweepDisc({0.5, 1.0}, {1.5, 1.0}, 0.0).hit);
  EXPECT_FALSE(world.sweepDisc({0.5, 1.125}, {1.5, 1.125}, 0.125).hit);
}

TEST(WorldField, a_large_domain_with_a_thin_band_fits_in_memory) {
  RandomStream random(46, 0);
  std::vector<Polygon> polygons;
  for (int k = 0; k < test::kShapeCount; ++k)
    polygons.push_back(test::randomPolygon(static_cast<test::Shape>(k), random));
  std::vector<PlacedPolygon> placed;
  for (int k = 0; k < 40; ++k) {
    placed.push_back({&polygons[static_cast<std::size_t>(k % test::kShapeCount)],
                      Transform::of({random.uniform(2.0, 98.0), random.uniform(2.0, 98.0)}, random.uniform(0.0, 6.3)),
                      k});
  }
  const WorldField world(placed, {{{0, 0}, {100, 100}}, kClosed}, 0.05);
  EXPECT_LE(world.nx() * world.ny(), 1 << 22);
  EXPECT_LT(world.memoryBytes(), 64u << 20);
  const SweepHit hit = world.sweepDisc({50.0, 99.0}, {50.0, 200.0}, 0.05);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time * 101.0, 0.95, 1e-9);
}

TEST(WorldField, a_band_that_makes_no_sense_is_refused) {
  EXPECT_THROW(WorldField({}, {{{0, 0}, {1, 1}}, kClosed}, 0.0), Error);
  EXPECT_THROW(WorldField({}, {{{0, 0}, {1, 1}}, kClosed}, 0.1, -1.0), Error);
  EXPECT_THROW(WorldField({}, {{{0, 0}, {1, kInfinity}}, kClosed}, 0.1), Error);
}

}  // namespace
}  // namespace froude
