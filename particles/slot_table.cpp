#include <froude/particles/slot_table.h>

#include <algorithm>

namespace froude {

PoolSettings checkedSettings(PoolSettings settings) {
  if (settings.name.empty()) throw PoolError("a pool has no name; give PoolSettings::name");
  if (settings.initialCapacity == 0 || settings.initialCapacity > kMaxPoolCapacity) {
    throw PoolError("pool '" + settings.name + "': an initial capacity of " + std::to_string(settings.initialCapacity) +
                    " is outside 1 … 2147483648");
  }
  return settings;
}

std::string poolFullMessage(const PoolSettings& settings, std::size_t capacity) {
  return "pool '" + settings.name + "' is full: all " + std::to_string(capacity) +
         " places are in use; raise PoolSettings::initialCapacity, call reserve, or choose GrowthPolicy::Grow or "
         "RecycleOldest";
}

std::string badHandleMessage(const PoolSettings& settings, std::uint32_t slot, std::uint32_t generation) {
  const std::string start = "pool '" + settings.name + "': ";
  if (generation == 0) return start + "a null handle cannot be released";
  return start + "the handle {slot " + std::to_string(slot) + ", generation " + std::to_string(generation) +
         "} is stale: what it named was released before, or belongs to another pool; ask isAlive first";
}

SlotTable::SlotTable(std::size_t capacity, bool tracksAge) : tracksAge_(tracksAge) { grow(capacity); }

void SlotTable::grow(std::size_t count) {
  const std::size_t before = capacity();
  const std::size_t after = before + count;
  generation_.reserve(after);
  free_.reserve(after);
  if (tracksAge_) {
    older_.reserve(after);
    younger_.reserve(after);
  }
  generation_.resize(after);
  free_.resize(after);
  // Below the others, the lowest on top, so that fresh slots come in order.
  std::copy_backward(free_.begin(), free_.begin() + freeCount_, free_.begin() + freeCount_ + count);
  for (std::size_t k = 0; k < count; ++k) {
    generation_[before + k] = firstGeneration_;
    free_[k] = static_cast<std::uint32_t>(after - 1 - k);
  }
  freeCount_ += count;
  if (tracksAge_) {
    older_.resize(after);
    younger_.resize(after);
  }
}

std::size_t SlotTable::purge(std::size_t granule) {
  const auto isNeeded = [this](std::size_t slot) {
    return (generation_[slot] & 1u) != 0 || generation_[slot] == kWorn;
  };
  std::size_t needed = capacity();
  while (needed > 0 && !isNeeded(needed - 1)) --needed;
  const std::size_t kept = std::min(capacity(), std::max<std::size_t>(1, (needed + granule - 1) / granule) * granule);
  const std::size_t dropped = capacity() - kept;
  if (dropped == 0) return 0;
  for (std::size_t slot = kept; slot < capacity(); ++slot) {
    firstGeneration_ = std::max(firstGeneration_, generation_[slot]);
  }
  const auto isDropped = [kept](std::uint32_t slot) { return slot >= kept; };
  std::remove_if(free_.begin(), free_.begin() + freeCount_, isDropped);
  freeCount_ -= dropped;
  for (AlignedArray<std::uint32_t>* a : {&generation_, &free_}) {
    a->resize(kept);
    a->shrink();
  }
  if (tracksAge_) {
    for (AlignedArray<std::uint32_t>* a : {&older_, &younger_}) {
      a->resize(kept);
      a->shrink();
    }
  }
  return dropped;
}

std::uint32_t SlotTable::acquireTracked() {
  const std::uint32_t slot = free_[--freeCount_];
  ++generation_[slot];
  linkYoungest(slot);
  return slot;
}

void SlotTable::releaseRarely(std::uint32_t slot) {
  if (tracksAge_) unlink(slot);
  if (++generation_[slot] == kWorn) {
    ++wornCount_;
  } else {
    free_[freeCount_++] = slot;
  }
}

void SlotTable::linkYoungest(std::uint32_t slot) {
  older_[slot] = youngest_;
  younger_[slot] = kNone;
  (youngest_ == kNone ? oldest_ : younger_[youngest_]) = slot;
  youngest_ = slot;
}

void SlotTable::unlink(std::uint32_t slot) {
  const std::uint32_t older = older_[slot];
  const std::uint32_t younger = younger_[slot];
  (older == kNone ? oldest_ : younger_[older]) = younger;
  (younger == kNone ? youngest_ : older_[younger]) = older;
  older_[slot] = younger_[slot] = 0;  // so that equal states have equal bytes
}

void SlotTable::archive(Archive& archive) {
  archive.array("generation", generation_);
  const std::size_t slots = generation_.size();
  if (archive.loading()) free_.resize(slots);
  freeCount_ = archive.count("free", freeCount_);
  if (freeCount_ > slots) throw PoolError("saved state: more free slots than slots");
  archive.bytes("free", free_.data(), sizeof(std::uint32_t), freeCount_);
  archive.value("first_generation", firstGeneration_);
  if (tracksAge_) {
    archive.array("older", older_);
    archive.array("younger", younger_);
    archive.value("oldest", oldest_);
    archive.value("youngest", youngest_);
  }
  wornCount_ = static_cast<std::size_t>(std::count(generation_.begin(), generation_.end(), kWorn));
}

std::size_t SlotTable::memoryBytes() const {
  return sizeof(std::uint32_t) * (generation_.capacity() + free_.capacity() + older_.capacity() + younger_.capacity());
}

}  // namespace froude
