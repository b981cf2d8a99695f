// What does an object cost from the pool, and from new and delete, with 100,000 of them live? A small one (16 bytes), a
// medium one (64 bytes) and one that owns memory (a vector of 256 numbers).
#include <benchmark/benchmark.h>

#include <array>
#include <memory>
#include <vector>

#include <froude/base/random.h>
#include <froude/particles/object_pool.h>
#include "rows.h"

namespace {

using namespace froude;

constexpr std::size_t kLive = 100000;

struct Small {
  std::array<std::uint64_t, 2> words{};
};
struct Medium {
  std::array<std::uint64_t, 8> words{};
};
struct Large {
  std::array<std::uint64_t, 32> words{};
};
struct Owner {
  std::vector<double> numbers = std::vector<double>(256);
};

// A new object as its user wants it: reset, or, for the one that owns memory, by a function that reuses what is there.
template <typename T>
void prepare(ObjectPool<T>& pool) {
  if constexpr (std::is_same_v<T, Owner>) pool.initialize([](Owner& o) { o.numbers[0] = 0.0; });
}

// Random numbers are drawn beforehand, so that the loop measures the pool.
std::vector<std::uint32_t> victims() {
  std::vector<std::uint32_t> v(1 << 20);
  RandomStream random(1, 1);
  for (std::uint32_t& i : v) i = random.below(kLive);
  return v;
}

// Shuffled, so that the free list and the addresses are not in order.
template <typename T>
std::vector<ObjectHandle<T>> fill(ObjectPool<T>& pool, const std::vector<std::uint32_t>& victim) {
  std::vector<ObjectHandle<T>> live;
  for (std::size_t i = 0; i < kLive; ++i) live.push_back(pool.create());
  for (std::size_t k = 0; k + 8 < victim.size(); k += 8) {
    for (std::size_t j = k; j < k + 8; ++j) pool.tryRelease(live[victim[j]]);
    for (std::size_t j = k; j < k + 8; ++j) {
      if (!pool.isAlive(live[victim[j]])) live[victim[j]] = pool.create();
    }
  }
  return live;
}

// Objects one after the other out of a fresh pool.
template <typename T>
void get(benchmark::State& state) {
  ObjectPool<T> pool({kLive, GrowthPolicy::Fixed, "bench"});
  prepare(pool);
  for (auto _ : state) {
    auto handle = pool.tryCreate();
    benchmark::DoNotOptimize(handle);
    if (pool.size() == pool.capacity()) {
      state.PauseTiming();
      pool.clear();
      state.ResumeTiming();
    }
  }
  bench::items(state, 1);
}

// A random live object is released, and one is created in its place: as new, or raw (what the slot held before).
template <typename T, bool Raw>
void getPut(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  ObjectPool<T> pool({kLive + kLive / 4, GrowthPolicy::Grow, "bench"});
  prepare(pool);
  auto live = fill(pool, victim);
  std::size_t k = 0, failed = 0;
  for (auto _ : state) {
    const std::uint32_t i = victim[k++ & (victim.size() - 1)];
    failed += pool.tryRelease(live[i]) ? 0 : 1;
    live[i] = Raw ? pool.tryCreateRaw() : pool.tryCreate();
  }
  if (failed > 0) state.SkipWithError("a live object could not be released");
  benchmark::DoNotOptimize(live.data());
  bench::items(state, 1);
}

// An index free list over one slab without a check of any kind: what a pool that knows no stale handle would cost.
void uncheckedIndices(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  struct alignas(64) Slot {
    std::uint32_t next;
  };
  std::vector<Slot> slab(kLive + kLive / 4);
  for (std::uint32_t i = 0; i < slab.size(); ++i) slab[i].next = i + 1;
  std::uint32_t head = 0;
  const auto take = [&] { return std::exchange(head, slab[head].next); };
  std::vector<std::uint64_t> live(kLive);  // as large as handles
  for (auto& i : live) i = take();
  std::size_t k = 0;
  for (auto _ : state) {
    std::uint64_t& mine = live[victim[k++ & (victim.size() - 1)]];
    slab[mine].next = std::exchange(head, static_cast<std::uint32_t>(mine));
    mine = take();
  }
  benchmark::DoNotOptimize(live.data());
  bench::items(state, 1);
}

// What the caller of getPut pays in any case: a random entry of its own table of handles.
void handlesAlone(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  std::vector<ObjectHandle<int>> live(kLive);
  std::size_t k = 0;
  for (auto _ : state) ++live[victim[k++ & (victim.size() - 1)]].generation;
  benchmark::DoNotOptimize(live.data());
  bench::items(state, 1);
}

template <typename T>
void newDelete(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  std::vector<std::unique_ptr<T>> live(kLive);
  for (auto& p : live) p = std::make_unique<T>();
  for (const std::uint32_t i : victim) live[i] = std::make_unique<T>();
  std::size_t k = 0;
  for (auto _ : state) {
    const std::uint32_t i = victim[k++ & (victim.size() - 1)];
    live[i].reset();
    live[i] = std::make_unique<T>();
  }
  benchmark::DoNotOptimize(live.data());
  bench::items(state, 1);
}

BENCHMARK(handlesAlone);
BENCHMARK(uncheckedIndices);
BENCHMARK(get<Small>);
BENCHMARK(get<Medium>);
BENCHMARK(get<Large>);
BENCHMARK(get<Owner>);
BENCHMARK(getPut<Small, true>);
BENCHMARK(getPut<Medium, true>);
BENCHMARK(getPut<Large, true>);
BENCHMARK(getPut<Small, false>);
BENCHMARK(getPut<Medium, false>);
BENCHMARK(getPut<Large, false>);
BENCHMARK(getPut<Owner, false>);
BENCHMARK(newDelete<Small>);
BENCHMARK(newDelete<Medium>);
BENCHMARK(newDelete<Large>);
BENCHMARK(newDelete<Owner>);

}  // namespace
