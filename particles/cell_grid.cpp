#include <froude/particles/cell_grid.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr double kMaxCells = 1073741824.0;  // 2³⁰: 4 GiB of offsets

std::int32_t cellsAlong(double length, double cellSize, bool periodic, const char* axis) {
  if (!periodic) return std::max(1, static_cast<std::int32_t>(std::min(kMaxCells, std::ceil(length / cellSize))));
  // A period that is a whole number of cells up to rounding keeps that number.
  const double cells = std::floor(length / cellSize * (1.0 + 1e-12));
  if (cells < 3.0) {
    throw Error("cell grid: the period along " + std::string(axis) + ", " + std::to_string(length) +
                " m, is shorter than 3 cells of " + std::to_string(cellSize) +
                " m; make the periodic domain longer or the support radius smaller");
  }
  return static_cast<std::int32_t>(std::min(kMaxCells, cells));
}

}  // namespace

GridFrame GridFrame::cover(const Box& box, double cellSize, bool periodicX, bool periodicY) {
  if (box.empty() || !box.min.allFinite() || !box.max.allFinite()) {
    throw Error("cell grid: the box to cover is empty or not finite");
  }
  if (!(cellSize > 0.0) || !std::isfinite(cellSize)) {
    throw Error("cell grid: a cell size of " + std::to_string(cellSize) + " m is not a positive number");
  }
  const Vec2 extent = box.size();
  GridFrame frame;
  frame.origin = box.min;
  frame.cellSize = cellSize;
  frame.nx = cellsAlong(extent.x(), cellSize, periodicX, "x");
  frame.ny = cellsAlong(extent.y(), cellSize, periodicY, "y");
  frame.periodicX = periodicX;
  frame.periodicY = periodicY;
  frame.period = {periodicX ? extent.x() : 0.0, periodicY ? extent.y() : 0.0};
  const double cells = static_cast<double>(frame.nx) * static_cast<double>(frame.ny);
  if (cells > kMaxCells) {
    throw Error("cell grid: a box of " + std::to_string(extent.x()) + " × " + std::to_string(extent.y()) +
                " m has more than 2^30 cells of " + std::to_string(cellSize) +
                " m; make the domain smaller or the spacing larger");
  }
  return frame;
}

void CellGrid::build(std::span<const double> x, std::span<const double> y, const GridFrame& frame) {
  FROUDE_ASSERT(x.size() == y.size() && x.size() < 0xFFFFFFFFu);
  frame_ = frame;
  period_ = frame.periodLength();
  inverse_ = frame.cellExtent().cwiseInverse();
  last_ = {frame.nx - 1.0, frame.ny - 1.0};
  cell_.resize(x.size());
  findCells(x, y);
  sort_.sort(cell_.span(), frame.cellCount());
}

void CellGrid::findCells(std::span<const double> x, std::span<const double> y) {
  parallelFor(x.size(), 4 * kBlockSize, [&](std::size_t begin, std::size_t end) {
    const double originX = frame_.origin.x(), originY = frame_.origin.y();
    const double inverseX = inverse_.x(), inverseY = inverse_.y();
    const double lastX = last_.x(), lastY = last_.y();
    const std::int32_t nx = frame_.nx;
    std::uint32_t* cell = cell_.data();
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t cx = clampedCell((x[i] - originX) * inverseX, lastX);
      const std::int32_t cy = clampedCell((y[i] - originY) * inverseY, lastY);
      cell[i] = static_cast<std::uint32_t>(cy * nx + cx);
    }
  });
}

std::size_t CellGrid::memoryBytes() const { return sizeof(std::uint32_t) * cell_.capacity() + sort_.memoryBytes(); }

}  // namespace froude
