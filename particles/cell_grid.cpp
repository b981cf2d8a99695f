#include <froude/particles/cell_grid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include <froude/base/assert.h>
#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr double kMaxCells = 1073741824.0;  // 2³⁰: 4 GiB of offsets

// Below this a second thread costs more than it saves.
constexpr std::size_t kSerialParticles = 16384;
constexpr std::size_t kMaxChunks = 16;
constexpr std::size_t kCellBlock = 8192;

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
  order_.resize(x.size());
  findCells(x, y);
  // Every chunk costs a histogram of all cells, so sparse grids take fewer. The number of chunks follows the machine,
  // and may: a stable sort has one result.
  const std::size_t affordable = 4 * x.size() / frame.cellCount();
  const std::size_t chunks = std::min({static_cast<std::size_t>(concurrency()), kMaxChunks, affordable});
  if (chunks < 2 || x.size() < kSerialParticles) {
    sortSerial();
  } else {
    sortParallel(chunks);
  }
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

// cellStart_[c + 2] counts the particles of cell c; summed up, cellStart_[c + 1] is where c starts; and when the last
// particle of c has been placed there, it has become where c + 1 starts.
void CellGrid::sortSerial() {
  const std::size_t cells = frame_.cellCount(), n = cell_.size();
  cellStart_.resize(cells + 2);
  std::uint32_t* start = cellStart_.data();
  std::memset(start, 0, (cells + 2) * sizeof(std::uint32_t));
  const std::uint32_t* cell = cell_.data();
  std::uint32_t* order = order_.data();
  std::uint32_t descents = 0, previous = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t c = cell[i];
    descents += c < previous ? 1u : 0u;
    previous = c;
    ++start[c + 2];
  }
  sorted_ = descents == 0;
  std::uint32_t sum = 0;
  for (std::size_t c = 2; c < cells + 2; ++c) start[c] = sum += start[c];
  if (sorted_) {
    for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<std::uint32_t>(i);
    std::memmove(start, start + 1, (cells + 1) * sizeof(std::uint32_t));
  } else {
    for (std::size_t i = 0; i < n; ++i) order[start[cell[i] + 1]++] = static_cast<std::uint32_t>(i);
  }
  cellStart_.resize(cells + 1);
}

void CellGrid::sortParallel(std::size_t chunks) {
  const std::size_t cells = frame_.cellCount(), n = cell_.size();
  const std::size_t chunkSize = (n + chunks - 1) / chunks;
  cellStart_.resize(cells + 1);
  histograms_.resize(chunks * cells);
  std::array<std::uint32_t, kMaxChunks> descents{};
  parallelFor(n, chunkSize, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* histogram = histograms_.data() + begin / chunkSize * cells;
    std::memset(histogram, 0, cells * sizeof(std::uint32_t));
    const std::uint32_t* cell = cell_.data();
    std::uint32_t down = 0, previous = begin > 0 ? cell[begin - 1] : 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t c = cell[i];
      down += c < previous ? 1u : 0u;
      previous = c;
      ++histogram[c];
    }
    descents[begin / chunkSize] = down;
  });
  sorted_ = std::all_of(descents.begin(), descents.end(), [](std::uint32_t d) { return d == 0; });
  blockSums_.resize(blockCount(cells, kCellBlock));
  parallelFor(cells, kCellBlock, [&](std::size_t begin, std::size_t end) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < chunks; ++k) {
      const std::uint32_t* histogram = histograms_.data() + k * cells;
      for (std::size_t c = begin; c < end; ++c) sum += histogram[c];
    }
    blockSums_[begin / kCellBlock] = sum;
  });
  std::uint32_t before = 0;
  for (std::uint32_t& sum : blockSums_) before += std::exchange(sum, before);
  parallelFor(cells, kCellBlock, [&](std::size_t begin, std::size_t end) {
    std::uint32_t next = blockSums_[begin / kCellBlock];
    for (std::size_t c = begin; c < end; ++c) {
      cellStart_[c] = next;
      for (std::size_t k = 0; k < chunks; ++k) next += std::exchange(histograms_[k * cells + c], next);
    }
  });
  cellStart_[cells] = static_cast<std::uint32_t>(n);
  parallelFor(n, chunkSize, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* next = histograms_.data() + begin / chunkSize * cells;
    for (std::size_t i = begin; i < end; ++i) order_[next[cell_[i]]++] = static_cast<std::uint32_t>(i);
  });
}

std::size_t CellGrid::memoryBytes() const {
  return sizeof(std::uint32_t) * (cell_.capacity() + order_.capacity() + cellStart_.capacity() +
                                  histograms_.capacity() + blockSums_.capacity());
}

}  // namespace froude
