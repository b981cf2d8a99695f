#include <froude/particles/pool.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include <froude/base/parallel.h>

namespace froude {
namespace {

template <std::size_t N>
void gather(std::byte* to, const std::byte* from, std::span<const std::uint32_t> order, std::size_t begin,
            std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) std::memcpy(to + i * N, from + std::size_t{order[i]} * N, N);
}

void gather(std::size_t elementSize, std::byte* to, const std::byte* from, std::span<const std::uint32_t> order,
            std::size_t begin, std::size_t end) {
  if (elementSize == 8) return gather<8>(to, from, order, begin, end);
  if (elementSize == 4) return gather<4>(to, from, order, begin, end);
  gather<1>(to, from, order, begin, end);
}

}  // namespace

ParticlePool::ParticlePool(PoolSettings settings)
    : settings_(checkedSettings(std::move(settings))),
      table_(settings_.initialCapacity, settings_.policy == GrowthPolicy::RecycleOldest) {
  for (const char* name : {"x", "y", "vx", "vy"}) addColumn<double>(name, ColumnKind::State);
  addColumn<std::uint32_t>("slot", ColumnKind::State);
  addColumn<std::uint64_t>("birth", ColumnKind::State);
  addColumn<std::uint8_t>("marked", ColumnKind::State);
  indexOfSlot_.resize(table_.capacity());
  sizeColumns(table_.capacity());
}

std::uint32_t ParticlePool::addColumn(std::string_view name, ColumnKind kind, ColumnType type,
                                      std::size_t elementSize) {
  if (name.empty()) throw PoolError("pool '" + settings_.name + "': a column needs a name");
  for (const Column& c : columns_) {
    if (c.info.name == name) {
      throw PoolError("pool '" + settings_.name + "' has a column '" + std::string(name) +
                      "' already; use findColumn to share it, or choose another name");
    }
  }
  Column column{{std::string(name), kind, type, elementSize}, {}};
  column.data.resize(rows_ * elementSize);
  if (kind == ColumnKind::State) spareOf(elementSize).resize(rows_ * elementSize);
  columns_.push_back(std::move(column));
  return static_cast<std::uint32_t>(columns_.size() - 1);
}

std::uint32_t ParticlePool::findColumn(std::string_view name, ColumnType type) const {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].info.name == name && columns_[i].info.type == type) return static_cast<std::uint32_t>(i);
  }
  return SlotTable::kNone;
}

std::span<const std::byte> ParticlePool::columnBytes(std::size_t index) const {
  const Column& c = columns_[index];
  return {c.data.data(), size_ * c.info.elementSize};
}

// Reserves everywhere before it resizes anywhere, so that a lack of memory leaves the pool as it was.
void ParticlePool::sizeColumns(std::size_t rows) {
  for (Column& c : columns_) c.data.reserve(rows * c.info.elementSize);
  for (Spare& spare : spares_) spare.data.reserve(rows * spare.elementSize);
  survivors_.reserve(rows);
  for (Column& c : columns_) c.data.resize(rows * c.info.elementSize);
  for (Spare& spare : spares_) spare.data.resize(rows * spare.elementSize);
  survivors_.resize(rows);
  rows_ = rows;
}

void ParticlePool::growTo(std::size_t capacity) {
  if (capacity > kMaxPoolCapacity) {
    throw PoolError("pool '" + settings_.name + "' cannot hold " + std::to_string(capacity) +
                    " particles; the largest capacity is 2147483648");
  }
  if (capacity > rows_) sizeColumns(capacity);
  indexOfSlot_.reserve(capacity);
  table_.grow(capacity - table_.capacity());
  indexOfSlot_.resize(capacity);
}

void ParticlePool::reserve(std::size_t count) {
  if (count <= table_.capacity()) return;
  const std::size_t step = settings_.initialCapacity;
  growTo((count + step - 1) / step * step);
}

bool ParticlePool::makeRoom() {
  if (!table_.full()) {
    if (size_ == rows_) sizeColumns(std::min(table_.capacity(), rows_ + settings_.initialCapacity));
    return true;
  }
  if (settings_.policy == GrowthPolicy::Fixed) return false;
  if (settings_.policy == GrowthPolicy::Grow) {
    growTo(table_.capacity() + settings_.initialCapacity);
    return true;
  }
  removeAt(indexOfSlot_[table_.oldest()]);
  ++counters_.recycled;
  return true;
}

ParticleHandle ParticlePool::append() {
  const std::uint32_t slot = table_.acquire();
  const auto index = static_cast<std::uint32_t>(size_++);
  for (Column& c : columns_) {
    if (c.info.kind == ColumnKind::State) {
      std::memset(c.data.data() + index * c.info.elementSize, 0, c.info.elementSize);
    }
  }
  indexOfSlot_[slot] = index;
  column(kSlot)[index] = slot;
  column(kBirth)[index] = counters_.created++;
  if (initializer_) initializer_(*this, index);
  return {slot, table_.generation(slot)};
}

ParticleHandle ParticlePool::create() {
  if (!makeRoom()) {
    ++counters_.refused;
    throw PoolError(poolFullMessage(settings_, capacity()));
  }
  return append();
}

ParticleHandle ParticlePool::tryCreate() {
  bool room = false;
  try {
    room = makeRoom();
  } catch (const std::bad_alloc&) {
  } catch (const PoolError&) {
  }
  if (room) return append();
  ++counters_.refused;
  return {};
}

void ParticlePool::removeAt(std::uint32_t index) {
  table_.release(column(kSlot)[index]);
  ++counters_.released;
  const std::size_t last = size_ - 1;
  if (index != last) {
    for (Column& c : columns_) {
      const std::size_t n = c.info.elementSize;
      if (c.info.kind == ColumnKind::State) std::memcpy(c.data.data() + index * n, c.data.data() + last * n, n);
    }
    indexOfSlot_[column(kSlot)[index]] = index;
  }
  size_ = last;
}

bool ParticlePool::tryRelease(ParticleHandle handle) {
  if (!isAlive(handle)) return false;
  removeAt(indexOfSlot_[handle.slot]);
  return true;
}

void ParticlePool::release(ParticleHandle handle) {
  if (!tryRelease(handle)) throw PoolError(badHandleMessage(settings_, handle.slot, handle.generation));
}

std::size_t ParticlePool::firstMarked() const {
  const std::uint8_t* marked = column(kMarked).data();
  const void* hit = size_ > 0 ? std::memchr(marked, 1, size_) : nullptr;
  return hit == nullptr ? size_ : static_cast<std::size_t>(static_cast<const std::uint8_t*>(hit) - marked);
}

std::size_t ParticlePool::compact() {
  const std::size_t first = firstMarked();
  if (first == size_) return 0;
  const std::uint8_t* marked = markedColumn();
  const std::uint32_t* slot = column(kSlot).data();
  std::size_t kept = first;
  for (std::size_t i = first; i < size_; ++i) {
    if (marked[i] != 0) {
      table_.release(slot[i]);
    } else {
      indexOfSlot_[slot[i]] = static_cast<std::uint32_t>(kept);
      survivors_[kept++] = static_cast<std::uint32_t>(i);
    }
  }
  // In place: survivors only move down, and each column is one task.
  parallelFor(columns_.size(), 1, [&](std::size_t c, std::size_t) {
    Column& column = columns_[c];
    if (column.info.kind != ColumnKind::State) return;
    gather(column.info.elementSize, column.data.data(), column.data.data(), survivors_.span(), first, kept);
  });
  const std::size_t removed = size_ - kept;
  counters_.released += removed;
  size_ = kept;
  return removed;
}

void ParticlePool::permute(std::span<const std::uint32_t> order) {
  FROUDE_ASSERT(order.size() == size_);
  for (Column& c : columns_) {
    if (c.info.kind != ColumnKind::State) continue;
    AlignedArray<std::byte>& spare = spareOf(c.info.elementSize);
    parallelFor(size_, [&](std::size_t begin, std::size_t end) {
      gather(c.info.elementSize, spare.data(), c.data.data(), order, begin, end);
    });
    c.data.swap(spare);
  }
  const std::span<const std::uint32_t> slot = slots();
  parallelFor(size_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) indexOfSlot_[slot[i]] = static_cast<std::uint32_t>(i);
  });
}

AlignedArray<std::byte>& ParticlePool::spareOf(std::size_t elementSize) {
  for (Spare& spare : spares_) {
    if (spare.elementSize == elementSize) return spare.data;
  }
  return spares_.emplace_back(Spare{elementSize, {}}).data;
}

std::size_t ParticlePool::purge() {
  const std::size_t step = settings_.initialCapacity;
  const std::size_t dropped = table_.purge(step);
  indexOfSlot_.resize(table_.capacity());
  indexOfSlot_.shrink();
  const std::size_t rows = std::max<std::size_t>(1, (size_ + step - 1) / step) * step;
  if (rows >= rows_) return dropped;
  for (Column& c : columns_) {
    c.data.resize(rows * c.info.elementSize);
    c.data.shrink();
  }
  for (Spare& spare : spares_) {
    spare.data.resize(rows * spare.elementSize);
    spare.data.shrink();
  }
  survivors_.resize(rows);
  survivors_.shrink();
  rows_ = rows;
  return dropped;
}

void ParticlePool::clear() {
  for (const std::uint32_t slot : slots()) table_.release(slot);
  counters_.released += size_;
  size_ = 0;
}

void ParticlePool::archive(Archive& archive) {
  archive.beginSection(settings_.name);
  const auto isState = [](const Column& c) { return c.info.kind == ColumnKind::State; };
  const auto own = static_cast<std::size_t>(std::count_if(columns_.begin(), columns_.end(), isState));
  const std::size_t saved = archive.count("columns", own);
  if (saved != own) {
    throw PoolError("pool '" + settings_.name + "': the saved state has " + std::to_string(saved) +
                    " columns, this pool has " + std::to_string(own) + "; it was saved from another definition");
  }
  table_.archive(archive);
  const std::size_t size = archive.count("size", size_);
  if (size > table_.capacity()) throw PoolError("pool '" + settings_.name + "': saved state is damaged");
  if (archive.loading()) {
    indexOfSlot_.resize(table_.capacity());
    if (size > rows_) sizeColumns(table_.capacity());
    size_ = size;
  }
  archive.bytes("counters", &counters_, sizeof(std::uint64_t), sizeof counters_ / sizeof(std::uint64_t));
  archive.beginSection("column");
  for (Column& c : columns_) {
    if (isState(c)) archive.bytes(c.info.name, c.data.data(), c.info.elementSize, size_);
  }
  archive.endSection();
  archive.endSection();
  if (!archive.loading()) return;
  const std::span<const std::uint32_t> slot = slots();
  for (std::size_t i = 0; i < size_; ++i) {
    if (slot[i] >= indexOfSlot_.size()) throw PoolError("pool '" + settings_.name + "': saved state is damaged");
    indexOfSlot_[slot[i]] = static_cast<std::uint32_t>(i);
  }
}

std::size_t ParticlePool::memoryBytes() const {
  std::size_t bytes = table_.memoryBytes();
  bytes += (indexOfSlot_.capacity() + survivors_.capacity()) * sizeof(std::uint32_t);
  for (const Column& c : columns_) bytes += c.data.capacity();
  for (const Spare& spare : spares_) bytes += spare.data.capacity();
  return bytes;
}

}  // namespace froude
