// A block of fluid as a solver has it, for the benchmarks of cells and neighbours.
#pragma once

#include <cmath>
#include <vector>

#include <froude/base/random.h>
#include <froude/particles/cell_grid.h>

namespace froude::bench {

inline constexpr double kSpacing = 0.01;

// A square block of fluid on a jittered lattice in a domain four times its area, as after a few steps.
struct FluidBlock {
  FluidBlock(std::size_t count, double cell, bool shuffled) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
    RandomStream random(1, 2);
    for (std::size_t i = 0; i < count; ++i) {
      x.push_back((static_cast<double>(i % side) + random.uniform()) * kSpacing);
      y.push_back((static_cast<double>(i / side) + random.uniform()) * kSpacing);
    }
    const double extent = 2.0 * kSpacing * static_cast<double>(side);
    frame = GridFrame::cover({{0.0, 0.0}, {extent, extent}}, cell);
    if (shuffled) return;
    sort();
    for (std::size_t i = 0; i < count; ++i) {  // one step of motion after the sort: nearly sorted
      x[i] += 0.2 * kSpacing * random.uniform(-1.0, 1.0);
      y[i] += 0.2 * kSpacing * random.uniform(-1.0, 1.0);
    }
  }
  void sort() {
    grid.build(x, y, frame);
    const std::vector<double> oldX = x, oldY = y;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = oldX[grid.order()[i]];
      y[i] = oldY[grid.order()[i]];
    }
    grid.build(x, y, frame);
  }
  std::vector<double> x, y;
  GridFrame frame;
  CellGrid grid;
};

}  // namespace froude::bench
