#include <froude/fields/batch.h>
#include <gtest/gtest.h>

#include <bit>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/world_field.h>

#include "support/polygon_generator.h"

namespace froude {
namespace {

/// All columns of a batch.
struct Answers {
  std::vector<double> distance, normalX, normalY, closestX, closestY;
  std::vector<std::int32_t> edge;
  std::vector<FeatureKind> feature;

  explicit Answers(std::size_t n)
      : distance(n), normalX(n), normalY(n), closestX(n), closestY(n), edge(n), feature(n) {}

  FieldBatch batch(std::span<const double> x, std::span<const double> y) {
    return {x, y, distance, normalX, normalY, closestX, closestY, edge, feature};
  }
};

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a == 0.0 && b == 0.0) ||
         (std::isnan(a) && std::isnan(b));
}

void expectSame(const Answers& a, std::size_t i, const FieldSample& s, const Vec2& closest) {
  ASSERT_TRUE(sameBits(a.distance[i], s.distance)) << a.distance[i] << " " << s.distance;
  ASSERT_TRUE(sameBits(a.normalX[i], s.normal.x()) && sameBits(a.normalY[i], s.normal.y()));
  ASSERT_TRUE(sameBits(a.closestX[i], closest.x()) && sameBits(a.closestY[i], closest.y()));
  ASSERT_EQ(a.edge[i], s.edge);
  ASSERT_EQ(a.feature[i], s.feature);
}

struct Points {
  std::vector<double> x, y;
  void add(const Vec2& p) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
};

/// Anywhere, on and within rounding of the outline, far outside, and not finite.
Points pointsFor(const Polygon& polygon, double band, RandomStream& random, int count) {
  const Box box = polygon.bounds().grown(1.5 * band);
  Points points;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t e = random.below(polygon.edgeCount());
    const Vec2 onEdge = polygon.edgeStart(e) + random.uniform() * (polygon.edgeEnd(e) - polygon.edgeStart(e));
    const double off = box.size().maxCoeff() * std::pow(10.0, random.uniform(-17.0, -1.0));
    const Vec2 direction(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    switch (random.below(8)) {
      case 0:
        points.add(polygon.edgeStart(e));
        break;
      case 1:
        points.add(onEdge);
        break;
      case 2:
      case 3:
        points.add(onEdge + off * direction);
        break;
      case 4:
        points.add(onEdge + band * direction);
        break;
      default:
        points.add(box.min + Vec2(random.uniform() * box.size().x(), random.uniform() * box.size().y()));
    }
    if (k % 97 == 0) points.add(Vec2(1e3, -1e9));
    if (k % 101 == 0) points.add(Vec2(std::nan(""), 0.0));
    if (k % 103 == 0) points.add(Vec2(0.0, kInfinity));
  }
  return points;
}

TEST(FieldBatch, says_what_the_field_says_of_each_point_on_every_target) {
  RandomStream random(11, 0);
  for (int k = 0; k < 48; ++k) {
    const auto shape = static_cast<test::Shape>(k % test::kShapeCount);
    const test::Outline outline = test::makeOutline(shape, random);
    const Polygon polygon = test::placed(outline, 1.0, Transform::of(Vec2(k % 3 == 0 ? 1e4 : 0.0, 0.0), 0.3 * k));
    const double band = std::pow(10.0, random.uniform(-2.5, -0.3));
    const DistanceField field(polygon, band);
    const Points points = pointsFor(polygon, band, random, 700 + k);
    for (const SimdTarget target : supportedSimdTargets()) {
      SCOPED_TRACE(outline.name + " " + std::to_string(k) + " " + std::string(name(target)));
      Answers answers(points.x.size());
      sampleBatch(field, Transform(), answers.batch(points.x, points.y), target);
      for (std::size_t i = 0; i < points.x.size(); ++i) {
        const Vec2 p(points.x[i], points.y[i]);
        const FieldSample s = field.sample(p);
        ASSERT_NO_FATAL_FAILURE(expectSame(answers, i, s, s.closest)) << i << " at " << p.transpose();
      }
    }
  }
}

TEST(FieldBatch, turns_points_into_the_frame_of_the_polygon_and_answers_back) {
  RandomStream random(12, 0);
  for (int k = 0; k < 16; ++k) {
    const auto shape = static_cast<test::Shape>(k % test::kShapeCount);
    const Polygon polygon = test::randomPolygon(shape, random);
    const DistanceField field(polygon, 0.05);
    const Transform pose = Transform::of(Vec2(random.uniform(-3.0, 3.0), 7.0), random.uniform(0.0, 6.0));
    const Points points = pointsFor(polygon.transformed(pose), 0.05, random, 500);
    for (const SimdTarget target : supportedSimdTargets()) {
      SCOPED_TRACE(std::to_string(k) + " " + std::string(name(target)));
      Answers answers(points.x.size());
      sampleBatch(field, pose, answers.batch(points.x, points.y), target);
      for (std::size_t i = 0; i < points.x.size(); ++i) {
        const Vec2 p(points.x[i], points.y[i]);
        FieldSample s = field.sample(pose.toLocal(p));
        const Vec2 closest = s.exact ? pose.toWorld(s.closest) : p;
        s.normal = pose.rotation.apply(s.normal);
        ASSERT_NO_FATAL_FAILURE(expectSame(answers, i, s, closest)) << i << " at " << p.transpose();
      }
    }
  }
}

TEST(FieldBatch, serves_a_world_of_overlapping_polygons_and_walls) {
  RandomStream random(13, 0);
  std::vector<Polygon> polygons;
  for (int k = 0; k < 12; ++k)
    polygons.push_back(test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random));
  std::vector<PlacedPolygon> placed;
  for (const Polygon& polygon : polygons) {
    placed.push_back({&polygon, Transform::of(Vec2(random.uniform(0.0, 3.0), random.uniform(0.0, 2.0)), 1.0)});
  }
  const WorldField field(placed, {{Vec2(0.0, 0.0), Vec2(3.0, 2.0)}, {true, true, true, false}}, 0.03);
  Points points;
  for (int k = 0; k < 20000; ++k) points.add(Vec2(random.uniform(-0.5, 3.5), random.uniform(-0.5, 2.5)));
  for (const SimdTarget target : supportedSimdTargets()) {
    Answers answers(points.x.size());
    sampleBatch(field, answers.batch(points.x, points.y), target);
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      const FieldSample s = field.sample(Vec2(points.x[i], points.y[i]));
      ASSERT_NO_FATAL_FAILURE(expectSame(answers, i, s, s.closest)) << i << " " << name(target);
    }
  }
}

TEST(FieldBatch, fills_only_the_columns_that_are_wanted) {
  const DistanceField field(Polygon::box({Vec2(0.0, 0.0), Vec2(1.0, 1.0)}), 0.2);
  const std::vector<double> x{0.5, 1.1, 5.0}, y{0.9, 1.1, 5.0};
  std::vector<double> distance(3);
  FieldBatch batch{.x = x, .y = y};
  batch.distance = distance;
  sampleBatch(field, Transform(), batch);
  EXPECT_DOUBLE_EQ(distance[0], -0.1);
  EXPECT_NEAR(distance[1], std::sqrt(0.02), 1e-15);
  EXPECT_GT(distance[2], 0.2);
}

TEST(FieldBatch, refuses_columns_that_do_not_fit) {
  const DistanceField field(Polygon::box({Vec2(0.0, 0.0), Vec2(1.0, 1.0)}), 0.2);
  const std::vector<double> three(3);
  std::vector<double> two(2), other(3);
  EXPECT_THROW(sampleBatch(field, Transform(), {.x = three, .y = two}), Error);
  FieldBatch batch{.x = three, .y = three};
  batch.distance = two;
  EXPECT_THROW(sampleBatch(field, Transform(), batch), Error);
  batch.distance = {};
  batch.normalX = other;
  EXPECT_THROW(sampleBatch(field, Transform(), batch), Error);
}

}  // namespace
}  // namespace froude
