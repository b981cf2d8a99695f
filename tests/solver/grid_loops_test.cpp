// The grid loops: those of every set of instructions against the scalar ones, on tiles with and without a period.
#include <froude/solver/fluid/grid/grid_loops.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <froude/base/random.h>
#include <froude/fields/tile_grid.h>

namespace froude {
namespace {

using Field = AlignedArray<float>;

// Random coefficients on tiles of a plane with a period, some of them missing.
struct Sample {
  explicit Sample(TilePeriod period) {
    std::vector<TileIndex> tiles;
    const int wide = period.x > 0 ? (period.x + 15) / 16 : 4, high = period.y > 0 ? (period.y + 15) / 16 : 3;
    for (int row = 0; row < high; ++row) {
      for (int column = 0; column < wide; ++column) {
        if ((column + 2 * row) % 5 != 3) tiles.push_back({column, row});
      }
    }
    grid.build(tiles, period);
    std::vector<TileIndex> above;
    for (const TileIndex& at : tiles) {
      const TileIndex up{at.x / 2, at.y / 2};
      if (std::find(above.begin(), above.end(), up) == above.end()) above.push_back(up);
    }
    std::sort(above.begin(), above.end());
    coarse.build(above, {(period.x + 1) / 2, (period.y + 1) / 2});
    for (Field* f : {&ax, &ay, &ground, &ar, &diagonal, &inverse, &x, &r}) grid.clear(*f);
    RandomStream random(11, static_cast<std::uint64_t>(period.x));
    links.resize(grid.size() + 1);
    parents.resize(grid.size() + 1);
    for (std::size_t t = 1; t <= grid.size(); ++t) {
      const Tile& tile = grid.tile(t);
      const auto lane = static_cast<std::uint32_t>(grid.tile(tile.left).columns - 1);
      const auto row = static_cast<std::uint32_t>(grid.tile(tile.down).rows - 1);
      links[t] = {256 * tile.left + lane, 256 * tile.right, 256 * tile.down + 16 * row,
                  256 * tile.up,          tile.columns - 1, tile.rows};
      parents[t].place = 256 * coarse.find(tile.at.x / 2, tile.at.y / 2) +
                         static_cast<std::uint32_t>(128 * (tile.at.y % 2) + 8 * (tile.at.x % 2));
      for (int j = 0; j < tile.rows; ++j) {
        for (int i = 0; i < tile.columns; ++i) {
          const std::size_t at = 256 * t + static_cast<std::size_t>(16 * j + i);
          if (random.uniform(0.0, 1.0) < 0.2) continue;
          for (Field* f : {&ax, &ay, &ground}) (*f)[at] = static_cast<float>(random.uniform(-0.3, 1.0));
          for (Field* f : {&ax, &ay, &ground}) (*f)[at] = std::max(0.0f, (*f)[at]);
          for (Field* f : {&x, &r}) (*f)[at] = static_cast<float>(random.uniform(-1.0, 1.0));
        }
      }
    }
    assemble(scalarGridLoops(), ar, diagonal, inverse);
  }
  std::vector<double> assemble(const GridLoops& loops, Field& right, Field& whole, Field& inverted) const {
    std::vector<double> sums(grid.size() + 1);
    loops.assemble({links.data(), ax.data(), ay.data(), ground.data(), right.data(), whole.data(), inverted.data()},
                   sums.data(), 1, grid.size() + 1);
    return sums;
  }
  GridOperator matrix() const {
    return {links.data(), ax.data(), ar.data(), ay.data(), diagonal.data(), inverse.data()};
  }
  TileGrid grid, coarse;
  mutable std::vector<TileLinks> links;
  std::vector<TileParent> parents;
  Field ax, ay, ground, ar, diagonal, inverse, x, r;
};

void expectNear(const Field& a, const Field& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    ASSERT_NEAR(a[k], b[k], 2e-6f * (1.0f + std::abs(b[k]))) << what << ' ' << k;
}

void expectNear(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 1e-4) << what << ' ' << k;
}

// All that a target makes of a sample, in one order.
struct Results {
  std::vector<Field> fields;
  std::vector<std::vector<double>> sums;
  std::vector<std::uint16_t> bits;

  Results(const GridLoops& loops, const Sample& s) {
    const std::size_t end = s.grid.size() + 1;
    const GridOperator a = s.matrix();
    const auto field = [&]() -> float* {
      fields.emplace_back();
      s.grid.clear(fields.back());
      return fields.back().data();
    };
    const auto copyOf = [&](const Field& f) -> float* {
      fields.push_back(f);
      return fields.back().data();
    };
    const auto coarseField = [&]() -> float* {
      fields.emplace_back();
      s.coarse.clear(fields.back());
      return fields.back().data();
    };
    const auto sum = [&]() -> double* { return sums.emplace_back(end).data(); };
    fields.reserve(30);
    sums.reserve(10);
    Field right, whole, inverted;
    for (Field* f : {&right, &whole, &inverted}) s.grid.clear(*f);
    sums.push_back(s.assemble(loops, right, whole, inverted));
    for (const Field* f : {&right, &whole, &inverted}) copyOf(*f);
    float *cx = coarseField(), *cy = coarseField(), *cg = coarseField();
    loops.coarsen({s.ax.data(), s.ay.data(), s.ground.data(), s.parents.data(), 0.7f, cx, cy, cg}, 1, end);
    loops.apply(a, s.x.data(), field(), sum(), 1, end);
    loops.residual(a, s.r.data(), s.x.data(), field(), 1, end);
    loops.smooth(a, s.r.data(), s.x.data(), 0.8f, field(), sum(), 1, end);
    loops.smooth(a, s.r.data(), s.x.data(), 1.4f, field(), nullptr, 1, end);
    loops.start(a, s.r.data(), 0.6f, field(), sum(), 1, end);
    float* restricted = coarseField();
    loops.restrictResidual(a, s.r.data(), s.x.data(), s.parents.data(), restricted, 1, end);
    loops.prolong(a, restricted, s.parents.data(), copyOf(s.x), 1, end);
    float *kappa = copyOf(s.x), *r = copyOf(s.r), *z = field();
    loops.advance(a, 0.37f, s.r.data(), s.x.data(), kappa, r, 0.6f, z, sum(), 1, end);
    loops.direct(a, s.r.data(), 0.3f, copyOf(s.x), 1, end);
    loops.clean(a, copyOf(s.x), 1, end);
    bits.resize(16 * end);
    loops.positive(s.ax.data(), bits.data(), 0, end);
  }
};

TEST(GridLoops, every_set_of_instructions_does_as_the_scalar_loops) {
  for (const TilePeriod period : {TilePeriod{}, TilePeriod{64, 48}, TilePeriod{37, 21}, TilePeriod{7, 0}}) {
    const Sample sample(period);
    const Results expected(scalarGridLoops(), sample);
    for (const SimdTarget target : supportedSimdTargets()) {
      const Results results(gridLoops(target), sample);
      const std::string where = std::string(name(target)) + " period " + std::to_string(period.x);
      for (std::size_t k = 0; k < expected.fields.size(); ++k) {
        expectNear(results.fields[k], expected.fields[k], where + " field " + std::to_string(k));
      }
      for (std::size_t k = 0; k < expected.sums.size(); ++k) {
        expectNear(results.sums[k], expected.sums[k], where + " sum " + std::to_string(k));
      }
      EXPECT_EQ(results.bits, expected.bits) << where;
    }
  }
}

TEST(GridLoops, what_lies_beyond_a_period_stays_zero) {
  const Sample sample({37, 21});
  for (const SimdTarget target : supportedSimdTargets()) {
    const Results results(gridLoops(target), sample);
    for (const Field& field : results.fields) {
      if (field.size() != sample.grid.values()) continue;
      for (std::size_t k = TileGrid::kCells; k < field.size(); ++k) {
        const auto [i, j] = sample.grid.cell(k);
        if (i >= 37 || j >= 21) {
          ASSERT_EQ(field[k], 0.0f) << name(target) << ' ' << i << ' ' << j;
        }
      }
    }
  }
}

}  // namespace
}  // namespace froude
