#include <froude/solver/fluid/fluid_cells.h>

#include <froude/base/parallel.h>

namespace froude {

GridFrame fluidFrame(const DomainDef& domain, std::span<const double> x, std::span<const double> y, double cellSize) {
  auto smallest = [](std::span<const double> v) {
    return -parallelMax(v.size(), -kInfinity, [&](std::size_t begin, std::size_t end) {
      double most = -kInfinity;
      for (std::size_t i = begin; i < end; ++i) most = -v[i] > most ? -v[i] : most;
      return most;
    });
  };
  auto largest = [](std::span<const double> v) {
    return parallelMax(v.size(), -kInfinity, [&](std::size_t begin, std::size_t end) {
      double most = -kInfinity;
      for (std::size_t i = begin; i < end; ++i) most = v[i] > most ? v[i] : most;
      return most;
    });
  };
  // What flew outside the domain is about to be retired; it is searched for in the border cells.
  const Vec2 low = Vec2(smallest(x), smallest(y)).cwiseMax(domain.box.min).cwiseMin(domain.box.max);
  const Vec2 high = Vec2(largest(x), largest(y)).cwiseMax(low).cwiseMin(domain.box.max);

  const std::size_t most = std::max<std::size_t>(65536, 16 * x.size());
  double size = cellSize;
  while (true) {
    Box box;
    box.include(Vec2(domain.box.min + size * ((low - domain.box.min) / size).array().floor().matrix()));
    box.include(high);
    if (domain.periodicX) box = {{domain.box.min.x(), box.min.y()}, {domain.box.max.x(), box.max.y()}};
    if (domain.periodicY) box = {{box.min.x(), domain.box.min.y()}, {box.max.x(), domain.box.max.y()}};
    const Vec2 cells = box.size() / size;
    if ((cells.x() + 1.0) * (cells.y() + 1.0) > static_cast<double>(most)) {
      size *= 1.5;
      continue;
    }
    box.max = box.max.cwiseMax(box.min + Vec2(size, size));
    return GridFrame::cover(box, size, domain.periodicX, domain.periodicY);
  }
}

void findOccupiedCells(const CellGrid& grid, std::vector<std::uint32_t>& cells) {
  cells.clear();
  const std::span<const std::uint32_t> start = grid.cellStart();
  for (std::uint32_t c = 0; c + 1 < start.size(); ++c) {
    if (start[c + 1] > start[c]) cells.push_back(c);
  }
}

}  // namespace froude
