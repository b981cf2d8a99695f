#include <froude/particles/pool.h>
#include <gtest/gtest.h>

#include <tbb/task_arena.h>
#include <cstdlib>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <froude/base/random.h>

namespace {

using namespace froude;

PoolSettings settings(std::size_t capacity, GrowthPolicy policy) { return {capacity, policy, "water"}; }

std::string messageOf(const std::function<void()>& f) {
  try {
    f();
  } catch (const PoolError& e) {
    return e.what();
  }
  return "nothing was thrown";
}

// Handles find their own particle, slots and indices are inverse to each other, nothing is there twice.
void expectSound(const ParticlePool& pool) {
  std::set<std::uint32_t> slots;
  for (std::uint32_t i = 0; i < pool.size(); ++i) {
    const ParticleHandle h = pool.handleAt(i);
    ASSERT_TRUE(pool.isAlive(h));
    ASSERT_EQ(pool.indexOf(h), i);
    ASSERT_EQ(pool.slots()[i], h.slot);
    slots.insert(h.slot);
  }
  ASSERT_EQ(slots.size(), pool.size());
  ASSERT_LE(pool.size(), pool.capacity());
  ASSERT_EQ(pool.counters().created - pool.counters().released, pool.size());
}

std::uint64_t hashOf(ParticlePool& pool) {
  HashingArchive archive;
  pool.archive(archive);
  return archive.hash().value();
}

TEST(ParticlePool, a_recycled_slot_gets_a_new_generation) {
  ParticlePool pool(settings(1, GrowthPolicy::Fixed));
  const ParticleHandle first = pool.create();
  pool.release(first);
  const ParticleHandle second = pool.create();
  EXPECT_EQ(first.slot, second.slot);
  EXPECT_NE(first.generation, second.generation);
  EXPECT_FALSE(pool.isAlive(first));
  EXPECT_TRUE(pool.isAlive(second));
  EXPECT_FALSE(pool.indexOf(first));
}

TEST(ParticlePool, null_is_never_alive_and_never_handed_out) {
  ParticlePool pool(settings(4, GrowthPolicy::Fixed));
  EXPECT_TRUE(ParticleHandle{}.isNull());
  EXPECT_FALSE(pool.isAlive({}));
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(pool.create().isNull());
  EXPECT_FALSE(pool.isAlive({}));
}

TEST(ParticlePool, a_null_stale_or_doubled_release_is_an_error_in_words) {
  ParticlePool pool(settings(4, GrowthPolicy::Fixed));
  EXPECT_NE(messageOf([&] { pool.release({}); }).find("null"), std::string::npos);
  const ParticleHandle h = pool.create();
  pool.release(h);
  EXPECT_NE(messageOf([&] { pool.release(h); }).find("stale"), std::string::npos);
  EXPECT_NE(messageOf([&] { pool.release(h); }).find("'water'"), std::string::npos);
  pool.create();
  EXPECT_THROW(pool.release(h), PoolError);
  EXPECT_THROW(pool.release({99, 1}), PoolError);
  EXPECT_FALSE(pool.tryRelease(h));
  EXPECT_EQ(pool.size(), 1u);
}

TEST(ParticlePool, the_handle_that_comes_next_is_not_alive_before_it_comes) {
  ParticlePool pool(settings(1, GrowthPolicy::Fixed));
  pool.release(pool.create());
  for (std::uint32_t generation = 0; generation < 10; ++generation) EXPECT_FALSE(pool.isAlive({0, generation}));
}

TEST(ParticlePool, the_slot_that_was_freed_last_is_reused_first) {
  ParticlePool pool(settings(5, GrowthPolicy::Fixed));
  std::vector<ParticleHandle> handles;
  for (int i = 0; i < 5; ++i) handles.push_back(pool.create());
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(handles[i].slot, i);
  for (const int i : {3, 0, 4}) pool.release(handles[static_cast<std::size_t>(i)]);
  EXPECT_EQ(pool.create().slot, handles[4].slot);
  pool.release(handles[1]);
  EXPECT_EQ(pool.create().slot, handles[1].slot);
  EXPECT_EQ(pool.create().slot, handles[0].slot);
  EXPECT_EQ(pool.create().slot, handles[3].slot);
}

// Every life of a slot, from its first to its last.
TEST(LongSlotTable, a_worn_slot_is_taken_out_of_service_and_its_handles_stay_stale) {
  const char* wanted = std::getenv("FROUDE_LONG");
  if (wanted == nullptr || *wanted != '1') GTEST_SKIP() << "FROUDE_LONG=1 runs it";
  SlotTable table(2, false);
  const std::uint32_t worn = table.acquire();
  const std::uint32_t first = table.generation(worn);
  table.release(worn);
  std::uint64_t lives = 1;
  while (true) {
    const std::uint32_t slot = table.acquire();
    if (slot != worn) break;
    table.release(slot);
    ++lives;
  }
  EXPECT_EQ(lives, (std::uint64_t{1} << 31) - 1);
  EXPECT_FALSE(table.isLive(worn, first));
  EXPECT_EQ(table.liveCount(), 1u);
  EXPECT_TRUE(table.full());
  EXPECT_EQ(table.purge(1), 0u);  // a worn slot is not dropped: it would come back with its generations
}

TEST(ParticlePool, a_full_fixed_pool_says_its_name_its_capacity_and_what_to_raise) {
  ParticlePool pool(settings(3, GrowthPolicy::Fixed));
  for (int i = 0; i < 3; ++i) pool.create();
  const std::string message = messageOf([&] { pool.create(); });
  for (const char* part : {"'water'", "3", "initialCapacity", "Grow"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  EXPECT_TRUE(pool.tryCreate().isNull());
  EXPECT_EQ(pool.counters().refused, 2u);
  EXPECT_EQ(pool.size(), 3u);
  pool.reserve(4);
  EXPECT_EQ(pool.capacity(), 6u);
  EXPECT_FALSE(pool.tryCreate().isNull());
}

TEST(ParticlePool, a_growing_pool_grows_by_its_initial_size_and_keeps_everything) {
  ParticlePool pool(settings(10, GrowthPolicy::Grow));
  const auto mass = pool.addColumn<float>("mass", ColumnKind::State);
  std::vector<ParticleHandle> handles;
  for (int i = 0; i < 35; ++i) {
    handles.push_back(pool.create());
    pool.x().back() = i;
    pool.column(mass).back() = static_cast<float>(2 * i);
    EXPECT_EQ(pool.capacity(), static_cast<std::size_t>(10 * (i / 10 + 1)));
  }
  for (std::size_t i = 0; i < 35; ++i) {
    const std::uint32_t at = *pool.indexOf(handles[i]);
    EXPECT_EQ(pool.x()[at], static_cast<double>(i));
    EXPECT_EQ(pool.column(mass)[at], static_cast<float>(2 * i));
  }
  expectSound(pool);
}

TEST(ParticlePool, a_recycling_pool_releases_the_oldest_live_particle) {
  ParticlePool pool(settings(3, GrowthPolicy::RecycleOldest));
  const ParticleHandle a = pool.create(), b = pool.create(), c = pool.create();
  pool.release(a);
  const ParticleHandle d = pool.create();
  EXPECT_EQ(pool.counters().recycled, 0u);
  const ParticleHandle e = pool.create();
  EXPECT_FALSE(pool.isAlive(b));
  EXPECT_TRUE(pool.isAlive(c) && pool.isAlive(d) && pool.isAlive(e));
  const ParticleHandle f = pool.create();
  EXPECT_FALSE(pool.isAlive(c));
  EXPECT_EQ(*pool.indexOf(f), pool.size() - 1);
  EXPECT_EQ(pool.counters().recycled, 2u);
  EXPECT_EQ(pool.counters().released, 3u);
  expectSound(pool);
}

TEST(ParticlePool, definitions_that_cannot_be_met_are_refused) {
  EXPECT_THROW(ParticlePool({0, GrowthPolicy::Grow, "p"}), PoolError);
  EXPECT_THROW(ParticlePool({std::size_t{1} << 40, GrowthPolicy::Grow, "p"}), PoolError);
  EXPECT_THROW(ParticlePool({10, GrowthPolicy::Grow, ""}), PoolError);
  ParticlePool pool(settings(2, GrowthPolicy::Fixed));
  EXPECT_THROW(pool.addColumn<double>("x", ColumnKind::State), PoolError);
  EXPECT_THROW(pool.addColumn<double>("", ColumnKind::State), PoolError);
}

TEST(ParticlePool, columns_are_found_by_name_and_type) {
  ParticlePool pool(settings(2, GrowthPolicy::Fixed));
  pool.addColumn<float>("density", ColumnKind::State);
  EXPECT_TRUE(pool.findColumn<float>("density"));
  EXPECT_FALSE(pool.findColumn<double>("density"));
  EXPECT_FALSE(pool.findColumn<float>("pressure"));
  pool.create();
  pool.x()[0] = 3.5;
  EXPECT_EQ(pool.column(*pool.findColumn<double>("x"))[0], 3.5);
}

TEST(ParticlePool, columns_are_aligned_and_a_new_particle_is_zero_whatever_was_there) {
  ParticlePool pool(settings(3, GrowthPolicy::Fixed));
  const auto a = pool.addColumn<std::uint8_t>("a", ColumnKind::State);
  const auto b = pool.addColumn<std::uint64_t>("b", ColumnKind::State);
  for (int round = 0; round < 3; ++round) {
    const ParticleHandle h = pool.create();
    EXPECT_EQ(pool.column(a)[0] + pool.column(b)[0], 0u);
    EXPECT_EQ(pool.vx()[0], 0.0);
    pool.column(a)[0] = 9;
    pool.column(b)[0] = 9;
    pool.vx()[0] = 9.0;
    pool.release(h);
  }
  for (std::size_t c = 0; c < pool.columnCount(); ++c) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(pool.columnBytes(c).data()) % 64, 0u) << pool.columnInfo(c).name;
  }
}

TEST(ParticlePool, the_initializer_sees_each_new_particle) {
  ParticlePool pool(settings(2, GrowthPolicy::Grow));
  int calls = 0;
  pool.initialize([&calls](ParticlePool& p, std::uint32_t i) {
    p.vy()[i] = -1.0;
    EXPECT_TRUE(p.isAlive(p.handleAt(i)));
    ++calls;
  });
  for (int i = 0; i < 5; ++i) pool.create();
  EXPECT_EQ(calls, 5);
  EXPECT_EQ(pool.vy()[4], -1.0);
  pool.initialize(nullptr);
  pool.create();
  EXPECT_EQ(pool.vy()[5], 0.0);
}

TEST(ParticlePool, compact_removes_what_is_marked_and_keeps_the_order_of_the_rest) {
  ParticlePool pool(settings(100, GrowthPolicy::Fixed));
  const auto id = pool.addColumn<std::int32_t>("id", ColumnKind::State);
  std::vector<ParticleHandle> handles;
  for (int i = 0; i < 100; ++i) {
    handles.push_back(pool.create());
    pool.column(id)[static_cast<std::size_t>(i)] = i;
  }
  EXPECT_EQ(pool.compact(), 0u);
  std::vector<int> expected;
  for (int i = 0; i < 100; ++i) {
    if (i % 3 == 1 || i == 99) {
      pool.kill(static_cast<std::uint32_t>(i));
      pool.kill(static_cast<std::uint32_t>(i));
    } else {
      expected.push_back(i);
    }
  }
  EXPECT_TRUE(pool.isAlive(handles[1]));
  EXPECT_EQ(pool.compact(), 100 - expected.size());
  EXPECT_FALSE(pool.isAlive(handles[1]));
  const auto ids = pool.column(id);
  EXPECT_EQ(std::vector<int>(ids.begin(), ids.end()), expected);
  expectSound(pool);
  for (std::uint32_t i = 0; i < pool.size(); ++i) pool.kill(i);
  pool.compact();
  EXPECT_TRUE(pool.empty());
}

TEST(ParticlePool, permute_sorts_state_columns_and_handles_follow) {
  constexpr std::size_t kCount = 5000;
  for (const int threads : {1, 2, 3, 7}) {
    ParticlePool pool(settings(kCount, GrowthPolicy::Fixed));
    const auto byte = pool.addColumn<std::uint8_t>("byte", ColumnKind::State);
    const auto word = pool.addColumn<float>("word", ColumnKind::State);
    std::vector<ParticleHandle> handles;
    for (std::size_t i = 0; i < kCount; ++i) {
      handles.push_back(pool.create());
      pool.x()[i] = static_cast<double>(i);
      pool.column(byte)[i] = static_cast<std::uint8_t>(i);
      pool.column(word)[i] = static_cast<float>(i);
    }
    std::vector<std::uint32_t> order(kCount);
    std::iota(order.begin(), order.end(), 0u);
    RandomStream random(1, 1);
    for (std::size_t i = kCount - 1; i > 0; --i) {
      std::swap(order[i], order[random.below(static_cast<std::uint32_t>(i + 1))]);
    }
    tbb::task_arena(threads).execute([&] { pool.permute(order); });
    for (std::size_t i = 0; i < kCount; ++i) {
      ASSERT_EQ(pool.x()[i], order[i]);
      ASSERT_EQ(pool.column(byte)[i], static_cast<std::uint8_t>(order[i]));
      ASSERT_EQ(pool.column(word)[i], static_cast<float>(order[i]));
      ASSERT_EQ(order[*pool.indexOf(handles[i])], i);
    }
    expectSound(pool);
  }
}

TEST(ParticlePool, purge_gives_back_what_is_not_needed_and_stale_handles_stay_stale) {
  ParticlePool pool(settings(10, GrowthPolicy::Grow));
  std::vector<ParticleHandle> handles;
  for (int i = 0; i < 95; ++i) handles.push_back(pool.create());
  for (std::size_t i = 12; i < 95; ++i) pool.release(handles[i]);
  const std::size_t before = pool.memoryBytes();
  EXPECT_EQ(pool.purge(), 80u);
  EXPECT_EQ(pool.capacity(), 20u);
  EXPECT_LT(pool.memoryBytes(), before / 3);
  std::vector<ParticleHandle> later;
  for (int i = 0; i < 90; ++i) later.push_back(pool.create());
  for (std::size_t i = 12; i < 95; ++i) EXPECT_FALSE(pool.isAlive(handles[i])) << i;
  for (std::size_t i = 0; i < 12; ++i) EXPECT_TRUE(pool.isAlive(handles[i])) << i;
  for (const ParticleHandle h : later) EXPECT_TRUE(pool.isAlive(h));
  expectSound(pool);
}

TEST(ParticlePool, purge_works_when_only_the_last_slot_is_live) {
  ParticlePool pool(settings(8, GrowthPolicy::Grow));
  std::vector<ParticleHandle> handles;
  for (int i = 0; i < 64; ++i) handles.push_back(pool.create());
  for (int i = 0; i < 63; ++i) pool.release(handles[static_cast<std::size_t>(i)]);
  pool.x()[0] = 4.0;
  EXPECT_EQ(pool.purge(), 0u);
  EXPECT_EQ(pool.x()[*pool.indexOf(handles[63])], 4.0);
  for (int i = 0; i < 63; ++i) pool.create();
  EXPECT_EQ(pool.capacity(), 64u);
  expectSound(pool);
}

TEST(ParticlePool, clear_leaves_no_handle_alive) {
  ParticlePool pool(settings(4, GrowthPolicy::RecycleOldest));
  const ParticleHandle h = pool.create();
  pool.create();
  pool.clear();
  EXPECT_TRUE(pool.empty());
  EXPECT_FALSE(pool.isAlive(h));
  for (int i = 0; i < 6; ++i) pool.create();
  expectSound(pool);
}

TEST(ParticlePool, a_loaded_pool_goes_on_like_the_one_that_was_saved) {
  for (const GrowthPolicy policy : {GrowthPolicy::Fixed, GrowthPolicy::Grow, GrowthPolicy::RecycleOldest}) {
    ParticlePool pool(settings(16, policy));
    const auto steps = [](ParticlePool& p, std::uint64_t seed) {
      RandomStream random(seed, 0);
      for (int k = 0; k < 200; ++k) {
        if (random.below(3) != 0) {
          const ParticleHandle h = p.tryCreate();
          if (!h.isNull()) p.x()[*p.indexOf(h)] = random.uniform();
        } else if (!p.empty()) {
          p.release(p.handleAt(random.below(static_cast<std::uint32_t>(p.size()))));
        }
      }
    };
    steps(pool, 1);
    if (!pool.empty()) pool.kill(0);  // a mark that waits for compact is state too
    MemorySnapshot snapshot;
    snapshot.save([&](Archive& a) { pool.archive(a); });
    const std::uint64_t saved = hashOf(pool);
    steps(pool, 2);
    pool.compact();
    const std::uint64_t later = hashOf(pool);
    EXPECT_NE(saved, later);

    snapshot.load([&](Archive& a) { pool.archive(a); });
    EXPECT_EQ(hashOf(pool), saved);
    expectSound(pool);
    steps(pool, 2);
    pool.compact();
    EXPECT_EQ(hashOf(pool), later);

    ParticlePool other(settings(16, policy));
    snapshot.load([&](Archive& a) { other.archive(a); });
    EXPECT_EQ(hashOf(other), saved);
    steps(other, 2);
    other.compact();
    EXPECT_EQ(hashOf(other), later);
    expectSound(other);
  }
}

TEST(ParticlePool, the_state_of_another_definition_is_refused) {
  ParticlePool pool(settings(4, GrowthPolicy::Fixed)), other(settings(4, GrowthPolicy::Fixed));
  other.addColumn<double>("more", ColumnKind::State);
  MemorySnapshot snapshot;
  snapshot.save([&](Archive& a) { pool.archive(a); });
  EXPECT_THROW(snapshot.load([&](Archive& a) { other.archive(a); }), PoolError);
}

TEST(ParticlePool, scratch_columns_are_not_part_of_the_state) {
  ParticlePool pool(settings(4, GrowthPolicy::Fixed));
  const auto scratch = pool.addColumn<double>("scratch", ColumnKind::Scratch);
  pool.create();
  const std::uint64_t before = hashOf(pool);
  pool.column(scratch)[0] = 5.0;
  EXPECT_EQ(hashOf(pool), before);
  EXPECT_EQ(pool.column(scratch).size(), 1u);
}

// Random operations against a map: whatever happens, a live handle finds its own values and no other handle is alive.
void compareWithMap(GrowthPolicy policy, std::uint64_t seed, int operations) {
  ParticlePool pool(settings(20, policy));
  const auto id = pool.addColumn<std::uint64_t>("id", ColumnKind::State);
  using Key = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Key, std::uint64_t> live;
  std::vector<ParticleHandle> everSeen;
  RandomStream random(seed, 5);
  for (int k = 0; k < operations; ++k) {
    const std::uint32_t what = random.below(100);
    if (what < 50) {
      if (policy == GrowthPolicy::RecycleOldest && pool.size() == pool.capacity()) {
        const auto oldest = std::min_element(pool.birth().begin(), pool.birth().end()) - pool.birth().begin();
        const ParticleHandle h = pool.handleAt(static_cast<std::uint32_t>(oldest));
        live.erase({h.slot, h.generation});
      }
      const ParticleHandle h = pool.tryCreate();
      ASSERT_EQ(h.isNull(), policy == GrowthPolicy::Fixed && live.size() == pool.capacity());
      if (h.isNull()) continue;
      ASSERT_TRUE(live.emplace(Key{h.slot, h.generation}, k).second) << "a handle was handed out twice";
      pool.column(id)[*pool.indexOf(h)] = static_cast<std::uint64_t>(k);
      everSeen.push_back(h);
    } else if (what < 85 && !everSeen.empty()) {
      const ParticleHandle h = everSeen[random.below(static_cast<std::uint32_t>(everSeen.size()))];
      ASSERT_EQ(pool.tryRelease(h), live.erase({h.slot, h.generation}) == 1);
    } else if (what < 90) {
      for (std::uint32_t i = 0; i < pool.size(); ++i) {
        if (random.below(4) != 0) continue;
        const ParticleHandle h = pool.handleAt(i);
        live.erase({h.slot, h.generation});
        pool.kill(i);
      }
      pool.compact();
    } else if (what < 97) {
      std::vector<std::uint32_t> order(pool.size());
      std::iota(order.begin(), order.end(), 0u);
      std::reverse(order.begin(), order.end());
      pool.permute(order);
    } else {
      pool.purge();
    }
    ASSERT_EQ(pool.size(), live.size());
    for (const ParticleHandle h : everSeen) {
      const auto known = live.find({h.slot, h.generation});
      ASSERT_EQ(pool.isAlive(h), known != live.end());
      ASSERT_TRUE(known == live.end() || pool.column(id)[*pool.indexOf(h)] == known->second);
    }
  }
  expectSound(pool);
}

TEST(ParticlePool, agrees_with_a_map_under_random_operations) {
  for (const GrowthPolicy policy : {GrowthPolicy::Fixed, GrowthPolicy::Grow, GrowthPolicy::RecycleOldest}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) compareWithMap(policy, seed, 600);
  }
}

}  // namespace
