// Counts every allocation of this program, to prove that a steady step makes none.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include <froude/base/random.h>
#include <froude/fields/cut_reach.h>
#include <froude/particles/cell_grid.h>
#include <froude/particles/emitter.h>
#include <froude/particles/neighbour_list.h>
#include <froude/particles/object_pool.h>
#include <froude/particles/sink.h>

namespace {

std::atomic<std::size_t> allocations{0};

void* allocate(std::size_t bytes, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  void* p = alignment > alignof(std::max_align_t) ? std::aligned_alloc(alignment, rounded) : std::malloc(bytes);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes + (bytes == 0), 1); }
void* operator new[](std::size_t bytes) { return allocate(bytes + (bytes == 0), 1); }
void* operator new(std::size_t bytes, std::align_val_t a) { return allocate(bytes, static_cast<std::size_t>(a)); }
void* operator new[](std::size_t bytes, std::align_val_t a) { return allocate(bytes, static_cast<std::size_t>(a)); }
// The rest of the family too: a sanitizer's own would not match our delete.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return ++allocations, std::malloc(bytes + (bytes == 0));
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return ++allocations, std::malloc(bytes + (bytes == 0));
}
void operator delete(void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace {

using namespace froude;

TEST(Allocations, are_counted) {
  const std::size_t before = allocations;
  AlignedArray<double> a(10);
  std::vector<int> b(10);
  EXPECT_EQ(allocations, before + 2);
}

// A nozzle above, a sink below, particles that fall from one into the other: every step creates, removes and sorts.
struct Fountain {
  explicit Fountain(PoolSettings settings)
      : pool(std::move(settings)),
        expires(pool.addColumn<double>("expires", ColumnKind::State)),
        emitter({.kind = EmitterDef::Kind::Fluid, .from = {0.8, 0.9}, .to = {0.2, 0.9}, .speed = 1.0}, 0.01, 1, 0) {
    pool.initialize([this](ParticlePool& p, std::uint32_t i) { p.column(expires)[i] = 0.6; });
    sinks.add(Polygon::box({{-1.0, -1.0}, {2.0, 0.2}}));
  }

  void step(double dt) {
    emitter.emit(time, dt, [this](const Vec2& position, const Vec2& velocity) {
      const ParticleHandle h = pool.tryCreate();
      if (h.isNull()) return;
      const std::uint32_t i = *pool.indexOf(h);
      pool.x()[i] = position.x();
      pool.y()[i] = position.y();
      pool.vx()[i] = velocity.x();
      pool.vy()[i] = velocity.y();
      pool.column(expires)[i] = time + 0.65;
    });
    time += dt;
    for (std::size_t i = 0; i < pool.size(); ++i) {
      pool.x()[i] += pool.vx()[i] * dt + 0.002 * std::sin(100.0 * pool.y()[i]);
      pool.y()[i] += pool.vy()[i] * dt;
    }
    sinks.mark(pool);
    markExpired(pool, expires, time);
    pool.compact();
    grid.build(pool.x(), pool.y(), frame);
    pool.permute(grid.order());
    list.build(grid, pool.x(), pool.y(), 0.02);
    snapshot.save([this](Archive& a) { pool.archive(a); });
    if (++steps % 5 == 0) snapshot.load([this](Archive& a) { pool.archive(a); });
  }

  ParticlePool pool;
  ColumnId<double> expires;
  Emitter emitter;
  SinkSet sinks;
  GridFrame frame = GridFrame::cover({{0.0, 0.0}, {1.0, 1.0}}, 0.02);
  CellGrid grid;
  NeighbourList list;
  MemorySnapshot snapshot;
  double time = 0.0;
  int steps = 0;
};

TEST(Allocations, a_steady_step_of_creating_removing_sorting_and_saving_makes_none) {
  for (const GrowthPolicy policy : {GrowthPolicy::Fixed, GrowthPolicy::Grow, GrowthPolicy::RecycleOldest}) {
    // In the calling thread: TBB's own allocation of tasks is not ours.
    tbb::task_arena(1).execute([policy] {
      Fountain fountain({policy == GrowthPolicy::Grow ? 500u : 3000u, policy, "fountain"});
      for (int i = 0; i < 400; ++i) fountain.step(0.004);
      const std::uint64_t created = fountain.pool.counters().created, released = fountain.pool.counters().released;
      const std::size_t before = allocations;
      for (int i = 0; i < 400; ++i) fountain.step(0.004);
      EXPECT_EQ(allocations, before);
      EXPECT_GT(fountain.pool.counters().created, created + 5000);
      EXPECT_GT(fountain.pool.counters().released, released + 5000);
      EXPECT_GT(fountain.list.entryCount(), fountain.pool.size());
    });
  }
}

TEST(Allocations, an_object_pool_that_is_large_enough_makes_none) {
  ObjectPool<std::array<double, 8>> pool({1000, GrowthPolicy::RecycleOldest, "contacts"});
  std::vector<ObjectHandle<std::array<double, 8>>> handles;
  handles.reserve(20000);
  const std::size_t before = allocations;
  RandomStream random(1, 1);
  for (int i = 0; i < 10000; ++i) {
    handles.push_back(pool.create());
    pool.tryRelease(handles[random.below(static_cast<std::uint32_t>(handles.size()))]);
  }
  EXPECT_EQ(allocations, before);
}

TEST(Allocations, cutting_the_cells_of_bodies_that_turn_makes_none) {
  tbb::task_arena(1).execute([] {
    const Polygon plate = Polygon::box({{-0.3, -0.001}, {0.3, 0.001}}), wheel = Polygon::regular(9, 0.2);
    const CutGrid grid{{0.0, 0.0}, 0.02, 0, 0};
    CutCells cut;
    const CutOutline fixed{&wheel, Transform::of({0.6, 0.6}, 0.0), {0.6, 0.6}, 0};
    cut.setFixed(grid, {&fixed, 1}, {{{0.0, 0.0}, {1.0, 1.0}}, {true, true, true, true}});
    CutReach reach;
    auto turn = [&](int steps) {
      std::size_t stencils = 0;
      for (int s = 0; s < steps; ++s) {
        const std::array<CutOutline, 2> moving{
            CutOutline{&plate, Transform::of({0.4, 0.4}, 0.05 * kPi * s), {0.4, 0.4}, 1},
            CutOutline{&wheel, Transform::of({0.7, 0.3}, -0.05 * kPi * s), {0.7, 0.3}, 2}};
        cut.update({0, 0, 49, 49}, moving);
        reach.build(grid, cut);
        stencils += reach.stencils().size();
      }
      return stencils;
    };
    turn(40);
    const std::size_t before = allocations;
    EXPECT_GT(turn(40), 1000u);
    EXPECT_EQ(allocations, before);
  });
}

}  // namespace
