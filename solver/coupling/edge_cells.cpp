#include <froude/solver/coupling/edge_cells.h>

#include <algorithm>
#include <cmath>

namespace froude {

void EdgeCells::build(std::span<const Vec2> ends, double reach) {
  const std::size_t edges = ends.size() / 2;
  box_ = Box();
  for (const Vec2& p : ends) box_.include(p);
  sorted_.resize(edges);
  cellOf_.resize(edges);
  if (edges == 0) return;
  const Vec2 size = box_.size();
  const double most = 4.0 * static_cast<double>(edges) + 16.0;
  cell_ = std::max({reach, std::sqrt(size.x() * size.y() / most), size.maxCoeff() / most, 1e-300});
  nx_ = static_cast<int>(size.x() / cell_) + 1;
  ny_ = static_cast<int>(size.y() / cell_) + 1;
  start_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) + 1, 0);
  for (std::size_t e = 0; e < edges; ++e) {
    const Vec2 middle = 0.5 * (ends[2 * e] + ends[2 * e + 1]) - box_.min;
    cellOf_[e] =
        static_cast<std::uint32_t>(static_cast<int>(middle.y() / cell_) * nx_ + static_cast<int>(middle.x() / cell_));
    ++start_[cellOf_[e] + 1];
  }
  for (std::size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
  for (std::size_t e = edges; e-- > 0;) sorted_[--start_[cellOf_[e] + 1]] = static_cast<std::uint32_t>(e);
  // Filling from behind has moved each begin one place down.
  for (std::size_t k = 0; k + 1 < start_.size(); ++k) start_[k] = start_[k + 1];
  start_.back() = static_cast<std::uint32_t>(edges);
}

}  // namespace froude
