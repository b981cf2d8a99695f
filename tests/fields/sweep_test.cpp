#include <gtest/gtest.h>

#include <froude/base/random.h>
#include <froude/fields/distance_field.h>
#include <froude/fields/sweep.h>

#include "support/polygon_generator.h"
#include "support/sweep_oracle.h"

namespace froude {
namespace {

const Polygon kSquare = Polygon::box({{-0.5, -0.5}, {0.5, 0.5}});
constexpr double kSkin = 1e-12;  // a generous bound of the contact skin near the origin

TEST(SweepDisc, meets_a_face_at_the_analytic_time) {
  const DistanceField field(kSquare, 0.5);
  for (const double radius : {0.0, 1e-3, 0.25, 0.5}) {
    const SweepHit hit = sweepDisc(field, {2.5, 0.25}, {-1.5, 0.125}, radius);
    ASSERT_TRUE(hit.hit);
    const double time = (2.0 - radius) / 4.0;
    EXPECT_NEAR(hit.time, time, kSkin);
    EXPECT_NEAR((hit.normal - Vec2(1, 0)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((hit.point - Vec2(0.5, 0.25 - 0.125 * time)).norm(), 0.0, kSkin);
    EXPECT_EQ(hit.edge, 1);
    EXPECT_GT(hit.center.x(), 0.5 + radius);
    EXPECT_FALSE(hit.startedInside);
  }
}

TEST(SweepDisc, meets_a_corner_at_the_analytic_time) {
  const DistanceField field(kSquare, 0.5);
  // Down the line x = 0.6 past the corner (0.5, 0.5): contact where the centre is 0.25 from it.
  const SweepHit hit = sweepDisc(field, {0.6, 2.0}, {0.6, -2.0}, 0.25);
  ASSERT_TRUE(hit.hit);
  const double y = 0.5 + std::sqrt(0.25 * 0.25 - 0.1 * 0.1);
  EXPECT_NEAR(hit.time, (2.0 - y) / 4.0, kSkin);
  EXPECT_NEAR((hit.point - Vec2(0.5, 0.5)).norm(), 0.0, kSkin);
  EXPECT_NEAR((hit.normal - Vec2(0.1, y - 0.5) / 0.25).norm(), 0.0, kSkin);
}

TEST(SweepDisc, grazing_is_decided_on_the_right_side_of_touching) {
  const DistanceField field(kSquare, 0.5);
  EXPECT_TRUE(sweepDisc(field, {-2, 0.75 - 1e-11}, {2, 0.75 - 1e-11}, 0.25).hit);
  EXPECT_FALSE(sweepDisc(field, {-2, 0.75 + 1e-11}, {2, 0.75 + 1e-11}, 0.25).hit);
  const double past = 0.5 + 0.25 / std::sqrt(2.0);
  EXPECT_TRUE(sweepDisc(field, {past + 1 - 1e-11, past - 1}, {past - 1 - 1e-11, past + 1}, 0.25).hit);
  EXPECT_FALSE(sweepDisc(field, {past + 1 + 1e-11, past - 1}, {past - 1 + 1e-11, past + 1}, 0.25).hit);
}

TEST(SweepDisc, a_point_on_the_boundary_hits_only_if_it_moves_in) {
  const DistanceField field(kSquare, 0.5);
  const Vec2 on(0.5, 0.1);
  EXPECT_FALSE(sweepDisc(field, on, on + Vec2(1.0, 0.3), 0.0).hit) << "outwards";
  EXPECT_FALSE(sweepDisc(field, on, on + Vec2(0.0, 0.3), 0.0).hit) << "along the edge";
  EXPECT_FALSE(sweepDisc(field, on, {0.5, 3.0}, 0.0).hit) << "along the edge and past its end";
  const SweepHit in = sweepDisc(field, on, on - Vec2(1e-9, 0.3), 0.0);
  EXPECT_TRUE(in.hit);
  EXPECT_EQ(in.time, 0.0);
  EXPECT_FALSE(in.startedInside);
  EXPECT_GT(in.center.x(), 0.5);
  EXPECT_FALSE(sweepDisc(field, on, on, 0.0).hit) << "not at all";
}

TEST(SweepDisc, a_point_on_a_corner_hits_only_if_it_moves_into_the_wedge) {
  const DistanceField field(kSquare, 0.5);
  const Vec2 corner(0.5, 0.5);
  for (int k = 0; k < 64; ++k) {
    const double angle = 2.0 * kPi * k / 64.0;
    const Vec2 step(std::round(1e6 * std::cos(angle)) * 1e-6, std::round(1e6 * std::sin(angle)) * 1e-6);
    const bool in = step.x() < 0.0 && step.y() < 0.0;
    EXPECT_EQ(sweepDisc(field, corner, corner + 0.25 * step, 0.0).hit, in) << angle;
  }
  // The concave corner of an L: in unless between the two faces.
  const DistanceField ell(Polygon::make({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}), 0.5);
  const Vec2 inner(1.0, 1.0);
  for (int k = 0; k < 64; ++k) {
    const double angle = 2.0 * kPi * k / 64.0;
    const Vec2 step(std::round(1e6 * std::cos(angle)) * 1e-6, std::round(1e6 * std::sin(angle)) * 1e-6);
    EXPECT_EQ(sweepDisc(ell, inner, inner + 0.25 * step, 0.0).hit, step.x() < 0.0 || step.y() < 0.0) << angle;
  }
}

TEST(SweepDisc, a_point_sliding_along_a_floor_into_a_wall_stops_at_the_wall) {
  const DistanceField ell(Polygon::make({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}), 0.5);
  const SweepHit hit = sweepDisc(ell, {1.75, 1.0}, {0.75, 1.0}, 0.0);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 0.75, kSkin);
  EXPECT_EQ(hit.normal, Vec2(1.0, 0.0));
  const SweepHit wide = sweepDisc(ell, {1.75, 1.25}, {0.75, 1.25}, 0.25);
  ASSERT_TRUE(wide.hit);
  EXPECT_NEAR(wide.time, 0.5, kSkin);
  EXPECT_EQ(wide.normal, Vec2(1.0, 0.0));
}

TEST(SweepDisc, a_disc_in_contact_may_leave_or_slide_but_not_enter) {
  const DistanceField field(kSquare, 0.5);
  const Vec2 touching(0.75, 0.1);
  EXPECT_FALSE(sweepDisc(field, touching, {3.0, 0.2}, 0.25).hit);
  EXPECT_FALSE(sweepDisc(field, touching, {0.75, 3.0}, 0.25).hit);
  const SweepHit in = sweepDisc(field, touching, {0.5, 0.2}, 0.25);
  EXPECT_TRUE(in.hit);
  EXPECT_EQ(in.time, 0.0);
}

TEST(SweepDisc, an_overlapping_start_gives_the_minimum_translation) {
  const DistanceField field(kSquare, 0.5);
  const SweepHit deep = sweepDisc(field, {0.3, 0.0}, {2.0, 0.0}, 0.0);
  EXPECT_TRUE(deep.hit);
  EXPECT_TRUE(deep.startedInside);
  EXPECT_EQ(deep.time, 0.0);
  EXPECT_EQ(deep.normal, Vec2(1.0, 0.0));
  EXPECT_NEAR((deep.point - Vec2(0.5, 0.0)).norm(), 0.0, 1e-15);
  const SweepHit shallow = sweepDisc(field, {0.0, 0.7}, {0.0, 2.0}, 0.25);
  EXPECT_TRUE(shallow.startedInside);
  EXPECT_EQ(shallow.normal, Vec2(0.0, 1.0));
  const DistanceField thinBand(kSquare, 0.01);
  EXPECT_TRUE(sweepDisc(thinBand, {0.1, 0.0}, {3.0, 0.0}, 0.0).startedInside) << "deeper than the band";
}

TEST(SweepDisc, no_path_and_no_number_are_no_hit) {
  const DistanceField field(kSquare, 0.5);
  EXPECT_FALSE(sweepDisc(field, {1, 0}, {1, 0}, 0.1).hit);
  EXPECT_FALSE(sweepDisc(field, {std::nan(""), 0}, {1, 0}, 0.1).hit);
  EXPECT_FALSE(sweepDisc(field, {1, 0}, {kInfinity, 0}, 0.1).hit);
  const RigidMotion motion{Transform(), {0, 0}, std::nan("")};
  EXPECT_FALSE(sweepDisc(field, motion, 0.1, {1, 0}, {-1, 0}, 0.1).hit);
}

TEST(SweepDisc, equals_brute_force_over_all_edges) {
  RandomStream random(21, 0);
  int hits = 0;
  for (int k = 0; k < 240; ++k) {
    const auto shape = static_cast<test::Shape>(k % test::kShapeCount);
    const test::Outline outline = test::makeOutline(shape, random);
    const double scale = k % 3 == 0 ? std::pow(10.0, random.uniform(-3.0, 3.0)) : 1.0;
    const Vec2 offset = k % 5 == 4 ? Vec2(-1e6, 1e6) : Vec2(0.0, 0.0);
    const Polygon polygon = test::placed(outline, scale, Transform::of(offset, random.uniform(0.0, 6.3)));
    const double band = scale * std::pow(10.0, random.uniform(-2.0, -0.5));
    const DistanceField field(polygon, band);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    const double unit = std::max(scale, offset.cwiseAbs().maxCoeff());
    for (int i = 0; i < 100; ++i) {
      const double reach = scale * std::pow(10.0, random.uniform(-1.0, 1.5));
      const Vec2 target =
          polygon.bounds().center() + scale * Vec2(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6));
      const double angle = random.uniform(0.0, 6.3);
      const Vec2 p = target + reach * Vec2(std::cos(angle), std::sin(angle));
      const Vec2 q = target - random.uniform() * reach * Vec2(std::cos(angle), std::sin(angle));
      const auto d = static_cast<double>(test::signedDistance(edges, p));
      const double radius = i % 3 == 0 ? 0.0 : random.uniform() * std::min(band, 0.9 * d);
      if (d <= radius + 1e-9 * unit) continue;
      const SweepHit hit = sweepDisc(field, p, q, radius);
      SCOPED_TRACE(outline.name + " " + std::to_string(k) + " path " + std::to_string(i));
      const std::optional<long double> wanted = test::firstTouch(edges, p, q, radius);
      const double length = (q - p).norm();
      if (!hit.hit) {
        ASSERT_FALSE(wanted.has_value());
        continue;
      }
      ++hits;
      // Never late. Early by no more than the skin takes to cross, which at a graze may be the whole approach.
      ASSERT_TRUE(!wanted || hit.time <= static_cast<double>(*wanted) + 1e-15 * unit / length);
      const Vec2 at = p + hit.time * (q - p);
      ASSERT_NEAR(static_cast<double>(test::boundaryDistance(edges, at)), radius, 2e-13 * std::max(unit, reach));
      ASSERT_GE(static_cast<double>(test::signedDistance(edges, hit.center)), radius);
      ASSERT_NEAR((hit.point + radius * hit.normal - hit.center).norm(), 0.0, 1e-12 * std::max(unit, reach));
      ASSERT_NEAR(hit.normal.norm(), 1.0, 1e-14);
      ASSERT_LE(hit.normal.dot(q - p), 0.02 * length) << "the normal opposes the motion";
      if (wanted && std::abs(hit.normal.dot(q - p)) > 0.05 * length) {
        ASSERT_NEAR(hit.time, static_cast<double>(*wanted), 5e-12 * std::max(unit, reach) / length);
      }
    }
  }
  EXPECT_GT(hits, 4000);
}

TEST(SweepMovingPolygon, a_turning_rod_meets_a_resting_point_at_the_analytic_time) {
  // A rod of length 1 and half thickness h about the origin: its flank meets the point (ρ, 0) where ρ sin θ = h.
  const double h = 0.5e-4;
  const DistanceField rod(Polygon::box({{0.0, -h}, {1.0, h}}), 0.05);
  for (const double spin : {0.5, 2.0, -3.0, 40.0}) {
    for (const double angle : {-1.0, -0.2, -2.5}) {
      const double start = spin > 0.0 ? angle : -angle;
      const RigidMotion motion{Transform::of({0, 0}, start), {0, 0}, spin};
      const Vec2 point(0.7, 0.0);
      const double wanted = (std::abs(start) - std::asin(h / 0.7)) / std::abs(spin);
      const double dt = 1.3 * wanted;
      const SweepHit hit = sweepDisc(rod, motion, dt, point, point, 0.0);
      ASSERT_TRUE(hit.hit) << spin << ' ' << angle;
      EXPECT_NEAR(hit.time * dt, wanted, 1e-12 * wanted);
      EXPECT_NEAR((hit.point - point).norm(), 0.0, 1e-12);
      EXPECT_NEAR(hit.normal.dot(Vec2(0.0, spin)) / std::abs(spin), 1.0, 1e-6);
      EXPECT_FALSE(sweepDisc(rod, motion, 0.9 * wanted, point, point, 0.0).hit);
    }
  }
}

TEST(SweepMovingPolygon, a_turning_square_meets_a_resting_disc_with_its_corner) {
  // The corner at distance √½ turns towards a disc on the x axis: contact where their distance is the radius.
  const DistanceField square(kSquare, 0.3);
  const double arm = std::sqrt(0.5);
  const double radius = 0.1;
  const double x = 0.8;
  const double cosine = (arm * arm + x * x - radius * radius) / (2.0 * arm * x);
  const double spin = 5.0;
  const RigidMotion motion{Transform(), {0, 0}, spin};
  // The lower right corner starts at −45 degrees.
  const double wanted = (0.25 * kPi - std::acos(cosine)) / spin;
  const SweepHit hit = sweepDisc(square, motion, 0.2, {x, 0}, {x, 0}, radius);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time * 0.2, wanted, 1e-12);
}

TEST(SweepMovingPolygon, only_relative_motion_counts) {
  const DistanceField square(kSquare, 0.3);
  const RigidMotion motion{Transform::of({0, 0}, 0.0), {3.0, 0.0}, 0.0};
  const SweepHit hit = sweepDisc(square, motion, 1.0, {2.0, 0.0}, {2.0, 0.0}, 0.25);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 1.25 / 3.0, kSkin);
  EXPECT_NEAR((hit.point - Vec2(1.75, 0.0)).norm(), 0.0, kSkin);
  EXPECT_FALSE(sweepDisc(square, motion, 1.0, {2.0, 0.0}, {5.0, 0.0}, 0.25).hit) << "carried along";
}

TEST(SweepMovingPolygon, more_than_half_a_turn_in_one_step_misses_nothing) {
  const double h = 0.5e-4;
  const DistanceField rod(Polygon::box({{0.0, -h}, {1.0, h}}), 0.05);
  for (int k = 1; k < 60; ++k) {
    const double angle = 2.0 * kPi * k / 60.0;
    const RigidMotion motion{Transform(), {0, 0}, 2.0 * kPi};
    const Vec2 point(0.8 * std::cos(angle), 0.8 * std::sin(angle));
    const SweepHit hit = sweepDisc(rod, motion, 1.0, point, point, 0.01);
    ASSERT_TRUE(hit.hit) << k;
    EXPECT_NEAR(hit.time * 2.0 * kPi, angle - std::asin((h + 0.01) / 0.8), 1e-10) << k;
  }
}

TEST(SweepMovingPolygon, a_thousand_metres_a_second_do_not_pass_a_plate_of_a_tenth_of_a_millimetre) {
  const DistanceField plate(Polygon::box({{-0.5, -0.5e-4}, {0.5, 0.5e-4}}), 0.01);
  RandomStream random(22, 0);
  for (int k = 0; k < 5000; ++k) {
    const double spin = random.uniform(-50.0, 50.0);
    const double dt = std::pow(10.0, random.uniform(-4.0, -2.0));
    const RigidMotion motion{
        Transform::of({0, 0}, random.uniform(-0.3, 0.3)), {0.0, random.uniform(-100.0, 100.0)}, spin};
    const double speed = 1000.0 + std::abs(motion.velocity.y());
    const double mid = random.uniform(0.2, 0.8);
    const Transform pose = motion.at(mid * dt);
    const Vec2 target = pose.toWorld({random.uniform(-0.3, 0.3), 0.0});
    const Vec2 velocity = pose.rotation.apply({random.uniform(-300.0, 300.0), -speed});
    const Vec2 from = target - mid * dt * velocity;
    const Vec2 to = target + (1.0 - mid) * dt * velocity;
    const double radius = k % 2 == 0 ? 0.0 : 0.005;
    const SweepHit hit = sweepDisc(plate, motion, dt, from, to, radius);
    ASSERT_TRUE(hit.hit) << k;
    if (hit.startedInside) continue;
    ASSERT_LE(hit.time, mid);
    const Vec2 local = motion.at(hit.time * dt).toLocal(hit.center);
    ASSERT_NEAR(static_cast<double>(test::signedDistance(test::oracleEdges(plate.polygon()), local)), radius, 1e-6);
  }
}

TEST(SweepMovingPolygon, in_contact_it_may_leave_or_be_left) {
  const DistanceField square(kSquare, 0.3);
  const Vec2 on(0.5, 0.2);
  const RigidMotion still{Transform(), {0, 0}, 0.0};
  EXPECT_FALSE(sweepDisc(square, still, 1.0, on, {2.0, 0.2}, 0.0).hit);
  EXPECT_TRUE(sweepDisc(square, still, 1.0, on, {0.4, 0.2}, 0.0).hit);
  const RigidMotion turning{Transform(), {0, 0}, -0.4};  // the upper half of the right face turns away
  EXPECT_TRUE(sweepDisc(square, turning, 1.0, on, on, 0.0).hit) << "the face's lower end comes along";
  const RigidMotion leaving{Transform(), {-1, 0}, -0.4};
  EXPECT_FALSE(sweepDisc(square, leaving, 1.0, on, {1.5, 0.2}, 0.0).hit);
  EXPECT_FALSE(sweepDisc(square, leaving, 1.0, {0.75, 0.2}, {1.5, 0.2}, 0.25).hit);
}

TEST(SweepMovingPolygon, agrees_with_a_scan_in_time) {
  RandomStream random(23, 0);
  int hits = 0;
  int misses = 0;
  for (int k = 0; k < 48; ++k) {
    const Polygon polygon = test::randomPolygon(static_cast<test::Shape>(k % test::kShapeCount), random);
    const double band = 0.05;
    const DistanceField field(polygon, band);
    const std::vector<test::OracleEdge> edges = test::oracleEdges(polygon);
    for (int i = 0; i < 12; ++i) {
      RigidMotion motion;
      motion.start = Transform::of({random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0, 6.3));
      motion.velocity = {random.uniform(-2, 2), random.uniform(-2, 2)};
      motion.spin = random.uniform(-1, 1) * (i % 4 == 0 ? 8.0 : 1.0);
      const double angle = random.uniform(0.0, 6.3);
      const Vec2 aside = 1.2 * Vec2(std::cos(angle), std::sin(angle));
      const Vec2 from = motion.start.position + aside;
      const Vec2 to = motion.at(1.0).position + Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
      const double radius = i % 2 == 0 ? 0.0 : random.uniform(0.0, band);
      if (test::signedDistance(edges, motion.start.toLocal(from)) < radius + 1e-6) continue;
      SCOPED_TRACE(std::to_string(k) + " motion " + std::to_string(i));
      const SweepHit hit = sweepDisc(field, motion, 1.0, from, to, radius);
      const std::optional<double> scan = test::scanForTouch(edges, motion, 1.0, from, to, radius, 800);
      if (!hit.hit) {
        ASSERT_FALSE(scan.has_value());
        ++misses;
        continue;
      }
      ++hits;
      ASSERT_TRUE(!scan || hit.time <= *scan + 1e-12);
      const Vec2 local = test::inFrame(motion, 1.0, from, to, hit.time);
      ASSERT_NEAR(static_cast<double>(test::signedDistance(edges, local)), radius, 2e-6);
      ASSERT_GE(static_cast<double>(test::signedDistance(edges, motion.at(hit.time).toLocal(hit.center))),
                radius - 1e-15);
      ASSERT_NEAR((hit.point + radius * hit.normal - hit.center).norm(), 0.0, 1e-5);
    }
  }
  EXPECT_GT(hits, 150);
  EXPECT_GT(misses, 30);
}

}  // namespace
}  // namespace froude
