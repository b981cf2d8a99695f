// What does an object cost from the pool, and from new and delete, with 100,000 of them live?
#include <benchmark/benchmark.h>

#include <array>
#include <memory>
#include <vector>

#include <froude/base/random.h>
#include <froude/particles/object_pool.h>

namespace {

using namespace froude;

constexpr std::size_t kLive = 100000;

template <std::size_t Bytes>
struct Payload {
  std::array<std::uint64_t, Bytes / 8> words{};
};

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
  for (const std::uint32_t i : victim) {
    pool.release(live[i]);
    live[i] = pool.create();
  }
  return live;
}

template <std::size_t Bytes>
void poolGet(benchmark::State& state) {
  ObjectPool<Payload<Bytes>> pool({kLive, GrowthPolicy::Fixed, "bench"});
  for (auto _ : state) {
    auto handle = pool.tryCreate();
    benchmark::DoNotOptimize(handle);
    if (pool.size() == pool.capacity()) {
      state.PauseTiming();
      pool.clear();
      state.ResumeTiming();
    }
  }
}

template <std::size_t Bytes, bool Raw>
void poolGetPut(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  ObjectPool<Payload<Bytes>> pool({kLive + kLive / 4, GrowthPolicy::Grow, "bench"});
  auto live = fill(pool, victim);
  std::size_t k = 0;
  for (auto _ : state) {
    const std::uint32_t i = victim[k++ & (victim.size() - 1)];
    pool.tryRelease(live[i]);
    live[i] = Raw ? pool.tryCreateRaw() : pool.tryCreate();
  }
  benchmark::DoNotOptimize(live.data());
}

// What the caller of poolGetPut pays in any case: a random entry of its own table of handles.
void handlesAlone(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  std::vector<ObjectHandle<int>> live(kLive);
  std::size_t k = 0;
  for (auto _ : state) ++live[victim[k++ & (victim.size() - 1)]].generation;
  benchmark::DoNotOptimize(live.data());
}

template <std::size_t Bytes>
void newDelete(benchmark::State& state) {
  const std::vector<std::uint32_t> victim = victims();
  std::vector<std::unique_ptr<Payload<Bytes>>> live(kLive);
  for (const std::uint32_t i : victim) live[i] = std::make_unique<Payload<Bytes>>();
  std::size_t k = 0;
  for (auto _ : state) {
    const std::uint32_t i = victim[k++ & (victim.size() - 1)];
    live[i].reset();
    live[i] = std::make_unique<Payload<Bytes>>();
  }
  benchmark::DoNotOptimize(live.data());
}

BENCHMARK(handlesAlone);
BENCHMARK(poolGet<16>);
BENCHMARK(poolGet<64>);
BENCHMARK(poolGet<256>);
BENCHMARK(poolGetPut<16, false>);
BENCHMARK(poolGetPut<64, false>);
BENCHMARK(poolGetPut<256, false>);
BENCHMARK(poolGetPut<16, true>);
BENCHMARK(poolGetPut<64, true>);
BENCHMARK(poolGetPut<256, true>);
BENCHMARK(newDelete<16>);
BENCHMARK(newDelete<64>);
BENCHMARK(newDelete<256>);

}  // namespace
