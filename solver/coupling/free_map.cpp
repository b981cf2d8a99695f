#include <froude/solver/coupling/free_map.h>

#include <cstring>

#include <froude/base/parallel.h>

namespace froude {
namespace {

constexpr int kStepsPerCell = 8;  // 255 steps then reach 32 cells far
constexpr std::size_t kReadBehind = 4;

int cellsPerTile(std::size_t particles) { return particles >= 65536 ? 8 : particles >= 8192 ? 4 : 2; }

}  // namespace

void FreeMap::prepare(const Obstacles& obstacles, double radius, const CollisionFilter& filter, std::size_t particles) {
  const int perTile = std::max(perTile_, cellsPerTile(particles));
  const bool same = obstacles.fixedVersion() == fixedVersion_ && obstacles.anyMoving() == moving_;
  if (perTile == perTile_ && same) return;
  perTile_ = perTile;
  fixedVersion_ = obstacles.fixedVersion();
  tiles_ = obstacles.tiles();
  cell_ = tiles_.size / perTile;
  quantum_ = cell_ / kStepsPerCell;
  // Sweeps keep skins of 2⁻⁴⁴ of the largest coordinate; look-ups and steps along a path round far less than this.
  margin_ = radius + 0x1p-40 * (obstacles.scale() + tiles_.size);
  filter_ = filter;
  moving_ = obstacles.anyMoving();
  const std::size_t cells =
      static_cast<std::size_t>(tiles_.nx * perTile_) * static_cast<std::size_t>(tiles_.ny * perTile_);
  fixed_.resize(cells + kReadBehind);
  if (moving_) all_.resize(cells + kReadBehind);
  enterFixed(obstacles);
}

FreeMap::View FreeMap::view() const {
  return {moving_ ? all_.data() : fixed_.data(),
          tiles_.origin.x(),
          tiles_.origin.y(),
          cell_,
          1.0 / cell_,
          quantum_,
          tiles_.nx * perTile_,
          tiles_.ny * perTile_};
}

std::uint8_t FreeMap::steps(double distance) const {
  return static_cast<std::uint8_t>(std::clamp(std::floor((distance - margin_) / quantum_), 0.0, 255.0));
}

Vec2 FreeMap::center(int x, int y, int side) const {
  return tiles_.origin + cell_ * Vec2(x + 0.5 * side, y + 0.5 * side);
}

// Lowers the values of a square of side × side cells to what `bound`, a lower bound of the distance of a point, allows.
// A square that is far for its size gets one value, that of the cells at its corners; others are asked in quarters.
template <typename Bound>
void FreeMap::lower(std::uint8_t* cells, int x, int y, int side, const Bound& bound) const {
  const double distance = bound(center(x, y, side));
  const double corner = 0.70711 * (side - 1) * cell_;
  const std::uint8_t value = steps(distance - corner);
  if (side > 1 && value < 255 && std::abs(distance) < 5.0 * corner) {
    const int half = side / 2;
    for (const int dy : {0, half}) {
      for (const int dx : {0, half}) lower(cells, x + dx, y + dy, half, bound);
    }
    return;
  }
  const int nx = tiles_.nx * perTile_;
  for (int row = y; row < y + side; ++row) {
    std::uint8_t* line = cells + static_cast<std::ptrdiff_t>(row) * nx;
    for (int column = x; column < x + side; ++column) line[column] = std::min(line[column], value);
  }
}

void FreeMap::enterFixed(const Obstacles& obstacles) {
  const DomainDef& domain = obstacles.domain();
  // What is beyond a periodic side is another image, which this map leaves to the exact query.
  const auto bound = [&](const Vec2& at) {
    double distance = obstacles.fixedBound(at, filter_);
    if (domain.periodicX) distance = std::min({distance, at.x() - domain.box.min.x(), domain.box.max.x() - at.x()});
    if (domain.periodicY) distance = std::min({distance, at.y() - domain.box.min.y(), domain.box.max.y() - at.y()});
    return distance;
  };
  std::memset(fixed_.data(), 255, fixed_.size());
  parallelFor(static_cast<std::size_t>(tiles_.ny), 1, [&](std::size_t row, std::size_t) {
    const int y = static_cast<int>(row) * perTile_;
    for (int tile = 0; tile < tiles_.nx; ++tile) lower(fixed_.data(), tile * perTile_, y, perTile_, bound);
  });
}

void FreeMap::refresh(const Obstacles& obstacles) {
  if (!moving_) return;
  const auto nx = static_cast<std::size_t>(tiles_.nx * perTile_);
  const std::uint8_t beyond = steps(obstacles.reach());
  parallelFor(static_cast<std::size_t>(tiles_.ny), 1, [&](std::size_t row, std::size_t) {
    const int tileY = static_cast<int>(row), y = tileY * perTile_;
    const std::size_t first = static_cast<std::size_t>(y) * nx;
    for (std::size_t c = first; c < first + static_cast<std::size_t>(perTile_) * nx; ++c) {
      all_[c] = std::min(fixed_[c], beyond);
    }
    for (int tileX = 0; tileX < tiles_.nx; ++tileX) {
      for (const std::uint32_t k : obstacles.movingIn(tileX, tileY)) {
        lower(all_.data(), tileX * perTile_, y, perTile_,
              [&](const Vec2& at) { return obstacles.movingBound(k, at, filter_); });
      }
    }
  });
}

}  // namespace froude
