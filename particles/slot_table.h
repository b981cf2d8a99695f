// Slots with generations: what makes a handle go stale. Shared by the particle pool and the object pools; holds no
// payload.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <froude/base/aligned.h>
#include <froude/base/api.h>
#include <froude/base/archive.h>
#include <froude/base/error.h>

namespace froude {

/// What a full pool does: `Fixed` refuses, `Grow` adds its initial size, `RecycleOldest` releases the oldest live
/// entry.
enum class GrowthPolicy { Fixed, Grow, RecycleOldest };

/// Definition of a pool.
struct PoolSettings {
  std::size_t initialCapacity = 1024;  ///< entries, 1 … 2³¹; also the step by which `Grow` grows
  GrowthPolicy policy = GrowthPolicy::Grow;
  std::string name = "pool";  ///< appears in errors and as the section of saved state
};

/// A full `Fixed` pool, a stale or doubled release, a definition that cannot be met.
class FROUDE_API PoolError : public Error {
 public:
  using Error::Error;
};

/// What happened to a pool since it was made; part of its saved state.
struct PoolCounters {
  std::uint64_t created = 0;
  std::uint64_t released = 0;  ///< all that went, the recycled ones included
  std::uint64_t recycled = 0;  ///< released by RecycleOldest to make room
  std::uint64_t refused = 0;   ///< creations that a full pool turned down
};

inline constexpr std::size_t kMaxPoolCapacity = std::size_t{1} << 31;

/// The words that both kinds of pool share. `checkedSettings` returns what it is given, or throws PoolError.
FROUDE_API PoolSettings checkedSettings(PoolSettings settings);
FROUDE_API std::string poolFullMessage(const PoolSettings& settings, std::size_t capacity);
FROUDE_API std::string badHandleMessage(const PoolSettings& settings, std::uint32_t slot, std::uint32_t generation);

/// Hands out slot numbers. A slot's generation is odd while it is live and even while it is free, and rises with every
/// change, so that {slot, generation} names one life of a slot; generation 0 was never handed out. The slot that was
/// freed last is handed out first, while it is still in the caches. After 2³¹ − 1 lives a slot is worn: it is taken out
/// of service, so that no handle ever names two lives. All operations are O(1) unless said otherwise and allocate
/// nothing, `grow` and `purge` excepted. Not for use from several threads at once.
class FROUDE_API SlotTable {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  /// `tracksAge` keeps the live slots in order of birth (two words a slot), for `oldest`.
  SlotTable(std::size_t capacity, bool tracksAge);

  /// Slots, the worn ones included.
  std::size_t capacity() const { return generation_.size(); }
  std::size_t liveCount() const { return generation_.size() - freeCount_ - wornCount_; }
  bool full() const { return freeCount_ == 0; }
  std::uint32_t generation(std::uint32_t slot) const { return generation_[slot]; }
  bool isLive(std::uint32_t slot) const { return (generation_[slot] & 1u) != 0; }
  /// True for the one life of the slot that {slot, generation} names; false for anything else, null included.
  bool isLive(std::uint32_t slot, std::uint32_t generation) const {
    return slot < generation_.size() && (generation & 1u) != 0 && generation_[slot] == generation;
  }

  /// Takes the slot that was freed last; of slots never used, the lowest. Precondition: not full.
  std::uint32_t acquire() {
    if (tracksAge_) [[unlikely]]
      return acquireTracked();
    const std::uint32_t slot = free_[--freeCount_];
    ++generation_[slot];
    return slot;
  }
  /// Frees a live slot. Precondition: isLive(slot).
  void release(std::uint32_t slot) {
    const std::uint32_t next = generation_[slot] + 1;
    if (tracksAge_ || next == kWorn) [[unlikely]]
      return releaseRarely(slot);
    generation_[slot] = next;
    free_[freeCount_++] = slot;
  }
  /// The slot that will be acquired some acquisitions from now, if none is released meanwhile: for prefetching.
  /// Precondition: not full.
  std::uint32_t upcoming() const {
    constexpr std::size_t kAhead = 8;
    return free_[freeCount_ > kAhead ? freeCount_ - 1 - kAhead : 0];
  }
  /// The live slot that was acquired first. Preconditions: tracksAge, and at least one is live.
  std::uint32_t oldest() const { return oldest_; }

  /// Adds `count` slots, to be taken after the free ones. Strong guarantee: std::bad_alloc leaves the table as it was.
  /// Cost: O(count + free slots).
  void grow(std::size_t count);
  /// Drops free slots from the end, down to a whole multiple of `granule` that holds all live and worn slots, never
  /// below one granule. Slots that a later `grow` adds start above every generation that was dropped, so stale handles
  /// stay stale. Returns the number of slots dropped. Cost: O(capacity).
  std::size_t purge(std::size_t granule);

  void archive(Archive& archive);
  std::size_t memoryBytes() const;

 private:
  static constexpr std::uint32_t kWorn = 0xFFFFFFFEu;  // even: not live

  // What is rare is out of line and whole: the compiler then keeps the short path's numbers in registers.
  std::uint32_t acquireTracked();
  void releaseRarely(std::uint32_t slot);
  void linkYoungest(std::uint32_t slot);
  void unlink(std::uint32_t slot);

  AlignedArray<std::uint32_t> generation_;
  AlignedArray<std::uint32_t> free_;  ///< the first freeCount_: free slots, the next to be taken last
  AlignedArray<std::uint32_t> older_, younger_;
  std::size_t freeCount_ = 0, wornCount_ = 0;
  std::uint32_t oldest_ = kNone, youngest_ = kNone;
  std::uint32_t firstGeneration_ = 0;  ///< of slots to come: even, above all that purge dropped
  bool tracksAge_;
};

}  // namespace froude
