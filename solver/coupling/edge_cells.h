// Square cells that list the edges whose middles lie in them: which edges may be near a point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <froude/base/types.h>

namespace froude {

/// Rebuilt whole; memory is reused. Lists are in the order of the edges.
class EdgeCells {
 public:
  /// `ends`: two for each edge [m]; reach: no edge matters farther from its middle than this [m]. Cost: a counting
  /// sort.
  void build(std::span<const Vec2> ends, double reach);
  /// All ends are inside.
  const Box& box() const { return box_; }
  double cell() const { return cell_; }
  /// visit(edge) for all edges that may matter to a point within `reach` of x, and others.
  template <typename Visit>
  void forEachNear(const Vec2& x, double reach, Visit&& visit) const {
    if (sorted_.empty()) return;
    const double r = reach + cell_;
    const Vec2 low = (x - box_.min - Vec2(r, r)) / cell_, high = (x - box_.min + Vec2(r, r)) / cell_;
    const int x0 = std::max(0, static_cast<int>(std::max(low.x(), -1.0))),
              y0 = std::max(0, static_cast<int>(std::max(low.y(), -1.0)));
    const int x1 = std::min(nx_ - 1, static_cast<int>(std::min(high.x(), 1e6)));
    const int y1 = std::min(ny_ - 1, static_cast<int>(std::min(high.y(), 1e6)));
    for (int j = y0; j <= y1; ++j) {
      for (int i = x0; i <= x1; ++i) {
        const auto cell = static_cast<std::size_t>(j * nx_ + i);
        for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) visit(sorted_[k]);
      }
    }
  }

 private:
  Box box_;
  double cell_ = 1.0;  // [m]
  int nx_ = 1, ny_ = 1;
  std::vector<std::uint32_t> start_, sorted_, cellOf_;
};

}  // namespace froude
