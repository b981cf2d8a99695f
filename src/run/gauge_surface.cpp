#include "run/gauge_surface.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace froude::run {
namespace {

constexpr double kWet = 0.5;
// Between cells dx apart that are both above (below) these, φ stays above (below) ½: its gradient is at most 0.65/dx,
// at a plane surface, and a void that would dig down to ½ between them shows at the cells around it.
constexpr float kSurelyWet = 0.9f, kSurelyDry = 0.1f;
constexpr float kNotLookedAt = -1.0f;
constexpr std::int64_t kStripCells = 1 << 20;
constexpr std::int64_t kMaxTiles = 1 << 22;
constexpr double kSupport = 2.0;  // [dx]

bool isWet(double phi) { return phi >= kWet; }
bool isSolid(double phi) { return std::isnan(phi); }

}  // namespace

FluidSurface::FluidSurface(const World& world) : world_(world) {
  const ParticlePool* fluid = world.fluid();
  if (fluid == nullptr || fluid->empty()) return;
  const DomainDef& domain = world.definition().domain;
  dx_ = world.definition().fluid->spacing;
  h_ = 0.5 * dx_;
  origin_ = domain.box.min;

  Box box;
  const auto x = fluid->x(), y = fluid->y();
  for (std::size_t i = 0; i < fluid->size(); ++i) box.include(Vec2(x[i], y[i]));
  box = box.grown(kSupport * dx_);
  if (domain.periodicX) box.min.x() = domain.box.min.x(), box.max.x() = domain.box.max.x();
  if (domain.periodicY) box.min.y() = domain.box.min.y(), box.max.y() = domain.box.max.y();
  box.min = box.min.cwiseMax(domain.box.min);
  box.max = box.max.cwiseMin(domain.box.max);
  if (box.empty()) return;

  // Cells whose centres are in the box. The slack keeps the last cell of a domain that is a whole number of cells wide.
  const auto first = [&](double from, double o) { return std::ceil((from - o) / h_ - 0.5 - 1e-6); };
  const auto last = [&](double to, double o) { return std::floor((to - o) / h_ - 0.5 + 1e-6); };
  firstColumn_ = static_cast<std::int64_t>(first(box.min.x(), origin_.x()));
  firstRow_ = static_cast<std::int64_t>(first(box.min.y(), origin_.y()));
  columns_ = std::max<std::int64_t>(0, static_cast<std::int64_t>(last(box.max.x(), origin_.x())) - firstColumn_ + 1);
  rows_ = std::max<std::int64_t>(0, static_cast<std::int64_t>(last(box.max.y(), origin_.y())) - firstRow_ + 1);
  markTiles();
}

Vec2 FluidSurface::node(std::int64_t i, std::int64_t j) const {
  return origin_ + h_ * Vec2(static_cast<double>(firstColumn_ + i) + 0.5, static_cast<double>(firstRow_ + j) + 0.5);
}

void FluidSurface::markTiles() {
  tile_ = kSupport * dx_;
  const auto across = [&](std::int64_t cells) {
    return static_cast<std::int64_t>(static_cast<double>(cells) * h_ / tile_) + 1;
  };
  while (across(columns_) * across(rows_) > kMaxTiles) tile_ *= 2.0;
  tilesX_ = across(columns_);
  tilesY_ = across(rows_);
  tiles_.assign(static_cast<std::size_t>(tilesX_ * tilesY_), 0);

  const DomainDef& domain = world_.definition().domain;
  const Vec2 period = domain.box.size();
  const auto x = world_.fluid()->x(), y = world_.fluid()->y();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec2 p(x[i], y[i]);
    if (!std::isfinite(p.x()) || !std::isfinite(p.y())) continue;
    for (int sx = domain.periodicX ? -1 : 0; sx <= (domain.periodicX ? 1 : 0); ++sx)
      for (int sy = domain.periodicY ? -1 : 0; sy <= (domain.periodicY ? 1 : 0); ++sy)
        markParticle(p + period.cwiseProduct(Vec2(sx, sy)));
  }
}

// 2: holds a particle, and its neighbours are marked already.
void FluidSurface::markParticle(const Vec2& p) {
  const Vec2 t = (p - node(0, 0) + Vec2(0.5 * h_, 0.5 * h_)) / tile_;
  if (!(t.x() > -2.0 && t.y() > -2.0 && t.x() < static_cast<double>(tilesX_ + 1) &&
        t.y() < static_cast<double>(tilesY_ + 1)))
    return;
  const auto tx = static_cast<std::int64_t>(std::floor(t.x())), ty = static_cast<std::int64_t>(std::floor(t.y()));
  const bool inside = tx >= 0 && ty >= 0 && tx < tilesX_ && ty < tilesY_;
  if (inside && tiles_[static_cast<std::size_t>(ty * tilesX_ + tx)] == 2) return;
  for (std::int64_t ny = std::max<std::int64_t>(0, ty - 1); ny <= std::min(tilesY_ - 1, ty + 1); ++ny)
    for (std::int64_t nx = std::max<std::int64_t>(0, tx - 1); nx <= std::min(tilesX_ - 1, tx + 1); ++nx) {
      std::uint8_t& mark = tiles_[static_cast<std::size_t>(ny * tilesX_ + nx)];
      mark = std::max<std::uint8_t>(mark, 1);
    }
  if (inside) tiles_[static_cast<std::size_t>(ty * tilesX_ + tx)] = 2;
}

bool FluidSurface::active(std::int64_t i, std::int64_t j) const {
  const auto tx = static_cast<std::int64_t>((static_cast<double>(i) + 0.5) * h_ / tile_);
  const auto ty = static_cast<std::int64_t>((static_cast<double>(j) + 0.5) * h_ / tile_);
  return tiles_[static_cast<std::size_t>(std::min(ty, tilesY_ - 1) * tilesX_ + std::min(tx, tilesX_ - 1))] != 0;
}

double FluidSurface::phiAt(const Vec2& point) const {
  double phi = 0.0;
  world_.filledFraction({&point, 1}, {&phi, 1});
  return phi;
}

std::vector<float> FluidSurface::evaluate(const std::vector<Vec2>& points) const {
  std::vector<double> phi(points.size());
  world_.filledFraction(points, phi);
  return {phi.begin(), phi.end()};
}

// The part of the way from a wet point to a dry one at which φ passes ½. Towards a solid the last open point before it
// takes the place of the dry one, so that a surface that creeps up to a wall gets there without a jump.
double FluidSurface::crossing(const Vec2& wet, double phiWet, const Vec2& dry, double phiDry) const {
  double reach = 1.0;
  if (isSolid(phiDry)) {
    double inside = 1.0;
    reach = 0.0;
    for (int k = 0; k < 30; ++k) {
      const double middle = 0.5 * (reach + inside);
      (solid(wet + middle * (dry - wet)) ? inside : reach) = middle;
    }
    phiDry = phiAt(wet + reach * (dry - wet));
    if (isSolid(phiDry) || isWet(phiDry)) return reach;
  }
  phiDry = std::max(phiDry, 0.0);
  return reach * (phiWet - kWet) / (phiWet - phiDry);
}

// Lowest row (of the window, may be negative) whose centre at x is outside solids; `end` if there is none below it.
std::int64_t FluidSurface::bottomRow(double x, std::int64_t end) const {
  std::int64_t j = -firstRow_;
  while (j < end && solid(Vec2(x, node(0, j).y()))) ++j;
  return j;
}

double FluidSurface::height(double x) const {
  constexpr std::int64_t kBatch = 64;
  if (rows_ == 0) return 0.0;
  const std::int64_t bottom = bottomRow(x, rows_);
  double below = 0.0;
  for (std::int64_t first = bottom; bottom < rows_ && first <= rows_; first += kBatch) {
    std::vector<Vec2> points;
    // One row past the window: above the fluid, or in the ceiling.
    for (std::int64_t j = first; j < std::min(first + kBatch, rows_ + 1); ++j) points.emplace_back(x, node(0, j).y());
    const std::vector<float> phi = evaluate(points);
    for (std::size_t k = 0; k < phi.size(); ++k) {
      const double here = static_cast<double>(phi[k]);
      if (isWet(here)) {
        below = here;
        continue;
      }
      if (first == bottom && k == 0) return 0.0;
      const Vec2 wet = points[k] - Vec2(0.0, h_);
      return wet.y() + h_ * crossing(wet, below, points[k], here) - origin_.y();
    }
  }
  return bottom < rows_ ? node(0, rows_).y() - origin_.y() : 0.0;
}

double FluidSurface::area() {
  if (!area_) scan();
  return *area_;
}

double FluidSurface::level() {
  if (!level_) scan();
  return *level_;
}

// Row by row from below, in strips that fit a cache rather than a domain.
void FluidSurface::scan() {
  enum class Column : std::uint8_t { Searching, Wet, Done };
  std::vector<Column> state(static_cast<std::size_t>(columns_), Column::Searching);
  std::vector<std::int64_t> bottom(static_cast<std::size_t>(columns_));
  std::vector<double> top(static_cast<std::size_t>(columns_), std::nan(""));
  for (std::int64_t i = 0; i < columns_; ++i) {
    bottom[static_cast<std::size_t>(i)] = bottomRow(node(i, 0).x(), rows_);
    if (bottom[static_cast<std::size_t>(i)] < 0) state[static_cast<std::size_t>(i)] = Column::Done;
  }

  const std::int64_t width = std::max<std::int64_t>(columns_, 1);
  const std::int64_t stripRows = std::max<std::int64_t>(2, kStripCells / width / 2 * 2);
  std::vector<float> phi(static_cast<std::size_t>((stripRows + 1) * width), kNotLookedAt);
  std::vector<float> before(static_cast<std::size_t>(width), kNotLookedAt);
  std::uint64_t wetCells = 0;
  for (std::int64_t first = 0; first < rows_; first += stripRows) {
    const std::int64_t rows = std::min(stripRows, rows_ - first);
    fillStrip(phi, first, rows, first > 0);
    for (std::int64_t r = 0; r < rows; ++r) {
      const float* row = &phi[static_cast<std::size_t>(r * width)];
      const float* below = r > 0 ? row - width : before.data();
      for (std::int64_t i = 0; i < columns_; ++i) {
        const auto c = static_cast<std::size_t>(i);
        const bool wet = isWet(static_cast<double>(row[i]));
        if (wet) ++wetCells;
        if (state[c] == Column::Searching && first + r == bottom[c]) {
          state[c] = wet ? Column::Wet : Column::Done;
        } else if (state[c] == Column::Wet && !wet) {
          const Vec2 at = node(i, first + r - 1);
          top[c] = at.y() +
                   h_ * crossing(at, static_cast<double>(below[i]), node(i, first + r), static_cast<double>(row[i]));
          state[c] = Column::Done;
        }
      }
    }
    const auto lastRow = phi.begin() + static_cast<std::ptrdiff_t>((rows - 1) * width);
    std::copy(lastRow, lastRow + width, before.begin());
    const auto overlap = phi.begin() + static_cast<std::ptrdiff_t>(stripRows * width);
    std::copy(overlap, overlap + width, phi.begin());
  }

  double sum = 0.0;
  std::size_t wetColumns = 0;
  for (std::int64_t i = 0; i < columns_; ++i) {
    const auto c = static_cast<std::size_t>(i);
    if (state[c] == Column::Wet) {  // up to the ceiling, or to an open side
      const Vec2 at = node(i, rows_ - 1), beyond = node(i, rows_);
      top[c] = at.y() + h_ * crossing(at, static_cast<double>(before[c]), beyond, solid(beyond) ? std::nan("") : 0.0);
    }
    if (std::isnan(top[c])) continue;
    sum += top[c] - origin_.y();
    ++wetColumns;
  }
  area_ = static_cast<double>(wetCells) * h_ * h_;
  level_ = wetColumns > 0 ? sum / static_cast<double>(wetColumns) : std::nan("");
}

// Cells of even rows and columns first; between those that are all surely wet, or all surely dry, nothing needs a look.
// That leaves one φ a particle instead of four. Row 0 may be known from the strip below, at its even columns.
void FluidSurface::fillStrip(std::vector<float>& phi, std::int64_t firstRow, std::int64_t rows,
                             bool bottomKnown) const {
  const std::int64_t w = columns_;
  std::vector<Vec2> points;
  std::vector<std::size_t> places;
  const auto look = [&] {
    const std::vector<float> values = evaluate(points);
    for (std::size_t k = 0; k < values.size(); ++k) phi[places[k]] = values[k];
    points.clear();
    places.clear();
  };
  std::fill(phi.begin() + (bottomKnown ? w : 0), phi.end(), kNotLookedAt);
  for (std::int64_t r = bottomKnown ? 2 : 0; r <= rows && firstRow + r < rows_; r += 2)
    for (std::int64_t i = 0; i < w; i += 2)
      if (active(i, firstRow + r)) {
        points.push_back(node(i, firstRow + r));
        places.push_back(static_cast<std::size_t>(r * w + i));
      }
  look();

  const std::vector<std::uint8_t> nearBody = bodyMask(firstRow, rows);
  for (std::int64_t r = 0; r < rows; ++r)
    for (std::int64_t i = (r & 1) != 0 ? 0 : 1; i < w; i += (r & 1) != 0 ? 1 : 2) {
      if (!active(i, firstRow + r)) continue;
      const auto at = static_cast<std::size_t>(r * w + i);
      const std::int64_t stepX = i & 1, stepY = r & 1;
      const bool inside = i + stepX < w && firstRow + r + stepY < rows_;
      if (inside && (nearBody.empty() || nearBody[at] == 0)) {
        float least = 2.0f, most = -2.0f;
        for (const std::int64_t y : {-stepY, stepY})
          for (const std::int64_t x : {-stepX, stepX}) {
            const float corner = phi[static_cast<std::size_t>((r + y) * w + i + x)];
            least = std::min(least, std::isnan(corner) ? kNotLookedAt : corner);
            most = std::max(most, corner);
          }
        if (least >= kSurelyWet) {
          phi[at] = 1.0f;
          continue;
        }
        if (most <= kSurelyDry && least >= 0.0f) {
          phi[at] = 0.0f;
          continue;
        }
      }
      points.push_back(node(i, firstRow + r));
      places.push_back(at);
    }
  look();
}

// Where a polygon may lie between two wet cells; empty if there is none.
std::vector<std::uint8_t> FluidSurface::bodyMask(std::int64_t firstRow, std::int64_t rows) const {
  std::vector<std::uint8_t> mask;
  for (std::size_t b = 0; b < world_.bodyCount(); ++b) {
    const Box local = world_.bodyDefinition(b).shape->bounds();
    const Transform& transform = world_.body(b).transform;
    Box box;
    for (const double x : {local.min.x(), local.max.x()})
      for (const double y : {local.min.y(), local.max.y()}) box.include(transform.toWorld(Vec2(x, y)));
    const Vec2 low = (box.min - node(0, firstRow)) / h_, high = (box.max - node(0, firstRow)) / h_;
    const auto cell = [](double t, std::int64_t end) {
      return static_cast<std::int64_t>(std::clamp(t, -1.0, static_cast<double>(end)));
    };
    for (std::int64_t r = std::max<std::int64_t>(0, cell(low.y(), rows));
         r <= std::min(rows - 1, cell(high.y() + 1.0, rows)); ++r)
      for (std::int64_t i = std::max<std::int64_t>(0, cell(low.x(), columns_));
           i <= std::min(columns_ - 1, cell(high.x() + 1.0, columns_)); ++i) {
        if (mask.empty()) mask.assign(static_cast<std::size_t>(rows * columns_), 0);
        mask[static_cast<std::size_t>(r * columns_ + i)] = 1;
      }
  }
  return mask;
}

}  // namespace froude::run
