// Tanks of fluid for the pressure solve: a square of n × n cells, closed all round, with a free surface or discs in it.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <vector>

#include <froude/base/random.h>
#include <froude/solver/fluid/grid/pressure_system.h>

namespace froude::test {

enum class Tank { Full, Surface, Splash, Discs };

/// Kinds and open fractions of a tank's cells, and as right-hand side a step of free fall (5 cells at the
/// bottom) with noise. Cell (0, 0) is the lower left.
struct PressureScene {
  TileGrid grid;
  int n = 0;
  std::vector<GridCell> kind;
  AlignedArray<float> wx, wy, b;
  PressureCoefficients coefficients;

  PressureScene(Tank tank, int cells, std::uint64_t seed = 1) : n(cells) {
    std::vector<TileIndex> tiles;
    for (int y = 0; y <= n / 16; ++y) {
      for (int x = 0; x <= n / 16; ++x) tiles.push_back({x, y});
    }
    grid.build(tiles);
    kind.assign(grid.values(), GridCell::Air);
    grid.clear(wx);
    grid.clear(wy);
    grid.clear(b);
    RandomStream random(seed, static_cast<std::uint64_t>(n));
    std::vector<std::array<double, 3>> discs;
    RandomStream places(seed, 7);
    for (int k = 0; tank == Tank::Discs && k < 40; ++k) {
      discs.push_back({places.uniform(0.0, 1.0) * n, places.uniform(0.0, 0.9) * n, places.uniform(0.02, 0.05) * n});
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const std::size_t k = grid.place(i, j);
        const double x = (i + 0.5) / n, y = (j + 0.5) / n;
        bool wet = true;
        if (tank == Tank::Surface) wet = y < 0.6 + 0.15 * std::sin(5.0 * x) + 0.03 * std::sin(40.0 * x);
        if (tank == Tank::Splash) {
          wet = (y < 0.5 && random.uniform(0.0, 1.0) < 0.97) || random.uniform(0.0, 1.0) < 0.1;
        }
        if (tank == Tank::Discs) wet = y < 0.92;
        kind[k] = wet ? GridCell::Fluid : GridCell::Air;
        wx[k] = i == 0 ? 0.0f : openFace(discs, i, j, true);
        wy[k] = j == 0 ? 0.0f : openFace(discs, i, j, false);
        b[k] = static_cast<float>(random.uniform(-0.3, 0.3) + (j == 0 ? 20.0 / n : 0.0));
      }
    }
    // A cell without an open face is solid.
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const std::size_t k = grid.place(i, j);
        if (wx[k] + wy[k] + wx[grid.place(i + 1, j)] + wy[grid.place(i, j + 1)] == 0.0f) kind[k] = GridCell::Solid;
      }
    }
    coefficients.fromWeights(grid, kind.data(), wx.data(), wy.data());
  }

  /// Share of the left (`upright`) or bottom face of cell (x0, y0) outside all discs; where two overlap on it, less.
  static float openFace(const std::vector<std::array<double, 3>>& discs, double x0, double y0, bool upright) {
    double open = 1.0;
    for (const auto& [cx, cy, r] : discs) {
      const double off = upright ? x0 - cx : y0 - cy, half = r * r > off * off ? std::sqrt(r * r - off * off) : 0.0;
      const double middle = upright ? cy - y0 : cx - x0;
      const double low = std::max(0.0, middle - half), high = std::min(1.0, middle + half);
      if (half > 0.0 && high > low) open -= high - low;
    }
    return static_cast<float>(std::max(0.0, open));
  }
};

/// The matrix written out, from the coefficients alone; unknowns in the order of places, −1 for other places.
struct WrittenOut {
  std::vector<int> number;
  std::vector<std::size_t> place;
  Eigen::SparseMatrix<double> matrix;

  WrittenOut(const TileGrid& grid, const PressureCoefficients& c, std::span<const PressureBody> bodies = {}) {
    std::vector<double> diagonal(c.ground.begin(), c.ground.end());
    struct Pair {
      std::size_t a, b;
      double coefficient;
    };
    std::vector<Pair> pairs;
    for (std::size_t k = TileGrid::kCells; k < grid.values(); ++k) {
      const auto [i, j] = grid.cell(k);
      if (c.ax[k] > 0.0f) pairs.push_back({k, grid.place(i - 1, j), static_cast<double>(c.ax[k])});
      if (c.ay[k] > 0.0f) pairs.push_back({k, grid.place(i, j - 1), static_cast<double>(c.ay[k])});
    }
    for (const PressureEdge& e : c.edges) pairs.push_back({e.a, e.b, static_cast<double>(e.coefficient)});
    for (const Pair& p : pairs) {
      diagonal[p.a] += p.coefficient;
      diagonal[p.b] += p.coefficient;
    }
    number.assign(diagonal.size(), -1);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < diagonal.size(); ++k) {
      if (diagonal[k] <= 0.0) continue;
      number[k] = static_cast<int>(place.size());
      place.push_back(k);
      entries.emplace_back(number[k], number[k], diagonal[k]);
    }
    for (const Pair& p : pairs) {
      entries.emplace_back(number[p.a], number[p.b], -p.coefficient);
      entries.emplace_back(number[p.b], number[p.a], -p.coefficient);
    }
    for (const PressureBody& body : bodies) {
      for (const auto& a : body.entries) {
        for (const auto& b : body.entries) {
          double value = 0.0;
          for (std::size_t k = 0; k < 3; ++k) {
            value += static_cast<double>(body.mobility[k]) * static_cast<double>(a.j[k]) * static_cast<double>(b.j[k]);
          }
          entries.emplace_back(number[a.place], number[b.place], value);
        }
      }
    }
    matrix.resize(static_cast<int>(place.size()), static_cast<int>(place.size()));
    matrix.setFromTriplets(entries.begin(), entries.end());
  }

  Eigen::VectorXd gather(const float* field) const {
    Eigen::VectorXd v(static_cast<int>(place.size()));
    for (std::size_t k = 0; k < place.size(); ++k) v[static_cast<int>(k)] = static_cast<double>(field[place[k]]);
    return v;
  }
};

}  // namespace froude::test
