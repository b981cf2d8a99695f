// A pool of objects at stable addresses, with handles that go stale: contacts, bodies.
#pragma once

#include <bit>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <froude/base/assert.h>
#include <froude/particles/slot_table.h>

namespace froude {

/// Names one life of one object of an ObjectPool<T>. {0, 0} is null.
template <typename T>
struct ObjectHandle {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;
  bool isNull() const { return generation == 0; }
  friend bool operator==(const ObjectHandle&, const ObjectHandle&) = default;
};

/// The contract of ParticlePool for whole objects. Objects live in slabs and never move; `T` is default constructible
/// and move assignable. A new object is a fresh `T{}`, or, once `initialize` set a function, whatever the slot held
/// before, passed to that function: it may reuse memory that the object owns, and must set all it relies on. Iteration
/// is in slot order, the same in every run. Not for several threads at once; distinct objects may be used from distinct
/// threads.
template <typename T>
class ObjectPool {
 public:
  using Handle = ObjectHandle<T>;
  using Initializer = std::function<void(T&)>;

  /// PoolError if the capacity is 0 or above 2³¹, or the name is empty.
  explicit ObjectPool(PoolSettings settings);

  std::size_t size() const { return table_.liveCount(); }
  bool empty() const { return size() == 0; }
  std::size_t capacity() const { return table_.capacity(); }
  const PoolSettings& settings() const { return settings_; }
  const PoolCounters& counters() const { return counters_; }

  /// Full: PoolError under Fixed, naming the pool, its capacity and how to raise it.
  Handle create();
  /// As `create`, but null where it would throw (also when memory is short): for use inside steps.
  Handle tryCreate();
  /// As `tryCreate`, but the object stays what its slot held before, with no initializer: for a caller that sets all of
  /// it.
  Handle tryCreateRaw();
  void initialize(Initializer initializer) { initializer_ = std::move(initializer); }

  /// PoolError for a null, stale or already released handle. The object is left as it is until its slot is reused.
  void release(Handle handle);
  /// As `release`, but false where it would throw.
  bool tryRelease(Handle handle);

  bool isAlive(Handle handle) const { return table_.isLive(handle.slot, handle.generation); }
  /// Null for a null or stale handle.
  T* find(Handle handle) { return isAlive(handle) ? &at(handle.slot) : nullptr; }
  const T* find(Handle handle) const { return isAlive(handle) ? &at(handle.slot) : nullptr; }
  /// Precondition: isAlive(handle).
  T& operator[](Handle handle) {
    FROUDE_ASSERT(isAlive(handle));
    return at(handle.slot);
  }
  const T& operator[](Handle handle) const {
    FROUDE_ASSERT(isAlive(handle));
    return at(handle.slot);
  }

  /// visit(Handle, T&) for every live object in slot order. `visit` may release the object that it was given.
  template <typename Visit>
  void forEach(Visit&& visit) {
    for (std::uint32_t slot = 0; slot < table_.capacity(); ++slot) {
      if (table_.isLive(slot)) visit(Handle{slot, table_.generation(slot)}, at(slot));
    }
  }

  /// Capacity for at least `count` objects, in whole initial sizes, whatever the policy.
  void reserve(std::size_t count);
  /// Destroys the objects of trailing free slabs and gives their memory back. Returns the number of slots dropped.
  std::size_t purge();
  /// Releases all.
  void clear();

  /// Whole state. Objects with a member `archive(Archive&)` are saved by it; others must be trivially copyable, and
  /// free of padding if they are to be hashed.
  void archive(Archive& archive);
  std::size_t memoryBytes() const;

 private:
  struct FreeSlab {
    std::size_t count;
    void operator()(T* objects) const;
  };
  using Slab = std::unique_ptr<T[], FreeSlab>;

  T& at(std::uint32_t slot) { return slabs_[slot >> shift_][slot & mask_]; }
  const T& at(std::uint32_t slot) const { return slabs_[slot >> shift_][slot & mask_]; }
  bool makeRoom();
  bool tryMakeRoom();
  Handle acquire();
  void reset(T& object);
  void addSlabs(std::size_t capacity);

  PoolSettings settings_;
  PoolCounters counters_;
  SlotTable table_;
  std::vector<Slab> slabs_;
  AlignedArray<std::byte> packed_;  ///< live objects side by side, while saving and loading
  std::uint32_t shift_, mask_;      ///< a slab holds mask_ + 1 = 2^shift_ objects
  Initializer initializer_;
};

}  // namespace froude

#include <froude/particles/object_pool_impl.h>
