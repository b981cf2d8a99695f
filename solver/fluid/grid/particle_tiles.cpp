#include <froude/solver/fluid/grid/particle_tiles.h>

#include <algorithm>
#include <array>
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
    const double place = (x - origin) * perCell;
    auto i = static_cast<std::int32_t>(place);
    i -= static_cast<double>(i) > place ? 1 : 0;
    return period > 0 ? std::clamp(i, 0, period - 1) : i;
  }
};

// Tiles in the order in which they are met, and their numbers there.
class Met {
 public:
  explicit Met(std::vector<TileIndex>& list) : list_(&list) {
    list.clear();
    recent_.fill(0);
  }
  std::uint32_t number(const TileIndex& at) {
    std::uint32_t& recent = recent_[static_cast<std::size_t>((at.y & 15) * 16 + (at.x & 15))];
    if (recent < list_->size() && (*list_)[recent] == at) return recent;
    const auto found = std::find(list_->begin(), list_->end(), at);
    recent = static_cast<std::uint32_t>(found - list_->begin());
    if (found == list_->end()) list_->push_back(at);
    return recent;
  }

 private:
  std::vector<TileIndex>* list_;
  std::array<std::uint32_t, 256> recent_;
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
  parallelFor(x.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    Found& found = found_[begin / kBlock];
    found.first.resize(found.tiles.size());
    for (std::size_t k = 0; k < found.tiles.size(); ++k) {
      found.first[k] = tiles_.find(found.tiles[k].x, found.tiles[k].y) * static_cast<std::uint32_t>(TileGrid::kCells);
    }
    for (std::size_t k = begin; k < end; ++k) key_[k] = found.first[key_[k] >> 8] + (key_[k] & 255u);
  });
  sort_.sort(key_.span(), tiles_.values());
}

// Particles stand nearly in order, so that a tile comes up a few times a block. Keys are numbers of tiles within the
// block until the tiles are known.
void ParticleTiles::findTiles(std::span<const double> x, std::span<const double> y, const CutGrid& grid) {
  const std::size_t blocks = blockCount(x.size(), kBlock);
  if (found_.size() < blocks) found_.resize(blocks);
  key_.resize(x.size());
  const Axis alongX{grid.origin.x(), 1.0 / grid.size, grid.periodX},
      alongY{grid.origin.y(), 1.0 / grid.size, grid.periodY};
  parallelFor(x.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    Met met(found_[begin / kBlock].tiles);
    TileIndex last{std::numeric_limits<std::int32_t>::min(), 0};
    std::uint32_t number = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const std::int32_t i = alongX.cell(x[k]), j = alongY.cell(y[k]);
      const TileIndex at{i >> 4, j >> 4};
      if (at != last) {
        number = met.number(at);
        last = at;
      }
      key_[k] = number << 8 | static_cast<std::uint32_t>((j & (kSide - 1)) * kSide + (i & (kSide - 1)));
    }
  });
  wanted_.clear();
  for (std::size_t b = 0; b < blocks; ++b)
    wanted_.insert(wanted_.end(), found_[b].tiles.begin(), found_[b].tiles.end());
  sortUnique(wanted_);
}

// Without periods the tiles beside sorted ones are sorted too: no list of nine times the length is.
void ParticleTiles::addNeighbours(const CutGrid& grid) {
  if (grid.periodX > 0 || grid.periodY > 0) return addWrappedNeighbours(grid);
  rows_.clear();
  for (const TileIndex& at : wanted_) {
    for (std::int32_t dx = -1; dx <= 1; ++dx) {
      const TileIndex beside{at.x + dx, at.y};
      if (rows_.empty() || rows_.back() < beside) rows_.push_back(beside);
    }
  }
  wanted_.clear();
  std::size_t next[3] = {0, 0, 0};  // in the rows, moved down, as they are, moved up
  auto moved = [&](std::size_t k) {
    const TileIndex& at = rows_[next[k]];
    return TileIndex{at.x, at.y + static_cast<std::int32_t>(k) - 1};
  };
  while (next[2] < rows_.size()) {
    TileIndex least = moved(2);
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      if (next[k] < rows_.size()) least = std::min(least, moved(k));
    }
    wanted_.push_back(least);
    for (std::size_t k = 0; k < 3; ++k) {
      if (next[k] < rows_.size() && moved(k) == least) ++next[k];
    }
  }
}

void ParticleTiles::addWrappedNeighbours(const CutGrid& grid) {
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
         (wanted_.capacity() + rows_.capacity()) * sizeof(TileIndex);
}

}  // namespace froude
