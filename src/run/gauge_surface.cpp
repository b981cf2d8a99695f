#include "run/gauge_surface.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <froude/solver/fluid/kernel.h>

namespace froude::run {
namespace {

constexpr double kWet = 0.5;
// Between cells dx apart that are both above (below) these, φ stays above (below) ½: its gradient is at most 0.65/dx,
// at a plane surface, and a void that would dig down to ½ between them shows at the cells around it.
constexpr float kSurelyWet = 0.9f, kSurelyDry = 0.1f;
constexpr float kNotLookedAt = -1.0f;
constexpr std::int64_t kStripCells = 1 << 20;
constexpr std::int64_t kMaxTiles = 1 << 22;

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
  box = box.grown(kernel::kSupport * dx_);
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
  tile_ = kernel::kSupport * dx_;
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
    // Not on the wall itself: which side of it a point there is on is a matter of rounding.
    phiDry = phiAt(wet + (1.0 - 1e-6) * reach * (dry - wet));
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

}  // namespace froude::run
