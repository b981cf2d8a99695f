// The sparse grid against a map of its tiles, and halos against look-ups cell by cell.
#include <froude/fields/tile_grid.h>

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>
#include <vector>

#include <froude/base/random.h>

namespace froude {
namespace {

std::vector<TileIndex> randomTiles(std::uint64_t seed, int count, int reach, bool negative) {
  RandomStream random(seed, 0);
  std::set<std::pair<int, int>> chosen;  // (y, x): by rows
  while (static_cast<int>(chosen.size()) < count) {
    const double low = negative ? -reach : 0;
    chosen.insert({static_cast<int>(random.uniform(low, reach)), static_cast<int>(random.uniform(low, reach))});
  }
  std::vector<TileIndex> tiles;
  for (const auto& [y, x] : chosen) tiles.push_back({x, y});
  return tiles;
}

int floorDivided(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

// A value that tells a cell from all others.
float mark(int i, int j) { return static_cast<float>(i * 1009 + j); }

AlignedArray<float> marked(const TileGrid& grid) {
  AlignedArray<float> field;
  grid.clear(field);
  for (std::size_t k = TileGrid::kCells; k < grid.values(); ++k) {
    const auto [i, j] = grid.cell(k);
    const TilePeriod period = grid.period();
    if ((period.x == 0 || i < period.x) && (period.y == 0 || j < period.y)) field[k] = mark(i, j);
  }
  return field;
}

TEST(TileGrid, finds_the_tiles_it_was_given_and_no_others_near_and_far_apart) {
  for (const int reach : {8, 40, 3000}) {  // the last is searched by rows
    const auto tiles = randomTiles(1, 40, reach, true);
    TileGrid grid;
    grid.build(tiles);
    ASSERT_EQ(grid.size(), tiles.size());
    std::map<std::pair<int, int>, std::size_t> known;
    for (std::size_t k = 0; k < tiles.size(); ++k) known[{tiles[k].x, tiles[k].y}] = k + 1;
    for (const TileIndex& at : tiles) {
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const auto it = known.find({at.x + dx, at.y + dy});
          EXPECT_EQ(grid.find(at.x + dx, at.y + dy), it == known.end() ? 0u : it->second);
        }
      }
    }
    EXPECT_EQ(grid.find(1 << 26, -(1 << 26)), 0u);
    EXPECT_LT(grid.memoryBytes(), 40000u) << "memory follows the tiles, not the plane";
  }
}

TEST(TileGrid, a_place_leads_back_to_its_cell_on_both_sides_of_zero) {
  const auto tiles = randomTiles(2, 30, 5, true);
  TileGrid grid;
  grid.build(tiles);
  const std::set<TileIndex> known(tiles.begin(), tiles.end());
  for (int j = -90; j < 90; ++j) {
    for (int i = -90; i < 90; ++i) {
      const std::size_t place = grid.place(i, j);
      if (known.count({floorDivided(i, 16), floorDivided(j, 16)}) == 0) {
        EXPECT_LT(place, TileGrid::kCells);
        continue;
      }
      ASSERT_GE(place, TileGrid::kCells);
      EXPECT_EQ(grid.cell(place), (std::array<std::int32_t, 2>{i, j}));
    }
  }
}

TEST(TileGrid, a_halo_is_what_the_cells_around_hold_and_zero_where_there_is_no_tile) {
  TileGrid grid;
  grid.build(randomTiles(3, 30, 4, true));
  const AlignedArray<float> field = marked(grid);
  TileHalo halo;
  for (std::size_t t = 1; t <= grid.size(); ++t) {
    grid.loadHalo(field.data(), t, halo);
    const TileIndex at = grid.tile(t).at;
    for (int j = -1; j <= 16; ++j) {
      for (int i = -1; i <= 16; ++i) EXPECT_EQ(halo.value(i, j), field[grid.place(at.x * 16 + i, at.y * 16 + j)]);
    }
  }
}

TEST(TileGrid, a_period_of_any_number_of_cells_closes_on_itself) {
  for (const TilePeriod period : {TilePeriod{37, 20}, TilePeriod{16, 0}, TilePeriod{5, 33}, TilePeriod{0, 3}}) {
    const int wide = period.x > 0 ? (period.x + 15) / 16 : 3, high = period.y > 0 ? (period.y + 15) / 16 : 2;
    std::vector<TileIndex> tiles;
    for (int y = 0; y < high; ++y) {
      for (int x = 0; x < wide; ++x) tiles.push_back({x, y});
    }
    TileGrid grid;
    grid.build(tiles, period);
    const AlignedArray<float> field = marked(grid);
    const auto expected = [&](int i, int j) {
      if (period.x > 0) i = (i + period.x) % period.x;
      if (period.y > 0) j = (j + period.y) % period.y;
      return i < 0 || j < 0 || i >= 16 * wide || j >= 16 * high ? 0.0f : mark(i, j);
    };
    TileHalo halo;
    for (std::size_t t = 1; t <= grid.size(); ++t) {
      const Tile& tile = grid.tile(t);
      grid.loadHalo(field.data(), t, halo);
      for (int j = -1; j <= tile.rows; ++j) {
        for (int i = -1; i <= tile.columns; ++i) {
          EXPECT_EQ(halo.value(i, j), expected(tile.at.x * 16 + i, tile.at.y * 16 + j)) << i << ' ' << j;
        }
      }
      for (int i = tile.columns + 1; i <= 16; ++i) EXPECT_EQ(halo.value(i, 3), 0.0f);
    }
  }
}

TEST(TileGrid, is_built_again_without_a_trace_of_what_it_was_and_may_be_empty) {
  TileGrid grid;
  grid.build(randomTiles(4, 60, 3000, true));
  grid.build({});
  EXPECT_EQ(grid.size(), 0u);
  EXPECT_EQ(grid.place(3, 3) / TileGrid::kCells, 0u);
  const auto tiles = randomTiles(5, 9, 4, false);
  grid.build(tiles, {64, 64});
  TileGrid fresh;
  fresh.build(tiles, {64, 64});
  for (int j = -64; j < 128; ++j) {
    for (int i = -64; i < 128; ++i) ASSERT_EQ(grid.place(i, j), fresh.place(i, j));
  }
  AlignedArray<float> field;
  grid.clear(field);
  EXPECT_EQ(field.size(), 10u * 256u);
}

}  // namespace
}  // namespace froude
