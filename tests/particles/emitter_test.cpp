#include <froude/particles/emitter.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace {

using namespace froude;

constexpr double kSpacing = 0.01;

EmitterDef fluidDef() {
  EmitterDef def;
  def.kind = EmitterDef::Kind::Fluid;
  def.from = {0.4, 2.5};
  def.to = {0.2, 2.5};
  def.speed = 2.0;
  def.stop = 1.0;
  return def;
}

EmitterDef bulletDef() {
  EmitterDef def = fluidDef();
  def.kind = EmitterDef::Kind::Bullet;
  def.rate = 1000.0;
  def.spread = 0.3;
  return def;
}

struct Shot {
  Vec2 position, velocity;
  double seen;  // end of the step that placed it
};

// All that comes until `until`, in steps of the lengths that `step` gives; everything moved on to that time.
std::vector<Shot> run(Emitter& emitter, double until, const std::function<double(int)>& step, double t = 0.0) {
  std::vector<Shot> shots;
  for (int k = 0; t < until; ++k) {
    const double dt = std::min(step(k), until - t);
    const std::size_t expected = emitter.pending(t, dt);
    const std::size_t placed = emitter.emit(t, dt, [&](const Vec2& p, const Vec2& v) {
      shots.push_back({p + (until - (t + dt)) * v, v, t + dt});
    });
    EXPECT_EQ(placed, expected);
    t += dt;
  }
  return shots;
}

double steady(int) { return 0.001; }

TEST(Emitter, fluid_leaves_to_the_left_normal_of_the_nozzle) {
  Emitter emitter(fluidDef(), kSpacing, 1, 0);
  EXPECT_LT((emitter.direction() - Vec2(0.0, -1.0)).norm(), 1e-15);
  for (const Shot& s : run(emitter, 0.2, steady)) {
    EXPECT_LT((s.velocity - Vec2(0.0, -2.0)).norm(), 1e-14);
    EXPECT_LE(s.position.y(), 2.5);
  }
}

TEST(Emitter, fluid_forms_a_lattice_of_rows_one_spacing_apart) {
  Emitter emitter(fluidDef(), kSpacing, 1, 0);
  EXPECT_EQ(emitter.perEvent(), 20u);
  const double until = 0.1;
  const auto shots = run(emitter, until, steady);
  const std::size_t rows = shots.size() / 20;
  EXPECT_EQ(rows, 20u);  // 0.1 s · 2 m/s / 0.01 m, the first at t = 0
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t k = 0; k < 20; ++k) {
      const Vec2 expected{0.4 - (static_cast<double>(k) + 0.5) * kSpacing,
                          2.5 - 2.0 * until + static_cast<double>(row) * kSpacing};
      EXPECT_LT((shots[row * 20 + k].position - expected).norm(), 1e-12) << row << " " << k;
    }
  }
}

TEST(Emitter, a_nozzle_that_is_no_whole_number_of_spacings_is_filled_from_its_middle) {
  EmitterDef def = fluidDef();
  def.from = {0.0, 0.0};
  def.to = {0.0, 0.057};
  Emitter emitter(def, kSpacing, 1, 0);
  EXPECT_EQ(emitter.perEvent(), 5u);
  const auto shots = run(emitter, 0.001, steady);
  ASSERT_EQ(shots.size(), 5u);
  EXPECT_NEAR(shots[0].position.y() + shots[4].position.y(), 0.057, 1e-15);
  EXPECT_NEAR(shots[4].position.y() - shots[0].position.y(), 0.04, 1e-15);
}

TEST(Emitter, the_jet_does_not_depend_on_how_time_is_divided) {
  for (const EmitterDef& def : {fluidDef(), bulletDef()}) {
    Emitter reference(def, kSpacing, 9, 4);
    const auto expected = run(reference, 0.3, steady);
    ASSERT_GT(expected.size(), 100u);
    RandomStream random(1, 1);
    const std::vector<std::function<double(int)>> divisions{[](int) { return 0.3; }, [](int) { return 1.7e-5; },
                                                            [](int k) { return k % 2 == 0 ? 0.005 : 0.0; },
                                                            [&random](int) { return random.uniform(0.0, 0.02); }};
    for (const auto& division : divisions) {
      Emitter emitter(def, kSpacing, 9, 4);
      const auto shots = run(emitter, 0.3, division);
      ASSERT_EQ(shots.size(), expected.size());
      for (std::size_t i = 0; i < shots.size(); ++i) {
        ASSERT_LT((shots[i].position - expected[i].position).norm(), 1e-12);
        ASSERT_EQ(shots[i].velocity, expected[i].velocity);
      }
    }
  }
}

TEST(Emitter, steps_that_end_exactly_at_an_event_neither_lose_nor_double_it) {
  EmitterDef def = bulletDef();
  for (const double rate : {10.0, 30.0, 1000.0, 7.0}) {
    def.rate = rate;
    def.stop = kInfinity;
    Emitter emitter(def, kSpacing, 1, 0);
    double t = 0.0;
    for (int k = 0; k < 5000; ++k) {
      const double next = (k + 1) / rate;
      EXPECT_LE(emitter.pending(t, next - t), 2u);
      emitter.emit(t, next - t, [](const Vec2&, const Vec2&) {});
      EXPECT_LE(std::abs(static_cast<double>(emitter.events()) - (k + 1.5)), 0.5);
      t = next;
    }
  }
}

TEST(Emitter, bullets_start_on_the_nozzle_within_the_spread_at_the_rate) {
  EmitterDef def = bulletDef();
  def.stop = kInfinity;
  Emitter emitter(def, kSpacing, 1, 0);
  double lowest = 1.0, highest = -1.0, count = 0.0, left = 1.0, right = 0.0;
  for (int k = 0; k < 10000; ++k) {
    emitter.emit(k * 0.001, 0.001, [&](const Vec2& p, const Vec2& v) {
      count += 1.0;
      EXPECT_NEAR(v.norm(), 2.0, 1e-13);
      const double angle = std::atan2(v.x(), -v.y());
      lowest = std::min(lowest, angle);
      highest = std::max(highest, angle);
      const double age = (2.5 - p.y()) / -v.y();
      EXPECT_LE(age, 0.001 + 1e-12);
      const double start = p.x() - age * v.x();
      left = std::min(left, start);
      right = std::max(right, start);
      EXPECT_GE(start, 0.2 - 1e-12);
      EXPECT_LE(start, 0.4 + 1e-12);
    });
  }
  EXPECT_EQ(count, 10000.0);
  EXPECT_NEAR(lowest, -0.3, 0.001);
  EXPECT_NEAR(highest, 0.3, 0.001);
  EXPECT_NEAR(left, 0.2, 0.001);
  EXPECT_NEAR(right, 0.4, 0.001);
}

TEST(Emitter, emitters_of_one_scene_shoot_differently_and_the_same_again) {
  const auto first = [](std::uint64_t seed, std::uint64_t index) {
    Emitter emitter(bulletDef(), kSpacing, seed, index);
    return run(emitter, 0.001, steady).front().position;
  };
  EXPECT_NE(first(1, 0), first(1, 1));
  EXPECT_NE(first(1, 0), first(2, 0));
  EXPECT_EQ(first(1, 0), first(1, 0));
}

TEST(Emitter, works_between_start_and_stop_only) {
  EmitterDef def = fluidDef();
  def.start = 0.2;
  def.stop = 0.3;
  Emitter emitter(def, kSpacing, 1, 0);
  EXPECT_EQ(emitter.pending(0.0, 0.2), 0u);
  const auto shots = run(emitter, 1.0, [](int) { return 0.07; });
  EXPECT_EQ(shots.size(), 20u * 20u);
  for (const Shot& s : shots) {
    EXPECT_GE(s.position.y(), 2.5 - 2.0 * 0.8 - 1e-12);
    EXPECT_LE(s.position.y(), 2.5 - 2.0 * 0.7 + 1e-12);
  }
}

TEST(Emitter, what_fell_into_a_gap_is_skipped) {
  Emitter emitter(bulletDef(), kSpacing, 1, 0);
  EXPECT_LE(emitter.pending(0.5, 0.01), 11u);
  emitter.emit(0.5, 0.01, [](const Vec2& p, const Vec2&) { EXPECT_GT(p.y(), 2.5 - 0.021); });
}

TEST(Emitter, a_loaded_emitter_goes_on_exactly) {
  for (const EmitterDef& def : {fluidDef(), bulletDef()}) {
    Emitter emitter(def, kSpacing, 3, 1), resumed(def, kSpacing, 3, 1);
    run(emitter, 0.0337, steady);
    MemorySnapshot snapshot;
    snapshot.save([&](Archive& a) { emitter.archive(a); });
    snapshot.load([&](Archive& a) { resumed.archive(a); });
    const auto expected = run(emitter, 0.2, steady, 0.0337);
    const auto shots = run(resumed, 0.2, steady, 0.0337);
    ASSERT_EQ(shots.size(), expected.size());
    for (std::size_t i = 0; i < shots.size(); ++i) EXPECT_EQ(shots[i].position, expected[i].position);
    snapshot.load([&](Archive& a) { emitter.archive(a); });
    EXPECT_EQ(run(emitter, 0.2, steady, 0.0337).size(), expected.size()) << "time went back";
  }
}

TEST(Emitter, what_finds_no_room_is_refused_for_good_and_counted) {
  EmitterDef def = fluidDef();
  def.limit = 50;
  Emitter emitter(def, kSpacing, 1, 0);
  EXPECT_EQ(emitter.room(0), 50u);
  EXPECT_EQ(emitter.room(45), 5u);
  EXPECT_EQ(emitter.room(60), 0u);
  const auto ignore = [](const Vec2&, const Vec2&) {};
  EXPECT_EQ(emitter.emit(0.0, 0.0199, ignore, emitter.room(0)), 50u);  // 4 rows of 20
  EXPECT_EQ(emitter.refused(), 30u);
  EXPECT_EQ(emitter.emit(0.0199, 0.005, ignore, emitter.room(0)), 20u);
  def.policy = GrowthPolicy::Grow;
  EXPECT_GT(Emitter(def, kSpacing, 1, 0).room(1000), std::size_t{1} << 40);
}

TEST(Emitter, a_step_of_no_length_lets_nothing_in) {
  Emitter emitter(fluidDef(), kSpacing, 1, 0);
  EXPECT_EQ(emitter.pending(0.0, 0.0), 0u);
  EXPECT_EQ(emitter.expiry(3.0), kInfinity);
}

TEST(Emitter, definitions_that_cannot_work_are_refused_in_words) {
  const auto refusal = [](const std::function<void(EmitterDef&)>& spoil, EmitterDef def) -> std::string {
    spoil(def);
    def.name = "tap";
    try {
      Emitter(def, kSpacing, 1, 0);
    } catch (const EmitterError& e) {
      return e.what();
    }
    return "nothing was thrown";
  };
  const auto expect = [&](const char* word, const std::function<void(EmitterDef&)>& spoil, const EmitterDef& def) {
    const std::string message = refusal(spoil, def);
    EXPECT_NE(message.find(word), std::string::npos) << message;
    EXPECT_NE(message.find("'tap'"), std::string::npos) << message;
  };
  const EmitterDef fluid = fluidDef(), bullet = bulletDef();
  expect(
      "finite", [](EmitterDef& d) { d.from.x() = std::nan(""); }, fluid);
  expect(
      "length", [](EmitterDef& d) { d.to = d.from; }, bullet);
  expect(
      "shorter", [](EmitterDef& d) { d.to = d.from + Vec2(0.009, 0.0); }, fluid);
  expect(
      "speed", [](EmitterDef& d) { d.speed = 0.0; }, fluid);
  expect(
      "speed", [](EmitterDef& d) { d.speed = -1.0; }, bullet);
  expect(
      "rate", [](EmitterDef& d) { d.rate = 0.0; }, bullet);
  expect(
      "spread", [](EmitterDef& d) { d.spread = 4.0; }, bullet);
  expect(
      "spread", [](EmitterDef& d) { d.spread = std::nan(""); }, bullet);
  expect(
      "stop", [](EmitterDef& d) { d.stop = d.start; }, fluid);
  expect(
      "lifetime", [](EmitterDef& d) { d.lifetime = 0.0; }, fluid);
  expect(
      "limit", [](EmitterDef& d) { d.limit = 0; }, fluid);
  EXPECT_EQ(refusal([](EmitterDef& d) { d.speed = 0.0; }, bullet), "nothing was thrown");
}

}  // namespace
