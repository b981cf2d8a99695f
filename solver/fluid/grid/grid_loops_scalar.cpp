#include <froude/solver/fluid/grid/grid_loops.h>

#include <algorithm>
#include <cmath>

namespace froude {
namespace {

// Σ a·x_neighbour of cell (i, j) of tile t.
float neighbours(const GridOperator& a, const float* x, std::size_t t, std::int32_t i, std::int32_t j) {
  const TileLinks& link = a.links[t];
  const std::size_t at = t * 256 + static_cast<std::size_t>(16 * j + i), row = static_cast<std::size_t>(16 * j);
  const std::size_t left = i == 0 ? link.left + row : at - 1;
  const std::size_t right = i == link.lane ? link.right + row : at + 1;
  const std::size_t down = j == 0 ? link.down + static_cast<std::size_t>(i) : at - 16;
  const std::size_t up = j == link.rows - 1 ? link.up + static_cast<std::size_t>(i) : at + 16;
  return a.ax[at] * x[left] + a.ar[at] * x[right] + a.ay[at] * x[down] + a.ay[up] * x[up];
}

template <typename Body>
void eachCell(const GridOperator& a, std::size_t begin, std::size_t end, Body&& body) {
  for (std::size_t t = begin; t < end; ++t) {
    for (std::int32_t j = a.links[t].first; j < a.links[t].end; ++j) {
      for (std::int32_t i = 0; i <= a.links[t].lane; ++i) body(t, i, j, t * 256 + static_cast<std::size_t>(16 * j + i));
    }
  }
}

void clearSums(double* sums, std::size_t begin, std::size_t end) {
  if (sums != nullptr) std::fill(sums + begin, sums + end, 0.0);
}

void assemble(const GridAssembly& a, double* sums, std::size_t begin, std::size_t end) {
  for (std::size_t t = begin; t < end; ++t) {
    TileLinks& link = a.links[t];
    link.first = link.end = 0;
    sums[t] = 0.0;
    for (std::int32_t j = 0; j < 16; ++j) {
      for (std::int32_t i = 0; i < 16; ++i) {
        const auto row = static_cast<std::size_t>(16 * j);
        const std::size_t at = t * 256 + row + static_cast<std::size_t>(i);
        if (i > link.lane || j >= link.rows) {
          a.ar[at] = a.diagonal[at] = a.inverse[at] = 0.0f;
          continue;
        }
        a.ar[at] = a.ax[i == link.lane ? link.right + row : at + 1];
        const float above = a.ay[j == link.rows - 1 ? link.up + static_cast<std::size_t>(i) : at + 16];
        const float joined = (a.ax[at] + a.ar[at]) + (a.ay[at] + above);
        sums[t] += static_cast<double>(joined);
        a.diagonal[at] = joined + a.ground[at];
        a.inverse[at] = a.diagonal[at] > 0.0f ? 1.0f / a.diagonal[at] : 0.0f;
        if (a.inverse[at] > 0.0f) {
          if (link.end == 0) link.first = j;
          link.end = j + 1;
        }
      }
    }
  }
}

void coarsen(const GridCoarsening& a, std::size_t begin, std::size_t end) {
  for (std::size_t t = begin; t < end; ++t) {
    for (std::size_t j = 0; j < 8; ++j) {
      for (std::size_t i = 0; i < 8; ++i) {
        const std::size_t at = t * 256 + 32 * j + 2 * i, to = a.parents[t].place + 16 * j + i;
        a.coarseX[to] = 0.5f * (a.ax[at] + a.ax[at + 16]);
        a.coarseY[to] = 0.5f * (a.ay[at] + a.ay[at + 1]);
        a.coarseGround[to] = a.share * ((a.ground[at] + a.ground[at + 16]) + (a.ground[at + 1] + a.ground[at + 17]));
      }
    }
  }
}

void positive(const float* values, std::uint16_t* bits, std::size_t begin, std::size_t end) {
  for (std::size_t row = 16 * begin; row < 16 * end; ++row) {
    std::uint32_t word = 0;
    for (std::uint32_t i = 0; i < 16; ++i) word |= static_cast<std::uint32_t>(values[16 * row + i] > 0.0f) << i;
    bits[row] = static_cast<std::uint16_t>(word);
  }
}

void clean(const GridOperator& a, float* x, std::size_t begin, std::size_t end) {
  for (std::size_t k = begin * 256; k < end * 256; ++k) x[k] = a.inverse[k] > 0.0f ? x[k] : 0.0f;
}

void apply(const GridOperator& a, const float* x, float* q, double* sums, std::size_t begin, std::size_t end) {
  clearSums(sums, begin, end);
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t i, std::int32_t j, std::size_t at) {
    q[at] = a.diagonal[at] * x[at] - neighbours(a, x, t, i, j);
    sums[t] += static_cast<double>(x[at] * q[at]);
  });
}

void residual(const GridOperator& a, const float* b, const float* x, float* r, std::size_t begin, std::size_t end) {
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t i, std::int32_t j, std::size_t at) {
    r[at] = a.inverse[at] > 0.0f ? b[at] - a.diagonal[at] * x[at] + neighbours(a, x, t, i, j) : 0.0f;
  });
}

void smooth(const GridOperator& a, const float* r, const float* x, float weight, float* out, double* sums,
            std::size_t begin, std::size_t end) {
  clearSums(sums, begin, end);
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t i, std::int32_t j, std::size_t at) {
    out[at] = (1.0f - weight) * x[at] + weight * a.inverse[at] * (r[at] + neighbours(a, x, t, i, j));
    if (sums != nullptr) sums[t] += static_cast<double>(r[at] * out[at]);
  });
}

void start(const GridOperator& a, const float* r, float weight, float* out, double* sums, std::size_t begin,
           std::size_t end) {
  clearSums(sums, begin, end);
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t, std::int32_t, std::size_t at) {
    out[at] = weight * a.inverse[at] * r[at];
    if (sums != nullptr) sums[t] = std::max(sums[t], static_cast<double>(std::abs(r[at])));
  });
}

void restrictResidual(const GridOperator& a, const float* r, const float* x, const TileParent* parents, float* coarse,
                      std::size_t begin, std::size_t end) {
  for (std::size_t t = begin; t < end; ++t) {
    float* to = coarse + parents[t].place;
    for (std::int32_t j = a.links[t].first / 2; 2 * j < a.links[t].end; ++j) std::fill_n(to + 16 * j, 8, 0.0f);
  }
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t i, std::int32_t j, std::size_t at) {
    const auto place = parents[t].place + static_cast<std::size_t>(16 * (j / 2) + i / 2);
    coarse[place] += r[at] - a.diagonal[at] * x[at] + neighbours(a, x, t, i, j);
  });
}

void prolong(const GridOperator& a, const float* coarse, const TileParent* parents, float* x, std::size_t begin,
             std::size_t end) {
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t i, std::int32_t j, std::size_t at) {
    if (a.inverse[at] > 0.0f) x[at] += coarse[parents[t].place + static_cast<std::size_t>(16 * (j / 2) + i / 2)];
  });
}

void advance(const GridOperator& a, float step, const float* p, const float* q, float* kappa, float* r, float weight,
             float* z, double* sums, std::size_t begin, std::size_t end) {
  clearSums(sums, begin, end);
  eachCell(a, begin, end, [&](std::size_t t, std::int32_t, std::int32_t, std::size_t at) {
    kappa[at] += step * p[at];
    r[at] -= step * q[at];
    z[at] = weight * a.inverse[at] * r[at];
    sums[t] = std::max(sums[t], static_cast<double>(std::abs(r[at])));
  });
}

void direct(const GridOperator& a, const float* z, float share, float* p, std::size_t begin, std::size_t end) {
  eachCell(a, begin, end,
           [&](std::size_t, std::int32_t, std::int32_t, std::size_t at) { p[at] = z[at] + share * p[at]; });
}

}  // namespace

void linkTiles(const TileGrid& grid, AlignedArray<TileLinks>& links) {
  links.resize(grid.size() + 1);
  links[0] = {};
  constexpr auto kCells = static_cast<std::uint32_t>(TileGrid::kCells);
  for (std::size_t t = 1; t <= grid.size(); ++t) {
    const Tile& tile = grid.tile(t);
    const auto lane = static_cast<std::uint32_t>(grid.tile(tile.left).columns - 1);
    const auto row = static_cast<std::uint32_t>(grid.tile(tile.down).rows - 1);
    links[t] = {tile.left * kCells + lane, tile.right * kCells, tile.down * kCells + 16 * row,
                tile.up * kCells,          tile.columns - 1,    tile.rows};
  }
}

const GridLoops& scalarGridLoops() {
  static constexpr GridLoops kLoops{assemble, coarsen, positive,         clean,   apply,   residual,
                                    smooth,   start,   restrictResidual, prolong, advance, direct};
  return kLoops;
}

}  // namespace froude
