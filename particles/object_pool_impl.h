// How ObjectPool does it. Included by object_pool.h.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include <froude/particles/object_pool.h>

namespace froude {

inline constexpr std::align_val_t kSlabAlignment{64};

// The paths that are short are `inline`, which GCC takes as a wish at -O2: a call for each object would cost as much as
// the object.

template <typename T>
ObjectPool<T>::ObjectPool(PoolSettings settings)
    : settings_(checkedSettings(std::move(settings))),
      table_(settings_.initialCapacity, settings_.policy == GrowthPolicy::RecycleOldest),
      // A power of two, so that a slot's address is a shift and a mask; an eighth, so that rounding up wastes little.
      shift_(static_cast<std::uint32_t>(std::bit_width(std::max<std::size_t>(16, settings_.initialCapacity / 8)) - 1)),
      mask_((1u << shift_) - 1) {
  addSlabs(table_.capacity());
}

template <typename T>
void ObjectPool<T>::addSlabs(std::size_t capacity) {
  const std::size_t wanted = (capacity + mask_) >> shift_;
  slabs_.reserve(wanted);
  const std::size_t count = std::size_t{mask_} + 1;
  while (slabs_.size() < wanted) {
    // On whole cache lines, so that an object of 64 bytes is one line and not parts of two.
    auto* objects = static_cast<T*>(::operator new(count * sizeof(T), kSlabAlignment));
    try {
      std::uninitialized_value_construct_n(objects, count);
    } catch (...) {
      ::operator delete(objects, kSlabAlignment);
      throw;
    }
    slabs_.push_back(Slab(objects, FreeSlab{count}));
  }
}

template <typename T>
void ObjectPool<T>::FreeSlab::operator()(T* objects) const {
  std::destroy_n(objects, count);
  ::operator delete(objects, kSlabAlignment);
}

template <typename T>
void ObjectPool<T>::reserve(std::size_t count) {
  if (count <= table_.capacity()) return;
  const std::size_t step = settings_.initialCapacity;
  const std::size_t capacity = (count + step - 1) / step * step;
  if (capacity > kMaxPoolCapacity) {
    throw PoolError("pool '" + settings_.name + "' cannot hold " + std::to_string(capacity) +
                    " objects; the largest capacity is 2147483648");
  }
  addSlabs(capacity);
  table_.grow(capacity - table_.capacity());
}

template <typename T>
bool ObjectPool<T>::makeRoom() {
  if (settings_.policy == GrowthPolicy::Fixed) return false;
  if (settings_.policy == GrowthPolicy::Grow) {
    reserve(table_.capacity() + 1);
  } else {
    table_.release(table_.oldest());
    ++counters_.released;
    ++counters_.recycled;
  }
  return true;
}

template <typename T>
bool ObjectPool<T>::tryMakeRoom() {
  try {
    if (makeRoom()) return true;
  } catch (const std::bad_alloc&) {
  } catch (const PoolError&) {
  }
  ++counters_.refused;
  return false;
}

template <typename T>
inline ObjectHandle<T> ObjectPool<T>::acquire() {
  const std::uint32_t slot = table_.acquire();
  ++counters_.created;
  return {slot, table_.generation(slot)};
}

template <typename T>
inline void ObjectPool<T>::reset(T& object) {
  if (initializer_) {
    initializer_(object);
  } else {
    object = T{};
  }
}

template <typename T>
ObjectHandle<T> ObjectPool<T>::create() {
  if (table_.full() && !makeRoom()) {
    ++counters_.refused;
    throw PoolError(poolFullMessage(settings_, capacity()));
  }
  const Handle handle = acquire();
  reset(at(handle.slot));
  return handle;
}

template <typename T>
inline ObjectHandle<T> ObjectPool<T>::tryCreate() {
  if (table_.full()) [[unlikely]] {
    if (!tryMakeRoom()) return {};
  }
  const Handle handle = acquire();
#if defined(__GNUC__)
  // The order in which free slots come is known: fetching an object that will be reset soon hides its cache misses. Not
  // in a function of its own, which GCC takes for one without effect, and drops.
  if (!table_.full()) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&at(table_.upcoming()));
    for (std::size_t line = 0; line < sizeof(T) && line < 256; line += 64) __builtin_prefetch(bytes + line, 1);
  }
#endif
  reset(at(handle.slot));
  return handle;
}

template <typename T>
inline ObjectHandle<T> ObjectPool<T>::tryCreateRaw() {
  if (table_.full()) [[unlikely]] {
    if (!tryMakeRoom()) return {};
  }
  return acquire();
}

template <typename T>
inline bool ObjectPool<T>::tryRelease(Handle handle) {
  if (!isAlive(handle)) return false;
  table_.release(handle.slot);
  ++counters_.released;
  return true;
}

template <typename T>
inline void ObjectPool<T>::release(Handle handle) {
  if (!tryRelease(handle)) throw PoolError(badHandleMessage(settings_, handle.slot, handle.generation));
}

template <typename T>
void ObjectPool<T>::clear() {
  forEach([this](Handle handle, T&) { release(handle); });
}

template <typename T>
std::size_t ObjectPool<T>::purge() {
  const std::size_t dropped = table_.purge(settings_.initialCapacity);
  slabs_.resize((table_.capacity() + mask_) >> shift_);
  return dropped;
}

template <typename T>
void ObjectPool<T>::archive(Archive& archive) {
  archive.beginSection(settings_.name);
  table_.archive(archive);
  archive.bytes("counters", &counters_, sizeof(std::uint64_t), sizeof counters_ / sizeof(std::uint64_t));
  if (archive.loading()) addSlabs(table_.capacity());
  if constexpr (requires(T & object, Archive & a) { object.archive(a); }) {
    forEach([&archive](Handle handle, T& object) {
      archive.beginSection(std::to_string(handle.slot));
      object.archive(archive);
      archive.endSection();
    });
  } else {
    static_assert(std::is_trivially_copyable_v<T>, "give T a member archive(Archive&)");
    packed_.resize(size() * sizeof(T));
    std::byte* next = packed_.data();
    if (!archive.loading()) {
      forEach([&next](Handle, T& object) {
        std::memcpy(next, static_cast<const void*>(&object), sizeof(T));
        next += sizeof(T);
      });
    }
    archive.bytes("objects", packed_.data(), sizeof(T), size());
    if (archive.loading()) {
      forEach([&next](Handle, T& object) {
        std::memcpy(static_cast<void*>(&object), next, sizeof(T));
        next += sizeof(T);
      });
    }
  }
  archive.endSection();
}

template <typename T>
std::size_t ObjectPool<T>::memoryBytes() const {
  return table_.memoryBytes() + packed_.capacity() + slabs_.size() * (std::size_t{mask_} + 1) * sizeof(T);
}

}  // namespace froude
