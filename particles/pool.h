// The particle pool: structure of arrays with handles that go stale. It owns every per-particle column, the solvers'
// too.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/assert.h>
#include <froude/base/types.h>
#include <froude/particles/slot_table.h>

namespace froude {

/// Names one life of one particle, wherever sorting moves it. {0, 0} is null.
struct ParticleHandle {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;
  bool isNull() const { return generation == 0; }
  friend bool operator==(const ParticleHandle&, const ParticleHandle&) = default;
};

/// `State` columns are zero in a new particle and are saved, hashed, permuted and compacted. `Scratch` columns are only
/// sized: creating, removing and sorting leave undefined values in them.
enum class ColumnKind : std::uint8_t { State, Scratch };
enum class ColumnType : std::uint8_t { Double, Float, Int32, UInt32, UInt64, UInt8 };

/// A typed column of one pool; stays valid for the pool's life.
template <typename T>
struct ColumnId {
  std::uint32_t index = 0xFFFFFFFFu;
};

struct ColumnInfo {
  std::string name;
  ColumnKind kind;
  ColumnType type;
  std::size_t elementSize;  ///< bytes
};

/// Live particles are dense at indices [0, size()) of all columns, which are 64-byte aligned and padded (see
/// AlignedArray). An index is good until the next release, compact or permute, a span until the next create, permute,
/// reserve, purge or load; handles and column ids last. Creating and removing are not for several threads at once,
/// except `kill`. A pool whose capacity suffices allocates nothing, whatever is created, removed and permuted.
class FROUDE_API ParticlePool {
 public:
  using Initializer = std::function<void(ParticlePool&, std::uint32_t index)>;

  /// PoolError if the capacity is 0 or above 2³¹, or the name is empty.
  explicit ParticlePool(PoolSettings settings);

  /// A new column, all zero. PoolError if the name is empty or taken. T: double, float, int32, uint32, uint64 or uint8.
  template <typename T>
  ColumnId<T> addColumn(std::string_view name, ColumnKind kind) {
    return {addColumn(name, kind, typeOf<T>(), sizeof(T))};
  }
  /// The column of that name and type, if there is one.
  template <typename T>
  std::optional<ColumnId<T>> findColumn(std::string_view name) const {
    const std::uint32_t index = findColumn(name, typeOf<T>());
    return index == SlotTable::kNone ? std::nullopt : std::optional(ColumnId<T>{index});
  }
  template <typename T>
  std::span<T> column(ColumnId<T> id) {
    FROUDE_ASSERT(id.index < columns_.size() && columns_[id.index].info.type == typeOf<T>());
    return {reinterpret_cast<T*>(columns_[id.index].data.data()), size_};
  }
  template <typename T>
  std::span<const T> column(ColumnId<T> id) const {
    FROUDE_ASSERT(id.index < columns_.size() && columns_[id.index].info.type == typeOf<T>());
    return {reinterpret_cast<const T*>(columns_[id.index].data.data()), size_};
  }
  std::size_t columnCount() const { return columns_.size(); }
  const ColumnInfo& columnInfo(std::size_t index) const { return columns_[index].info; }
  /// Values of any column as bytes, elementSize · size() of them: for export.
  std::span<const std::byte> columnBytes(std::size_t index) const;

  std::span<double> x() { return column(kX); }    ///< [m]
  std::span<double> y() { return column(kY); }    ///< [m]
  std::span<double> vx() { return column(kVx); }  ///< [m/s]
  std::span<double> vy() { return column(kVy); }  ///< [m/s]
  std::span<const double> x() const { return column(kX); }
  std::span<const double> y() const { return column(kY); }
  std::span<const double> vx() const { return column(kVx); }
  std::span<const double> vy() const { return column(kVy); }
  /// The handle's slot of the particle at each index.
  std::span<const std::uint32_t> slots() const { return column(kSlot); }
  /// Sequence number of creation, from 0, over the pool's whole life.
  std::span<const std::uint64_t> birth() const { return column(kBirth); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Particles that fit before the policy speaks.
  std::size_t capacity() const { return table_.capacity(); }
  const PoolSettings& settings() const { return settings_; }
  const PoolCounters& counters() const { return counters_; }

  /// A new particle at index size() − 1, State columns zero, then passed to the initializer. Full: PoolError under
  /// Fixed.
  ParticleHandle create();
  /// As `create`, but null where it would throw (also when memory is short): for use inside steps.
  ParticleHandle tryCreate();
  /// Called for each new particle from now on (an empty function: none). It must not create or remove particles.
  void initialize(Initializer initializer) { initializer_ = std::move(initializer); }

  /// Removes at once; the last particle takes the freed index. PoolError for a null, stale or already released handle.
  void release(ParticleHandle handle);
  /// As `release`, but false where it would throw.
  bool tryRelease(ParticleHandle handle);
  /// Marks for removal by `compact`; until then the particle stays where it is and its handle is good. Marking twice is
  /// marking once. May be called from several threads for different particles.
  void kill(std::uint32_t index) { markedColumn()[index] = 1; }
  bool isMarked(std::uint32_t index) const { return column(kMarked)[index] != 0; }
  /// Is there anything for `compact`? Cost: one byte read a particle.
  bool anyMarked() const { return firstMarked() < size_; }
  /// Removes all that is marked and keeps the order of the rest. Returns how many went. Cost: O(size) bytes read if
  /// none.
  std::size_t compact();

  bool isAlive(ParticleHandle handle) const { return table_.isLive(handle.slot, handle.generation); }
  /// Where the particle is now; empty for a null or stale handle.
  std::optional<std::uint32_t> indexOf(ParticleHandle handle) const {
    return isAlive(handle) ? std::optional(indexOfSlot_[handle.slot]) : std::nullopt;
  }
  ParticleHandle handleAt(std::uint32_t index) const {
    const std::uint32_t slot = column(kSlot)[index];
    return {slot, table_.generation(slot)};
  }

  /// new[i] = old[order[i]] in all State columns; handles follow. Precondition: a permutation of [0, size()). Parallel.
  void permute(std::span<const std::uint32_t> order);

  /// Capacity for at least `count` particles, in whole initial sizes, whatever the policy.
  void reserve(std::size_t count);
  /// Gives back slots and memory that nothing live needs, in whole initial sizes. Returns the number of slots dropped.
  std::size_t purge();
  /// Removes all particles; their handles go stale.
  void clear();

  /// Whole state: State columns, slots, generations, free list, counters. PoolError when loading into a pool with
  /// another number of State columns. Loading may allocate where more was saved than fits.
  void archive(Archive& archive);
  std::size_t memoryBytes() const;

 private:
  struct Column {
    ColumnInfo info;
    AlignedArray<std::byte> data;
  };
  static constexpr ColumnId<double> kX{0}, kY{1}, kVx{2}, kVy{3};
  static constexpr ColumnId<std::uint32_t> kSlot{4};
  static constexpr ColumnId<std::uint64_t> kBirth{5};
  static constexpr ColumnId<std::uint8_t> kMarked{6};

  template <typename T>
  static constexpr ColumnType typeOf() {
    if constexpr (std::is_same_v<T, double>) return ColumnType::Double;
    if constexpr (std::is_same_v<T, float>) return ColumnType::Float;
    if constexpr (std::is_same_v<T, std::int32_t>) return ColumnType::Int32;
    if constexpr (std::is_same_v<T, std::uint32_t>) return ColumnType::UInt32;
    if constexpr (std::is_same_v<T, std::uint64_t>) return ColumnType::UInt64;
    if constexpr (std::is_same_v<T, std::uint8_t>) return ColumnType::UInt8;
  }
  std::uint32_t addColumn(std::string_view name, ColumnKind kind, ColumnType type, std::size_t elementSize);
  std::uint32_t findColumn(std::string_view name, ColumnType type) const;
  std::uint8_t* markedColumn() { return reinterpret_cast<std::uint8_t*>(columns_[kMarked.index].data.data()); }
  std::size_t firstMarked() const;  ///< size() if none
  bool makeRoom();
  ParticleHandle append();
  void removeAt(std::uint32_t index);
  void growTo(std::size_t capacity);
  void sizeColumns(std::size_t rows);
  AlignedArray<std::byte>& spareOf(std::size_t elementSize);

  PoolSettings settings_;
  PoolCounters counters_;
  SlotTable table_;
  std::vector<Column> columns_;
  /// The other half of permute's double buffer: one for each size of an element, handed from column to column.
  struct Spare {
    std::size_t elementSize;
    AlignedArray<std::byte> data;
  };
  std::vector<Spare> spares_;
  AlignedArray<std::uint32_t> indexOfSlot_;
  AlignedArray<std::uint32_t> survivors_;  ///< work space of compact
  std::size_t size_ = 0;
  std::size_t rows_ = 0;  ///< particles for which all columns have memory
  Initializer initializer_;
};

}  // namespace froude
