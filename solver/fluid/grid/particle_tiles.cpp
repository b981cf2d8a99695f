#include <froude/solver/fluid/grid/particle_tiles.h>

#include <algorithm>
#include <limits>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr std::size_t kBlock = 4 * kBlockSize;
constexpr std::int32_t kSide = TileGrid::kSide;

// The cell that holds a coordinate, the last one of a period where rounding put it on the seam.
struct Axis {
  double origin, perCell;
  std::int32_t period;
  std::int32_t cell(double x) const {
    const auto i = static_cast<std::int32_t>(std::floor((x - origin) * perCell));
    return period > 0 ? std::clamp(i, 0, period - 1) : i;
  }
};

void sortUnique(std::vector<TileIndex>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

void ParticleTiles::build(std::span<const double> x, std::span<const double> y, const CutGrid& grid) {
  findTiles(x, y, grid);
  addNeighbours(grid);
  tiles_.build(wanted_, {grid.periodX, grid.periodY});
  key_.resize(x.size());
  const Axis alongX{grid.origin.x(), 1.0 / grid.size, grid.periodX},
      alongY{grid.origin.y(), 1.0 / grid.size, grid.periodY};
  parallelFor(x.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    TileIndex last{std::numeric_limits<std::int32_t>::min(), 0};
    std::uint32_t tile = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const std::int32_t i = alongX.cell(x[k]), j = alongY.cell(y[k]);
      const TileIndex at{i >> 4, j >> 4};
      if (at != last) {
        tile = tiles_.find(at.x, at.y);
        last = at;
      }
      key_[k] = tile * static_cast<std::uint32_t>(TileGrid::kCells) +
                static_cast<std::uint32_t>((j & (kSide - 1)) * kSide + (i & (kSide - 1)));
    }
  });
  sort_.sort(key_.span(), tiles_.values());
}

// Particles stand nearly in order, so that a tile comes up a few times a block.
void ParticleTiles::findTiles(std::span<const double> x, std::span<const double> y, const CutGrid& grid) {
  const std::size_t blocks = blockCount(x.size(), kBlock);
  if (found_.size() < blocks) found_.resize(blocks);
  const Axis alongX{grid.origin.x(), 1.0 / grid.size, grid.periodX},
      alongY{grid.origin.y(), 1.0 / grid.size, grid.periodY};
  parallelFor(x.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<TileIndex>& list = found_[begin / kBlock];
    list.clear();
    TileIndex last{std::numeric_limits<std::int32_t>::min(), 0};
    for (std::size_t k = begin; k < end; ++k) {
      const TileIndex at{alongX.cell(x[k]) >> 4, alongY.cell(y[k]) >> 4};
      if (at == last) continue;
      list.push_back(at);
      last = at;
    }
    sortUnique(list);
  });
  wanted_.clear();
  for (std::size_t b = 0; b < blocks; ++b) wanted_.insert(wanted_.end(), found_[b].begin(), found_[b].end());
  sortUnique(wanted_);
}

void ParticleTiles::addNeighbours(const CutGrid& grid) {
  auto wrapped = [](std::int32_t tile, std::int32_t period) {
    const std::int32_t count = (period + kSide - 1) / kSide;
    return count == 0 ? tile : (tile % count + count) % count;
  };
  const std::size_t own = wanted_.size();
  for (std::size_t k = 0; k < own; ++k) {
    const TileIndex at = wanted_[k];
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        wanted_.push_back({wrapped(at.x + dx, grid.periodX), wrapped(at.y + dy, grid.periodY)});
      }
    }
  }
  sortUnique(wanted_);
}

std::size_t ParticleTiles::memoryBytes() const {
  return tiles_.memoryBytes() + sort_.memoryBytes() + key_.capacity() * sizeof(std::uint32_t) +
         wanted_.capacity() * sizeof(TileIndex);
}

}  // namespace froude
