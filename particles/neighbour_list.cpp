#include <froude/particles/neighbour_list.h>

#include <algorithm>
#include <array>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>

namespace froude {

void NeighbourList::build(const CellGrid& grid, std::span<const double> x, std::span<const double> y, double radius,
                          double skin) {
  FROUDE_ASSERT(x.size() == grid.size() && y.size() == grid.size());
  FROUDE_ASSERT(radius >= 0.0 && skin >= 0.0 && radius + skin <= grid.frame().cellSize * (1.0 + 1e-12));
  frame_ = grid.frame();
  radius_ = radius;
  skin_ = skin;
  first_.resize(x.size());
  count_.resize(x.size());
  const std::size_t blocks = blockCount(x.size(), kRowsPerBlock);
  if (blocks_.size() < blocks) blocks_.resize(blocks);
  parallelFor(x.size(), kRowsPerBlock,
              [&](std::size_t begin, std::size_t) { buildBlock(grid, x, y, begin / kRowsPerBlock); });
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

void NeighbourList::buildBlock(const CellGrid& grid, std::span<const double> x, std::span<const double> y,
                               std::size_t block) {
  const double limit = (radius_ + skin_) * (radius_ + skin_);
  AlignedArray<std::uint32_t>& buffer = blocks_[block];
  const std::size_t end = std::min(x.size(), (block + 1) * kRowsPerBlock);
  std::array<CellRun, 9> runs;
  std::size_t runCount = 0, candidates = 0, used = 0;
  std::uint32_t cell = 0xFFFFFFFFu;
  for (std::size_t i = block * kRowsPerBlock; i < end; ++i) {
    const double xi = x[i], yi = y[i];
    if (const std::uint32_t c = grid.cellOf(xi, yi); c != cell) {
      cell = c;
      runCount = candidates = 0;
      grid.forEachRun(cell, [&](const CellRun& run) {
        runs[runCount++] = run;
        candidates += run.end - run.begin;
      });
    }
    // Room for all candidates, and half as much again so that a slightly denser step later does not allocate.
    if (buffer.size() < used + candidates) buffer.resize(used + candidates + (used + candidates) / 2);
    first_[i] = static_cast<std::uint32_t>(used);
    std::uint32_t* out = buffer.data() + used;
    for (std::size_t r = 0; r < runCount; ++r) {
      const double xr = xi - runs[r].shiftX, yr = yi - runs[r].shiftY;
      for (std::uint32_t j = runs[r].begin; j < runs[r].end; ++j) {
        const double dx = x[j] - xr, dy = y[j] - yr;
        *out = j;  // written always, kept if near: a branch here would be mispredicted half the time
        out += static_cast<std::size_t>((dx * dx + dy * dy < limit) & (j != i));
      }
    }
    count_[i] = static_cast<std::uint32_t>(out - buffer.data()) - first_[i];
    used += count_[i];
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
