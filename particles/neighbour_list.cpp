#include <froude/particles/neighbour_list.h>

#include <algorithm>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>
#include <froude/particles/list_rows.h>

namespace froude {

void NeighbourList::build(const CellGrid& grid, std::span<const double> x, std::span<const double> y, double radius,
                          double skin, SimdTarget target) {
  FROUDE_ASSERT(x.size() == grid.size() && y.size() == grid.size());
  FROUDE_ASSERT(radius >= 0.0 && skin >= 0.0 && radius + skin <= grid.frame().cellSize * (1.0 + 1e-12));
  frame_ = grid.frame();
  radius_ = radius;
  skin_ = skin;
  first_.resize(x.size());
  count_.resize(x.size());
  const std::size_t blocks = blockCount(x.size(), kRowsPerBlock);
  if (blocks_.size() < blocks) blocks_.resize(blocks);
  const ListRows listRows = listRowsLoop(target);
  const double limit = (radius + skin) * (radius + skin);
  parallelFor(x.size(), kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    listRows(grid, {x.data(), y.data(), limit, first_.data(), count_.data()}, begin, end,
             blocks_[begin / kRowsPerBlock]);
  });
  entries_ = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t last = std::min(x.size(), (b + 1) * kRowsPerBlock) - 1;
    entries_ += first_[last] + count_[last];
  }
  builtX_.clear();
  builtY_.clear();
  if (skin > 0.0) {
    builtX_.assign(x);
    builtY_.assign(y);
  }
}

bool NeighbourList::stillHolds(std::span<const double> x, std::span<const double> y) const {
  if (x.size() != size() || builtX_.size() != x.size()) return false;
  const double limit = 0.25 * skin_ * skin_;
  const double moved = parallelMax(x.size(), 0.0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 d = frame_.minimumImage({x[i] - builtX_[i], y[i] - builtY_[i]});
      if (!(d.squaredNorm() <= limit)) return kInfinity;  // in this form NaN counts as moved
    }
    return 0.0;
  });
  return moved == 0.0;
}

std::size_t NeighbourList::memoryBytes() const {
  std::size_t bytes = (first_.capacity() + count_.capacity()) * sizeof(std::uint32_t);
  bytes += (builtX_.capacity() + builtY_.capacity()) * sizeof(double);
  for (const auto& block : blocks_) bytes += block.capacity() * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace froude
