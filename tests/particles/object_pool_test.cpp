#include <froude/particles/object_pool.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <froude/base/random.h>

namespace {

using namespace froude;

struct Contact {
  double impulse = 1.0;
  std::uint64_t id = 0;
};

struct Body {
  std::vector<int> vertices;
  void archive(Archive& a) { a.array("vertices", vertices); }
};

PoolSettings settings(std::size_t capacity, GrowthPolicy policy) { return {capacity, policy, "contacts"}; }

TEST(ObjectPool, a_recycled_slot_gets_a_new_generation_and_a_fresh_object) {
  ObjectPool<Contact> pool(settings(1, GrowthPolicy::Fixed));
  const auto first = pool.create();
  pool[first].id = 7;
  pool.release(first);
  const auto second = pool.create();
  EXPECT_EQ(first.slot, second.slot);
  EXPECT_FALSE(pool.isAlive(first));
  EXPECT_EQ(pool.find(first), nullptr);
  ASSERT_NE(pool.find(second), nullptr);
  EXPECT_EQ(pool[second].id, 0u);
  EXPECT_EQ(pool[second].impulse, 1.0);
}

TEST(ObjectPool, a_null_stale_or_doubled_release_is_an_error_in_words) {
  ObjectPool<Contact> pool(settings(2, GrowthPolicy::Fixed));
  EXPECT_THROW(pool.release({}), PoolError);
  const auto h = pool.create();
  pool.release(h);
  EXPECT_THROW(pool.release(h), PoolError);
  EXPECT_FALSE(pool.tryRelease(h));
  EXPECT_FALSE(pool.tryRelease({50, 1}));
  EXPECT_TRUE(pool.empty());
}

TEST(ObjectPool, a_full_fixed_pool_refuses_and_says_what_to_raise) {
  ObjectPool<Contact> pool(settings(2, GrowthPolicy::Fixed));
  pool.create();
  pool.create();
  try {
    pool.create();
    FAIL();
  } catch (const PoolError& e) {
    EXPECT_NE(std::string(e.what()).find("'contacts' is full: all 2"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(pool.tryCreate().isNull());
  EXPECT_TRUE(pool.tryCreateRaw().isNull());
  EXPECT_EQ(pool.counters().refused, 3u);
  pool.reserve(3);
  EXPECT_EQ(pool.capacity(), 4u);
  EXPECT_FALSE(pool.tryCreate().isNull());
}

TEST(ObjectPool, objects_never_move_while_the_pool_grows) {
  for (const std::size_t initial : {1u, 3u, 100u, 1000u}) {
    ObjectPool<Contact> pool(settings(initial, GrowthPolicy::Grow));
    std::vector<std::pair<ObjectHandle<Contact>, Contact*>> places;
    for (std::uint64_t i = 0; i < 2500; ++i) {
      const auto h = pool.create();
      pool[h].id = i;
      places.emplace_back(h, &pool[h]);
      ASSERT_EQ(pool.capacity() % initial, 0u);
    }
    for (std::uint64_t i = 0; i < places.size(); ++i) {
      ASSERT_EQ(pool.find(places[i].first), places[i].second);
      ASSERT_EQ(places[i].second->id, i);
    }
  }
}

TEST(ObjectPool, a_recycling_pool_releases_the_oldest) {
  ObjectPool<Contact> pool(settings(3, GrowthPolicy::RecycleOldest));
  const auto a = pool.create(), b = pool.create(), c = pool.create();
  pool.release(b);
  const auto d = pool.create();
  const auto e = pool.create();
  EXPECT_FALSE(pool.isAlive(a));
  EXPECT_TRUE(pool.isAlive(c) && pool.isAlive(d) && pool.isAlive(e));
  EXPECT_EQ(pool.counters().recycled, 1u);
  EXPECT_EQ(pool.size(), 3u);
}

TEST(ObjectPool, an_initializer_may_reuse_what_the_object_owns) {
  ObjectPool<Body> pool(settings(1, GrowthPolicy::Fixed));
  pool.initialize([](Body& b) { b.vertices.clear(); });
  const auto first = pool.create();
  pool[first].vertices.assign(100, 1);
  const int* memory = pool[first].vertices.data();
  pool.release(first);
  const auto second = pool.create();
  EXPECT_TRUE(pool[second].vertices.empty());
  EXPECT_GE(pool[second].vertices.capacity(), 100u);
  pool[second].vertices.resize(50);
  EXPECT_EQ(pool[second].vertices.data(), memory);
}

TEST(ObjectPool, a_raw_object_is_what_its_slot_held) {
  ObjectPool<Contact> pool(settings(1, GrowthPolicy::Fixed));
  const auto first = pool.create();
  pool[first].id = 5;
  pool.release(first);
  EXPECT_EQ(pool[pool.tryCreateRaw()].id, 5u);
}

TEST(ObjectPool, visits_live_objects_in_slot_order_and_lets_them_go_meanwhile) {
  ObjectPool<Contact> pool(settings(10, GrowthPolicy::Fixed));
  for (std::uint64_t i = 0; i < 10; ++i) pool[pool.create()].id = i;
  pool.forEach([&pool](ObjectHandle<Contact> h, Contact& c) {
    if (c.id % 2 == 0) pool.release(h);
  });
  std::vector<std::uint64_t> seen;
  pool.forEach([&seen](ObjectHandle<Contact>, Contact& c) { seen.push_back(c.id); });
  EXPECT_EQ(seen, (std::vector<std::uint64_t>{1, 3, 5, 7, 9}));
  pool.clear();
  EXPECT_TRUE(pool.empty());
}

TEST(ObjectPool, purge_destroys_trailing_objects_and_stale_handles_stay_stale) {
  static int alive = 0;
  struct Counted {
    Counted() { ++alive; }
    Counted(const Counted&) { ++alive; }
    Counted& operator=(const Counted&) = default;
    ~Counted() { --alive; }
  };
  {
    ObjectPool<Counted> pool(settings(100, GrowthPolicy::Grow));
    std::vector<ObjectHandle<Counted>> handles;
    for (int i = 0; i < 1000; ++i) handles.push_back(pool.create());
    for (std::size_t i = 50; i < 1000; ++i) pool.release(handles[i]);
    EXPECT_GE(alive, 1000);
    EXPECT_EQ(pool.purge(), 900u);
    EXPECT_LT(alive, 200);
    for (int i = 0; i < 950; ++i) pool.create();
    for (std::size_t i = 50; i < 1000; ++i) EXPECT_FALSE(pool.isAlive(handles[i]));
    for (std::size_t i = 0; i < 50; ++i) EXPECT_TRUE(pool.isAlive(handles[i]));
  }
  EXPECT_EQ(alive, 0);
}

TEST(ObjectPool, slabs_begin_on_a_cache_line) {
  struct Line {
    std::uint64_t words[8] = {};
  };
  ObjectPool<Line> pool(settings(1000, GrowthPolicy::Fixed));
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(&pool[pool.create()]) % 64, 0u);
  }
}

template <typename T, typename Set>
void expectLoadGoesOn(Set set) {
  const auto steps = [&set](ObjectPool<T>& pool, std::uint64_t seed) {
    RandomStream random(seed, 0);
    std::vector<ObjectHandle<T>> handles;
    pool.forEach([&handles](ObjectHandle<T> h, T&) { handles.push_back(h); });
    for (int k = 0; k < 100; ++k) {
      if (handles.empty() || random.below(2) == 0) {
        handles.push_back(pool.create());
        set(pool[handles.back()], k);
      } else {
        pool.tryRelease(handles[random.below(static_cast<std::uint32_t>(handles.size()))]);
      }
    }
  };
  const auto hash = [](ObjectPool<T>& pool) {
    HashingArchive archive;
    pool.archive(archive);
    return archive.hash().value();
  };
  ObjectPool<T> pool(settings(8, GrowthPolicy::Grow)), other(settings(8, GrowthPolicy::Grow));
  steps(pool, 1);
  MemorySnapshot snapshot;
  snapshot.save([&pool](Archive& a) { pool.archive(a); });
  steps(pool, 2);
  snapshot.load([&other](Archive& a) { other.archive(a); });
  EXPECT_NE(hash(other), hash(pool));
  steps(other, 2);
  EXPECT_EQ(hash(other), hash(pool));
  snapshot.load([&pool](Archive& a) { pool.archive(a); });
  steps(pool, 2);
  EXPECT_EQ(hash(other), hash(pool));
}

TEST(ObjectPool, a_loaded_pool_goes_on_like_the_one_that_was_saved) {
  expectLoadGoesOn<Contact>([](Contact& c, int k) { c.id = static_cast<std::uint64_t>(k); });
  expectLoadGoesOn<Body>([](Body& b, int k) { b.vertices.assign(static_cast<std::size_t>(k % 5), k); });
}

TEST(ObjectPool, agrees_with_a_map_under_random_operations) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    ObjectPool<Contact> pool(settings(10, GrowthPolicy::Grow));
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> live;
    std::vector<ObjectHandle<Contact>> everSeen;
    RandomStream random(seed, 4);
    for (std::uint64_t k = 0; k < 800; ++k) {
      if (random.below(2) == 0 || everSeen.empty()) {
        const auto h = pool.create();
        pool[h].id = k;
        ASSERT_TRUE(live.emplace(std::pair{h.slot, h.generation}, k).second);
        everSeen.push_back(h);
      } else if (random.below(20) == 0) {
        pool.purge();
      } else {
        const auto h = everSeen[random.below(static_cast<std::uint32_t>(everSeen.size()))];
        ASSERT_EQ(pool.tryRelease(h), live.erase({h.slot, h.generation}) == 1);
      }
      ASSERT_EQ(pool.size(), live.size());
      for (const auto h : everSeen) {
        const auto known = live.find({h.slot, h.generation});
        const Contact* found = pool.find(h);
        ASSERT_EQ(found != nullptr, known != live.end());
        ASSERT_TRUE(found == nullptr || found->id == known->second);
      }
    }
  }
}

}  // namespace
