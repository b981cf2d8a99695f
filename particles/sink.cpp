#include <froude/particles/sink.h>

#include <algorithm>
#include <array>
#include <utility>

#include <froude/base/parallel.h>

namespace froude {

std::size_t SinkSet::add(Polygon shape) {
  const Box box = shape.bounds();
  all_.include(box);
  sinks_.push_back({std::move(shape), box});
  counts_.push_back(0);
  return sinks_.size() - 1;
}

std::int32_t SinkSet::sinkAt(const Vec2& point) const {
  if (!all_.contains(point)) return -1;
  for (std::size_t s = 0; s < sinks_.size(); ++s) {
    if (sinks_[s].box.contains(point) && sinks_[s].shape.contains(point)) return static_cast<std::int32_t>(s);
  }
  return -1;
}

std::size_t SinkSet::mark(ParticlePool& pool) {
  if (empty() || pool.empty()) return 0;
  const std::span<const double> x = pool.x(), y = pool.y();
  const std::size_t sinks = sinks_.size();
  blockCounts_.assign(blockCount(pool.size()) * sinks, 0);
  parallelFor(pool.size(), [&](std::size_t begin, std::size_t end) {
    std::uint64_t* counts = blockCounts_.data() + begin / kBlockSize * sinks;
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t s = sinkAt({x[i], y[i]});
      if (s < 0 || pool.isMarked(static_cast<std::uint32_t>(i))) continue;
      pool.kill(static_cast<std::uint32_t>(i));
      ++counts[s];
    }
  });
  std::size_t marked = 0;
  for (std::size_t k = 0; k < blockCounts_.size(); ++k) {
    counts_[k % sinks] += blockCounts_[k];
    marked += blockCounts_[k];
  }
  return marked;
}

void SinkSet::archive(Archive& archive) {
  archive.beginSection("sinks");
  const std::size_t saved = archive.count("count", counts_.size());
  if (saved != counts_.size()) throw Error("sinks: the saved state has another number of sinks");
  archive.bytes("swallowed", counts_.data(), sizeof(std::uint64_t), counts_.size());
  archive.endSection();
}

namespace {

// Marks every particle for which `due` holds. The counts are whole numbers, exact as doubles: the sum is too.
template <typename Due>
std::size_t markWhere(ParticlePool& pool, Due due) {
  return static_cast<std::size_t>(parallelSum(pool.size(), [&](std::size_t begin, std::size_t end) {
    double marked = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<std::uint32_t>(k);
      if (!due(i) || pool.isMarked(i)) continue;
      pool.kill(i);
      marked += 1.0;
    }
    return marked;
  }));
}

}  // namespace

std::size_t markExpired(ParticlePool& pool, ColumnId<double> expires, double now) {
  const std::span<const double> at = pool.column(expires);
  return markWhere(pool, [&](std::uint32_t i) { return at[i] <= now && at[i] < kInfinity; });
}

std::size_t countWith(const ParticlePool& pool, ColumnId<std::uint32_t> column, std::uint32_t value) {
  const std::span<const std::uint32_t> values = pool.column(column);
  return static_cast<std::size_t>(parallelSum(pool.size(), [&](std::size_t begin, std::size_t end) {
    double count = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      if (values[i] == value && !pool.isMarked(static_cast<std::uint32_t>(i))) count += 1.0;
    }
    return count;
  }));
}

std::size_t markOldestWith(ParticlePool& pool, ColumnId<std::uint32_t> column, std::uint32_t value, std::size_t count) {
  if (count == 0) return 0;
  const std::span<const std::uint32_t> values = pool.column(column);
  const std::span<const std::uint64_t> birth = pool.birth();
  const auto isOurs = [&](std::uint32_t i) { return values[i] == value && !pool.isMarked(i); };
  // Births are distinct. Each pass counts them in 256 buckets and goes on in the one where the count is reached.
  constexpr std::uint64_t kBuckets = 256;
  std::uint64_t low = 0, width = pool.counters().created;
  std::size_t wanted = count;
  while (width > 1) {
    const std::uint64_t step = (width + kBuckets - 1) / kBuckets;
    std::array<std::size_t, kBuckets> counts{};
    for (std::uint32_t i = 0; i < pool.size(); ++i) {
      if (isOurs(i) && birth[i] >= low && birth[i] < low + width) ++counts[(birth[i] - low) / step];
    }
    std::uint64_t bucket = 0;
    while (bucket + 1 < kBuckets && counts[bucket] < wanted) wanted -= counts[bucket++];
    low += bucket * step;
    width = step;
  }
  return markWhere(pool, [&](std::uint32_t i) { return isOurs(i) && birth[i] <= low; });
}

}  // namespace froude
