// Area and level: one pass over all cells near the fluid, row by row from below, in strips that bound the memory.
#include <algorithm>
#include <cmath>

#include <froude/solver/fluid/kernel.h>
#include "run/gauge_surface.h"

namespace froude::run {
namespace {

constexpr float kWet = 0.5f;
// Between cells dx apart that are both above (below) these, φ stays above (below) ½: its gradient is at most 0.71/dx,
// at a plane surface, and a void that would dig down to ½ between them shows at the cells around it.
constexpr float kSurelyWet = 0.9f, kSurelyDry = 0.1f;
constexpr float kNotLookedAt = -1.0f;
constexpr std::int64_t kStripCells = 1 << 20;

}  // namespace

/// The run of wet cells from the bottom of each column.
struct FluidSurface::ColumnTops {
  enum class State : std::uint8_t { Searching, Wet, Done };
  std::vector<State> state;
  std::vector<std::int64_t> bottom;  // rows
  std::vector<float> below;          // φ of the row before
  std::vector<double> top;           // [m above the domain's lower side]; NaN: dry, or not known yet

  explicit ColumnTops(const FluidSurface& s)
      : state(static_cast<std::size_t>(s.columns_), State::Searching),
        bottom(state.size()),
        below(state.size(), kNotLookedAt),
        top(state.size(), std::nan("")) {
    for (std::size_t c = 0; c < state.size(); ++c)
      bottom[c] = s.bottomRow(s.node(static_cast<std::int64_t>(c), 0).x(), s.rows_);
  }

  void addRow(const FluidSurface& s, std::int64_t row, const float* phi) {
    for (std::size_t c = 0; c < state.size(); ++c) {
      const bool wet = phi[c] >= kWet;
      if (state[c] == State::Searching && row == bottom[c])
        state[c] = wet ? State::Wet : State::Done;
      else if (state[c] == State::Wet && !wet)
        close(s, c, row, static_cast<double>(phi[c]));
      below[c] = phi[c];
    }
  }

  /// The run ended below `row`.
  void close(const FluidSurface& s, std::size_t c, std::int64_t row, double phi) {
    const Vec2 wet = s.node(static_cast<std::int64_t>(c), row - 1), dry = wet + Vec2(0.0, s.h_);
    top[c] = wet.y() + s.h_ * s.crossing(wet, static_cast<double>(below[c]), dry, phi) - s.origin_.y();
    state[c] = State::Done;
  }

  /// Runs that fill the window end at the ceiling, or at an open side.
  void finish(const FluidSurface& s) {
    for (std::size_t c = 0; c < state.size(); ++c) {
      if (state[c] != State::Wet) continue;
      const Vec2 beyond = s.node(static_cast<std::int64_t>(c), s.rows_);
      close(s, c, s.rows_, s.solid(beyond) ? std::nan("") : 0.0);
    }
  }

  double mean() const {
    double sum = 0.0;
    std::size_t wet = 0;
    for (const double t : top) {
      if (std::isnan(t)) continue;
      sum += t;
      ++wet;
    }
    return wet > 0 ? sum / static_cast<double>(wet) : std::nan("");
  }
};

void FluidSurface::scan() {
  area_ = 0.0;
  level_ = std::nan("");
  if (rows_ == 0 || columns_ == 0) return;
  constexpr std::int64_t kBand = BulkFraction::kBandRows;
  const std::int64_t stripRows = std::max(kBand, kStripCells / columns_ / kBand * kBand);
  const BulkFraction bulk(*world_.fluid(), {node(0, 0), h_, columns_, rows_});
  ColumnTops tops(*this);
  std::vector<float> phi(static_cast<std::size_t>((std::min(stripRows, rows_) + 1) * columns_));
  std::int64_t wetCells = 0;
  for (std::int64_t first = 0; first < rows_; first += stripRows) {
    const std::int64_t rows = std::min(stripRows, rows_ - first);
    fillStrip(phi, bulk, first, rows);
    const auto end = phi.begin() + static_cast<std::ptrdiff_t>(rows * columns_);
    wetCells += std::count_if(phi.begin(), end, [](float v) { return v >= kWet; });
    for (std::int64_t r = 0; r < rows; ++r) tops.addRow(*this, first + r, &phi[static_cast<std::size_t>(r * columns_)]);
  }
  tops.finish(*this);
  area_ = static_cast<double>(wetCells) * h_ * h_;
  level_ = tops.mean();
}

// Away from solids φ is the particles' part alone. Near them the cells of even rows and columns come first; between
// those that are all surely wet, or all surely dry, nothing needs a look.
void FluidSurface::fillStrip(std::vector<float>& phi, const BulkFraction& bulk, std::int64_t firstRow,
                             std::int64_t rows) const {
  const std::int64_t w = columns_;
  const std::int64_t rowsAbove = std::min(rows + 1, rows_ - firstRow);  // the next strip's first row closes the squares
  bulk.rows(firstRow, rowsAbove, phi.data());
  const std::vector<Near> near = solidMask(firstRow, rowsAbove);
  std::vector<Vec2> points;
  std::vector<std::size_t> places;
  const auto look = [&] {
    const std::vector<float> values = evaluate(points);
    for (std::size_t k = 0; k < values.size(); ++k) phi[places[k]] = values[k];
    points.clear();
    places.clear();
  };
  for (std::int64_t r = 0; r < rowsAbove; r += 2)
    for (std::int64_t i = 0; i < w; i += 2) {
      const auto at = static_cast<std::size_t>(r * w + i);
      if (near[at] == Near::Nothing) continue;
      phi[at] = kNotLookedAt;
      if (!active(i, firstRow + r)) continue;
      points.push_back(node(i, firstRow + r));
      places.push_back(at);
    }
  look();

  for (std::int64_t r = 0; r < rows; ++r)
    for (std::int64_t i = (r & 1) != 0 ? 0 : 1; i < w; i += (r & 1) != 0 ? 1 : 2) {
      const auto at = static_cast<std::size_t>(r * w + i);
      if (near[at] == Near::Nothing) continue;
      phi[at] = kNotLookedAt;
      if (!active(i, firstRow + r)) continue;
      const std::int64_t stepX = i & 1, stepY = r & 1;
      if (near[at] == Near::Beside && i + stepX < w && r + stepY < rowsAbove) {
        float least = 2.0f, most = -2.0f;
        for (const std::int64_t y : {-stepY, stepY})
          for (const std::int64_t x : {-stepX, stepX}) {
            const float corner = phi[static_cast<std::size_t>((r + y) * w + i + x)];
            least = std::min(least, std::isnan(corner) ? kNotLookedAt : corner);
            most = std::max(most, corner);
          }
        if (least >= kSurelyWet || (most <= kSurelyDry && least >= 0.0f)) {
          phi[at] = least >= kSurelyWet ? 1.0f : 0.0f;
          continue;
        }
      }
      points.push_back(node(i, firstRow + r));
      places.push_back(at);
    }
  look();
}

// Cells whose support meets a wall, a periodic side or the box of a polygon; the polygon
// itself may lie between the cells of that box.
std::vector<FluidSurface::Near> FluidSurface::solidMask(std::int64_t firstRow, std::int64_t rows) const {
  std::vector<Near> mask(static_cast<std::size_t>(rows * columns_), Near::Nothing);
  const auto mark = [&](const Box& box, Near what) {
    const auto cell = [](double t, std::int64_t end) {
      return static_cast<std::int64_t>(std::clamp(t, -1.0, static_cast<double>(end)));
    };
    const Vec2 low = (box.min - node(0, firstRow)) / h_, high = (box.max - node(0, firstRow)) / h_;
    const std::int64_t r0 = std::max<std::int64_t>(0, cell(low.y(), rows)),
                       i0 = std::max<std::int64_t>(0, cell(low.x(), columns_));
    const std::int64_t r1 = cell(high.y() + 1.0, rows - 1), i1 = cell(high.x() + 1.0, columns_ - 1);
    for (std::int64_t r = r0; r <= r1; ++r)
      for (std::int64_t i = i0; i <= i1; ++i) {
        Near& m = mask[static_cast<std::size_t>(r * columns_ + i)];
        m = std::max(m, what);
      }
  };
  const DomainDef& domain = world_.definition().domain;
  const double reach = kernel::kSupport * dx_;
  for (std::size_t side = 0; side < 4; ++side) {
    const int axis = side < 2 ? 0 : 1;
    if (!domain.closed[side] && !(axis == 0 ? domain.periodicX : domain.periodicY)) continue;
    Box strip = domain.box.grown(dx_);
    if (side % 2 == 0)
      strip.max[axis] = domain.box.min[axis] + reach;
    else
      strip.min[axis] = domain.box.max[axis] - reach;
    mark(strip, Near::Beside);
  }
  for (std::size_t b = 0; b < world_.bodyCount(); ++b) {
    const Box local = world_.bodyDefinition(b).shape->bounds();
    const Transform& transform = world_.body(b).transform;
    Box box;
    for (const double x : {local.min.x(), local.max.x()})
      for (const double y : {local.min.y(), local.max.y()}) box.include(transform.toWorld(Vec2(x, y)));
    mark(box.grown(reach), Near::Beside);
    mark(box, Near::Inside);
  }
  return mask;
}

}  // namespace froude::run
