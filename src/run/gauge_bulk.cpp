#include "run/gauge_bulk.h"

#include <algorithm>
#include <cmath>

#include <froude/base/parallel.h>
#include <froude/solver/fluid/kernel.h>

namespace froude::run {
namespace {

constexpr double kReach = 2.0 * kernel::kSupport;  // of a particle [cells]
constexpr std::int64_t kAcross = 8;                // cells that its support holds along an axis
constexpr std::int64_t kMargin = kAcross;          // cells beside a row, so that none need be left out
constexpr double kPerCell = 0.5;                   // dx/cell: h is half a spacing

/// The first cell inside the support; one at its edge has no share.
std::int64_t firstCell(double place) { return static_cast<std::int64_t>(std::floor(place - kReach)) + 1; }

}  // namespace

BulkFraction::BulkFraction(const ParticlePool& fluid, const CellWindow& window) : window_(window) {
  const std::int64_t bands = (window.rows + kBandRows - 1) / kBandRows;
  const auto x = fluid.x(), y = fluid.y();
  // A particle that reaches into the window from below begins in its first band.
  const auto bandOf = [&](std::size_t i, Vec2& place) -> std::int64_t {
    place = (Vec2(x[i], y[i]) - window.first) / window.h;
    const bool near = place.x() > -kReach && place.y() > -kReach &&
                      place.x() < static_cast<double>(window.columns - 1) + kReach &&
                      place.y() < static_cast<double>(window.rows - 1) + kReach;
    return near ? std::max<std::int64_t>(0, firstCell(place.y())) / kBandRows : -1;
  };
  bandStart_.assign(static_cast<std::size_t>(bands) + 1, 0);
  Vec2 place;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const std::int64_t band = bandOf(i, place);
    if (band >= 0 && band < bands) ++bandStart_[static_cast<std::size_t>(band) + 1];
  }
  for (std::size_t b = 1; b < bandStart_.size(); ++b) bandStart_[b] += bandStart_[b - 1];
  places_.resize(bandStart_.back());
  std::vector<std::uint32_t> next(bandStart_.begin(), bandStart_.end() - 1);
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const std::int64_t band = bandOf(i, place);
    if (band >= 0 && band < bands) places_[next[static_cast<std::size_t>(band)]++] = place;
  }
}

void BulkFraction::rows(std::int64_t firstRow, std::int64_t count, float* out) const {
  const std::int64_t first = firstRow / kBandRows;
  const auto bands = static_cast<std::size_t>((count + kBandRows - 1) / kBandRows);
  parallelFor(bands, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::int64_t done = static_cast<std::int64_t>(b) * kBandRows;
      addBand(first + static_cast<std::int64_t>(b), std::min(kBandRows, count - done), out + done * window_.columns);
    }
  });
}

void BulkFraction::addBand(std::int64_t band, std::int64_t count, float* out) const {
  const std::int64_t bottom = band * kBandRows, stride = window_.columns + 2 * kMargin;
  std::vector<double> sums(static_cast<std::size_t>(count * stride), 0.0);
  const std::size_t from = bandStart_[static_cast<std::size_t>(std::max<std::int64_t>(0, band - 1))];
  const std::size_t to = bandStart_[static_cast<std::size_t>(band) + 1];
  for (std::size_t k = from; k < to; ++k) {
    const Vec2& p = places_[k];
    const std::int64_t left = firstCell(p.x()), low = firstCell(p.y());
    double u2[kAcross];
    for (int i = 0; i < kAcross; ++i) {
      const double u = kPerCell * (static_cast<double>(left + i) - p.x());
      u2[i] = u * u;
    }
    for (std::int64_t j = std::max(low, bottom); j < std::min(low + kAcross, bottom + count); ++j) {
      const double v = kPerCell * (static_cast<double>(j) - p.y()), v2 = v * v;
      double* row = &sums[static_cast<std::size_t>((j - bottom) * stride + kMargin + left)];
      for (int i = 0; i < kAcross; ++i) row[i] += kernel::value(u2[i] + v2);
    }
  }
  for (std::int64_t r = 0; r < count; ++r) {
    const auto row = sums.begin() + static_cast<std::ptrdiff_t>(r * stride + kMargin);
    std::copy(row, row + window_.columns, out + r * window_.columns);
  }
}

}  // namespace froude::run
