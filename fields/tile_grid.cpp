#include <froude/fields/tile_grid.h>

#include <algorithm>
#include <cstring>

#include <froude/base/assert.h>

namespace froude {
namespace {

// Places of the bounding box, a tile, up to which a directory of all of them is kept.
constexpr std::int64_t kPlacesPerTile = 32;
constexpr std::int64_t kPlacesAnyway = 4096;

// Tiles that cover a period.
std::int32_t tilesOf(std::int32_t period) { return (period + TileGrid::kSide - 1) / TileGrid::kSide; }

// Cells of the tile at coordinate k along an axis.
std::int32_t extent(std::int32_t k, std::int32_t period) {
  return period > 0 ? std::min(TileGrid::kSide, period - k * TileGrid::kSide) : TileGrid::kSide;
}

std::int32_t wrapped(std::int32_t k, std::int32_t period) {
  if (period == 0) return k;
  return k < 0 ? k + period : (k >= period ? k - period : k);
}

}  // namespace

void TileGrid::build(std::span<const TileIndex> tiles, TilePeriod period) {
  period_ = period;
  tiles_.resize(tiles.size() + 1);
  tiles_[0] = Tile{};
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    FROUDE_ASSERT(k == 0 || tiles[k - 1] < tiles[k]);
    Tile& tile = tiles_[k + 1];
    tile = Tile{};
    tile.at = tiles[k];
    tile.columns = extent(tile.at.x, period.x);
    tile.rows = extent(tile.at.y, period.y);
    FROUDE_ASSERT(tile.columns > 0 && tile.rows > 0);
    FROUDE_ASSERT((period.x == 0 || tile.at.x >= 0) && (period.y == 0 || tile.at.y >= 0));
  }
  buildDirectory();
  for (std::size_t t = 1; t < tiles_.size(); ++t) {
    Tile& tile = tiles_[t];
    tile.left = neighbour(tile, -1, 0);
    tile.right = neighbour(tile, 1, 0);
    tile.down = neighbour(tile, 0, -1);
    tile.up = neighbour(tile, 0, 1);
    tile.downLeft = neighbour(tile, -1, -1);
    tile.downRight = neighbour(tile, 1, -1);
    tile.upLeft = neighbour(tile, -1, 1);
    tile.upRight = neighbour(tile, 1, 1);
  }
}

void TileGrid::buildDirectory() {
  directory_.clear();
  rows_.clear();
  wide_ = high_ = 0;
  if (size() == 0) return;
  minX_ = tiles_[1].at.x;
  minY_ = tiles_[1].at.y;
  std::int32_t maxX = minX_;
  for (std::size_t t = 1; t < tiles_.size(); ++t) {
    minX_ = std::min(minX_, tiles_[t].at.x);
    maxX = std::max(maxX, tiles_[t].at.x);
  }
  wide_ = std::int64_t{maxX} - minX_ + 1;
  high_ = std::int64_t{tiles_[size()].at.y} - minY_ + 1;
  if (wide_ * high_ <= std::max(kPlacesAnyway, kPlacesPerTile * static_cast<std::int64_t>(size()))) {
    directory_.resize(static_cast<std::size_t>(wide_ * high_));
    for (std::size_t t = 1; t < tiles_.size(); ++t) {
      const std::int64_t at = (tiles_[t].at.y - minY_) * wide_ + (tiles_[t].at.x - minX_);
      directory_[static_cast<std::size_t>(at)] = static_cast<std::uint32_t>(t);
    }
    return;
  }
  for (std::size_t t = 1; t < tiles_.size(); ++t) {
    if (t == 1 || tiles_[t].at.y != tiles_[t - 1].at.y) {
      rows_.push_back({tiles_[t].at.y, static_cast<std::uint32_t>(t)});
    }
  }
  rows_.push_back({tiles_[size()].at.y + 1, static_cast<std::uint32_t>(tiles_.size())});
}

std::uint32_t TileGrid::find(std::int32_t x, std::int32_t y) const {
  const std::int64_t column = std::int64_t{x} - minX_, row = std::int64_t{y} - minY_;
  if (column < 0 || column >= wide_ || row < 0 || row >= high_) return 0;
  if (!directory_.empty()) return directory_[static_cast<std::size_t>(row * wide_ + column)];
  const Row* last = rows_.end() - 1;
  const Row* found =
      std::lower_bound(rows_.begin(), last, y, [](const Row& r, std::int32_t value) { return r.y < value; });
  if (found == last || found->y != y) return 0;
  const Tile* begin = tiles_.data() + found->first;
  const Tile* end = tiles_.data() + found[1].first;
  const Tile* tile = std::lower_bound(begin, end, x, [](const Tile& t, std::int32_t value) { return t.at.x < value; });
  return tile != end && tile->at.x == x ? static_cast<std::uint32_t>(tile - tiles_.data()) : 0;
}

std::uint32_t TileGrid::neighbour(const Tile& tile, std::int32_t dx, std::int32_t dy) const {
  return find(wrapped(tile.at.x + dx, tilesOf(period_.x)), wrapped(tile.at.y + dy, tilesOf(period_.y)));
}

std::size_t TileGrid::place(std::int32_t i, std::int32_t j) const {
  i = wrapped(i, period_.x);
  j = wrapped(j, period_.y);
  const std::size_t t = find(i >> 4, j >> 4);
  return t * kCells + static_cast<std::size_t>((j & 15) * kSide + (i & 15));
}

std::array<std::int32_t, 2> TileGrid::cell(std::size_t place) const {
  const Tile& tile = tiles_[place / kCells];
  const auto within = static_cast<std::int32_t>(place % kCells);
  return {tile.at.x * kSide + within % kSide, tile.at.y * kSide + within / kSide};
}

void TileGrid::loadHalo(const float* field, std::size_t t, TileHalo& halo) const {
  const Tile& tile = tiles_[t];
  const float* own = field + t * kCells;
  const float* left = field + tile.left * kCells + tiles_[tile.left].columns - 1;
  const float* right = field + tile.right * kCells;
  const std::int32_t columns = tile.columns, rows = tile.rows;
  const auto copyRow = [&](const float* from, float* to) {
    std::memcpy(to, from, sizeof(float) * kSide);  // of a known length: inlined
    if (columns < kSide) std::fill(to + columns, to + kSide + 1, 0.0f);
  };
  for (std::int32_t j = 0; j < rows; ++j) {
    float* to = halo.row(j);
    copyRow(own + j * kSide, to);
    to[-1] = left[j * kSide];
    to[columns] = right[j * kSide];
  }
  const std::int32_t below = (tiles_[tile.down].rows - 1) * kSide;
  float* down = halo.row(-1);
  copyRow(field + tile.down * kCells + below, down);
  down[-1] = field[tile.downLeft * kCells + static_cast<std::size_t>(below + tiles_[tile.downLeft].columns - 1)];
  down[columns] = field[tile.downRight * kCells + static_cast<std::size_t>(below)];
  float* up = halo.row(rows);
  copyRow(field + tile.up * kCells, up);
  up[-1] = field[tile.upLeft * kCells + static_cast<std::size_t>(tiles_[tile.upLeft].columns - 1)];
  up[columns] = field[tile.upRight * kCells];
  for (std::int32_t j = rows + 1; j <= kSide; ++j) std::fill(halo.row(j) - 1, halo.row(j) + kSide + 1, 0.0f);
}

std::size_t TileGrid::memoryBytes() const {
  return tiles_.capacity() * sizeof(Tile) + directory_.capacity() * sizeof(std::uint32_t) +
         rows_.capacity() * sizeof(Row);
}

}  // namespace froude
