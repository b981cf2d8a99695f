// Times of impact against closed forms.
#include <froude/solver/contact/time_of_impact.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/convex_pairs.h"
#include "support/pair_oracle.h"

namespace froude {
namespace {

using namespace test;

TEST(TimeOfImpact, a_fast_small_box_meets_a_thin_wall) {
  const ConvexShape wall(rectangle(0.001, 5)), bullet(rectangle(0.01, 0.01));
  const RigidMotion still, flight{{{-100, 0}, {}}, {1000, 0}, 50.0};
  const TimeOfImpact hit = timeOfImpact(wall, still, bullet, flight, 1.0, 1e-4);
  ASSERT_EQ(hit.status, ImpactStatus::Hit);
  EXPECT_NEAR(hit.time, 0.1, 2e-5);
}

TEST(TimeOfImpact, a_spinning_rod_meets_a_plane_when_its_end_does) {
  const double h = 0.6, w = 2.0, target = 1e-5;
  const ConvexShape floor(rectangle(10, 1, {0, -1 - h})), rod({{-1, -1e-9}, {1, -1e-9}, {1, 1e-9}, {-1, 1e-9}});
  const TimeOfImpact hit = timeOfImpact(floor, {}, rod, {{}, {0, 0}, w}, 1.0, target);
  ASSERT_EQ(hit.status, ImpactStatus::Hit);
  EXPECT_NEAR(hit.time, std::asin(h) / w, 2 * target);
  EXPECT_LE(hit.steps, 10);
}

std::vector<Vec2> ringOf(const nlohmann::json& points) {
  std::vector<Vec2> ring;
  for (const auto& p : points) ring.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
  return ring;
}

TEST(TimeOfImpact, golden_translations_meet_at_their_times) {
  std::ifstream file(std::string(FROUDE_TEST_DATA) + "/geometry_toi.json");
  const nlohmann::json golden = nlohmann::json::parse(file);
  const double target = 1e-9;
  int tried = 0;
  for (const auto& entry : golden.at("cases")) {
    if (entry.at("kind") != "translate") continue;
    ++tried;
    const ConvexShape a(ringOf(entry.at("A"))), b(ringOf(entry.at("B")));
    const Vec2 velocity(entry.at("vB").at(0).get<double>(), entry.at("vB").at(1).get<double>());
    const TimeOfImpact hit = timeOfImpact(a, {}, b, {{}, velocity, 0.0}, 20.0, target);
    if (entry.at("toi").is_null()) {
      EXPECT_EQ(hit.status, ImpactStatus::Separate) << entry.at("name");
      continue;
    }
    ASSERT_EQ(hit.status, ImpactStatus::Hit) << entry.at("name");
    const double truth = entry.at("toi").get<double>();
    EXPECT_LE(hit.time, truth) << entry.at("name");
    EXPECT_NEAR(hit.time, truth, 10 * target) << entry.at("name");
  }
  EXPECT_EQ(tried, 5);
}

TEST(TimeOfImpact, golden_turns_meet_at_their_times) {
  // h, v, w and the half sizes as in tests/data/geometry_toi.json; the floor's top is at 0.
  struct Case {
    double a, b, height, fall, spin, time;
  };
  const double target = 1e-9;
  const ConvexShape floor(rectangle(20, 1, {0, -1}));
  for (const Case& c : {Case{1, 1e-10, 0.6, 0, 2, 0.3217505543966422}, Case{1, 0.25, 0.8, 0, 1.5, 0.42900073919552295},
                        Case{1, 1e-10, 2, -1, 3, 1.3038643902017732}}) {
    const ConvexShape body(rectangle(c.a, c.b));
    const TimeOfImpact hit = timeOfImpact(floor, {}, body, {{{0, c.height}, {}}, {0, c.fall}, c.spin}, 3.0, target);
    ASSERT_EQ(hit.status, ImpactStatus::Hit) << c.time;
    EXPECT_NEAR(hit.time, c.time, 20 * target);
    EXPECT_LE(hit.time, c.time);
  }
}

TEST(TimeOfImpact, what_touches_at_the_start_and_leaves_is_separate) {
  const ConvexShape a(rectangle(1, 1)), b(rectangle(1, 1));
  for (const double gap : {0.0, 0.0005, 0.001}) {
    const auto moving = [&](const Vec2& v) {
      return timeOfImpact(a, {}, b, {{{2.0 + gap, 0.3}, {}}, v, 0.0}, 1.0, 0.001);
    };
    EXPECT_EQ(moving({0.5, 0}).status, ImpactStatus::Separate) << gap;
    EXPECT_EQ(moving({0, 3}).status, ImpactStatus::Separate) << gap;  // along the side
    const TimeOfImpact hit = moving({-0.5, 0});
    EXPECT_EQ(hit.status, ImpactStatus::Hit) << gap;
    EXPECT_EQ(hit.time, 0.0);
  }
}

TEST(TimeOfImpact, overlap_at_the_start_and_numbers_that_are_not_finite_have_a_status) {
  const ConvexShape a(rectangle(1, 1));
  EXPECT_EQ(timeOfImpact(a, {}, a, {{{1, 0}, {}}, {1, 0}, 0.0}, 1.0, 0.001).status, ImpactStatus::Overlapping);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(timeOfImpact(a, {}, a, {{{5, 0}, {}}, {nan, 0}, 0.0}, 1.0, 0.001).status, ImpactStatus::Failed);
  EXPECT_EQ(timeOfImpact(a, {}, a, {{{nan, 0}, {}}, {1, 0}, 0.0}, 1.0, 0.001).status, ImpactStatus::Failed);
  EXPECT_EQ(timeOfImpact(a, {}, a, {{{5, 0}, {}}, {-1, 0}, nan}, 9.0, 0.001).status, ImpactStatus::Failed);
}

TEST(TimeOfImpact, grazing_past_within_the_target_or_outside_it) {
  const ConvexShape a(rectangle(1, 1)), b(rectangle(1, 1));
  const auto past = [&](double gap, double spin) {
    return timeOfImpact(a, {}, b, {{{-10, 2.0 + gap}, {}}, {5, 0}, spin}, 4.0, 0.001);
  };
  EXPECT_EQ(past(0.002, 0.0).status, ImpactStatus::Separate);
  // Within the target, though its edge only slides past: met when the first corners come near.
  const TimeOfImpact hit = past(0.0005, 0.0);
  ASSERT_EQ(hit.status, ImpactStatus::Hit);
  EXPECT_NEAR(hit.time, 8.0 / 5.0, 0.001);
  // The diagonal of a turning box reaches √2 − 1 farther than its side.
  EXPECT_EQ(past(std::sqrt(2.0) - 1.0 + 0.002, 40.0).status, ImpactStatus::Separate);
  EXPECT_EQ(past(std::sqrt(2.0) - 1.0 - 0.01, 40.0).status, ImpactStatus::Hit);
}

TEST(LongTimeOfImpact, random_pairs_are_never_late_and_never_missed) {
  const int pairs = std::getenv("FROUDE_LONG") != nullptr ? 100'000 : 4'000;
  RandomStream random(10, 1);
  const double target = 1e-3;
  int hits = 0, separate = 0;
  for (int k = 0; k < pairs; ++k) {
    const ConvexShape a(roundRing(random, 3 + random.below(6), random.uniform(0.02, 1.0)));
    const ConvexShape b(roundRing(random, 3 + random.below(6), random.uniform(0.02, 1.0)));
    const auto motion = [&](const Vec2& at) {
      return RigidMotion{Transform::of(at, turnAtRandom(random)), random.uniform(0.0, 6.0) * unit(turnAtRandom(random)),
                         random.uniform(-10.0, 10.0)};
    };
    const RigidMotion motionA = motion({0, 0}), motionB = motion(random.uniform(1.0, 4.0) * unit(turnAtRandom(random)));
    const auto separation = [&](double t) {
      const RealRing ringA = placed(a.vertices(), motionA.at(t)), ringB = placed(b.vertices(), motionB.at(t));
      const Real s = oracleAxis(ringA, ringB).separation;
      return static_cast<double>(s > 0 ? oracleDistance(ringA, ringB) : s);
    };
    const TimeOfImpact impact = timeOfImpact(a, motionA, b, motionB, 1.0, target);
    const double start = separation(0.0);
    ASSERT_EQ(impact.status == ImpactStatus::Overlapping, start < 0.0) << k;
    if (start < target) continue;
    ASSERT_NE(impact.status, ImpactStatus::Failed) << k;
    for (int i = 0; i <= 100; ++i)
      ASSERT_GT(separation(impact.time * i / 100.0), (1.0 - 1e-9) * target) << k << ' ' << i;
    if (impact.status == ImpactStatus::Hit) {
      ++hits;
      ASSERT_LE(separation(impact.time), 1.1 * target * (1.0 + 1e-9)) << k;
    } else {
      ++separate;
      ASSERT_EQ(impact.time, 1.0) << k;
    }
  }
  EXPECT_GT(hits, pairs / 10);
  EXPECT_GT(separate, pairs / 10);
}

}  // namespace
}  // namespace froude
