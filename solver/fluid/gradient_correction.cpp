#include <froude/solver/fluid/gradient_correction.h>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr float kLeastMoment = 0.5f;  // determinant; below, the mean is of too few
constexpr std::int32_t kReach = 2;    // cells on each side over which M is averaged
constexpr float kStray = 0.03f;       // share of particles at a surface that make none
constexpr std::size_t kBlock = 128;   // cells a task

}  // namespace

GradientCorrection::Sum GradientCorrection::around(const GridFrame& frame, std::uint32_t cell) const {
  const auto cx = static_cast<std::int32_t>(cell % static_cast<std::uint32_t>(frame.nx));
  const auto cy = static_cast<std::int32_t>(cell / static_cast<std::uint32_t>(frame.nx));
  auto wrapped = [](std::int32_t k, std::int32_t n, bool periodic) { return periodic ? (k + n) % n : k; };
  Sum sum;
  sum.surface = 0.0f;
  for (std::int32_t y = cy - kReach; y <= cy + kReach; ++y) {
    const std::int32_t row = wrapped(y, frame.ny, frame.periodicY);
    if (row < 0 || row >= frame.ny) continue;
    for (std::int32_t x = cx - kReach; x <= cx + kReach; ++x) {
      const std::int32_t column = wrapped(x, frame.nx, frame.periodicX);
      if (column < 0 || column >= frame.nx) continue;
      const Sum& other =
          cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(frame.nx) + static_cast<std::size_t>(column)];
      sum.xx += other.xx;
      sum.xy += other.xy;
      sum.yy += other.yy;
      sum.count += other.count;
      sum.surface += other.surface;
      sum.open += other.open;
      sum.none[0] += other.none[0];
      sum.none[1] += other.none[1];
    }
  }
  return sum;
}

void GradientCorrection::build(const CellGrid& grid, std::span<const std::uint32_t> occupied,
                               const Matrices<const float>& moment, const Place* place, float usual) {
  const std::size_t n = grid.size();
  for (AlignedArray<float>* a : {&xx_, &xy_, &yy_}) a->resize(n);
  deep_.resize(n);
  closed_.resize(n);
  cells_.resize(grid.frame().cellCount());
  std::fill(cells_.begin(), cells_.end(), Sum{});
  const std::span<const std::uint32_t> start = grid.cellStart();
  parallelFor(occupied.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Sum sum;
      sum.surface = 0.0f;
      for (std::uint32_t i = start[occupied[k]]; i < start[occupied[k] + 1]; ++i) {
        if (place[i] != Place::Inside) {
          sum.surface += 1.0f;
          sum.open += place[i] == Place::AtSurface ? 1.0f : 0.0f;
          continue;
        }
        sum.xx += moment.xx[i];
        sum.xy += moment.xy[i];
        sum.yy += moment.yy[i];
        sum.count += 1.0f;
      }
      if (sum.count == 0.0f) sum.surface += 1.0f;
      cells_[occupied[k]] = sum;
    }
  });
  parallelFor(occupied.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Sum sum = around(grid.frame(), occupied[k]);
      const float scale = sum.count > 0.0f ? 1.0f / sum.count : 0.0f;
      const float xx = scale * sum.xx, xy = scale * sum.xy, yy = scale * sum.yy, det = xx * yy - xy * xy;
      const bool usable = det > kLeastMoment;
      for (std::uint32_t i = start[occupied[k]]; i < start[occupied[k] + 1]; ++i) {
        const bool inside = usable && place[i] == Place::Inside;
        xx_[i] = inside ? yy / det : usual;
        xy_[i] = inside ? -xy / det : 0.0f;
        yy_[i] = inside ? xx / det : usual;
        deep_[i] = inside && sum.surface == 0.0f;
        closed_[i] = place[i] != Place::AtSurface && sum.open <= kStray * (sum.count + sum.surface);
      }
    }
  });
}

std::size_t GradientCorrection::memoryBytes() const {
  return cells_.capacity() * sizeof(Sum) + 3 * xx_.capacity() * sizeof(float) + deep_.capacity() + closed_.capacity();
}

}  // namespace froude
