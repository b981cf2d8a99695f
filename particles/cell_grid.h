// Particles sorted into square cells: a stable counting sort, and the runs of candidates around a cell.
#pragma once

#include <cstdint>
#include <span>

#include <froude/base/aligned.h>
#include <froude/base/api.h>
#include <froude/base/error.h>
#include <froude/base/types.h>
#include <froude/particles/key_sort.h>

namespace froude {

/// Where the cells are. Row-major: cell = iy · nx + ix.
struct FROUDE_API GridFrame {
  Vec2 origin{0.0, 0.0};  ///< lower left corner [m]
  double cellSize = 1.0;  ///< edge of a cell and largest search radius [m]; periodic axes stretch it, see cellExtent
  std::int32_t nx = 1, ny = 1;
  bool periodicX = false, periodicY = false;
  Vec2 period{0.0, 0.0};  ///< of periodic axes [m]; 0 means nx · cellSize, ny · cellSize

  /// The cells of at least `cellSize` that cover `box`; a periodic axis has the box's extent as its period, divided
  /// into a whole number of cells. Error if the box is empty or not finite, if cellSize is not a positive number, if a
  /// periodic axis is shorter than 3 cells (a particle would be its own neighbour's neighbour twice) or above 2³⁰
  /// cells.
  static GridFrame cover(const Box& box, double cellSize, bool periodicX = false, bool periodicY = false);

  Vec2 periodLength() const {
    return {period.x() > 0.0 ? period.x() : nx * cellSize, period.y() > 0.0 ? period.y() : ny * cellSize};
  }
  /// Width and height of a cell [m], both ≥ cellSize.
  Vec2 cellExtent() const {
    const Vec2 p = periodLength();
    return {periodicX ? p.x() / nx : cellSize, periodicY ? p.y() / ny : cellSize};
  }
  std::size_t cellCount() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  /// The shortest of all images of a difference of two positions [m]; both inside the frame along periodic axes.
  Vec2 minimumImage(Vec2 d) const {
    const Vec2 p = periodLength();
    if (periodicX) d.x() -= p.x() * std::nearbyint(d.x() / p.x());
    if (periodicY) d.y() -= p.y() * std::nearbyint(d.y() / p.y());
    return d;
  }
};

/// Particles [begin, end) after sorting; add (shiftX, shiftY) to their positions to see them from the asking cell [m].
struct CellRun {
  std::uint32_t begin, end;
  double shiftX, shiftY;
};

/// `build` finds the order; the owner of the positions then permutes them by `order()`, after which `cellStart` and the
/// runs speak of indices in the sorted columns. A particle outside the frame counts into the nearest border cell, which
/// keeps neighbour search right (clamping brings no two particles farther apart) but slow if many are; along a periodic
/// axis positions must be inside the period. A particle with a position that is not a number goes to a border cell.
/// The result depends on the input alone, not on threads. Allocates only where a build is larger than all before.
class FROUDE_API CellGrid {
 public:
  /// x, y: positions [m], same length, below 2³². Cost: O(particles + cells); see docs/decisions.
  void build(std::span<const double> x, std::span<const double> y, const GridFrame& frame);

  const GridFrame& frame() const { return frame_; }
  std::size_t size() const { return cell_.size(); }
  /// new[i] = old[order()[i]] sorts by cell and keeps the order within a cell.
  std::span<const std::uint32_t> order() const { return sort_.order(); }
  /// True if `order()` is 0, 1, 2, …: nothing to permute.
  bool sorted() const { return sort_.sorted(); }
  /// cellCount() + 1 offsets into the sorted particles.
  std::span<const std::uint32_t> cellStart() const { return sort_.start(); }
  /// The cell of each particle, in the order of the input of `build` (not sorted).
  std::span<const std::uint32_t> cells() const { return cell_.span(); }

  /// The cell of a point, by the arithmetic of `build`.
  std::uint32_t cellOf(double x, double y) const {
    const std::int32_t cx = clampedCell((x - frame_.origin.x()) * inverse_.x(), last_.x());
    const std::int32_t cy = clampedCell((y - frame_.origin.y()) * inverse_.y(), last_.y());
    return static_cast<std::uint32_t>(cy * frame_.nx + cx);
  }

  /// run(const CellRun&) for the particles in the 3 × 3 cells around `cell`, itself included, in a fixed order: three
  /// runs, more at periodic seams, fewer at borders; runs may be empty.
  template <typename F>
  void forEachRun(std::uint32_t cell, F&& run) const {
    const auto nx = static_cast<std::uint32_t>(frame_.nx);
    const std::int32_t cx = static_cast<std::int32_t>(cell % nx), cy = static_cast<std::int32_t>(cell / nx);
    for (std::int32_t iy = cy - 1; iy <= cy + 1; ++iy) {
      std::int32_t row = iy;
      double shiftY = 0.0;
      if (!wrap(row, frame_.ny, frame_.periodicY, period_.y(), shiftY)) continue;
      const std::int32_t first = cx > 0 ? cx - 1 : 0, last = cx + 1 < frame_.nx ? cx + 1 : cx;
      if (cx == 0 && frame_.periodicX) run(runOf(row, frame_.nx - 1, frame_.nx - 1, -period_.x(), shiftY));
      run(runOf(row, first, last, 0.0, shiftY));
      if (cx + 1 == frame_.nx && frame_.periodicX) run(runOf(row, 0, 0, period_.x(), shiftY));
    }
  }

  std::size_t memoryBytes() const;

 private:
  // Comparisons in this form send NaN to 0 instead of an undefined conversion.
  static std::int32_t clampedCell(double t, double last) {
    return static_cast<std::int32_t>(t > 0.0 ? (t < last ? t : last) : 0.0);
  }
  static bool wrap(std::int32_t& i, std::int32_t n, bool periodic, double period, double& shift) {
    if (i >= 0 && i < n) return true;
    shift = i < 0 ? -period : period;
    i += i < 0 ? n : -n;
    return periodic;
  }
  CellRun runOf(std::int32_t row, std::int32_t first, std::int32_t last, double shiftX, double shiftY) const {
    const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(frame_.nx);
    const std::span<const std::uint32_t> start = sort_.start();
    return {start[base + static_cast<std::size_t>(first)], start[base + static_cast<std::size_t>(last) + 1], shiftX,
            shiftY};
  }
  void findCells(std::span<const double> x, std::span<const double> y);

  GridFrame frame_;
  Vec2 inverse_{1.0, 1.0}, last_{0.0, 0.0}, period_{1.0, 1.0};
  AlignedArray<std::uint32_t> cell_;
  KeySort sort_;
};

}  // namespace froude
