#include <froude/particles/sink.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <froude/base/random.h>

namespace {

using namespace froude;

void scatter(ParticlePool& pool, std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, 2);
  for (std::size_t i = 0; i < count; ++i) {
    pool.create();
    pool.x()[i] = random.uniform(-1.0, 4.0);
    pool.y()[i] = random.uniform(-1.0, 4.0);
  }
}

SinkSet threeSinks() {
  SinkSet sinks;
  sinks.add(Polygon::box({{0.0, 0.0}, {1.0, 1.0}}));
  sinks.add(Polygon::make({{0.5, 0.5}, {3.0, 0.5}, {3.0, 3.0}, {2.0, 1.0}}));
  sinks.add(Polygon::regular(6, 0.4).transformed(Transform::of({3.2, 3.2}, 0.2)));
  return sinks;
}

TEST(SinkSet, swallows_what_is_inside_and_counts_it_for_the_first_sink_on_any_number_of_threads) {
  const Polygon concave = Polygon::make({{0.5, 0.5}, {3.0, 0.5}, {3.0, 3.0}, {2.0, 1.0}});
  const Polygon hexagon = Polygon::regular(6, 0.4).transformed(Transform::of({3.2, 3.2}, 0.2));
  for (const int threads : {1, 2, 3, 7}) {
    SinkSet sinks = threeSinks();
    ParticlePool pool({10000, GrowthPolicy::Fixed, "p"});
    scatter(pool, 10000, 4);
    pool.kill(5);
    std::vector<std::uint64_t> expected(3, 0);
    std::vector<bool> inside;
    for (std::uint32_t i = 0; i < pool.size(); ++i) {
      const Vec2 p{pool.x()[i], pool.y()[i]};
      const int sink = std::max(std::abs(p.x() - 0.5), std::abs(p.y() - 0.5)) <= 0.5 ? 0
                       : concave.contains(p)                                         ? 1
                       : hexagon.contains(p)                                         ? 2
                                                                                     : -1;
      EXPECT_EQ(sinks.sinkAt(p), sink);
      if (sink >= 0 && i != 5) ++expected[static_cast<std::size_t>(sink)];
      inside.push_back(sink >= 0 || i == 5);
    }
    std::size_t marked = 0;
    tbb::task_arena(threads).execute([&] { marked = sinks.mark(pool); });
    EXPECT_EQ(marked, expected[0] + expected[1] + expected[2]);
    EXPECT_EQ(std::vector<std::uint64_t>(sinks.counts().begin(), sinks.counts().end()), expected);
    for (std::uint32_t i = 0; i < pool.size(); ++i) ASSERT_EQ(pool.isMarked(i), inside[i]) << i;
    EXPECT_EQ(sinks.mark(pool), 0u) << "what is marked is not counted again";
    pool.compact();
    EXPECT_EQ(sinks.mark(pool), 0u);
  }
}

TEST(SinkSet, no_sink_and_no_particle_are_nothing_to_do) {
  SinkSet none;
  ParticlePool pool({10, GrowthPolicy::Fixed, "p"});
  EXPECT_EQ(none.mark(pool), 0u);
  EXPECT_EQ(none.sinkAt({0.0, 0.0}), -1);
  SinkSet sinks = threeSinks();
  EXPECT_EQ(sinks.mark(pool), 0u);
  pool.create();
  pool.x()[0] = std::nan("");
  EXPECT_EQ(sinks.mark(pool), 0u);
}

TEST(SinkSet, counts_are_saved_and_another_number_of_sinks_is_refused) {
  SinkSet sinks = threeSinks(), other = threeSinks(), none;
  ParticlePool pool({100, GrowthPolicy::Fixed, "p"});
  scatter(pool, 100, 5);
  sinks.mark(pool);
  MemorySnapshot snapshot;
  snapshot.save([&](Archive& a) { sinks.archive(a); });
  snapshot.load([&](Archive& a) { other.archive(a); });
  EXPECT_TRUE(std::equal(sinks.counts().begin(), sinks.counts().end(), other.counts().begin()));
  EXPECT_GT(other.counts()[0], 0u);
  EXPECT_THROW(snapshot.load([&](Archive& a) { none.archive(a); }), Error);
}

TEST(Lifetime, particles_expire_at_their_time_and_not_before) {
  ParticlePool pool({10, GrowthPolicy::Fixed, "p"});
  const auto expires = pool.addColumn<double>("expires", ColumnKind::State);
  for (const double t : {1.0, 2.0, kInfinity, std::nan(""), 3.0}) {
    pool.create();
    pool.column(expires).back() = t;
  }
  EXPECT_EQ(markExpired(pool, expires, 0.999), 0u);
  EXPECT_EQ(markExpired(pool, expires, 2.0), 2u);
  EXPECT_EQ(markExpired(pool, expires, 2.0), 0u);
  pool.compact();
  EXPECT_EQ(markExpired(pool, expires, 1e300), 1u);
  pool.compact();
  EXPECT_EQ(markExpired(pool, expires, kInfinity), 0u);
  EXPECT_EQ(pool.size(), 2u);
}

TEST(Oldest, of_one_emitter_are_marked_and_no_others) {
  constexpr std::size_t kCount = 5000;
  ParticlePool pool({kCount, GrowthPolicy::Fixed, "p"});
  const auto source = pool.addColumn<std::uint32_t>("source", ColumnKind::State);
  RandomStream random(1, 6);
  for (std::size_t i = 0; i < kCount; ++i) {
    pool.create();
    pool.column(source)[i] = random.below(3);
  }
  std::vector<std::uint32_t> order(kCount);
  for (std::size_t i = 0; i < kCount; ++i) order[i] = static_cast<std::uint32_t>((i * 1237) % kCount);
  pool.permute(order);
  for (const std::size_t wanted : {0u, 1u, 7u, 300u, 100000u}) {
    std::vector<std::uint64_t> births;
    for (std::uint32_t i = 0; i < pool.size(); ++i) {
      if (pool.column(source)[i] == 2 && !pool.isMarked(i)) births.push_back(pool.birth()[i]);
    }
    std::sort(births.begin(), births.end());
    ASSERT_EQ(countWith(pool, source, 2), births.size());
    const std::size_t expected = std::min(wanted, births.size());
    EXPECT_EQ(markOldestWith(pool, source, 2, wanted), expected);
    for (std::uint32_t i = 0; i < pool.size(); ++i) {
      if (!pool.isMarked(i)) continue;
      ASSERT_EQ(pool.column(source)[i], 2u);
      ASSERT_TRUE(expected == births.size() || pool.birth()[i] < births[expected]);
    }
    pool.compact();
  }
  EXPECT_EQ(countWith(pool, source, 2), 0u);
  EXPECT_GT(countWith(pool, source, 1), 0u);
}

}  // namespace
