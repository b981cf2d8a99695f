// A front that goes outwards over tiles: every set of instructions against a walk over single cells.
#include <froude/solver/fluid/grid/front_loops.h>

#include <gtest/gtest.h>

#include <vector>

#include <froude/base/random.h>

namespace froude {
namespace {

struct Field {
  AlignedArray<float> values, known;
};

TileGrid gridOf(TilePeriod period) {
  std::vector<TileIndex> tiles;
  const int wide = period.x > 0 ? (period.x + 15) / 16 : 4, high = period.y > 0 ? (period.y + 15) / 16 : 3;
  for (int row = 0; row < high; ++row) {
    for (int column = 0; column < wide; ++column) {
      if ((column + 2 * row) % 5 != 3) tiles.push_back({column, row});
    }
  }
  TileGrid grid;
  grid.build(tiles, period);
  return grid;
}

// A few cells of each tile, none of the second tile.
Field sparseField(const TileGrid& grid) {
  Field f;
  grid.clear(f.values);
  grid.clear(f.known);
  RandomStream random(3, grid.size());
  for (std::size_t k = TileGrid::kCells; k < grid.values(); ++k) {
    const Tile& tile = grid.tile(k / 256);
    const auto i = static_cast<int>(k % 16), j = static_cast<int>(k % 256 / 16);
    if (i >= tile.columns || j >= tile.rows || k / 256 == 2 || random.uniform(0.0, 1.0) > 0.04) continue;
    f.known[k] = 1.0f;
    f.values[k] = static_cast<float>(random.uniform(-2.0, 2.0));
  }
  return f;
}

// As the definition says, a cell at a time.
Field spreadByCells(const TileGrid& grid, const Field& from) {
  Field to = from;
  for (std::size_t k = TileGrid::kCells; k < grid.values(); ++k) {
    const Tile& tile = grid.tile(k / 256);
    if (static_cast<int>(k % 16) >= tile.columns || static_cast<int>(k % 256 / 16) >= tile.rows) continue;
    if (from.known[k] != 0.0f) continue;
    const auto [i, j] = grid.cell(k);
    const std::size_t left = grid.place(i - 1, j), right = grid.place(i + 1, j), down = grid.place(i, j - 1),
                      up = grid.place(i, j + 1);
    const float count = (from.known[left] + from.known[right]) + (from.known[down] + from.known[up]);
    if (count == 0.0f) continue;
    to.values[k] = ((from.values[left] + from.values[right]) + (from.values[down] + from.values[up])) / count;
    to.known[k] = 1.0f;
  }
  return to;
}

// By the loops; `words` are the known cells of `from` and are brought up to date.
Field spreadByTiles(const FrontLoops& loops, const TileGrid& grid, const Field& from,
                    AlignedArray<std::uint16_t>& words) {
  Field to = from;
  AlignedArray<float> next;
  grid.clear(next);
  AlignedArray<TileLinks> links;
  linkTiles(grid, links);
  AlignedArray<std::uint16_t> after = words;
  for (std::size_t t = 1; t <= grid.size(); ++t) {
    FrontRows rows;
    if (!findFront(words.data(), links[t], t, rows)) continue;
    loops.means(from.values.data(), links[t], rows, t, next.data());
    loops.take(next.data(), rows.fresh, t, to.values.data(), to.known.data());
    for (std::size_t j = 0; j < 16; ++j)
      after[16 * t + j] = static_cast<std::uint16_t>(after[16 * t + j] | rows.fresh[j]);
  }
  words = after;
  return to;
}

TEST(FrontLoops, a_front_reaches_what_a_walk_over_single_cells_does_with_the_same_bits) {
  for (const TilePeriod period : {TilePeriod{}, TilePeriod{64, 48}, TilePeriod{37, 21}, TilePeriod{7, 0}}) {
    const TileGrid grid = gridOf(period);
    for (const SimdTarget target : supportedSimdTargets()) {
      Field expected = sparseField(grid), found = expected;
      AlignedArray<std::uint16_t> words(16 * (grid.size() + 1));
      scalarGridLoops().positive(found.known.data(), words.data(), 1, grid.size() + 1);
      for (int layer = 0; layer < 4; ++layer) {
        expected = spreadByCells(grid, expected);
        found = spreadByTiles(frontLoops(target), grid, found, words);
        for (std::size_t k = 0; k < grid.values(); ++k) {
          ASSERT_EQ(found.known[k], expected.known[k]) << name(target) << " place " << k << " layer " << layer;
          ASSERT_EQ(found.values[k], expected.values[k]) << name(target) << " place " << k << " layer " << layer;
        }
      }
    }
  }
}

}  // namespace
}  // namespace froude
