// Sinks and lifetimes: what takes particles out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/archive.h>
#include <froude/fields/polygon.h>
#include <froude/particles/pool.h>

namespace froude {

/// Polygons that swallow a particle whose centre is inside. Where sinks overlap the first one counts it.
class FROUDE_API SinkSet {
 public:
  /// Returns the sink's number.
  std::size_t add(Polygon shape);
  std::size_t size() const { return sinks_.size(); }
  bool empty() const { return sinks_.empty(); }

  /// The first sink that contains the point, or −1. Boxes are looked at first.
  std::int32_t sinkAt(const Vec2& point) const;
  /// Marks (ParticlePool::kill) all particles inside a sink that are not marked yet and counts them. Parallel, same
  /// result on any number of threads. Returns how many were marked.
  std::size_t mark(ParticlePool& pool);
  /// Particles that each sink has swallowed so far.
  std::span<const std::uint64_t> counts() const { return counts_; }

  void archive(Archive& archive);

 private:
  struct Sink {
    Polygon shape;
    Box box;
  };
  std::vector<Sink> sinks_;
  std::vector<std::uint64_t> counts_;
  std::vector<std::uint64_t> blockCounts_;  ///< work space of mark: one row of counts a block
  Box all_;
};

/// Marks all particles with expires ≤ now [s] that are not marked yet; returns how many. NaN never expires, +∞ neither.
FROUDE_API std::size_t markExpired(ParticlePool& pool, ColumnId<double> expires, double now);

/// Particles that carry `value` in the column and are not marked: those of one emitter, say.
FROUDE_API std::size_t countWith(const ParticlePool& pool, ColumnId<std::uint32_t> column, std::uint32_t value);
/// Marks the `count` oldest (by birth) of them, all if there are fewer; returns how many were marked.
FROUDE_API std::size_t markOldestWith(ParticlePool& pool, ColumnId<std::uint32_t> column, std::uint32_t value,
                                      std::size_t count);

}  // namespace froude
